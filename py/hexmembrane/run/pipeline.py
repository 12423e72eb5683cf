# SPDX-License-Identifier: GPL-2.0-or-later
"""A whole test from one configuration: ``run(config, out)``."""

import contextlib
import pathlib

from yade import O

from hexmembrane import configuration
from hexmembrane.configuration import Config, ConfigError, toDict
from hexmembrane.configuration.schema import freeKeys
from hexmembrane.output.plots import plot
from hexmembrane.run import checkpoints, stages
from hexmembrane.run.progress import clock
from hexmembrane.scene import accuracy, builder, specimen
from hexmembrane.scene.handles import Scene

STAGES = ("specimen", "boundary", "consolidation", "shear")


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
	odd = [name for name in checkpoints.differences(toDict(before), toDict(config)) if name not in freeKeys(Config)]
	if odd:
		raise checkpoints.CheckpointError(
			f"checkpoint = '{out}': was made with other values of {', '.join(odd)}; fix: resume with the configuration "
			f"'{path}', or run without --resume in another folder"
		)


def _sameState(config):
	"""Check that the state in ``O`` has the configuration's lateral boundary and was consolidated at its pressure."""
	boundary = Scene().lateralBoundary
	if boundary.name != config.boundary:
		raise ConfigError("boundary", config.boundary, f"the state has a {boundary.name}", f"give boundary: {boundary.name}")
	wanted, pressure = config.consolidation.pressure, Scene().pressure
	if abs(pressure - wanted) > 1e-9 * wanted:
		raise ConfigError("consolidation.pressure", wanted, f"the state was consolidated at {pressure} Pa", "give that pressure")


def _wantOwnSettings(config):
	"""A state has the settings of the test that made it: none may be left to ``accuracy``."""
	if config.accuracy is not None and (left := accuracy.openKeys(config)):
		raise ConfigError(
			"accuracy", config.accuracy, f"leaves {', '.join(left)} open, and a state has those of its own test", "take them from that test's config.yaml"
		)


def _settle(config, say):
	"""Choose what ``accuracy`` leaves open; the error budget of the settings."""
	radii = specimen.plannedRadii(config)
	if config.accuracy is not None:
		chosen = accuracy.choose(config, radii)
		say(f"accuracy {100 * config.accuracy:g} %: " + ", ".join(f"{key} = {value:g}" for key, value in chosen.items()))
	budget = accuracy.budget(config, radii)
	for line in budget.lines():
		say(line)
	return budget


def run(config, out, resume=False, until="shear", start=None, quiet=False):
	"""Run the stages of a test into a folder.

	:param config: checked configuration.
	:param out: folder, made if need be.
	:param resume: go on from the folder's last checkpoint.
	:param until: last stage to run, one of STAGES.
	:param start: a consolidated state (``consolidated.yade.gz`` of another test) to shear instead of making a specimen.
	:param quiet: print nothing.
	:returns: the :class:`hexmembrane.run.stages.TriaxialTest`, None when only the specimen was made.
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

	if start is not None:
		_wantOwnSettings(config)
	budget = _settle(config, (lambda text: None) if resume else say)
	if resume:
		facts = checkpoints.read(out)
		_sameTest(config, out)
		stages.load(out / facts["state"])
		builder.setTier(config)
		say(f"resumed in {facts['stage']} after {facts['rows']} rows, step {O.iter}")
		test = stages.TriaxialTest(config, out, quiet, facts)
	elif start is not None:
		stages.load(start)
		_sameState(config)
		builder.setTier(config)
		O.trackEnergy = config.output.energy
		configuration.save(config, out / "config.yaml", budget=budget.asDict())
		test = stages.TriaxialTest(config, out, quiet)
		test.beginShear()
	else:
		configuration.save(config, out / "config.yaml", budget=budget.asDict())
		packing = specimen.provide(config, out, say)
		if until == "specimen":
			return None
		O.reset()
		builder.build(config, packing, say)
		test = stages.TriaxialTest(config, out, quiet)
		if until == "boundary":
			test.checkpoint("generated")
			return test
	with test.records, contextlib.closing(test.inside):
		return _stages(test, until, say)


def _stages(test, until, say):
	if test.stage in ("generated", "consolidation"):
		test.consolidate()
	if until == "shear":
		test.shear()
		picture = test.out / "test.png"
		plot(test.records.path, picture, test.config.title)
		say(f"wrote {test.records.path}, {picture}" + (f" and {test.frames.folder}" if test.frames.written else ""))
	say(f"done in {clock(test.elapsed())}")
	return test
