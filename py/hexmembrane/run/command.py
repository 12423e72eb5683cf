# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line ``scripts/run CONFIG --out DIR``."""

import argparse
import os
import pathlib
import sys

from yade import O

from hexmembrane import configuration
from hexmembrane.configuration import ConfigError
from hexmembrane.run.lock import LockError
from hexmembrane.run.manifest import CheckpointError
from hexmembrane.run.pipeline import STAGES, run


def _arguments(argv):
	parser = argparse.ArgumentParser(prog="scripts/run", description="Runs a triaxial test from a configuration.")
	parser.add_argument("config", metavar="CONFIG", help="YAML file of the test, see examples/README.md")
	parser.add_argument("--out", metavar="DIR", help="folder for all output (default: out/NAME OF CONFIG)")
	parser.add_argument("--resume", action="store_true", help="go on from the last checkpoint in DIR")
	parser.add_argument("--until", choices=STAGES, default="shear", help="stop after this stage")
	parser.add_argument("--from", dest="start", metavar="STATE", help="shear a consolidated.yade.gz of another test")
	parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
	return parser.parse_args(argv)


def _restartWithThreads(wanted):
	"""YADE's number of threads is fixed at its start: start its program once more with the wished one."""
	if wanted is None or wanted == O.numThreads:
		return
	program = getattr(sys, "yade_argv", [None])[0]
	if not program or os.environ.get("HEXMEMBRANE_RESTARTED"):
		raise ConfigError("numerics.threads", wanted, f"YADE runs with {O.numThreads}", f"start it with -j {wanted}")
	os.environ["HEXMEMBRANE_RESTARTED"] = "1"
	sys.stdout.flush()
	os.execv(sys.executable, [sys.executable, program, "-n", "-x", "-j", str(wanted), *sys.argv])


def main(argv):
	"""The command line; returns the exit code: 0, 2 for bad input, 1 for a test that failed, 130 when interrupted."""
	arguments = _arguments(argv)
	try:
		config = configuration.load(arguments.config)
		_restartWithThreads(config.numerics.threads)
		out = arguments.out or pathlib.Path("out", pathlib.Path(arguments.config).stem)
		run(config, out, arguments.resume, arguments.until, arguments.start, arguments.quiet)
	except (ConfigError, CheckpointError, LockError) as error:
		print(f"error: {error}", file=sys.stderr)
		return 2
	except (ValueError, RuntimeError, OSError) as error:
		print(f"error: {error}", file=sys.stderr)
		return 1
	except KeyboardInterrupt:
		print("interrupted: --resume goes on from the last checkpoint", file=sys.stderr)
		return 130
	return 0
