# SPDX-License-Identifier: GPL-2.0-or-later
"""A tube whose ends approach each other: it buckles at the wavelength of theory, folds, and does not pass through itself.

In the compact tier alone; that the tiers agree: tests/engines/test_membrane_bending.py and test_membrane_self_contact.py.
"""

import math

import numpy as np
import pytest
from membraneScene import makeMembrane, positions
from scipy.spatial import cKDTree
from tiers import engines, run
from yade import MembraneBending, MembraneBonds, MembraneSelfContact, Vector3

RADIUS, STRETCH = 0.02, 300.0  #: of the tube (m), E t of its sheet (N/m)


def tube(O, stiffness, height, particle, speed, contact):
	"""A tube of bonds and bending whose O-ring rows approach each other, at `speed` each; the membrane and the engines of its sheet."""
	O.reset()
	m = makeMembrane(specimenRadius=RADIUS, specimenHeight=height, particleRadius=particle, placement="centred")
	bonds = MembraneBonds(membrane=m, young=STRETCH / 3e-4, thickness=3e-4, poisson=1 / 3)
	bending = MembraneBending(membrane=m, stiffness=stiffness)
	sheet = [bonds, bending] + ([MembraneSelfContact(membrane=m, kn=5e3)] if contact else [])
	O.engines = engines("compact", sheet, damping=0.3, substeps=100)
	O.dt = 0.2 * min(bonds.criticalTimeStep(), bending.criticalTimeStep())
	for i, group in zip(m.ids, m.groups):
		if group == 1:  # held by generate()
			state = O.bodies[i].state
			state.vel = Vector3(0, 0, speed if state.pos[2] < height / 2 else -speed)
	return m, sheet


def profile(membrane):
	"""Mean radius and height of each ring, and the largest spread of the radii in one."""
	x = positions(membrane).reshape(membrane.rings, membrane.perRing, 3)
	radius = np.hypot(x[..., 0], x[..., 1])
	return radius.mean(axis=1), x[..., 2].mean(axis=1), radius.std(axis=1).max()


def crossings(membrane, x):
	"""Number of pairs of an edge and a triangle of the sheet that have no corner in common and meet."""
	edges = np.array([tuple(b) for b in membrane.bonds])
	triangles = np.array([tuple(t) for t in membrane.triangles])
	a, b = x[edges[:, 0]], x[edges[:, 1]]
	p, q, r = (x[triangles[:, c]] for c in range(3))
	middle, centre = (a + b) / 2, (p + q + r) / 3
	reach = np.linalg.norm(b - a, axis=1).max() / 2 + max(np.linalg.norm(corner - centre, axis=1).max() for corner in (p, q, r))
	near = cKDTree(middle).query_ball_tree(cKDTree(centre), reach)
	pairs = np.array([(e, t) for e, list_ in enumerate(near) for t in list_])
	e, t = pairs.T
	apart = (edges[e][:, :, None] != triangles[t][:, None, :]).all(axis=(1, 2))
	e, t = e[apart], t[apart]
	# a + s (b - a) = p + u (q - p) + v (r - p)
	way, side, other = b[e] - a[e], q[t] - p[t], r[t] - p[t]
	h = np.cross(way, other)
	det = (side * h).sum(axis=1)
	with np.errstate(divide="ignore", invalid="ignore"):
		from_ = a[e] - p[t]
		u = (from_ * h).sum(axis=1) / det
		g = np.cross(from_, side)
		v = (way * g).sum(axis=1) / det
		s = (other * g).sum(axis=1) / det
		return int(((u >= 0) & (v >= 0) & (u + v <= 1) & (s >= 0) & (s <= 1)).sum())


def nearest(membrane, x):
	"""Least distance of particles without a bond, over 2R."""
	bonds = {tuple(b) for b in membrane.bonds} | {tuple(b)[::-1] for b in membrane.bonds}
	pairs = [pair for pair in cKDTree(x).query_pairs(4 * membrane.sphereRadius) if pair not in bonds]
	return min(np.linalg.norm(x[i] - x[j]) for i, j in pairs) / (2 * membrane.sphereRadius)


def crossing(radius, z):
	"""Heights at which the curvature of a profile changes its sign."""
	curvature = radius[:-2] - 2 * radius[1:-1] + radius[2:]
	z = z[1:-1]
	k = np.flatnonzero(curvature[:-1] * curvature[1:] < 0)
	return z[k] - curvature[k] * (z[k + 1] - z[k]) / (curvature[k + 1] - curvature[k])


def test_bucklesAtTheLoadAndWavelengthOfTheory(O):
	"""Axisymmetric buckling of a long tube: N = 2 sqrt(D E t)/R, half wavelength pi (D R^2/(E t))^(1/4).

	The load reaches 0.994 of it, half waves 0.954 to 0.965; the tube is 2 % shorter by then, and rings stand 5 to a half wave.
	"""
	stiffness = 1e-5
	m, sheet = tube(O, stiffness, height=0.08, particle=0.7e-3, speed=0.005, contact=False)
	load, halfWave = 2 * math.sqrt(stiffness * STRETCH) / RADIUS, math.pi * (stiffness * RADIUS**2 / STRETCH) ** 0.25
	_, start, _ = profile(m)
	shortening, push = 0, []
	while shortening < 1.04 * load / STRETCH:
		run(400)
		radius, z, spread = profile(m)
		shortening = 1 - np.ptp(z) / np.ptp(start)
		push.append(-sheet[0].axialTension([z.mean()])[0] - sheet[1].axialTension([z.mean()])[0])
		assert spread < 1e-3 * RADIUS  # axisymmetric so far
	assert max(push) / (2 * math.pi * RADIUS) == pytest.approx(load, rel=0.02)
	waves = np.diff(crossing(radius, z)) / halfWave
	assert len(waves) > 8 and np.abs(waves - 1).max() < 0.06


@pytest.mark.parametrize("contact", [True, False], ids=["contact", "without"])
def test_foldsDoNotPassThroughEachOther(O, contact):
	"""Shortened to 45 % of its length; without self-contact the same tube passes through itself."""
	m, sheet = tube(O, 2e-5, height=0.05, particle=1e-3, speed=0.1, contact=contact)
	_, start, _ = profile(m)
	assert crossings(m, positions(m)) == 0
	met = 0
	least = 1.0
	while np.ptp(profile(m)[1]) > 0.45 * np.ptp(start):
		run(500)
		x = positions(m)
		met = max(met, crossings(m, x))
		least = min(least, nearest(m, x))
	if contact:
		assert met == 0 and least > 0.98
		assert len(sheet[2].pairs) > 100
	else:
		assert met > 0 and least < 0.5
