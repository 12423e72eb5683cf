# SPDX-License-Identifier: GPL-2.0-or-later
"""Measurement regions that the material carries with it, and the strain in them."""

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


def gradients(start, before, shifts):
	"""Displacement gradients of the regions' grains by least squares, entry (i, j) du_i/dx_j, (N, 3, 3); nan for less than four grains or grains in a plane.

	:param start: (N+1,), where each region's grains begin in ``before`` and ``shifts``, their places and displacements [m], (M, 3).
	"""
	found = np.full((len(start) - 1, 3, 3), np.nan)
	for k, (a, b) in enumerate(zip(start[:-1], start[1:])):
		if b - a < 4:
			continue
		x, u = before[a:b] - before[a:b].mean(axis=0), shifts[a:b] - shifts[a:b].mean(axis=0)
		solution, _, rank, _ = np.linalg.lstsq(x, u, rcond=1e-6)
		if rank == 3:
			found[k] = solution.T
	return found


class RegionHistory(CarriedRegions):
	"""Regions, carried or fixed, with the strain of what they held since they were made.

	Each call of :meth:`move` adds the strain, by least squares, of the grains that a region held at the call before.

	Attribute: ``strains``, (N, 3): axial (compression positive), volumetric (dilation positive), deviatoric (sum of the steps), [-].

	:param regions, centres, radii: as :class:`CarriedRegions`. :param carried: whether the material carries them.
	:param state: what :meth:`state` gave, to go on.
	"""

	def __init__(self, regions, centres, radii, carried=True, state=None):
		super().__init__(regions, centres, radii)
		self.carried, self.strains = carried, np.zeros((len(self.centres), 3))
		if state is not None:
			self._start, self._ids, self._places, self.strains = (state[name] for name in ("start", "ids", "places", "strains"))

	def state(self):
		"""All that a resumed test needs, a dictionary of arrays."""
		return {"centres": self.centres, "start": self._start, "ids": self._ids, "places": self._places, "strains": self.strains}

	def move(self):
		shifts = BodyArrays.positions(self._ids.tolist()) - self._places
		g = gradients(self._start, self._places, shifts)
		volumetric = np.trace(g, axis1=1, axis2=2)
		e = (g + g.transpose(0, 2, 1)) / 2 - volumetric[:, None, None] / 3 * np.eye(3)
		self.strains = self.strains + np.column_stack([-g[:, 2, 2], volumetric, np.sqrt(2 / 3 * (e**2).sum(axis=(1, 2)))])
		if self.carried:
			return super().move()
		self._hold()
		return self.centres
