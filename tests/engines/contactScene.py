# SPDX-License-Identifier: GPL-2.0-or-later
"""Scenes that the tests of the contact laws share."""

import math

import numpy as np

import hexmembrane  # noqa: F401
from hexmembrane.scene.platens import platen
from yade import (
	Bo1_Platen_Aabb,
	Bo1_Sphere_Aabb,
	ForceResetter,
	Ig2_Platen_Sphere_ScGeom,
	Ig2_Sphere_Sphere_LinearScGeom,
	Ig2_Sphere_Sphere_ScGeom,
	InsertionSortCollider,
	InteractionLoop,
	Ip2_LinearMat_LinearMat_LinearPhys,
	Law2_ScGeom_LinearPhys_Linear,
	LinearMat,
	NewtonIntegrator,
	utils,
)

EMOD, KRATIO, FRICTION, ROLLING, DENSITY = 1e8, 3.0, 0.4, 0.5, 2650.0
SOIL = dict(emod=EMOD, kratio=KRATIO, friction=FRICTION, rollingFriction=ROLLING, density=DENSITY)


def material(O, **changes):
	"""Appends the material of the tests, with changes (None takes a value away); returns it."""
	values = {name: value for name, value in {**SOIL, **changes}.items() if value is not None}
	O.materials.append(LinearMat(**values))
	return O.materials[-1]


def engines(O, gravity=(0, 0, 0), damping=0.0, ratcheting=False, bonds=False, verlet=0.05, stock=False):
	"""YADE's usual loop with our law. `ratcheting`: False is the shear increment as PFC has it, the true one at the contact point. `stock`: YADE's Ig2."""
	spheres = Ig2_Sphere_Sphere_ScGeom if stock else Ig2_Sphere_Sphere_LinearScGeom
	O.engines = [
		ForceResetter(),
		InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Platen_Aabb()], verletDist=-verlet),
		InteractionLoop(
			[spheres(avoidGranularRatcheting=ratcheting), Ig2_Platen_Sphere_ScGeom()],
			[Ip2_LinearMat_LinearMat_LinearPhys(bondNewContacts=bonds)],
			[Law2_ScGeom_LinearPhys_Linear()],
		),
		NewtonIntegrator(damping=damping, gravity=gravity),
	]


def law(O):
	return O.engines[2].lawDispatcher.functors[0]


def pair(O, r1, r2, overlap, direction=(0, 0, 1), velocity=(0, 0, 0)):
	"""Two spheres that only move as told; the second one lies in `direction` from the first and has `velocity`."""
	n = np.array(direction) / np.linalg.norm(direction)
	a = O.bodies.append(utils.sphere((0, 0, 0), r1, fixed=True))
	b = O.bodies.append(utils.sphere(tuple(n * (r1 + r2 - overlap)), r2, fixed=True))
	O.bodies[b].state.vel = velocity
	return a, b


def floor(O, radius=1.0):
	return O.bodies.append(platen((0, 0, 0), radius, 0.1, +1))


def swarm(O, count=40, seed=1, radii=(0.8e-3, 1.2e-3), speed=1.0, spin=300.0, keep=None):
	"""Spheres that fly from a lattice towards its middle, spinning at random: many oblique collisions. `keep` changes the order of the ids."""
	random = np.random.default_rng(seed)
	side = math.ceil(count ** (1 / 3))
	places = [(i, j, k) for i in range(side) for j in range(side) for k in range(side)][:count]
	bodies = []
	for place in places:
		x = (np.array(place) - 0.5 * (side - 1)) * 2.3 * max(radii) + random.uniform(-1e-4, 1e-4, 3)
		body = utils.sphere(tuple(x), random.uniform(*radii))
		body.state.vel = tuple(-speed * x / (0.5 * side * 2.3 * max(radii)) + random.uniform(-0.1, 0.1, 3) * speed)
		body.state.angVel = tuple(random.uniform(-spin, spin, 3))
		bodies.append(body)
	order = range(count) if keep is None else keep
	for i in order:
		O.bodies.append(bodies[i])
	return [list(order).index(i) for i in range(count)]


def stateOf(O, ids=None):
	ids = range(len(O.bodies)) if ids is None else ids
	states = (O.bodies[i].state for i in ids)
	return np.array([tuple(s.pos) + tuple(s.vel) + tuple(s.angVel) for s in states])


def apart(a, b):
	return float(np.linalg.norm(np.array(a) - np.array(b)))
