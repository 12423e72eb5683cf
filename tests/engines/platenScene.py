# SPDX-License-Identifier: GPL-2.0-or-later
"""Scenes that the tests of platens share: a linear frictional law with the stiffnesses given, and few bodies."""

import math

from hexmembrane.scene.platens import platen
from yade import (
	Bo1_Platen_Aabb,
	Bo1_Sphere_Aabb,
	ForceResetter,
	FrictMat,
	Ig2_Platen_Sphere_ScGeom,
	Ig2_Sphere_Sphere_ScGeom,
	InsertionSortCollider,
	InteractionLoop,
	Ip2_FrictMat_FrictMat_FrictPhys,
	Law2_ScGeom_FrictPhys_CundallStrack,
	MatchMaker,
	NewtonIntegrator,
	utils,
)

DENSITY = 2600.0


def engines(O, kn=1e5, ks=5e4, before=(), geometry=None, gravity=(0, 0, 0), damping=0.0, verlet=0.05):
	"""YADE's usual loop with kn and ks (N/m) for every contact; `before` are engines before NewtonIntegrator."""
	O.engines = [
		ForceResetter(),
		InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Platen_Aabb()], verletDist=-verlet if verlet else 0),
		InteractionLoop(
			[Ig2_Sphere_Sphere_ScGeom(), geometry or Ig2_Platen_Sphere_ScGeom()],
			[Ip2_FrictMat_FrictMat_FrictPhys(kn=MatchMaker(algo="val", val=kn), ks=MatchMaker(algo="val", val=ks))],
			[Law2_ScGeom_FrictPhys_CundallStrack(sphericalBodies=False)],
		),
		*before,
		NewtonIntegrator(damping=damping, gravity=gravity),
	]


def material(O, friction=0.4):
	"""The one material of the scene; `friction` is the coefficient."""
	O.materials.append(FrictMat(young=1e7, poisson=0.3, frictionAngle=math.atan(friction), density=DENSITY))


def sphere(O, centre, radius, fixed=False):
	"""Appends a sphere, returns its id."""
	return O.bodies.append(utils.sphere(centre, radius, fixed=fixed))


def floor(O, radius=1.0, height=0.5, face=(0, 0, 0)):
	"""Appends a platen whose upper face lies at `face`, returns its id."""
	return O.bodies.append(platen(face, radius, height, +1))

