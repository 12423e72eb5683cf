# SPDX-License-Identifier: GPL-2.0-or-later
"""launch.py THREADS SCRIPT [ARGS]: runs a Python script beside YADE as a batch program.

YADE's own program prints its banner, opens network ports for remote control and ends in a shell of its own; it can be imported as
well, which starts YADE only. The exit code is that of the script.
"""

import contextlib
import importlib.machinery
import importlib.util
import io
import os
import runpy
import shutil
import sys


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
	startYade(int(sys.argv[1]))
	code = run(sys.argv[2], sys.argv[3:])
	sys.stdout.flush()
	sys.stderr.flush()
	import yade

	# YADE's libraries may crash when they are unloaded; this removes its temporary files and leaves without a backtrace.
	yade.O.exitNoBacktrace(code)
