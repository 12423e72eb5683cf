# SPDX-License-Identifier: GPL-2.0-or-later
"""Run by test_threads.py inside YADE with a number of threads: a pressed membrane round a few grains; writes positions and velocities."""

import sys

import numpy as np

import hexmembrane  # noqa: F401
from membraneScene import makeMembrane, shake, stateOf
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
from yade.wrapper import MembraneBonds, MembraneORings, MembranePressure, MembraneRadialServo

file, withGrains = sys.argv[-2], sys.argv[-1] == "grains"
m = makeMembrane(mask=3)
shake(m, 5e-5)
random = np.random.default_rng(7)
if withGrains:
	for z in np.arange(0.003, 0.028, 0.006):
		for a in np.arange(0, 6.2, 0.35):
			O.bodies.append(utils.sphere((0.0168 * np.cos(a + z), 0.0168 * np.sin(a + z), z + random.uniform(0, 1e-4)), 0.003205))
O.engines = [
	ForceResetter(),
	InsertionSortCollider([Bo1_Sphere_Aabb()], avoidSelfInteractionMask=2, verletDist=1e-4),
	InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_FrictPhys()], [Law2_ScGeom_FrictPhys_CundallStrack()]),
	MembraneBonds(membrane=m, kn=5e4),
	MembranePressure(membrane=m, pressure=2e3),
	MembraneRadialServo(membrane=m, pressure=2e3),
	MembraneORings(membrane=m),
	NewtonIntegrator(damping=0.2),
]
O.dt = 2e-6
O.run(300, True)
assert (O.interactions.countReal() > 0) == withGrains
np.save(file, stateOf([b.id for b in O.bodies]))
