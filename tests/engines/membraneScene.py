# SPDX-License-Identifier: GPL-2.0-or-later
"""Small membrane scenes that several tests share."""

import numpy as np

RADIUS, HEIGHT, PARTICLE = 0.020, 0.030, 0.002


def makeMembrane(**changes):
	"""A generated HexMembrane of about 900 spheres on an empty scene with a frictionless material."""
	from yade import FrictMat, O
	from yade.wrapper import HexMembrane

	O.materials.append(FrictMat(young=1e8, poisson=0.3, frictionAngle=0.0, density=1000))
	arguments = dict(specimenRadius=RADIUS, specimenHeight=HEIGHT, particleRadius=PARTICLE)
	arguments.update(changes)
	membrane = HexMembrane(**arguments)
	membrane.generate()
	return membrane


def positions(membrane):
	return np.array([tuple(x) for x in membrane.positions])


def shake(membrane, size, seed=1):
	"""Moves every particle that is not an O-ring by up to `size` in each direction; returns the new positions."""
	from yade import O, Vector3

	random = np.random.default_rng(seed)
	for i, group in zip(membrane.ids, membrane.groups):
		if group != 1:
			O.bodies[i].state.pos += Vector3(*random.uniform(-size, size, 3))
	return positions(membrane)


def forcesOn(ids):
	from yade import O

	return np.array([tuple(O.forces.f(i)) for i in ids])


def stateOf(ids):
	"""Positions and velocities of bodies as one array, for exact comparison."""
	from yade import O

	return np.array([tuple(O.bodies[i].state.pos) + tuple(O.bodies[i].state.vel) + tuple(O.bodies[i].state.angVel) for i in ids])


def pressOnCore(m, group, *engines, steps=3000):
	"""Run a membrane (mask 3) whose particles of a group stand against fixed spheres, radially inside, with engines that press and hold it."""
	import yade
	from yade import (
		Bo1_Sphere_Aabb,
		ForceResetter,
		Ig2_Sphere_Sphere_ScGeom,
		InsertionSortCollider,
		InteractionLoop,
		Ip2_FrictMat_FrictMat_FrictPhys,
		Law2_ScGeom_FrictPhys_CundallStrack,
		NewtonIntegrator,
		O,
		utils,
	)

	for i, g in zip(m.ids, m.groups):
		if g == group:
			x = O.bodies[i].state.pos
			inward = -yade.Vector3(x[0], x[1], 0).normalized()
			O.bodies.append(utils.sphere(x + inward * 2 * m.sphereRadius, m.sphereRadius, fixed=True))
	O.engines = [
		ForceResetter(),
		InsertionSortCollider([Bo1_Sphere_Aabb()], avoidSelfInteractionMask=2, verletDist=1e-4),
		InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_FrictPhys()], [Law2_ScGeom_FrictPhys_CundallStrack()]),
		*engines,
		NewtonIntegrator(damping=0.5),
	]
	O.dt = 0.2 * (O.bodies[m.ids[200]].state.mass / (1e8 * m.sphereRadius)) ** 0.5
	O.run(steps, True)
