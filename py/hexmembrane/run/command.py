# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line ``scripts/run CONFIG --out DIR``."""

import argparse
import contextlib
import json
import math
import os
import pathlib
import signal
import sys

from yade import O

from hexmembrane import configuration
from hexmembrane.configuration import ConfigError
from hexmembrane.configuration.json_schema import jsonSchema
from hexmembrane.configuration.schema import LONGEST_PATH, plainText, shown
from hexmembrane.run import checkpoints
from hexmembrane.run.estimate import requireThreads
from hexmembrane.run.lock import LockError
from hexmembrane.run.manifest import CheckpointError
from hexmembrane.run.pipeline import check, run
from hexmembrane.run.progress import tell


def _arguments(argv):
	parser = argparse.ArgumentParser(prog="scripts/run", description="Runs a triaxial test from a configuration.")
	parser.add_argument("config", metavar="CONFIG", nargs="?", help="YAML file of the test, see examples/README.md")
	parser.add_argument("--out", metavar="DIR", help="folder for all output (default: out/NAME OF CONFIG)")
	parser.add_argument("--resume", action="store_true", help="go on from the last checkpoint in DIR")
	parser.add_argument("--until", metavar="STAGE", help="stop after this stage: specimen, boundary, consolidation, shear, or what a list of stages has (default: all)")
	parser.add_argument("--from", dest="start", metavar="STATE", help="shear a consolidated.yade.gz of another test")
	parser.add_argument("--lab", metavar="CURVE", help="CSV of a laboratory's curve to draw under the test's, instead of the key lab.file")
	parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
	parser.add_argument("--schema", action="store_true", help="print the JSON Schema of a configuration, and end")
	parser.add_argument("--check", action="store_true", help="check the configuration and say what would be made; nothing is made")
	parser.add_argument("--json", action="store_true", help="tell an error as one line of JSON on the error stream")
	arguments = parser.parse_args(argv)
	if arguments.config is None and not arguments.schema:
		parser.error("CONFIG is missing")
	if arguments.check and arguments.resume:
		parser.error("--check makes nothing, and --resume goes on from what is there: give one of them")
	return arguments


def _restartWithThreads(wanted):
	"""YADE's number of threads is fixed at its start: the launcher of scripts/run, which says where it is, starts once more with the wished one."""
	if wanted is None or wanted == O.numThreads:
		return
	launcher = os.environ.get("HEXMEMBRANE_LAUNCHER")
	if not launcher or os.environ.get("HEXMEMBRANE_RESTARTED"):
		raise ConfigError("numerics.threads", wanted, f"YADE runs with {O.numThreads}", f"start YADE with -j {wanted}, or use scripts/run")
	os.environ["HEXMEMBRANE_RESTARTED"] = "1"
	signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})  # the launcher takes them on
	os.execv(sys.executable, [sys.executable, launcher, str(wanted), *sys.argv])


class Terminated(KeyboardInterrupt):
	"""The signal SIGTERM, at the end of a chunk of steps."""


class HungUp(KeyboardInterrupt):
	"""The signal SIGHUP, the same: the terminal was closed."""


#: What an interruption is called, and the exit code, a shell's.
_ENDS = {Terminated: ("terminated", 143), HungUp: ("hung up", 129)}


@contextlib.contextmanager
def _terminable():
	"""Within it SIGTERM raises :class:`Terminated` and SIGHUP :class:`HungUp`, unless the caller has them ignored, as nohup does."""

	def end(number, frame):
		raise Terminated if number == signal.SIGTERM else HungUp

	before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)}
	before = {number: handler for number, handler in before.items() if handler is not signal.SIG_IGN}
	for number in before:
		signal.signal(number, end)
	try:
		yield
	finally:
		for number, handler in before.items():
			signal.signal(number, handler)


def _asDict(error, code):
	"""An error for programs: exit code, kind, message, fix; of a bad key also path, value and what is wrong."""
	message = str(error)
	found = {"exit": code, "kind": type(error).__name__, "message": message, "fix": message.rpartition("; fix: ")[2] if "; fix: " in message else None}
	if isinstance(error, ConfigError):
		value = error.value if isinstance(error.value, (str, int, bool, type(None))) or isinstance(error.value, float) and math.isfinite(error.value) else shown(error.value)
		found.update(key=error.path, value=value, wrong=error.wrong, fix=error.fix)
	return {"error": found}


def main(argv):
	"""The command line; returns the exit code: 0, 2 for bad input, 1 for a test that failed, 130 when interrupted, 143 when terminated, 129 when hung up."""
	arguments = _arguments(argv)
	if arguments.schema:
		print(json.dumps(jsonSchema(), indent=1))
		return 0
	out = None

	def failed(error, code):
		tell(json.dumps(_asDict(error, code)) if arguments.json else f"error: {error}", sys.stderr)
		return code

	try:
		with _terminable():
			config = configuration.load(arguments.config)
			if arguments.lab is not None:
				config = configuration.derived(config, {"lab": {"file": os.path.abspath(plainText("--lab", arguments.lab, LONGEST_PATH))}})
			requireThreads(config)
			_restartWithThreads(config.numerics.threads)
			out = pathlib.Path(plainText("--out", arguments.out or os.path.join("out", pathlib.Path(arguments.config).stem), LONGEST_PATH))
			if arguments.check:
				check(config, out, arguments.start)
				return 0
			run(config, out, arguments.resume, arguments.until, arguments.start, arguments.quiet)
	except (ConfigError, CheckpointError, LockError) as error:
		return failed(error, 2)
	except (ValueError, RuntimeError, OSError) as error:
		return failed(error, 1)
	except KeyboardInterrupt as signalled:
		how, code = _ENDS.get(type(signalled), ("interrupted", 130))
		tell(how + (": --resume goes on from the last checkpoint" if out and checkpoints.exist(out) else ", there is no checkpoint yet"), sys.stderr)
		return code
	return 0
