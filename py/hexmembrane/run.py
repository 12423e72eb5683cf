# SPDX-License-Identifier: GPL-2.0-or-later
"""A whole test from one configuration: ``run(config, out)``, or the command line ``scripts/run CONFIG --out DIR``."""

import argparse
import os
import pathlib
import sys

from yade import O

from hexmembrane import checkpoints, config as configuration, scene, specimen, stages
from hexmembrane.plots import plot
from hexmembrane.progress import clock
from hexmembrane.schema import ConfigError, toDict

STAGES = ("specimen", "boundary", "consolidation", "shear")

#: Keys that may differ when a test is resumed: they do not change what has been computed.
_FREE = ("title", "tier", "output.vtkEvery", "output.checkpointEvery", "numerics.threads", "specimen.packing", "specimen.gradation")
_FREE_LIMITS = ("consolidation.maxSteps", "consolidation.unbalanced", "consolidation.tolerance", "consolidation.timeLimit")


def _freshFolder(out, resume):
	"""Make the folder; one that holds a test already is an error unless it is resumed."""
	out = pathlib.Path(out)
	try:
		out.mkdir(parents=True, exist_ok=True)
	except OSError as error:
		raise ConfigError("--out", str(out), f"cannot be made ({error.strerror})", "choose another folder") from None
	if not resume and any((out / name).exists() for name in ("records.csv", "checkpoint.json")):
		raise ConfigError("--out", str(out), "holds a test already", "choose another folder, empty this one, or give --resume")
	return out


def _sameTest(config, out):
	"""Check that the folder's test is the one of this configuration."""
	path = out / "config.yaml"
	if not path.is_file():
		raise checkpoints.CheckpointError(f"checkpoint = '{out}': has no config.yaml; fix: run without --resume in another folder")
	before = configuration.load(path)
	odd = [name for name in checkpoints.differences(toDict(before), toDict(config)) if name not in _FREE + _FREE_LIMITS]
	if odd:
		raise checkpoints.CheckpointError(
			f"checkpoint = '{out}': was made with other values of {', '.join(odd)}; fix: resume with the configuration "
			f"'{path}', or run without --resume in another folder"
		)


def _sameState(config):
	"""Check that the state in ``O`` has the configuration's boundary and was consolidated at its pressure."""
	lateral = scene.Scene().lateral
	if lateral.name != config.boundary:
		raise ConfigError("boundary", config.boundary, f"the state has a {lateral.name}", f"give boundary: {lateral.name}")
	wanted, found = config.consolidation.pressure, lateral.pressure
	if abs(found - wanted) > 1e-9 * wanted:
		raise ConfigError("consolidation.pressure", wanted, f"the state was consolidated at {found} Pa", "give that pressure")


def run(config, out, resume=False, until="shear", start=None, quiet=False):
	"""Run the stages of a test into a folder.

	:param config: checked configuration. :param out: folder, made if need be.
	:param resume: go on from the folder's last checkpoint. :param until: last stage to run, one of STAGES.
	:param start: a consolidated state (``consolidated.yade.gz`` of another test) to shear instead of making a specimen.
	:param quiet: print nothing.
	:returns: the :class:`hexmembrane.stages.Test`, None when only the specimen was made.
	:raises ConfigError, CheckpointError, StageError, ValueError: each with the fix.
	"""
	if until not in STAGES:
		raise ConfigError("--until", until, "is no stage", f"use {', '.join(STAGES)}")
	if resume and start is not None:
		raise ConfigError("--from", str(start), "a resumed test starts from its own checkpoint", "leave out one of --from and --resume")
	out = _freshFolder(out, resume)

	def say(text):
		if not quiet:
			print(text, flush=True)

	if resume:
		facts = checkpoints.read(out)
		_sameTest(config, out)
		stages.load(out / facts["state"])
		scene.setTier(config)
		say(f"resumed in {facts['stage']} after {facts['rows']} rows, step {O.iter}")
		test = stages.Test(config, out, quiet, facts)
	elif start is not None:
		stages.load(start)
		_sameState(config)
		scene.setTier(config)
		O.trackEnergy = config.output.energy
		configuration.save(config, out / "config.yaml")
		test = stages.Test(config, out, quiet)
		test.beginShear()
	else:
		configuration.save(config, out / "config.yaml")
		packing = specimen.provide(config, out, say)
		if until == "specimen":
			return None
		O.reset()
		scene.build(config, packing, say)
		test = stages.Test(config, out, quiet)
		if until == "boundary":
			test.checkpoint("generated")
			return test
	with test.records:
		return _stages(test, until, say)


def _stages(test, until, say):
	if test.stage in ("generated", "consolidation"):
		test.consolidate()
	if until == "shear":
		test.shear()
		picture = test.out / "test.png"
		plot(test.records.path, picture, test.config.title)
		say(f"wrote {test.records.path}, {picture}" + (f" and {test.frames.folder}" if test.frames.list else ""))
	say(f"done in {clock(test.elapsed())}")
	return test


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
	except (ConfigError, checkpoints.CheckpointError) as error:
		print(f"error: {error}", file=sys.stderr)
		return 2
	except (ValueError, RuntimeError, OSError) as error:
		print(f"error: {error}", file=sys.stderr)
		return 1
	except KeyboardInterrupt:
		print("interrupted: --resume goes on from the last checkpoint", file=sys.stderr)
		return 130
	return 0
