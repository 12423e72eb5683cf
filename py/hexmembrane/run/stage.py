# SPDX-License-Identifier: GPL-2.0-or-later
"""What every kind of stage of a test has in common. The kinds: :mod:`hexmembrane.run.consolidation`, :mod:`hexmembrane.run.straining`."""

import abc

from hexmembrane.configuration.cement import CONSOLIDATED
from hexmembrane.run.estimate import RISE
from hexmembrane.run.progress import tell
from hexmembrane.scene import timestep
from hexmembrane.scene.builder import checkTimeStep
from hexmembrane.scene.cement import bondGrains

#: Parts that a smooth change of the pressure is divided into; each is 1 % of the time.
RAMP_PARTS = 100


class StageError(RuntimeError):
	"""A stage that cannot reach its target, or that YADE stopped; a checkpoint of the last sound state is in the folder."""


class Stage(abc.ABC):
	"""A stage of a test.

	:param test: the :class:`hexmembrane.run.stages.TriaxialTest`.
	:param planned: the :class:`hexmembrane.configuration.stages.Planned`.
	"""

	def __init__(self, test, planned):
		self.test, self.planned, self.config = test, planned, test.config

	@abc.abstractmethod
	def begin(self):
		"""Set servos and drives for the stage; strains may count from here."""

	@abc.abstractmethod
	def run(self):
		"""From where the stage is to its end, with rows, frames and checkpoints.

		:raises StageError: it does not get there.
		"""

	def nominal(self):
		"""(strain meant at the row before, at this row, whether it is the stage's last) for the measurement inside; twice the same where nothing new is reached."""
		return self.planned.farthest, self.planned.farthest, False

	def inertialTime(self):
		"""d sqrt(rho/sigma3) [s]: a strain rate times this is the inertial number."""
		grains = self.test.grains
		return timestep.inertialTime(grains.meanDiameter / 2, grains.density, max(self.planned.pressure, self.planned.before))

	def _changeTime(self):
		"""Time over which the pressure changes [s]."""
		return self.planned.time or RISE * self.inertialTime()

	def _leaveConsolidation(self):
		"""Enter the stage: after a consolidation strains count from here, the radial load stays, and frictions are those of shear."""
		test = self.test
		if len(self.planned.chain) > 1:
			return test.enterNext(self.planned.label)
		test.enter(self.planned.label)
		test.scene.holdRadialLoad()
		test.scene.setFriction(self.config.specimen.friction, self.config.platens.friction, self.config.contacts.frictions())
		test.scene.setTimeLimit(None)
		self._bond(CONSOLIDATED)

	def _bond(self, moment):
		"""Bond the grains where this is the moment for it. :raises StageError: it cannot be done."""
		if self.config.cement.when != moment:
			return
		test = self.test

		def say(text):
			if not test.quiet:
				tell(text)

		try:
			if bondGrains(self.config, test.scene, say):
				test.advance(1)  # bonds have no load in it; a scene that was just loaded knows its contacts then
				checkTimeStep(self.config, test.scene, say)
		except ValueError as error:
			raise StageError(str(error)) from None
