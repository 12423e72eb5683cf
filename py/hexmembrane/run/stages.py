# SPDX-License-Identifier: GPL-2.0-or-later
"""The stages of a test on the scene in ``O``: consolidation and shear, with records, VTK frames and checkpoints in one folder.

Python is not in the loop of a step: YADE runs in chunks of steps between rows. After each checkpoint the test goes on from the
saved state itself in the reference tier, where YADE's collider makes its lists anew after a load. A resumed run and one that was never
stopped take the same steps for that reason, bit by bit on one thread.
"""

import math
import pathlib
import time

from yade import BodyArrays, O

from hexmembrane.configuration import ConfigError
from hexmembrane.configuration.config import restTolerance
from hexmembrane.measure import rows
from hexmembrane.output.frames import Frames
from hexmembrane.output.records import Records
from hexmembrane.run.checkpoints import RECORDS, Store
from hexmembrane.run.inside import Inside
from hexmembrane.run.manifest import Checkpoint, Entry
from hexmembrane.run.pressure_watch import PressureWatch
from hexmembrane.run.progress import Progress
from hexmembrane.run.states import Image, load
from hexmembrane.scene import timestep
from hexmembrane.scene.builder import checkTimeStep
from hexmembrane.scene.handles import Scene
from hexmembrane.scene.timestep import QUASISTATIC

#: Parts that the pressure's smooth rise is divided into; each is 1 % of the time.
RAMP_PARTS = 100
#: Share of the pressure that the ramp begins with: servos hold no stress of 0.
_FIRST = 0.01
#: Steps that YADE is asked for at once: a signal waits for their end. A multiple of the usual numerics.substeps.
_AT_ONCE = 5000
#: Share of the height that consolidation may take, for what is checked before it.
_SHORTER = 0.1


class StageError(RuntimeError):
	"""A stage that cannot reach its target, or that YADE stopped; a checkpoint of the last sound state is in the folder."""


class TriaxialTest:
	"""A test whose specimen and lateral boundary are in ``O`` (see :func:`hexmembrane.scene.builder.build`).

	Attributes: ``config``, ``out``, ``quiet`` (see below); ``scene`` and ``grains`` (handles), ``stage`` (name), ``rowCount`` (rows of the stage so
	far), ``lastRow`` (a dict by column of the records), ``stageStart`` (step and time), ``reference`` (what strains count from), ``records``, ``frames``,
	``inside`` (what the configuration's ``measure`` asks for).

	:param config: checked configuration.
	:param out: existing folder for all files.
	:param quiet: print nothing.
	:param store: the folder's :class:`hexmembrane.run.checkpoints.Store`; None: one of its own, for a folder that nobody else writes into.
	:param resumed: what ``store.last()`` gave, its state loaded; None: begin.
	"""

	def __init__(self, config, out, quiet=False, store=None, resumed=None):
		self.config, self.out, self.quiet = config, pathlib.Path(out), quiet
		self.store = Store(out) if store is None else store
		self.scene = Scene()
		self.grains = rows.Grains.of(self.scene.grainIds())
		self.stage, self.rowCount, self.lastRow, self._earlier = "generated", 0, None, 0.0
		if resumed is None:
			self.stageStart, self.reference = {"step": O.iter, "time": O.time}, rows.Reference.of(self.scene)
			self.frames, self.records = Frames(self.out), Records(self.out / RECORDS)
			self.inside = Inside(config, self.out)
		else:
			self._goOnFrom(resumed)
		self._clock = time.monotonic()

	def _goOnFrom(self, resumed):
		checkpoint = resumed.checkpoint
		self.stage, self.rowCount, self.lastRow, self._earlier = checkpoint.stage, resumed.rows, resumed.last, checkpoint.elapsed
		self.stageStart, self.reference = checkpoint.begun, rows.Reference(**checkpoint.reference)
		self.frames, self.records = Frames(self.out, checkpoint.frames), Records(self.out / RECORDS, checkpoint.records.size)
		self.inside = Inside(self.config, self.out, checkpoint.inside)
		self.scene.tellCheckpoint(self.out / checkpoint.state)

	# What both stages share

	def elapsed(self):
		"""Wall clock of the test so far [s]."""
		return self._earlier + time.monotonic() - self._clock

	def _enter(self, stage):
		"""Begin a stage: strains, displacements and energies count from here."""
		if O.trackEnergy and not O.energy.items():
			self.advance(1)  # energies are known after a step
		self.stage, self.rowCount = stage, 0
		self.stageStart = {"step": O.iter, "time": O.time}
		self.reference = rows.Reference.of(self.scene)
		BodyArrays.setReference()

	def advance(self, steps):
		"""Run YADE for a number of steps.

		:raises StageError: YADE stopped before.
		"""
		wanted, why = O.iter + steps, None
		while O.iter < wanted and not why:
			end = min(wanted, O.iter + _AT_ONCE)
			try:
				O.run(end - O.iter, True)
			except RuntimeError as error:
				why = str(error)
			if O.iter != end:
				break
		if why or O.iter != wanted:
			why = why or _lostError()
			raise StageError(
				f"{self.stage}.step = {O.iter}: YADE stopped before step {wanted}: {self._torn()}{why or 'see its messages above'}; "
				f"fix: go on from the last checkpoint in '{self.out}', with a smaller numerics.safety, a slower test or what else is said here"
			)

	def _torn(self):
		"""What an error says first when the membrane is torn, else nothing."""
		broken = self.scene.lateralBoundary.brokenBonds()
		return f"the membrane is torn, {broken} of its bonds are broken (membrane.tensileStrength, shearStrength); " if broken else ""

	def row(self):
		"""Measure, write and return a row of the records."""
		self.lastRow = rows.row(self.scene, self.grains, self.reference, self.stage, self.elapsed())
		lost = rows.escaped(self.scene, self.grains)
		if lost is not None:
			raise StageError(
				f"{self.stage}.step = {O.iter}: grain {lost} at {tuple(O.bodies[lost].state.pos)} has left the {self.scene.lateralBoundary.name}; {self._torn()}"
				"fix: a smaller membrane.particleRadius, a smaller numerics.safety or a slower test"
			)
		self.records.append(self.lastRow)
		self.rowCount += 1
		if self.stage == "shear":
			self._measureInside()
		return self.lastRow

	def _measureInside(self):
		try:
			self.inside.row(self.scene, self.lastRow, self.rowCount - 1)
		except (RuntimeError, ValueError) as error:
			raise StageError(f"measure, in step {O.iter}: {self._torn()}{error}") from None

	def checkpoint(self, name=None):
		"""Save the state: as ``name``.yade.gz, kept; else uncompressed, which takes a third of the time, until two later ones are there.

		:raises OSError: the folder cannot be written; the checkpoint before is whole.
		"""
		state = self.store.stateName(name)
		if self.store.isLast(state, O.iter, self.records.size):
			return  # a test that has ended and is resumed
		with Image.taken() as image:
			entry = image.write(self.out / state)
			records = Entry(self.records.position(), self.records.sha256)
			elapsed = round(self.elapsed(), 2)
			made = Checkpoint(state, self.stage, O.iter, self.stageStart, records, list(self.frames.written), vars(self.reference), elapsed, self.inside.position())
			self.store.add(made, entry)
			if self.scene.loop is None:
				image.load(self.out / state)
				self.scene = Scene()
		self.scene.tellCheckpoint(self.out / state)

	def _show(self, progress, done):
		row = self.lastRow
		progress.update(
			done,
			strain=f"{100 * row['axial_strain']:.2f} %",
			q=f"{1e-3 * row['q']:.1f} kPa",
			porosity=f"{row['porosity']:.4f}",
			unbalanced=f"{row['unbalanced']:.1e}",
		)

	# Consolidation

	def consolidate(self):
		"""Raise confining pressure and axial stress together and smoothly, then wait for rest.

		Ends when the unbalanced force ratio is below its limit and transmitted pressure (main body) and axial stress (of the soil's
		middle half, or the platen's) are both within the tolerance of the pressure. Leaves ``consolidated.yade.gz``; the start is a checkpoint.

		:raises StageError: not at rest after maxSteps, the state it reached is the checkpoint; or a servo did not reach its target within
			timeLimit, the checkpoint is the last one before.
		"""
		keys = self.config.consolidation
		rampTime = keys.rampTime or 30 * self._inertialTime()
		with Progress("consolidation", self.quiet) as progress:
			if self.stage == "generated":
				self._beginConsolidation()
			self.scene.setTimeLimit(keys.timeLimit)
			while not (self.rowCount and self._atRest(rampTime)):
				steps = O.iter - self.stageStart["step"]
				if steps >= keys.maxSteps:
					self.checkpoint()
					raise StageError(self._restless(steps))
				self._rampedChunk(rampTime, min(self.config.output.consolidationSteps, keys.maxSteps - steps))
				self.row()
				self._show(progress, self._consolidationDone(rampTime))
				checkTimeStep(self.config, self.scene, progress.say)
				self._maybeCheckpoint()
			progress.update(1.0, porosity=f"{self.lastRow['porosity']:.4f}", coordination=f"{self.lastRow['coordination']:.2f}")
			progress.say(
				f"consolidated after {O.iter - self.stageStart['step']} steps: unbalanced {self.lastRow['unbalanced']:.2e}, "
				f"transmitted {1e-3 * self.lastRow['sigma3_transmitted_group3']:.2f} kPa of {1e-3 * keys.pressure:g} kPa"
			)
		self.beginShear()
		self.checkpoint("consolidated")

	def _beginConsolidation(self):
		keys = self.config.consolidation
		self.stage = "consolidation"
		self.scene.setPressure(_FIRST * keys.pressure)
		speed = QUASISTATIC / self._inertialTime()
		self.scene.topDrive.maxVelocity = speed * self.reference.height
		self.scene.lateralBoundary.setMaxVelocity(self.config.wall.maxVelocity or speed * self.reference.radius)
		grains, platens = self.config.specimen.friction, self.config.platens.friction
		smoother = self.config.platens.consolidationFriction
		self.scene.setFriction(grains if keys.friction is None else keys.friction, platens if smoother is None else smoother)
		self._enter("consolidation")
		self.checkpoint()

	def _inertialTime(self):
		"""d sqrt(rho/sigma3) [s]: a strain rate times this is the inertial number."""
		return timestep.inertialTime(self.grains.meanDiameter / 2, self.grains.density, self.config.consolidation.pressure)

	def _rampedChunk(self, rampTime, steps):
		"""Run ``steps`` steps, the pressure following its smooth rise P (1 - cos(pi t/T))/2, never below _FIRST of P."""
		target = self.config.consolidation.pressure
		end = O.iter + steps
		while O.iter < end:
			share = min(1.0, (O.time - self.stageStart["time"]) / rampTime)
			self.scene.setPressure(target * max(_FIRST, (1 - math.cos(math.pi * share)) / 2))
			part = end - O.iter
			if share < 1:
				part = min(part, max(1, math.ceil(rampTime / (RAMP_PARTS * O.dt))))
			self.advance(part)

	def _errors(self):
		"""Relative distances: of transmitted pressure and soil's axial stress from the pressure, of the platen's force from what it is to carry."""
		target, row, drive = self.config.consolidation.pressure, self.lastRow, self.scene.topDrive
		errors = {
			"transmitted pressure": abs(row["sigma3_transmitted_group3"] / self.scene.lateralBoundary.pressure - 1),
			"platen's force": abs(row["platen_force_top"] / (drive.stress * self.scene.endArea()) - 1),
		}
		if self.scene.axialServo:
			errors["soil's axial stress"] = abs(row["soil_axial_middle"] / target - 1)
		if self.scene.radialServo:
			errors["soil's radial stress"] = abs(row["soil_radial_middle"] / target - 1)
		return errors

	def _tolerance(self):
		return restTolerance(self.config.consolidation.tolerance, self.config.boundary, self.config.membrane.pressureTime)

	def _atRest(self, rampTime):
		keys = self.config.consolidation
		ramped = O.time - self.stageStart["time"] >= rampTime and self.lastRow["sigma3_target"] == keys.pressure
		return ramped and self.lastRow["unbalanced"] < keys.unbalanced and max(self._errors().values()) < self._tolerance()

	def _consolidationDone(self, rampTime):
		"""Share of the consolidation done: half for the ramp, half for the decades of unbalanced force."""
		share = (O.time - self.stageStart["time"]) / rampTime
		if share < 1:
			return share / 2
		decades = math.log10(max(self.lastRow["unbalanced"], 1e-30) / self.config.consolidation.unbalanced)
		return min(0.99, 0.5 + 0.5 * (1 - min(1.0, max(0.0, decades / 3))))

	def _restless(self, steps):
		keys = self.config.consolidation
		errors = ", ".join(f"{name} off by {100 * error:.2g} %" for name, error in self._errors().items())
		return (
			f"consolidation.maxSteps = {keys.maxSteps}: not at rest after {steps} steps (unbalanced {self.lastRow['unbalanced']:.2e}, "
			f"limit {keys.unbalanced:g}; {errors}, tolerance {100 * self._tolerance():g} %); its state is the checkpoint in "
			f"'{self.out}'; fix: allow more steps, a higher limit or tolerance, or more numerics.damping"
		)

	# Shear

	def beginShear(self):
		"""Strains count from here and the platens are set to their velocities."""
		self._enter("shear")
		self.scene.holdRadialLoad()
		self.scene.setFriction(self.config.specimen.friction, self.config.platens.friction)
		self.scene.setTimeLimit(None)
		keys = self.config.shear
		share = {"top": (0.0, 1.0), "both": (0.5, 0.5)}[keys.moving]
		for drive, part in zip((self.scene.bottomDrive, self.scene.topDrive), share):
			drive.mode = "velocity"
			drive.velocity = part * keys.velocity
			drive.rampTime = 2 * keys.rampStrain * self.reference.height / keys.velocity

	def strain(self):
		"""Axial strain since the stage began, compression positive."""
		bottom, top = self.scene.faces()
		return 1 - (top - bottom) / self.reference.height

	def shear(self):
		"""Shear from the consolidated state to the wished strain, one row at each equal part of it; leaves ``sheared.yade.gz``.

		:raises StageError: the platens do not move as asked; the pressure is not held and ``shear.stopOutsideTolerance`` is set.
		"""
		keys = self.config.shear
		watch = PressureWatch(keys, self.scene.lateralBoundary.name)
		total = self.config.output.records
		with Progress("shear", self.quiet) as progress:
			self._announceShear(progress)
			if self.rowCount == 0:
				self.advance(1)  # forces are not in a saved state, and a row needs them
				self.row()
				self._frame()
			while self.rowCount <= total:
				self._until(keys.strain * self.rowCount / total)
				self.row()
				if said := watch.strayed(self.lastRow):
					if keys.stopOutsideTolerance:
						raise StageError(f"{said}; the last checkpoint is in '{self.out}'")
					progress.say(f"WARNING: {said}")
				self._show(progress, (self.rowCount - 1) / total)
				every = self.config.output.vtkEvery
				if every and ((self.rowCount - 1) % every == 0 or self.rowCount > total):
					self._frame()
				if self._checkpointDue():
					checkTimeStep(self.config, self.scene, progress.say)
				self._maybeCheckpoint()
			self._report(progress, watch)
		self.checkpoint("sheared")

	def _until(self, strain):
		"""Run to an axial strain, to within one step's travel, one step at least."""
		step = self.config.shear.velocity * O.dt / self.reference.height
		limit = O.iter + 10 * self._stepsOfShear()
		missing = strain - self.strain()
		while True:
			if O.iter > limit:
				raise StageError(f"shear.strain = {self.strain():.4g}: the platens do not move as asked; fix: see the engines of the scene")
			self.advance(max(1, round(missing / step)))
			if (missing := strain - self.strain()) <= 0.5 * step:
				return

	def _stepsOfShear(self):
		return math.ceil((self.config.shear.strain + self.config.shear.rampStrain) * self.reference.height / (self.config.shear.velocity * O.dt))

	def _announceShear(self, progress):
		keys = self.config.shear
		if self.rowCount == 0:
			largest = mostRows(self.config, self.reference.height)
			if self.config.output.records > largest:
				raise StageError(
					f"output.records = {self.config.output.records}: shear of the consolidated specimen has {largest} steps; "
					f"fix: shear '{self.out / 'consolidated.yade.gz'}' with --from into another folder, with {largest} rows at most"
				)
		inertial = keys.velocity / self.reference.height * self._inertialTime()
		progress.say(
			f"shear at {keys.velocity:g} m/s to {100 * keys.strain:g} %: about {self._stepsOfShear()} steps, inertial number {inertial:.2e}"
			+ ("" if inertial <= QUASISTATIC else f"; WARNING: above {QUASISTATIC:g} this is not quasi-static; fix: lower shear.velocity")
		)

	def _report(self, progress, watch):
		row = self.lastRow
		progress.say(
			f"sheared to {100 * row['axial_strain']:.2f} %: q {1e-3 * row['q']:.1f} kPa, volumetric strain "
			f"{100 * row['volumetric_strain_radius']:.2f} % (Eq. 6) and {100 * row['volumetric_strain_volume']:.2f} % (volume), "
			f"transmitted {1e-3 * row['sigma3_transmitted_group3']:.2f} kPa ({watch.summary(self.records.path)}), broken bonds {row['bonds_broken']}"
			+ (f", energy balance off by {100 * row['energy_error']:.2g} %" if O.trackEnergy else "")
		)

	def _frame(self):
		if self.config.output.vtkEvery:
			self.frames.write(self.scene, self.grains, self.reference.radius, self.inside.grainArrays)

	def _checkpointDue(self):
		every = self.config.output.checkpointEvery
		return every > 0 and self.rowCount % every == 0

	def _maybeCheckpoint(self):
		if self._checkpointDue():
			self.checkpoint()


def mostRows(config, height):
	"""How many rows shear from this height [m] can have: one a step of the time step in ``O``."""
	return math.floor(config.shear.strain * height / (config.shear.velocity * O.dt))


def checkRows(config):
	"""The rows wished must have steps to stand for, also when the specimen has become shorter in consolidation.

	:raises ConfigError: they have not.
	"""
	bottom, top = Scene().faces()
	largest = mostRows(config, (1 - _SHORTER) * (top - bottom))
	if config.output.records > largest:
		wrong = f"is finer than the steps of shear, of {O.dt:.4g} s"
		raise ConfigError("output.records", config.output.records, wrong, f"at most {largest}, or a lower shear.velocity")


def _lostError():
	"""The error that YADE loses when a run in its thread ends before ``O.run`` waits for it: the next step meets it again; '' when it does not."""
	try:
		O.step()
	except RuntimeError as error:
		return str(error)
	return ""
