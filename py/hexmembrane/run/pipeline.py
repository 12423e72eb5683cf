# SPDX-License-Identifier: GPL-2.0-or-later
"""A whole test from one configuration: ``run(config, out)``."""

import contextlib
import pathlib
import sys

from yade import O

from hexmembrane import configuration
from hexmembrane.configuration import Config, ConfigError, toDict
from hexmembrane.configuration.schema import freeKeys
from hexmembrane.configuration.stages import MEMBRANE, boundaries, boundariesIn, plan
from hexmembrane.laboratory import curve, misfit
from hexmembrane.output import records
from hexmembrane.output.plots import plot
from hexmembrane.run import checkpoints, estimate, from_state, progress, stages, states, straining
from hexmembrane.run.checkpoints import FolderError, Store
from hexmembrane.run.lock import FolderLock
from hexmembrane.run.manifest import CheckpointError
from hexmembrane.run.progress import clock
from hexmembrane.run.states import Image
from hexmembrane.scene import accuracy, builder, specimen
from hexmembrane.scene.handles import Scene

#: What comes before a test's stages.
BEFORE = ("specimen", "boundary")


def _madeFolder(out):
	out = pathlib.Path(out)
	try:
		out.mkdir(parents=True, exist_ok=True)
	except OSError as error:
		raise ConfigError("--out", str(out), f"cannot be made ({error.strerror})", "choose another folder") from None
	return out


def _storeOf(out, resume):
	"""The folder's files, checked."""
	if not resume:
		return Store.begin(out)
	store = Store.existing(out)
	if not store.begun and store.manifest.files:
		raise CheckpointError(f"checkpoint = '{out}': has a specimen alone; fix: run in another folder with specimen.packing: {out / 'packing.txt'}")
	if not store.begun:
		raise CheckpointError(f"checkpoint = '{out}': there is none yet; fix: the same command without --resume, which begins anew")
	return store


def _sameTest(config, store):
	"""Check that the folder's test is the one of this configuration."""
	store.require("config.yaml")
	path = store.folder / "config.yaml"
	before = configuration.load(path)
	free = freeKeys(Config)
	odd = [name for name in checkpoints.differences(toDict(before), toDict(config)) if not any(f"{name}.".startswith(f"{key}.") for key in free)]
	if odd:
		raise CheckpointError(
			f"checkpoint = '{store.folder}': was made with other values of {', '.join(odd)}; fix: resume with the configuration "
			f"'{path}', or run without --resume in another folder"
		)


def _goOn(config, store, tell):
	"""The last whole checkpoint, its state in ``O``; nothing in the folder is changed before all of it is checked."""
	_sameTest(config, store)
	resumed = store.last()
	for warning in resumed.warnings:
		tell(f"WARNING: {warning}")
	checkpoint = resumed.checkpoint
	path = store.folder / checkpoint.state
	with Image.read(path, store.manifest.states[checkpoint.state]) as image:
		image.load(path)
	boundary = Scene().lateralBoundary.name
	wanted = boundariesIn(config, checkpoint.stage)
	if O.iter != checkpoint.step or boundary not in wanted:
		raise CheckpointError(
			f"state = '{path}': is of step {O.iter} with a {boundary}, the checkpoint is of step {checkpoint.step} with a {' or '.join(wanted)}; "
			"fix: put the test's own state back"
		)
	store.goOnFrom(resumed)
	return resumed


def _wantOwnSettings(config):
	"""A state has the settings of the test that made it: none may be left to ``accuracy``."""
	if config.accuracy is not None and (left := accuracy.openKeys(config)):
		raise ConfigError(
			"accuracy", config.accuracy, f"leaves {', '.join(left)} open, and a state has those of its own test", "take them from that test's config.yaml"
		)


def prepare(config, out, say):
	"""Choose what ``accuracy`` leaves open, say what the test needs, refuse what cannot be; the error budget of the settings."""
	estimate.requireThreads(config)
	curve.ofKeys(toDict(config.lab), config.consolidation.pressure)  # a wrong one is told before the test
	estimate.requireTravel(config)
	radii = specimen.plannedRadii(config)
	if config.accuracy is not None:
		chosen = accuracy.choose(config, radii)
		say(f"accuracy {100 * config.accuracy:g} %: " + ", ".join(f"{key} = {accuracy.valueSaid(value)}" for key, value in chosen.items()))
	for line in estimate.improbable(config, radii):
		say(line)
	estimate.requireStiffness(config, radii)
	needs = estimate.Estimate.of(config, radii)
	needs.require(config, estimate.Machine.here(out))
	say(needs.line())
	budget = accuracy.budget(config, radii)
	for line in budget.lines():
		say(line)
	return budget


def check(config, out, start=None, say=progress.tell):
	"""Check all that can be checked before a test and say what it would make; nothing is made.

	:raises ConfigError, CheckpointError: as :func:`run`.
	"""
	own = None
	if start is not None:
		_wantOwnSettings(config)
		own = from_state.adopt(config, start, say)
		states.load(start)
		from_state.require(config, start)
	prepare(config, out, say)
	Store.requireFree(out)
	keys, radii = config.specimen, 1e3 * specimen.plannedRadii(config)
	say(
		f"specimen: {len(radii)} grains of radius {radii.min():.4g} to {radii.max():.4g} mm in {2e3 * keys.radius:.4g} x {1e3 * keys.height:.4g} mm"
		+ (f", porosity {keys.porosity:g} asked for" if keys.made and start is None else "")
	)
	say(f"boundary: {', then '.join(boundaries(config))}, tier {config.tier}")
	for planned in plan(config)[0 if start is None else from_state.nextStage(config, Scene().lateralBoundary.name) :]:
		if start is None or planned.chain or planned.kind == MEMBRANE:
			say(f"{planned.label}: {planned.describe()}")
	say(f"nothing was made; the same command without --check makes it in {pathlib.Path(out)}" + (f", from {start}" if own or start else ""))


def run(config, out, resume=False, until=None, start=None, quiet=False):
	"""Run the stages of a test into a folder.

	:param config: checked configuration.
	:param out: folder, made if need be.
	:param resume: go on from the folder's last checkpoint.
	:param until: last stage to run: "specimen", "boundary" or the label of a stage; None: all.
	:param start: a consolidated state (``consolidated.yade.gz`` of another test) to shear instead of making a specimen.
	:param quiet: print nothing.
	:returns: the :class:`hexmembrane.run.stages.TriaxialTest`, None when only the specimen was made.
	:raises ConfigError, CheckpointError, LockError, FolderError, StageError, ValueError: each with the fix.
	"""
	known = (*BEFORE, *(planned.label for planned in plan(config)))
	if until is not None and until not in known:
		raise ConfigError("--until", until, "is no stage", f"use {', '.join(known)}")
	if resume and start is not None:
		raise ConfigError("--from", str(start), "a resumed test starts from its own checkpoint", "leave out one of --from and --resume")
	settled, own = [], None
	if start is not None:
		_wantOwnSettings(config)
		own = from_state.adopt(config, start, settled.append)
	budget = prepare(config, out, settled.append)
	out = _madeFolder(out)

	def say(text):
		if not quiet:
			progress.tell(text)

	def tell(text):
		progress.tell(text, sys.stderr)

	store = None
	try:
		with FolderLock(out):
			store = _storeOf(out, resume)
			return _run(config, budget, settled, store, until, start, own, quiet, say, tell)
	except OSError as error:
		if error.errno is None:
			raise  # it says what is wrong
		raise FolderError(error, out, store is not None and store.begun) from None


def _run(config, budget, settled, store, until, start, own, quiet, say, tell):
	out, resume = store.folder, store.begun
	if not resume:
		for line in settled:
			say(line)
	if resume:
		resumed = _goOn(config, store, tell)
		builder.setTier(config)
		say(f"resumed in {resumed.checkpoint.stage} after {resumed.rows} rows, step {O.iter}")
		test = stages.TriaxialTest(config, out, quiet, store, resumed)
	elif start is not None:
		states.load(start)
		from_state.require(config, start)
		builder.setTier(config)
		from_state.apply(config, own, say)
		O.trackEnergy = config.output.energy
		straining.checkRows(config)
		configuration.save(config, out / "config.yaml", budget=budget.asDict())
		store.seal("config.yaml")
		test = stages.TriaxialTest(config, out, quiet, store)
		test.begin(from_state.nextStage(config, test.scene.lateralBoundary.name))
		test.checkpoint()
	else:
		configuration.save(config, out / "config.yaml", budget=budget.asDict())
		packing = specimen.provide(config, out, say)
		store.seal("config.yaml", "packing.txt")
		if until == "specimen":
			store.write()
			return None
		O.reset()
		builder.build(config, packing, say)
		straining.checkRows(config)
		test = stages.TriaxialTest(config, out, quiet, store)
		if until == "boundary":
			test.checkpoint("generated")
			return test
	with test.records, contextlib.closing(test.inside):
		return _stages(test, until, say)


def _report(out, say):
	"""The page of the test in a folder; a library of it that is not installed is told of."""
	# a test without a page does not wait for what it needs
	from hexmembrane.report import page
	from hexmembrane.report.libraries import LibraryError

	try:
		page.write(out / checkpoints.REPORT, page.gather([out]))
		say(f"wrote {out / checkpoints.REPORT}")
	except LibraryError as error:
		say(f"no {checkpoints.REPORT}: {error}, or output.report: false")


def _stages(test, until, say):
	test.proceed(until)
	if until is None or test.plan[[planned.label for planned in test.plan].index(until)].chain:
		picture = test.out / checkpoints.PICTURE
		pressure = test.config.consolidation.pressure
		laboratory = curve.ofKeys(toDict(test.config.lab), pressure)
		found = misfit.ofRecords(laboratory, records.read(test.records.path), pressure) if laboratory else []
		plot(test.records.path, picture, test.config.title, laboratory, pressure, found)
		for line in [*laboratory.warnings, *(f"laboratory {laboratory.name}: {one}" for one in found)] if laboratory else ():
			say(line)
		say(f"wrote {test.records.path}, {picture}" + (f" and {test.frames.folder}" if test.frames.written else ""))
		if test.config.output.report:
			_report(test.out, say)
	say(f"done in {clock(test.elapsed())}")
	return test
