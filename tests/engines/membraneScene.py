# SPDX-License-Identifier: GPL-2.0-or-later
"""Small membrane scenes that several tests share."""

import numpy as np
import tiers
import yade
from contactScene import springs
from yade import O, Vector3, utils

RADIUS, HEIGHT, PARTICLE = 0.020, 0.030, 0.002
KN = 2e5  #: of the contacts (N/m)


def makeMembrane(**changes):
	"""A generated HexMembrane of about 900 spheres on an empty scene with a frictionless material."""
	springs(KN, KN, friction=0, density=1000)
	arguments = dict(specimenRadius=RADIUS, specimenHeight=HEIGHT, particleRadius=PARTICLE, mask=3)  # its spheres do not collide with each other
	arguments.update(changes)
	membrane = yade.HexMembrane(**arguments)
	membrane.generate()
	return membrane


def slack(membrane):
	"""Bonds of no stiffness to speak of: the compact tier wants bonds, and the test wants their forces below all rounding."""
	return yade.MembraneBonds(membrane=membrane, kn=1e-30)


def positions(membrane):
	return np.array([tuple(x) for x in membrane.positions])


def shake(membrane, size, seed=1):
	"""Moves every particle that is not an O-ring by up to `size` in each direction; returns the new positions."""
	random = np.random.default_rng(seed)
	for i, group in zip(membrane.ids, membrane.groups):
		if group != 1:
			O.bodies[i].state.pos += Vector3(*random.uniform(-size, size, 3))
	return positions(membrane)


def forcesOn(ids):
	return tiers.forces(ids)[:, :3]


def inward(x):
	"""Horizontal unit vector from a point to the axis."""
	return -Vector3(x[0], x[1], 0).normalized()


def core(membrane, groups, depth):
	"""Fixed spheres, one behind each particle of these groups, `depth` further in."""
	for i, group in zip(membrane.ids, membrane.groups):
		if group in groups:
			x = O.bodies[i].state.pos
			O.bodies.append(utils.sphere(x + depth * inward(x), membrane.sphereRadius, fixed=True))


def coreStep(membrane):
	"""A stable step of :func:`pressOnCore`."""
	return 0.2 * (O.bodies[membrane.ids[200]].state.mass / KN) ** 0.5


def pressOnCore(tier, membrane, group, *inner, steps=3000):
	"""Run a membrane (mask 3) whose particles of a group stand against fixed spheres, radially inside, with engines that press and hold it."""
	core(membrane, [group], 2 * membrane.sphereRadius)
	O.engines = tiers.engines(tier, inner, damping=0.5, substeps=100)
	O.dt = coreStep(membrane)
	tiers.run(steps)
