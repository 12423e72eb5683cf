# SPDX-License-Identifier: GPL-2.0-or-later
"""The stage that puts the membrane in the rigid wall's place, then lets the specimen come to rest."""

import math

from yade import O

from hexmembrane.run.consolidation import FIRST, Consolidation
from hexmembrane.run.progress import Progress
from hexmembrane.run.stage import RAMP_PARTS, StageError
from hexmembrane.scene import exchange
from hexmembrane.scene.handles import Scene

#: Resultant force on a membrane sphere over the pressure's on it, below which the sheet rests on the grains that stand still.
_RESTS = 0.01


class FromWall(Consolidation):
	"""The wall goes and the membrane comes at the same pressure; then a consolidation at that pressure, until rest.

	The state at its beginning still has the wall: what goes wrong with the membrane, or is interrupted before the grains move, begins again from there.
	"""

	def begin(self):
		self.test.enter(self.planned.label)

	def run(self):
		"""As :meth:`hexmembrane.run.consolidation.Consolidation.run`.

		:raises StageError: the membrane cannot be put there, or does not come to bear on the grains.
		"""
		if self.test.scene.lateralBoundary.name == "wall":
			with Progress(self.planned.label, self.test.quiet) as progress:
				self._exchange(progress)
		super().run()

	def _exchange(self, progress):
		test = self.test
		test.advance(1)  # forces are not in a saved state, and the stress of the soil needs them
		before = self._soilStress()
		held = exchange.Held(test.scene)
		try:
			exchange.putMembrane(self.config, test.scene, progress.say)
		except ValueError as error:
			raise StageError(f"{self.planned.path}: {error}; the state in the wall is in '{test.out}'") from None
		test.scene = Scene()
		test.scene.holdRadialLoad()
		steps = self._press(progress)
		held.release(test.scene)
		if test.scene.radialServo:
			test.scene.radialServo.dead = False
		test.scene.setPressure(self.planned.pressure)
		test.enter(self.planned.label)
		test.advance(1)
		after = self._soilStress()
		row = test.row()
		progress.say(
			f"membrane in the wall's place after {steps} steps in which the grains stood still; soil's stress in its middle, axial and radial: "
			f"{before[0]:.2f} and {before[1]:.2f} kPa in the wall, {after[0]:.2f} and {after[1]:.2f} kPa in the membrane, which transmits "
			f"{1e-3 * row['sigma3_transmitted_group3']:.2f} kPa"
		)
		test.checkpoint()

	def _soilStress(self):
		"""Axial and radial stress of the soil in its middle half [kPa]."""
		stress = self.test.scene.measure.stress()["middle"]
		return 1e-3 * stress[2, 2], 0.5e-3 * (stress[0, 0] + stress[1, 1])

	def _press(self, progress):
		"""Bring the pressure onto the membrane while the grains stand still, until it arrives at them; the number of steps."""
		test, pressure, time = self.test, self.planned.pressure, self._changeTime()
		boundary, begun, first, most = test.scene.lateralBoundary, O.time, O.iter, self.config.consolidation.maxSteps
		while True:
			share = min(1.0, (O.time - begun) / time)
			boundary.setPressure(pressure * max(FIRST, (1 - math.cos(math.pi * share)) / 2))
			test.advance(max(1, math.ceil(time / (RAMP_PARTS * O.dt))))
			arrived = boundary.transmittedPressures()[3] / pressure
			progress.update(min(0.99, share), transmitted=f"{100 * arrived:.1f} %")
			if share == 1 and abs(arrived - 1) < self._tolerance() and boundary.unbalanced() < _RESTS:
				return O.iter - first
			if O.iter - first >= most:
				raise StageError(
					f"consolidation.maxSteps = {most}: the membrane does not bear on the grains with the pressure after {most} steps ({100 * arrived:.3g} % of it arrive, "
					f"unbalanced {boundary.unbalanced():.2e}, limit {_RESTS:g}); the state in the wall is in '{test.out}'; "
					"fix: allow more steps, a larger membrane.maxFactor, or more numerics.damping"
				)
