# SPDX-License-Identifier: GPL-2.0-or-later
"""Isotropic consolidation to a pressure, until rest."""

import math

from yade import O

from hexmembrane.configuration.cement import PACKED
from hexmembrane.configuration.config import restTolerance
from hexmembrane.run.progress import Progress
from hexmembrane.run.stage import RAMP_PARTS, Stage, StageError
from hexmembrane.scene.builder import checkTimeStep
from hexmembrane.scene.timestep import QUASISTATIC

#: Share of the pressure that the first ramp begins with: servos hold no stress of 0.
FIRST = 0.01


class Consolidation(Stage):
	"""Confining pressure and axial stress change together and smoothly, then the specimen comes to rest.

	Ends when the unbalanced force ratio is below its limit and transmitted pressure (main body) and axial stress (of the soil's middle half, or the platen's)
	are both within the tolerance of the pressure. The first one's start is a checkpoint.
	"""

	def begin(self):
		test = self.test
		if self.planned.before > 0:
			test.scene.consolidateAgain()
			return test.enter(self.planned.label)
		test.stage = self.planned.label
		test.scene.setPressure(FIRST * self.planned.pressure)
		speed = QUASISTATIC / self.inertialTime()
		test.scene.topDrive.maxVelocity = speed * test.reference.height
		test.scene.lateralBoundary.setMaxVelocity(self.config.wall.maxVelocity or speed * test.reference.radius)
		grains, platens = self.config.specimen.friction, self.config.platens.friction
		own, smoother = self.config.consolidation.friction, self.config.platens.consolidationFriction
		pairs = self.config.contacts.frictions(platens=smoother)
		test.scene.setFriction(grains if own is None else own, platens if smoother is None else smoother, pairs)
		test.enter(self.planned.label)
		self._bond(PACKED)
		test.checkpoint()

	def run(self):
		"""As :meth:`hexmembrane.run.stage.Stage.run`.

		:raises StageError: not at rest after maxSteps, the state it reached is the checkpoint; or a servo did not reach its target within
			timeLimit, the checkpoint is the last one before.
		"""
		keys, test, rampTime = self.config.consolidation, self.test, self._changeTime()
		with Progress(self.planned.label, test.quiet) as progress:
			test.scene.setTimeLimit(keys.timeLimit)
			while not (test.rowCount and self._atRest(rampTime)):
				steps = O.iter - test.stageStart["step"]
				if steps >= keys.maxSteps:
					test.checkpoint()
					raise StageError(self._restless(steps))
				self._rampedChunk(rampTime, min(self.config.output.consolidationSteps, keys.maxSteps - steps))
				test.row()
				if O.time - test.stageStart["time"] >= rampTime:
					test.tellSaturated(progress.say)
				test.show(progress, self._done(rampTime))
				checkTimeStep(self.config, test.scene, progress.say)
				test.maybeCheckpoint()
			row = test.lastRow
			progress.update(1.0, porosity=f"{row['porosity']:.4f}", coordination=f"{row['coordination']:.2f}")
			progress.say(
				f"consolidated after {O.iter - test.stageStart['step']} steps: unbalanced {row['unbalanced']:.2e}, "
				f"transmitted {1e-3 * row['sigma3_transmitted_group3']:.2f} kPa of {1e-3 * self.planned.pressure:g} kPa"
			)

	def _rampedChunk(self, rampTime, steps):
		"""Run ``steps`` steps, the pressure following its smooth change by (1 - cos(pi t/T))/2, never below FIRST of the target."""
		target, before, test = self.planned.pressure, self.planned.before, self.test
		end = O.iter + steps
		while O.iter < end:
			share = min(1.0, (O.time - test.stageStart["time"]) / rampTime)
			test.scene.setPressure(max(FIRST * target, before + (target - before) * (1 - math.cos(math.pi * share)) / 2) if share < 1 else target)
			part = end - O.iter
			if share < 1:
				part = min(part, max(1, math.ceil(rampTime / (RAMP_PARTS * O.dt))))
			test.advance(part)

	def _errors(self):
		"""Relative distances: of transmitted pressure and soil's axial stress from the pressure, of the platen's force from what it is to carry."""
		target, row, scene = self.planned.pressure, self.test.lastRow, self.test.scene
		errors = {
			"transmitted pressure": abs(row["sigma3_transmitted_group3"] / scene.lateralBoundary.pressure - 1),
			"platen's force": abs(row["platen_force_top"] / (scene.topDrive.stress * scene.endArea()) - 1),
		}
		if scene.axialServo:
			errors["soil's axial stress"] = abs(row["soil_axial_middle"] / target - 1)
		if scene.radialServo:
			errors["soil's radial stress"] = abs(row["soil_radial_middle"] / target - 1)
		return errors

	def _tolerance(self):
		return restTolerance(self.config.consolidation.tolerance, self.test.scene.lateralBoundary.name, self.config.membrane.pressureTime)

	def _atRest(self, rampTime):
		row = self.test.lastRow
		ramped = O.time - self.test.stageStart["time"] >= rampTime and row["sigma3_target"] == self.planned.pressure
		return ramped and row["unbalanced"] < self.config.consolidation.unbalanced and max(self._errors().values()) < self._tolerance()

	def _done(self, rampTime):
		"""Share of the consolidation done: half for the ramp, half for the decades of unbalanced force."""
		share = (O.time - self.test.stageStart["time"]) / rampTime
		if share < 1:
			return share / 2
		decades = math.log10(max(self.test.lastRow["unbalanced"], 1e-30) / self.config.consolidation.unbalanced)
		return min(0.99, 0.5 + 0.5 * (1 - min(1.0, max(0.0, decades / 3))))

	def _restless(self, steps):
		keys = self.config.consolidation
		errors = ", ".join(f"{name} off by {100 * error:.2g} %" for name, error in self._errors().items())
		return (
			f"consolidation.maxSteps = {keys.maxSteps}: not at rest after {steps} steps (unbalanced {self.test.lastRow['unbalanced']:.2e}, "
			f"limit {keys.unbalanced:g}; {errors}, tolerance {100 * self._tolerance():g} %); its state is the checkpoint in "
			f"'{self.test.out}'; fix: allow more steps, a higher limit or tolerance, or more numerics.damping"
		)
