# SPDX-License-Identifier: GPL-2.0-or-later
"""Shear bands found in a strain step of 1 to 2 %: a band, a conjugate pair, a barrel or nothing; dip, azimuth and thickness, with intervals.

A band is a plane with more shear than there is beside it, across which the displacement jumps. With s the distance from the plane and t the thickness,

* the deviatoric strain is a polynomial of height and radius (symmetric about the axis: barrelling, dead cones at the platens) and A exp(-6 s^2/t^2),
* the displacement is such polynomials, an affine field and J erf(sqrt(6) s/t)/2.

Both profiles are those of one shear. The plane is that which leaves the least product of the shares of both fields that the symmetric and affine parts do not
explain, grains weighted with their volumes: the most likely one for normal noise of each grain alone. From these planes come index and verdict.

Vortices of many grains bend a plane's step. So the planes of a band or a pair are then fitted by generalised least squares (pkg/kernels/measure/BandLikelihood.hpp).
The thickness that is told is that of the slab of uniform shear, parallel to the plane, whose displacement fits best: linear across the slab, constant beyond.

The localisation index is the share of the specimen's deviatoric strain that A exp(-6 s^2/t^2) stands for: what bands carry above all that is symmetric, 1 at
most. Uniform strain and a barrel have about 0. There is a band when the index is INDEX_LIMIT or more, the jump explains EXPLAINED_LIMIT or more of the displacement
that is neither symmetric nor affine, and neither dip nor thickness is at a limit of the search: there the index says nothing.
"""

import dataclasses
import functools
import math

import numpy as np

from hexmembrane.measure.band_search import Search, normal, slabProfile

#: Least localisation index of bands, least share of the displacement that their jumps explain.
INDEX_LIMIT, EXPLAINED_LIMIT = 0.2, 0.2
#: Least index of the second band of a pair alone, and of the first.
SECOND_LIMIT = 0.1
#: Least coefficient of variation of the symmetric part of the deviatoric strain in a barrel.
BARREL_LIMIT = 0.25
#: Two planes are a conjugate pair when they dip in opposite directions to within this angle [degrees].
OPPOSITE = 45
#: Edge, in mean spacings of the grains, of the blocks that replicates are drawn of: neighbours move alike.
_BLOCK = 3.0
#: Fewest grains of a specimen.
FEWEST = 100


@dataclasses.dataclass(frozen=True)
class Plane:
	"""One band.

	:param dip: angle of its plane with the horizontal [degrees].
	:param azimuth: direction in which it dips, from x towards y [degrees], 0 to 360.
	:param point: where it meets the specimen's axis [m], (3,).
	:param thickness: [m].
	:param jump: displacement of its upper side less that of its lower side [m], (3,).
	"""

	dip: float
	azimuth: float
	point: tuple
	thickness: float
	jump: tuple = (math.nan,) * 3

	@property
	def normal(self):
		"""Upward unit normal, (3,)."""
		return normal(math.radians(self.dip), math.radians(self.azimuth))

	def distance(self, points):
		"""Signed distance of points (N, 3) from the plane [m], positive above it."""
		return (np.asarray(points) - self.point) @ self.normal

	def inside(self, points):
		"""Which of the points (N, 3) are in the slab, as booleans."""
		return np.abs(self.distance(points)) <= self.thickness / 2


@dataclasses.dataclass(frozen=True)
class Finding:
	"""What was found in one step.

	:param verdict: 'band', 'pair' (two conjugate ones), 'barrel' or 'none'.
	:param planes: the bands; without a band the best plane that there is, for the index's course.
	:param index: the localisation index.
	:param explained: share that the planes' jumps take of the displacement that is neither symmetric nor affine.
	:param barrel: coefficient of variation of the symmetric part of the deviatoric strain.
	:param intervals: 95 % intervals (low, high) by name: 'index', 'explained', and for each plane k 'dip[k]', 'azimuth[k]', 'thickness[k]'; empty without
		a band or a bootstrap. Those of an azimuth are within 180 degrees of the azimuth, so may leave 0 to 360.
	:param certainty: share of the bootstrap's replicates in which the planes are bands, nan without.
	"""

	verdict: str
	planes: tuple
	index: float
	explained: float
	barrel: float
	intervals: dict = dataclasses.field(default_factory=dict)
	certainty: float = math.nan


def find(positions, displacements, volumes, deviatoric, diameter, axis=None, replicates=0, seed=1):
	"""Find bands in a step.

	:param positions: of the grains when the step began [m], (N, 3).
	:param displacements: in the step [m], (N, 3).
	:param volumes: of their cells [m3], (N,); grains without one are left out.
	:param deviatoric: deviatoric strain in the step, (N,).
	:param diameter: d50 [m].
	:param axis: x and y of the specimen's axis [m]; None: the mean of the positions.
	:param replicates: of the bootstrap where there is a band, 0: no intervals. 50 or more give steady ones.
	:param seed: of the bootstrap's random numbers.
	:returns: a :class:`Finding`.
	:raises ValueError: arrays of other shapes, less than 100 grains with a cell, no strain at all, a diameter that is not positive.
	"""
	x, u, volumes, strain = _checked(positions, displacements, volumes, deviatoric, diameter)
	centre = np.append(x[:, :2].mean(axis=0) if axis is None else axis, 0.5 * (x[:, 2].min() + x[:, 2].max()))
	step = _Step(x - centre, u, volumes / volumes.sum(), strain, diameter)
	found, barrel = step.bands(), step.symmetricVariation()
	planes = found or (step.best,)
	verdict = ("band", "pair")[len(found) - 1] if found else "barrel" if barrel >= BARREL_LIMIT else "none"
	return Finding(
		verdict,
		tuple(_planeOf(plane, jump, centre) for plane, jump in step.slabs(step.search.likeliest(found) if found else planes)),
		min(1.0, sum(step.indices(planes))),
		step.explained(planes),
		barrel,
		*_bootstrap(step, found, replicates, seed),
	)


def _checked(positions, displacements, volumes, deviatoric, diameter):
	"""The arrays, of grains with a cell alone."""
	x, u, v, e = (np.asarray(values, dtype=float) for values in (positions, displacements, volumes, deviatoric))
	n = len(v)
	for name, values, shape in (("positions", x, (n, 3)), ("displacements", u, (n, 3)), ("volumes", v, (n,)), ("deviatoric", e, (n,))):
		if values.shape != shape:
			raise ValueError(f"bands.find: {name} = an array {values.shape}: {shape} expected; fix: give one row a grain")
	if not (math.isfinite(diameter) and diameter > 0):
		raise ValueError(f"bands.find: diameter = {diameter}: is no length; fix: give d50 in m")
	kept = (v > 0) & np.isfinite(e) & np.isfinite(x).all(axis=1) & np.isfinite(u).all(axis=1)
	if kept.sum() < FEWEST:
		raise ValueError(f"bands.find: volumes = {int(kept.sum())} grains with a cell and a strain: less than {FEWEST}; fix: give the grains of a whole specimen")
	if not (v[kept] @ e[kept] > 0):
		raise ValueError("bands.find: deviatoric = 0 in all grains: there is no strain to look at; fix: give a step in which the specimen is strained")
	return x[kept], u[kept], v[kept], e[kept]


class _Step:
	"""The judgement of planes in one step; the parameters are those of :class:`hexmembrane.measure.band_search.Search`."""

	def __init__(self, *arrays):
		self._take(Search(*arrays))

	def _take(self, search):
		self.search, self.left = search, search.squares.left()[0]
		self.strain = search.weights @ search.strain

	@functools.cached_property
	def best(self):
		"""The best single plane."""
		return self.search.best()

	def weighted(self, weights):
		"""The same grains with other weights."""
		made = _Step.__new__(_Step)
		made._take(self.search.weighted(weights))
		return made

	@staticmethod
	def _each(planes):
		"""Each plane with the others."""
		return [(plane, [*planes[:k], *planes[k + 1 :]]) for k, plane in enumerate(planes)]

	def slabs(self, planes):
		"""The slab of uniform shear of each plane, and the jump across it."""
		return [self.search.slab(plane, others) for plane, others in self._each(planes)]

	def explained(self, planes):
		return float(1 - self.search.squares.left(np.array(planes))[0] / self.left)

	def indices(self, planes):
		"""The localisation index of each plane."""
		shares = [self.search.weights @ slabProfile(self.search.x, plane) for plane in planes]
		return [float(self.search.squares.excess(plane, others)[0] * share / self.strain) for (plane, others), share in zip(self._each(planes), shares)]

	def areBands(self, planes):
		"""Whether they are."""
		indices = self.indices(planes)
		strong = sum(indices) >= INDEX_LIMIT and (len(planes) == 1 or min(indices) >= SECOND_LIMIT)
		if not (strong and self.explained(planes) >= EXPLAINED_LIMIT):
			return False
		return all(self.search.isFree(plane, slab) for plane, (slab, _) in zip(planes, self.slabs(planes)))

	def bands(self):
		"""The band or the two of a conjugate pair, none without. Two that are a pair may be no band when each is looked at alone."""
		return next((planes for planes in (self._pair(), (self.best,)) if planes and self.areBands(planes)), ())

	def _pair(self):
		"""The best plane and one that dips the other way, fitted together; none when they end up otherwise, or the best one has next to nothing."""
		if sum(self.indices((self.best,))) < SECOND_LIMIT / 2:
			return ()
		second = self.search.best((self.best,), self.best[1] + math.pi + np.radians(np.arange(-30, 31, 15)))
		planes = self.search.together((self.best, second))
		turn = math.degrees((planes[1][1] - planes[0][1]) % (2 * math.pi))
		return planes if abs(turn - 180) <= OPPOSITE else ()

	def symmetricVariation(self):
		"""Coefficient of variation of the part of the strain that is symmetric about the axis."""
		fit, weights = self.search.squares.symmetricStrain(), self.search.weights / self.search.weights.sum()
		mean = weights @ fit
		return float(np.sqrt(weights @ (fit - mean) ** 2) / mean)


def _planeOf(plane, jump, centre):
	"""A :class:`Plane` from a search's array."""
	point = centre + (0, 0, plane[2] / math.cos(plane[0]))
	return Plane(math.degrees(plane[0]), math.degrees(plane[1]) % 360, tuple(map(float, point)), math.exp(plane[3]), tuple(map(float, jump)))


def _bootstrap(step, planes, replicates, seed):
	"""(intervals, certainty): blocks of grains drawn with replacement, the planes fitted anew from where they are."""
	if not (replicates and planes):
		return {}, math.nan
	random, x = np.random.default_rng(seed), step.search.x
	edge = _BLOCK * float(np.prod(np.ptp(x, axis=0)) / len(x)) ** (1 / 3)
	block = np.unique(np.floor(x / edge).astype(int), axis=0, return_inverse=True)[1].ravel()
	count, held, table = block.max() + 1, 0, []
	for _ in range(replicates):
		again = step.weighted(step.search.weights * np.bincount(random.integers(count, size=count), minlength=count)[block])
		found = again.search.together(planes, len(planes), tolerance=0.05, trials=60)
		held += again.areBands(found)
		row = [min(1.0, sum(again.indices(found))), again.explained(found)]
		for (plane, _), was in zip(again.slabs(again.search.likeliest(found, tolerance=0.05, trials=60)), planes):
			turn = math.degrees((plane[1] - was[1] + math.pi) % (2 * math.pi) - math.pi)
			row += [math.degrees(plane[0]), math.degrees(was[1]) % 360 + turn, math.exp(plane[3])]
		table.append(row)
	names = ["index", "explained"] + [f"{name}[{k}]" for k in range(len(planes)) for name in ("dip", "azimuth", "thickness")]
	low, high = np.percentile(table, (2.5, 97.5), axis=0)
	return {name: (float(a), float(b)) for name, a, b in zip(names, low, high)}, held / replicates


def medianDiameter(radii):
	"""d50 [m]: half of the grains' volume is in smaller ones; ``radii`` [m]."""
	r = np.sort(np.asarray(radii))
	return 2 * float(r[np.searchsorted(np.cumsum(r**3), 0.5 * (r**3).sum())])


def expectedDips(phi, psi):
	"""Dips [degrees] of a band by Coulomb, 45 + phi/2, Roscoe, 45 + psi/2, and Arthur, their mean; angles of friction and dilatancy [degrees]."""
	coulomb, roscoe = 45 + phi / 2, 45 + psi / 2
	return coulomb, roscoe, (coulomb + roscoe) / 2


def onset(strains, indices, bands):
	"""Strain at which the index passes its limit for good, linear between steps; nan: never.

	:param strains: axial strain in the middle of each step, rising. :param indices: localisation index of each.
	:param bands: whether each step's verdict was a band or a pair. The first that is followed by no other verdict counts.
	"""
	without = [k for k, found in enumerate(bands) if not found]
	first = without[-1] + 1 if without else 0
	if first >= len(bands):
		return math.nan
	if first == 0 or not indices[first - 1] < INDEX_LIMIT <= indices[first]:
		return float(strains[first])
	share = (INDEX_LIMIT - indices[first - 1]) / (indices[first] - indices[first - 1])
	return float(strains[first - 1] + share * (strains[first] - strains[first - 1]))
