# SPDX-License-Identifier: GPL-2.0-or-later
"""Displacement fields with known bands in a real packing, with noise; trials of the search for bands in them.

``scripts/yade -x tests/python/syntheticBands.py TRIALS`` is the long form: that many trials of each kind, what was found, in how many it was right.
Noise: white, 0.006 d50, and vortices, 0.015 d50 with wave lengths of about 25 d50. In 1 % of uniform strain the deviatoric strain then varies by 0.35 of its mean from
grain to grain, as in a test.
"""

import dataclasses
import sys

import numpy as np
from hexmembrane.measure import bands
from hexmembrane.measure.band_search import normal
from scipy.spatial import Delaunay
from scipy.special import erf

RADIUS, HEIGHT = 0.02, 0.08
#: Axial strain of a step.
STRAIN = 0.01
KINDS = ("uniform", "barrel", "band", "pair")
#: Displacement over the jump by distance over nominal thickness, and the thickness of the slab of uniform shear that fits it best by the nominal one.
PROFILES = {
	"slab": (lambda s: np.clip(s, -0.5, 0.5), 1.0),
	"erf": (lambda s: erf(np.sqrt(6) * s) / 2, 0.884),
	"tanh": (lambda s: np.tanh(np.pi * s) / 2, 0.815),
}


def packing(grains, seed=1):
	"""Centres (N, 3) [m], mid-height at 0, and d50 [m] of a packing of YADE's CylinderPacking."""
	import yade

	sizes = np.random.default_rng(seed).uniform(0.7, 1.3, grains)
	made = yade.CylinderPacking(radius=RADIUS, height=HEIGHT, radii=sizes.tolist(), porosity=0.42, seed=seed)
	made.generate()
	return np.array(made.centres) - [0, 0, HEIGHT / 2], bands.medianDiameter(made.sizes)


def strains(x, u, diameter):
	"""Volume of the cells (N,) and deviatoric strain (N,) of grains at ``x`` that move by ``u``: means over the Delaunay tetrahedra round each."""
	t = Delaunay(x).simplices
	edges, moved = x[t][:, 1:] - x[t][:, :1], u[t][:, 1:] - u[t][:, :1]
	volume = np.abs(np.linalg.det(edges)) / 6
	kept = (np.linalg.norm(edges, axis=2).max(axis=1) < 2.5 * diameter) & (volume > 1e-3 * diameter**3)
	t, volume = t[kept], volume[kept]
	gradient = np.linalg.solve(edges[kept], moved[kept]).transpose(0, 2, 1)
	volumes, sums = np.zeros(len(x)), np.zeros((len(x), 3, 3))
	for k in range(4):
		np.add.at(volumes, t[:, k], volume / 4)
		np.add.at(sums, t[:, k], (volume / 4)[:, None, None] * gradient)
	gradient = sums / np.maximum(volumes, 1e-300)[:, None, None]
	e = (gradient + gradient.transpose(0, 2, 1)) / 2
	e -= np.trace(e, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
	return volumes, np.sqrt(2 / 3 * (e**2).sum(axis=(1, 2)))


def _affine(x, strain, lateral):
	return strain * x * [lateral, lateral, -1]


def _noise(x, diameter, random, white=0.006, vortices=0.015):
	k, phase, size = random.normal(size=(60, 3)) / (4 * diameter), random.uniform(0, 2 * np.pi, 60), random.normal(size=(60, 3))
	size -= ((size * k).sum(axis=1) / (k**2).sum(axis=1))[:, None] * k  # no change of volume
	return diameter * (white * random.normal(size=x.shape) + vortices * np.sqrt(2 / 60) * np.cos(x @ k.T + phase) @ size)


def _barrel(x, random):
	"""Axial strain concentrated about a height, the more the nearer to the axis; the sides bulge there."""
	width, lateral = random.uniform(0.25, 0.6), random.uniform(0.45, 0.7)
	z = 2 * x[:, 2] / HEIGHT - random.uniform(-0.1, 0.1)
	r2 = (x[:, :2] ** 2).sum(axis=1) / RADIUS**2
	strain = 0.8 * STRAIN / width
	u = _affine(x, 0.2 * STRAIN, lateral)
	u[:, :2] += lateral * strain * np.exp(-((z / width) ** 2))[:, None] * x[:, :2]
	u[:, 2] -= strain * np.sqrt(np.pi) / 2 * width * erf(z / width) * HEIGHT / 2 * (1.1 - 0.2 * r2)
	return u


def _bands(x, diameter, random, count):
	"""Jumps down the dip, opening by a dilatancy angle of 0 to 15 degrees, that take half or more of the axial strain."""
	share, azimuth = random.uniform(0.5, 0.9), random.uniform(0, 360)
	dip, thick = random.uniform(42, 68), random.uniform(3, 8)
	u, planes = _affine(x, (1 - share) * STRAIN, 0.5), []
	for k in range(count):
		if k:
			dip, azimuth, thick = dip + random.uniform(-5, 5), azimuth + 180 + random.uniform(-15, 15), thick * random.uniform(0.8, 1.25)
		n = normal(np.radians(dip), np.radians(azimuth))
		down = np.array([n[0] * n[2], n[1] * n[2], n[2] ** 2 - 1]) / np.sin(np.radians(dip))
		psi = np.radians(random.uniform(0, 15))
		jump = down * np.cos(psi) + n * np.sin(psi)
		profile, equal = PROFILES[("slab", "erf", "tanh")[random.integers(3)]]
		distance = (x - [0, 0, random.uniform(-0.12, 0.12) * HEIGHT]) @ n
		u = u + profile(distance / (thick * diameter))[:, None] * jump * (share * STRAIN * HEIGHT / count / -jump[2])
		planes.append((dip, azimuth % 360, thick * equal))
	return u, planes


def field(kind, x, diameter, random):
	"""(displacements (N, 3), planes) of a kind: dip and azimuth [degrees], thickness in d50 of each plane."""
	if kind == "uniform":
		return _affine(x, STRAIN, random.uniform(0.45, 0.7)), []
	if kind == "barrel":
		return _barrel(x, random), []
	return _bands(x, diameter, random, 2 if kind == "pair" else 1)


@dataclasses.dataclass
class Trial:
	"""What was found in a field; ``errors``: of each known plane, dip [degrees], azimuth [degrees], thickness in d50."""

	kind: str
	found: bands.Finding
	planes: list
	errors: np.ndarray

	@property
	def right(self):
		"""Whether the verdict is: a band, a pair, or neither of both."""
		return self.found.verdict == self.kind if self.planes else self.found.verdict in ("barrel", "none")


def trial(kind, grains, seed, replicates=0):
	"""A :class:`Trial`; ``grains``: what :func:`packing` gives."""
	x, diameter = grains
	random = np.random.default_rng(seed)
	u, planes = field(kind, x, diameter, random)
	u = u + _noise(x, diameter, random)
	volumes, deviatoric = strains(x, u, diameter)
	found = bands.find(x, u, volumes, deviatoric, diameter, axis=(0, 0), replicates=replicates)
	errors = []
	for dip, azimuth, thickness in planes:
		off = [(plane.azimuth - azimuth + 180) % 360 - 180 for plane in found.planes]
		k = int(np.argmin(np.abs(off)))
		errors.append((found.planes[k].dip - dip, off[k], found.planes[k].thickness / diameter - thickness))
	return Trial(kind, found, planes, np.array(errors).reshape(-1, 3))


def main(count, grains=7045):
	"""The long form: prints one line a trial and a summary a kind."""
	made = packing(grains)
	for kind in KINDS:
		trials = []
		for seed in range(count):
			one = trial(kind, made, seed)
			trials.append(one)
			errors = " ".join(f"[dip {a:+.1f} azimuth {b:+.1f} thickness {c:+.2f} d50]" for a, b, c in one.errors)
			print(f"{kind} {seed}: {one.found.verdict}, index {one.found.index:.3f}, explained {one.found.explained:.2f} {errors}", flush=True)
		right = [one for one in trials if one.right]
		print(f"{kind}: verdict right in {len(right)} of {count}", end="")
		if kind in ("band", "pair"):
			errors = np.abs(np.vstack([one.errors for one in right]))
			within = (errors[:, 0] <= 2).mean(), (errors[:, 2] <= 1).mean()
			print(f"; dip within 2 degrees in {100 * within[0]:.0f} %, thickness within 1 d50 in {100 * within[1]:.0f} %, 95 % of both within ", end="")
			print(" and ".join(f"{value:.2f}" for value in np.percentile(errors[:, (0, 2)], 95, axis=0)), end="")
		print(flush=True)


if __name__ == "__main__":
	main(int(sys.argv[1]))
