# SPDX-License-Identifier: GPL-2.0-or-later
"""The planes across which displacements of grains jump and in which their strain is, by weighted least squares. The model: :mod:`hexmembrane.measure.bands`.

A plane is an array: dip [rad], azimuth [rad], offset along its upward normal [m], logarithm of its thickness [m]. Uses nothing of YADE.
"""

import math

import numpy as np
from scipy.optimize import minimize
from scipy.special import erf

#: Dips that are looked at [degrees], and largest thickness of a band as a share of the specimen's diameter. The least is d50.
DIPS, THICKEST = (20, 80), 0.7
#: How much farther the search goes: the smooth profiles that fit a slab of uniform shear best are up to a quarter thicker than it.
_FARTHER = 1.3
#: Highest powers of height and of squared radius in the symmetric part.
_HEIGHT_POWER, _RADIUS_POWER = 5, 2
#: Share of a function's square that others must leave for it to count as another one.
_DEPENDENT = 1e-9
#: Grains that the search begins with.
_SCANNED = 1500
#: Planes that the search begins with differ by this angle or more [degrees].
_APART = 25


def normal(dip, azimuth):
	"""Upward unit normal of a plane, angles in radians, (3,)."""
	return np.array([math.sin(dip) * math.cos(azimuth), math.sin(dip) * math.sin(azimuth), math.cos(dip)])


def _symmetricPowers(x):
	"""Functions of height and radius at the places ``x`` (N, 3), the axis at x = y = 0, mid-height at z = 0: (N,) each."""
	square = (x[:, :2] ** 2).sum(axis=1)
	square, z = square / square.max(), x[:, 2] / np.abs(x[:, 2]).max()
	return [square**p * np.polynomial.Legendre.basis(q)(z) for p in range(_RADIUS_POWER + 1) for q in range(_HEIGHT_POWER + 1)]


def _orthonormal(columns, root):
	"""An orthonormal basis of the functions ``columns``, (N,) each, times the roots of the weights; those that depend on others add nothing."""
	columns = np.array(columns).T * root[:, None]
	columns /= np.linalg.norm(columns, axis=0)
	values, vectors = np.linalg.eigh(columns.T @ columns)
	kept = values > _DEPENDENT * values[-1]
	return columns @ (vectors[:, kept] / np.sqrt(values[kept]))


def _scaled(x, plane):
	return (x @ normal(*plane[:2]) - plane[2]) * (math.sqrt(6) * math.exp(-plane[3]))


def slabProfile(x, plane):
	"""Shear across a plane at the places ``x`` over that in the slab's middle, (N,)."""
	return np.exp(-(_scaled(x, plane) ** 2))


def stepProfile(x, plane):
	"""Share of the jump at the places ``x``, -1/2 to 1/2, (N,)."""
	return 0.5 * erf(_scaled(x, plane))


def rampProfile(x, plane):
	"""The same for a slab of uniform shear, whose displacement is linear across it, (N,)."""
	return np.clip((x @ normal(*plane[:2]) - plane[2]) * math.exp(-plane[3]), -0.5, 0.5)


def _beside(basis, columns):
	"""Orthonormal columns of what the functions ``columns``, (N,) each, add to the orthonormal ``basis``."""
	own = np.zeros((basis.shape[0], 0))
	for column in columns:
		left = column / np.linalg.norm(column)
		for _ in range(2):  # the second time takes what rounding has left of the first
			left = left - basis @ (basis.T @ left) - own @ (own.T @ left)
		size = left @ left
		if size > _DEPENDENT:
			own = np.column_stack([own, left / math.sqrt(size)])
	return own


def _less(values, basis):
	return values - basis @ (basis.T @ values)


def _rows(root, *columns):
	return np.ascontiguousarray(np.column_stack(columns).T) * root


class Base:
	"""What the symmetric and affine parts explain of displacements and strains: the same for all planes, and most of the work."""

	def __init__(self, x, u, weights, strain):
		self.x, self.weights, n, root = x, weights, len(x), np.sqrt(weights)
		self.root, powers, none = root, _symmetricPowers(x), np.zeros(len(x))
		a = x[:, :2] / np.abs(x[:, :2]).max()
		either = [np.ones(n), a[:, 0], a[:, 1], x[:, 2] / np.abs(x[:, 2]).max()]
		sideways = [np.concatenate([a[:, 0] * p, a[:, 1] * p]) for p in powers]
		sideways += [np.concatenate(pair) for f in either for pair in ((f, none), (none, f))]
		self.up = _orthonormal([*powers, a[:, 0], a[:, 1]], root)
		self.side = _orthonormal(sideways, np.tile(root, 2))
		self.still = _orthonormal(powers, root)
		self.uz, self.us, self.e = root * u[:, 2], np.concatenate([root * u[:, 0], root * u[:, 1]]), root * strain
		self.strain = self.still @ (self.still.T @ self.e)
		self.uz, self.us, self.e = _less(self.uz, self.up), _less(self.us, self.side), self.e - self.strain
		#: Rows that a profile is multiplied with: of the displacements up, along x and along y; of the strains.
		self.steps, self.slabs = _rows(root, self.up, self.side[:n], self.side[n:]), _rows(root, self.still)


class Field:
	"""Displacements and strains less what a :class:`Base` and given planes explain; what one plane more explains of the rest."""

	def __init__(self, base, planes=()):
		self._base, self.x, self.weights, n, root, none = base, base.x, base.weights, len(base.x), base.root, np.zeros(len(base.x))
		jumps = [root * stepProfile(self.x, plane) for plane in planes]
		up, still = _beside(base.up, jumps), _beside(base.still, [root * slabProfile(self.x, plane) for plane in planes])
		side = _beside(base.side, [np.concatenate(pair) for jump in jumps for pair in ((jump, none), (none, jump))])
		uz, us, rest = _less(base.uz, up), _less(base.us, side), _less(base.e, still)
		#: Weighted squares that are left, of displacements and of strains.
		self.left = np.array([uz @ uz + us @ us, rest @ rest])
		#: Part of the strain that is explained, (N,); 0 where the weight is.
		self.explainedStrain = np.divide(base.strain + base.e - rest, root, out=np.zeros(n), where=root > 0)
		self._sizes = np.cumsum([base.up.shape[1], base.side.shape[1]]).tolist()
		self._ownSizes = np.cumsum([up.shape[1], side.shape[1], side.shape[1]]).tolist()
		self._steps, self._slabs = _rows(root, up, side[:n], side[n:], uz, us[:n], us[n:]), _rows(root, still, rest)

	def jump(self, step):
		"""The jump (3,) [m] that fits best with the profile ``step`` (N,), and the weighted squares that it takes of those left."""
		base, own = self._base.steps @ step, self._steps @ step
		(a, b), (i, j, k) = self._sizes, self._ownSizes
		x, y, ownX, ownY, (bz, bx, by) = base[a:b], base[b:], own[i:j], own[j:k], own[k:]
		whole = self.weights @ step**2
		zz = whole - base[:a] @ base[:a] - own[:i] @ own[:i]
		xx, yy, xy = whole - x @ x - ownX @ ownX, whole - y @ y - ownY @ ownY, -x @ y - ownX @ ownY
		det = xx * yy - xy**2
		jump = np.array([(yy * bx - xy * by) / det, (xx * by - xy * bx) / det, bz / zz]) if zz > 0 and det > 0 else np.zeros(3)
		return jump, jump @ (bx, by, bz)

	def excess(self, plane):
		"""The strain in the slab's middle above that beside it that fits best, 0 at least, and the weighted squares that it takes of those left."""
		slab = slabProfile(self.x, plane)
		s, (*own, b) = self._base.slabs @ slab, self._slabs @ slab
		ss = self.weights @ slab**2 - s @ s - np.dot(own, own)
		strain = max(0.0, b / ss) if ss > 0 else 0.0
		return strain, strain * b

	def unlikely(self, plane):
		"""Logarithm of the product of the shares that the plane leaves of displacements and strains: the least is the most likely plane."""
		taken = np.array([self.jump(stepProfile(self.x, plane))[1], self.excess(plane)[1]])
		return float(np.log(np.maximum(1 - taken / np.maximum(self.left, 1e-300), 1e-12)).sum())


class Search:
	"""The search for planes.

	:param x: places (N, 3), the axis at x = y = 0, mid-height at z = 0 [m]. :param u: displacements (N, 3) [m].
	:param weights: (N,). :param strain: deviatoric strains (N,). :param diameter: d50 [m].
	"""

	def __init__(self, x, u, weights, strain, diameter):
		self.x, self.u, self.weights, self.strain, self._fields, self._base = x, u, weights, strain, {}, None
		wide = 2 * float(np.sqrt((x[:, :2] ** 2).sum(axis=1).max()))
		#: Largest thickness of a band [m].
		self.thickest = max(THICKEST * wide, 2 * diameter)
		self.low = np.array([math.radians(DIPS[0]), -math.inf, x[:, 2].min(), math.log(diameter)])
		self.high = np.array([math.radians(DIPS[1]), math.inf, x[:, 2].max(), math.log(_FARTHER * self.thickest)])
		self.steps = np.array([math.radians(4), math.radians(6), diameter, 0.25])

	def weighted(self, weights):
		"""The same grains with other weights."""
		return self._of(self.x, self.u, weights, self.strain)

	def _of(self, x, u, weights, strain):
		made = Search.__new__(Search)
		made.__dict__.update(self.__dict__, x=x, u=u, weights=weights, strain=strain, _fields={}, _base=None)
		return made

	def field(self, planes=()):
		"""The :class:`Field` with these planes in the model; that of the last planes is kept."""
		name = b"".join(np.asarray(plane).tobytes() for plane in planes)
		if name not in self._fields:
			if len(self._fields) > 1:
				self._fields.pop(next(reversed(self._fields)))  # the first one, mostly without planes, is asked for again and again
			self._base = self._base or Base(self.x, self.u, self.weights, self.strain)
			self._fields[name] = Field(self._base, planes)
		return self._fields[name]

	def isFree(self, plane, slab):
		"""Whether neither its dip nor its thickness is at a limit of the search, nor its slab (:meth:`thickness`) too thick for a band."""
		return all(self.low[k] + 1e-3 < plane[k] < self.high[k] - 1e-3 for k in (0, 3)) and math.exp(slab[3]) < self.thickest

	def refined(self, field, plane, tolerance=0.02, trials=200):
		"""The most likely plane near ``plane`` for what the field has left; ``tolerance`` in steps of the search."""

		def unlikely(steps):
			return field.unlikely(self._within(plane + steps * self.steps))

		options = {"initial_simplex": np.vstack([np.zeros(4), np.eye(4)]), "xatol": tolerance, "fatol": 1e-5, "maxfev": trials}
		return self._within(plane + minimize(unlikely, np.zeros(4), method="Nelder-Mead", options=options).x * self.steps)

	def _within(self, plane):
		return np.clip(plane, self.low, self.high)

	def together(self, planes, rounds=3, **precision):
		"""The planes fitted in turn, each with the others in the model."""
		planes = list(planes)
		for _ in range(rounds):
			for k, plane in enumerate(planes):
				planes[k] = self.refined(self.field([*planes[:k], *planes[k + 1 :]]), plane, **precision)
		return tuple(planes)

	def thickness(self, field, plane):
		"""The slab of uniform shear, parallel to the plane, whose displacement fits best what the field has left: (plane, jump (3,) [m])."""

		def ramp(steps):
			return rampProfile(self.x, self._within(plane + [0, 0, *steps * self.steps[2:]]))

		options = {"initial_simplex": np.array([[0, 0], [0.5, 0], [0, 1]]), "xatol": 0.02, "fatol": 1e-6 * field.left[0], "maxfev": 80}
		steps = minimize(lambda steps: -field.jump(ramp(steps))[1], np.zeros(2), method="Nelder-Mead", options=options).x
		return self._within(plane + [0, 0, *steps * self.steps[2:]]), field.jump(ramp(steps))[0]

	def scan(self, field, count, azimuths):
		"""The most likely ``count`` planes of a coarse grid; ``azimuths``: those to look at [rad]."""
		seen = []
		for dip in np.radians(np.arange(DIPS[0] + 5, DIPS[1], 10)):
			for azimuth in azimuths:
				for offset in np.quantile(self.x @ normal(dip, azimuth), np.linspace(0.2, 0.8, 7)):
					plane = np.array([dip, azimuth, offset, math.log(self.thickest / 2)])
					seen.append((field.unlikely(plane), plane))
		chosen = []
		for _, plane in sorted(seen, key=lambda one: one[0]):
			if all(normal(*plane[:2]) @ normal(*other[:2]) < math.cos(math.radians(_APART)) for other in chosen):
				chosen.append(plane)
			if len(chosen) == count:
				break
		return chosen

	def best(self, planes=(), azimuths=None):
		"""The most likely plane beside ``planes``; ``azimuths``: to look near [rad], all without."""
		if azimuths is None:
			azimuths = np.radians(np.arange(0, 360, 15))
		every = slice(None, None, max(1, len(self.x) // _SCANNED))
		part = self._of(self.x[every], self.u[every], self.weights[every], self.strain[every])
		field = part.field(planes)
		found = [part.refined(field, plane) for plane in part.scan(field, 4, azimuths)]
		return self.refined(self.field(planes), min(found, key=field.unlikely))
