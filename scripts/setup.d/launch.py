# SPDX-License-Identifier: GPL-2.0-or-later
"""launch.py THREADS SCRIPT [ARGS]: runs a Python script beside YADE as a batch program.

YADE's own program prints its banner, opens network ports for remote control and ends in a shell of its own; it can be imported as
well, which starts YADE only. The exit code is that of the script.

A signal while YADE starts ends the process at once: an exception must not pass through its libraries. Whoever starts this blocks SIGINT and SIGTERM
(runPython of setup.sh), which Python would meet with a traceback before it reads the first line here. YADE would have SIGHUP change nothing; here it
is as the caller has it: a terminal that is closed ends a script, but for nohup. Standard streams that are closed are opened
on /dev/null, lest a file of the script gets their place.
"""

import contextlib
import importlib.machinery
import importlib.util
import io
import os
import runpy
import shutil
import signal
import sys

#: Signals that end a process, and what it says.
_ENDING = {signal.SIGINT: b"interrupted\n", signal.SIGTERM: b"terminated\n", signal.SIGHUP: b"hung up\n"}


def openStreams():
	for descriptor in range(3):
		try:
			os.fstat(descriptor)
		except OSError:
			os.open(os.devnull, os.O_RDWR)  # takes the lowest free place
	for name, descriptor in (("stdout", 1), ("stderr", 2)):
		if getattr(sys, name) is None:
			setattr(sys, name, open(descriptor, "w", closefd=False))


def flushStreams():
	"""What cannot be written is lost: a reader that has gone changes no exit code."""
	for stream in (sys.stdout, sys.stderr):
		with contextlib.suppress(OSError, ValueError):
			stream.flush()


@contextlib.contextmanager
def endedBySignals():
	"""Within it a signal of _ENDING ends the process at once, SIGHUP at its end, with a shell's exit code for it; after it all are as before."""

	def end(number, frame):
		with contextlib.suppress(OSError):
			os.write(2, _ENDING[number])
		os._exit(128 + number)

	# a signal that the caller has set to be ignored stays so
	before = {number: signal.getsignal(number) for number in _ENDING}
	before = {number: handler for number, handler in before.items() if handler is not signal.SIG_IGN}
	for number in before:
		signal.signal(number, end)
	signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT, signal.SIGTERM})
	# YADE puts a handler of its own, which does nothing, in the place of that of SIGHUP: one that comes meanwhile waits
	signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
	yield
	for number in before:
		signal.signal(number, end)
	signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGHUP})
	for number, handler in before.items():
		signal.signal(number, handler)


def startYade(threads):
	program = os.environ.get("YADE_EXECUTABLE") or shutil.which("yade-double")
	if not program:
		sys.exit("launch.py: yade-double is not in PATH")
	arguments, dontWrite = sys.argv, sys.dont_write_bytecode
	sys.argv, sys.dont_write_bytecode = [program, "-n", "-j", str(threads)], True
	try:
		loader = importlib.machinery.SourceFileLoader("yadeProgram", program)
		module = importlib.util.module_from_spec(importlib.util.spec_from_loader("yadeProgram", loader))
		with contextlib.redirect_stdout(io.StringIO()):  # "Using python version ..."
			loader.exec_module(module)
	finally:
		sys.argv, sys.dont_write_bytecode = arguments, dontWrite


def run(script, arguments):
	"""The script's exit code."""
	sys.argv = [script] + arguments
	try:
		runpy.run_path(script, run_name="__main__")
	except SystemExit as exit:
		if exit.code is None or isinstance(exit.code, int):
			return exit.code or 0
		print(exit.code, file=sys.stderr)
		return 1
	except KeyboardInterrupt:
		print("interrupted", file=sys.stderr)
		return 130
	except BaseException:
		sys.excepthook(*sys.exc_info())
		return 1
	return 0


if __name__ == "__main__":
	openStreams()
	os.environ["HEXMEMBRANE_LAUNCHER"] = os.path.abspath(__file__)
	with endedBySignals():
		startYade(int(sys.argv[1]))
	code = run(sys.argv[2], sys.argv[3:])
	flushStreams()
	import yade

	# YADE's libraries may crash when they are unloaded; this removes its temporary files and leaves without a backtrace.
	yade.O.exitNoBacktrace(code)
