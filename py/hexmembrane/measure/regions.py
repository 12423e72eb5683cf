# SPDX-License-Identifier: GPL-2.0-or-later
"""Measurement regions that the material carries with it."""

import numpy as np
from yade import BodyArrays


class CarriedRegions:
	"""Centres of measurement regions that move with the grains that they hold.

	Between two calls of :meth:`move` each region goes on by the mean displacement of the grains whose centres it held at the first one.
	Displacements and not velocities are averaged: those of an instant are mostly the grains' trembling. Call it often enough that
	few grains pass a region's surface between two calls, such as each 0.1 % of strain. A region without a grain stays where it is::

		carried = CarriedRegions(yade.MeasureRegions(membrane=m), centres, 6e-3)
		...  # some steps
		carried.move()
		stress = carried.measure()["stress"]

	:param regions: a ``MeasureRegions``. :param centres: [m], (N, 3). :param radii: [m], (N,) or one number for all.
	:raises ValueError: for what ``MeasureRegions`` refuses: a region outside the specimen, a radius that is not positive.
	"""

	def __init__(self, regions, centres, radii):
		self.regions = regions
		self.centres = np.array(centres, dtype=float)
		self.radii = np.broadcast_to(np.asarray(radii, dtype=float), len(self.centres))
		self._hold()

	def _hold(self):
		self._start, self._ids = self.regions.members(self.centres, self.radii)
		self._places = BodyArrays.positions(self._ids.tolist())

	def move(self):
		"""Move the regions on with the grains that they held at the last call; returns the centres [m], (N, 3).

		:raises RuntimeError: for a grain that was erased since.
		"""
		shifts = BodyArrays.positions(self._ids.tolist()) - self._places
		sums = np.vstack([np.zeros((1, 3)), np.cumsum(shifts, axis=0)])
		counts = np.diff(self._start)
		self.centres = self.centres + np.diff(sums[self._start], axis=0) / np.maximum(counts, 1)[:, None]
		self._hold()
		return self.centres

	def measure(self, diameters=()):
		"""``MeasureRegions.measure`` at the regions' present places."""
		return self.regions.measure(self.centres, self.radii, diameters)
