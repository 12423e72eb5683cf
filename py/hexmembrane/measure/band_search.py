# SPDX-License-Identifier: GPL-2.0-or-later
"""The planes across which displacements of grains jump and in which their strain is, by weighted least squares. The model: :mod:`hexmembrane.measure.bands`.

A plane is an array: dip [rad], azimuth [rad], offset along its upward normal [m], logarithm of its thickness over 1 m. The least squares are YADE's class
BandSearch; here are where the search begins and where it ends.
"""

import math

import numpy as np
from yade import BandSearch

#: Dips that are looked at [degrees], and largest thickness of a band as a share of the specimen's diameter. The least is d50.
DIPS, THICKEST = (20, 80), 0.7
#: How much farther the search goes: the smooth profiles that fit a slab of uniform shear best are up to a quarter thicker than it.
#: Those of zones as wide as THICKEST come out thicker still, since the symmetric part takes their middle; with 2 here one of 100 uniform fields has a band.
_FARTHER = 1.3
#: Grains that the search begins with.
_SCANNED = 1500
#: Planes that the search begins with differ by this angle or more [degrees].
_APART = 25


def normal(dip, azimuth):
	"""Upward unit normal of a plane, angles in radians, (3,); of several as rows."""
	dip, azimuth = np.asarray(dip), np.asarray(azimuth)
	return np.stack([np.sin(dip) * np.cos(azimuth), np.sin(dip) * np.sin(azimuth), np.cos(dip)], axis=-1)


def slabProfile(x, plane):
	"""Shear across a plane at the places ``x`` over that in the slab's middle, (N,)."""
	return np.exp(-6 * ((x @ normal(*plane[:2]) - plane[2]) * math.exp(-plane[3])) ** 2)


class Search:
	"""The search for planes.

	:param x: places (N, 3), the axis at x = y = 0, mid-height at z = 0 [m]. :param u: displacements (N, 3) [m].
	:param weights: (N,). :param strain: deviatoric strains (N,). :param diameter: d50 [m].
	"""

	def __init__(self, x, u, weights, strain, diameter):
		wide = 2 * float(np.sqrt((x[:, :2] ** 2).sum(axis=1).max()))
		#: Largest thickness of a band [m].
		self.thickest, self.diameter = max(THICKEST * wide, 2 * diameter), diameter
		low = (math.radians(DIPS[0]), -math.inf, x[:, 2].min(), math.log(diameter))
		high = (math.radians(DIPS[1]), math.inf, x[:, 2].max(), math.log(_FARTHER * self.thickest))
		#: Lowest and highest plane, paces of the search.
		self.limits = np.array([low, high, (math.radians(4), math.radians(6), diameter, 0.25)])
		self._take(x, u, weights, strain)

	def _take(self, x, u, weights, strain):
		self.x, self.u, self.weights, self.strain = x, u, weights, strain
		#: YADE's BandSearch.
		self.squares = BandSearch()
		self.squares.setGrains(x, u, weights, strain)

	def _of(self, *arrays):
		made = Search.__new__(Search)
		made.thickest, made.diameter, made.limits = self.thickest, self.diameter, self.limits
		made._take(*arrays)
		return made

	def weighted(self, weights):
		"""The same grains with other weights."""
		return self._of(self.x, self.u, weights, self.strain)

	def isFree(self, plane, slab):
		"""Whether neither its dip nor its thickness is at a limit of the search, nor its slab (:meth:`slab`) too thick for a band."""
		low, high, _ = self.limits
		return all(low[k] + 1e-3 < plane[k] < high[k] - 1e-3 for k in (0, 3)) and math.exp(slab[3]) < self.thickest

	def refined(self, plane, beside=(), tolerance=0.02, trials=200):
		"""The most likely plane near ``plane`` for what the planes ``beside`` leave; ``tolerance`` in paces of the search."""
		return self.squares.refined(plane, self.limits, _rows(beside), tolerance, trials)

	def together(self, planes, rounds=3, **precision):
		"""The planes fitted in turn, each with the others in the model."""
		planes = list(planes)
		for _ in range(rounds):
			for k, plane in enumerate(planes):
				planes[k] = self.refined(plane, [*planes[:k], *planes[k + 1 :]], **precision)
		return tuple(planes)

	def likeliest(self, planes, **precision):
		"""The planes by generalised least squares from where they are: grains also move in vortices, which bend a plane's step."""
		return tuple(self.squares.likeliest(_rows(planes), self.limits, self.diameter, 3 if len(planes) > 1 else 1, **precision))

	def slab(self, plane, beside=()):
		"""The slab of uniform shear, parallel to the plane, whose displacement fits best what ``beside`` leave: (plane, jump (3,) [m])."""
		slab = self.squares.slab(plane, self.limits, _rows(beside))
		return slab, self.squares.jump(slab, _rows(beside), uniform=True)[0]

	def scan(self, count, azimuths, beside=()):
		"""The most likely ``count`` planes of a coarse grid; ``azimuths``: those to look at [rad]."""
		dips = np.radians(np.arange(DIPS[0] + 5, DIPS[1], 10))
		angles = np.array([(dip, azimuth) for dip in dips for azimuth in azimuths])
		normals = normal(*angles.T)
		offsets = np.quantile(self.x @ normals.T, np.linspace(0.2, 0.8, 7), axis=0)
		planes = np.column_stack([np.repeat(angles, len(offsets), axis=0), offsets.T.ravel(), np.full(offsets.size, math.log(self.thickest / 2))])
		chosen = []
		for k in np.argsort(self.squares.unlikely(planes, _rows(beside)), kind="stable"):
			n = normals[k // len(offsets)]
			if all(n @ other < math.cos(math.radians(_APART)) for _, other in chosen):
				chosen.append((planes[k], n))
			if len(chosen) == count:
				break
		return [plane for plane, _ in chosen]

	def best(self, beside=(), azimuths=None):
		"""The most likely plane beside the planes ``beside``; ``azimuths``: to look near [rad], all without."""
		if azimuths is None:
			azimuths = np.radians(np.arange(0, 360, 15))
		every = slice(None, None, max(1, len(self.x) // _SCANNED))
		part = self._of(self.x[every], self.u[every], self.weights[every], self.strain[every])
		found = [part.refined(plane, beside) for plane in part.scan(4, azimuths, beside)]
		return self.refined(found[np.argmin(part.squares.unlikely(found, _rows(beside)))], beside)


def _rows(planes):
	return np.array(planes).reshape(-1, 4)
