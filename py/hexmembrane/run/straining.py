# SPDX-License-Identifier: GPL-2.0-or-later
"""The stages after consolidation: platens that move at a speed (shear, unloading), and platens that stand (hold, pressure)."""

import math

from yade import O

from hexmembrane.configuration import ConfigError
from hexmembrane.configuration.stages import SHEAR, plan, span
from hexmembrane.run.pressure_watch import PressureWatch
from hexmembrane.run.progress import Progress
from hexmembrane.run.stage import RAMP_PARTS, Stage, StageError
from hexmembrane.scene.builder import checkTimeStep
from hexmembrane.scene.handles import Scene
from hexmembrane.scene.timestep import QUASISTATIC

#: Share of the height that consolidation may take, for what is checked before it.
_SHORTER = 0.1
#: Parts of a strain step after each of which q is compared with its target.
_LOOKS = 10
#: Strain beyond where it began at which an unloading to a q that never comes is given up.
_MOST_BACK = 0.2


class _Sheared(Stage):
	"""What the stages after a consolidation share: a row at the start, then rows to the end; the pressure is watched."""

	def run(self):
		test = self.test
		watch = PressureWatch(self.config.shear, test.scene.lateralBoundary.name, self.planned.label)
		with Progress(self.planned.label, test.quiet) as progress:
			self._announce(progress)
			if test.rowCount == 0:
				test.advance(1)  # forces are not in a saved state, and a row needs them
				test.row()
				if len(self.planned.chain) == 1:
					test.frame()
			while not self._ended():
				self._toNextRow()
				test.row()
				self._warn(watch, progress)
				test.show(progress, self._done())
				every = self.config.output.vtkEvery
				if every and ((test.rowCount - 1) % every == 0 or self._ended()):
					test.frame()
				if test.checkpointDue():
					checkTimeStep(self.config, test.scene, progress.say)
				test.maybeCheckpoint()
			self._report(progress, watch)

	def _warn(self, watch, progress):
		self.test.tellSaturated(progress.say)
		if said := watch.strayed(self.test.lastRow):
			if self.config.shear.stopOutsideTolerance:
				raise StageError(f"{said}; the last checkpoint is in '{self.test.out}'")
			progress.say(f"WARNING: {said}")

	def _ended(self):
		return self.test.rowCount > self.planned.records

	def _done(self):
		return min(1.0, (self.test.rowCount - 1) / self.planned.records)

	def _report(self, progress, watch):
		row = self.test.lastRow
		what = {"shear": "sheared to", "unloading": "unloaded to", "hold": "held at", "pressure": "pressure changed at"}[self.planned.kind]
		progress.say(
			f"{what} {100 * row['axial_strain']:.2f} %: q {1e-3 * row['q']:.1f} kPa, volumetric strain "
			f"{100 * row['volumetric_strain_radius']:.2f} % (Eq. 6) and {100 * row['volumetric_strain_volume']:.2f} % (volume), "
			f"transmitted {1e-3 * row['sigma3_transmitted_group3']:.2f} kPa ({watch.summary(self.test.records.path)}), broken bonds of the membrane {row['bonds_broken']}"
			+ (f", cement: {row['cement_bonds']} bonds hold, {row['cement_broken_tension']} broke in tension, {row['cement_broken_shear']} in shear" if "cement_bonds" in row else "")
			+ (f", energy balance off by {100 * row['energy_error']:.2g} %" if O.trackEnergy else "")
		)

	def _drive(self, velocities, rampTime):
		for drive, velocity in zip((self.test.scene.bottomDrive, self.test.scene.topDrive), velocities):
			drive.mode = "velocity"
			drive.velocity = velocity
			drive.rampTime = rampTime


class Straining(_Sheared):
	"""Shear or unloading, to a strain with one row at each equal part of the way, or to a deviatoric stress with one row at each strain step."""

	def begin(self):
		self._leaveConsolidation()
		height = self.test.reference.height
		if self.config.wall.maxVelocity is None and self.planned.direction > 0:
			self.test.scene.lateralBoundary.allowStraining(self.planned.speed / height)
		ramp = 2 * self.config.shear.rampStrain * height / self.planned.speed
		self._drive(self.planned.velocities, ramp)

	def nominal(self):
		planned, row = self.planned, self.test.rowCount - 1
		if planned.kind != SHEAR or planned.strain is None:
			return super().nominal()
		begun = self.test.stageStart["strain"]
		before, now = (max(planned.farthest, begun + (planned.strain - begun) * k / planned.records) for k in (row - 1, row))
		return before, now, row == planned.records

	def _ended(self):
		if self.planned.q is None:
			return super()._ended()
		return self.test.rowCount > 0 and self._beyond(self.test.lastRow["q"])

	def _done(self):
		if self.planned.q is None:
			return super()._done()
		return 0.5  # how far the strain has to go is not known

	def _beyond(self, q):
		return self.planned.direction * (q - self.planned.q) >= 0

	def _toNextRow(self):
		planned, test = self.planned, self.test
		if planned.q is None:
			begun = test.stageStart["strain"]
			return self._until(begun + (planned.strain - begun) * test.rowCount / planned.records)
		for _ in range(_LOOKS):
			self._until(test.strain() + planned.direction * planned.strainStep / _LOOKS)
			if self._beyond(test.q()):
				return None
		if planned.direction > 0 and test.strain() > self.config.shear.strain:
			raise StageError(self._neverThere("shear.strain is reached", "a larger shear.strain, for which the platens are made, or a smaller q"))
		if planned.direction < 0 and test.strain() < test.stageStart["strain"] - _MOST_BACK:
			raise StageError(self._neverThere(f"the strain has come back by {_MOST_BACK:g}", "a larger q"))
		return None

	def _neverThere(self, what, fix):
		return f"{self.planned.path}.q = {self.planned.q:g}: q is {self.test.q():.4g} Pa and {what}; fix: {fix}"

	def _until(self, strain):
		"""Run to an axial strain, to within one step's travel, one step at least."""
		sign, step = self.planned.direction, self.planned.speed * O.dt / self.test.reference.height
		missing = sign * (strain - self.test.strain())
		limit = O.iter + 10 * self._steps(max(missing, 0.0))
		while True:
			if O.iter > limit:
				raise StageError(f"{self.planned.label}.strain = {self.test.strain():.4g}: the platens do not move as asked; fix: see the engines of the scene")
			self.test.advance(max(1, round(missing / step)))
			if (missing := sign * (strain - self.test.strain())) <= 0.5 * step:
				return

	def _steps(self, strain):
		"""Steps that the platens need for a strain, their start counted."""
		return math.ceil((strain + self.config.shear.rampStrain) * self.test.reference.height / (self.planned.speed * O.dt))

	def _announce(self, progress):
		test, planned = self.test, self.planned
		if planned.q is None:
			end, way = f"{100 * planned.strain:g} %", planned.direction * (planned.strain - test.stageStart["strain"])
			if way <= 0:
				raise StageError(
					f"{planned.path}.strain = {planned.strain:g}: {planned.kind} begins at {test.stageStart['strain']:.4g}, which is beyond it; the last checkpoint is in "
					f"'{test.out}'; fix: another strain, or q before it"
				)
			steps = f"about {self._steps(way)} steps"
			largest = math.floor(way * test.reference.height / (planned.speed * O.dt))
			if test.rowCount == 0 and planned.records > largest:
				state = test.out / "consolidated.yade.gz"
				raise StageError(
					f"{'output' if planned.path == 'shear' else planned.path}.records = {planned.records}: {planned.kind} of the consolidated specimen has {largest} steps; "
					f"fix: shear '{state}' with --from into another folder, with {largest} rows at most"
				)
		else:
			end, steps = f"q = {1e-3 * planned.q:g} kPa", f"rows at strain steps of {planned.strainStep:.3g}"
		inertial = planned.speed / test.reference.height * self.inertialTime()
		progress.say(
			f"{planned.kind} at {planned.speed:g} m/s to {end}: {steps}, inertial number {inertial:.2e}"
			+ ("" if inertial <= QUASISTATIC else f"; WARNING: above {QUASISTATIC:g} this is not quasi-static; fix: lower shear.velocity")
		)


class Resting(_Sheared):
	"""Platens that stand for a time; the confining pressure stays, or changes smoothly to another."""

	def begin(self):
		self._leaveConsolidation()
		self._drive((0.0, 0.0), 0.0)

	def _announce(self, progress):
		change = f" from {1e-3 * self.planned.before:g} to {1e-3 * self.planned.pressure:g} kPa" if self.planned.pressure != self.planned.before else ""
		progress.say(f"{self.planned.kind}{change} for {self._changeTime():.4g} s, {math.ceil(self._changeTime() / O.dt)} steps")

	def _toNextRow(self):
		test, time, begun = self.test, self._changeTime(), self.test.stageStart["time"]
		end = begun + time * test.rowCount / self.planned.records
		while O.time < end - 0.5 * O.dt:
			left = max(1, round((end - O.time) / O.dt))
			if self.planned.pressure != self.planned.before:
				share = min(1.0, (O.time - begun) / time)
				test.scene.setPressure(self.planned.before + (self.planned.pressure - self.planned.before) * (1 - math.cos(math.pi * share)) / 2)
				left = min(left, max(1, math.ceil(time / (RAMP_PARTS * O.dt))))
			test.advance(left)
		if test.rowCount == self.planned.records:
			test.scene.setPressure(self.planned.pressure)


def checkRows(config):
	"""The rows wished must have steps to stand for, also when the specimen has become shorter in consolidation.

	:raises ConfigError: they have not.
	"""
	bottom, top = Scene().faces()
	stages = plan(config)
	for k, stage in enumerate(stages):
		way = span(stages, k)
		if not stage.straining or way is None:
			continue
		largest = math.floor(way * (1 - _SHORTER) * (top - bottom) / (stage.speed * O.dt))
		if stage.records > largest:
			name = "output.records" if config.stages is None else f"{stage.path}.records"
			raise ConfigError(name, stage.records, f"is finer than the steps of {stage.kind}, of {O.dt:.4g} s", f"at most {largest}, or a lower shear.velocity")
