# SPDX-License-Identifier: GPL-2.0-or-later
"""The same small triaxial specimen for the reference tier and for the compact tier."""

import math

import numpy as np

from hexmembrane.scene.platens import platen

RADIUS, HEIGHT = 0.02, 0.04


def build(
	tier,
	lateral="membrane",
	grains=150,
	friction=0.4,
	rollingFriction=0.5,
	membraneFriction=0.0,
	poisson=1 / 3,
	swell=1.004,
	pressure=1e5,
	velocity=0.0,
	substeps=20,
	damping=0.2,
	seed=1,
	spin=0.0,
	gain=0.0,
	particleRadius=2e-3,
):
	"""Fill YADE's empty scene; returns a dict of the engines by name, with 'loop' in the compact tier.

	:param tier: 'reference' or 'compact'. :param lateral: 'membrane' or 'wall'. :param swell: growth of the touching packing's grains, for overlaps.
	:param spin: random velocities and spins of this size, for motion in every direction.
	"""
	import yade
	from yade import O, utils

	def material(label, mu, mur):
		O.materials.append(yade.LinearMat(emod=1e8, kratio=3, friction=mu, rollingFriction=mur, density=2650, label=label))

	material("grain", friction, rollingFriction)
	material("platen", 0.3, rollingFriction)
	material("membrane", membraneFriction, 0)
	random = np.random.default_rng(seed)
	packing = yade.CylinderPacking(radius=RADIUS, height=HEIGHT, radii=random.uniform(0.7, 1.3, grains).tolist(), porosity=0.45, seed=seed)
	packing.generate()
	for centre, radius in zip(packing.centres, packing.sizes):
		body = utils.sphere(tuple(centre), radius * swell, material="grain")
		body.state.vel = tuple(spin * random.uniform(-1, 1, 3))
		body.state.angVel = tuple(spin / radius * random.uniform(-1, 1, 3))
		O.bodies.append(body)
	made = {}
	bottom = O.bodies.append(platen((0, 0, 0), RADIUS, 0.02, facing=1, material=O.materials["platen"]))
	top = O.bodies.append(platen((0, 0, HEIGHT), RADIUS, 0.02, facing=-1, material=O.materials["platen"]))
	if lateral == "membrane":
		m = yade.HexMembrane(
			specimenRadius=RADIUS, specimenHeight=HEIGHT, particleRadius=particleRadius, density=1000, material=O.materials["membrane"], mask=3, rotations=poisson < 0.33
		)
		m.generate()
		made["bonds"] = yade.MembraneBonds(membrane=m, young=2e6, thickness=5e-4, poisson=poisson)
		made["pressure"] = yade.MembranePressure(membrane=m, pressure=pressure)
		made["servo"] = yade.MembraneRadialServo(membrane=m, pressure=pressure, gain=gain, iterPeriod=10)
	else:
		wall = yade.Body()
		wall.shape = yade.CylinderWall(radius=RADIUS, height=2 * HEIGHT)
		wall.state.pos = (0, 0, HEIGHT / 2)
		wall.material = O.materials["membrane"]
		wall.dynamic = False
		wall = O.bodies.append(wall)
		made["wall"] = yade.RadialWallServo(wall=wall, stress=pressure, bottomPlaten=bottom, topPlaten=top, maxVelocity=0.05)
	made["bottom"] = yade.PlatenDrive(platen=bottom, direction=(0, 0, 1), mode="velocity", velocity=0.0)
	made["top"] = yade.PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=pressure, area=math.pi * RADIUS**2)
	if velocity:
		made["top"].mode, made["top"].velocity = "velocity", velocity
	if lateral == "membrane":
		made["oRings"] = yade.MembraneORings(membrane=m, mode="platens", bottomPlaten=bottom, topPlaten=top)
	inner = list(made.values())
	if tier == "compact":
		made["loop"] = yade.CompactLoop(engines=inner, damping=damping, substeps=substeps)
		O.engines = [yade.ForceResetter(), made["loop"]]
	else:
		O.engines = referenceEngines(inner, damping)
	O.dt = 2e-6
	return made


def referenceEngines(inner, damping):
	"""The reference tier's list round the same engines."""
	import yade

	return [
		yade.ForceResetter(),
		yade.InsertionSortCollider(
			[yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb(), yade.Bo1_CylinderWall_Aabb()], verletDist=1e-4, avoidSelfInteractionMask=2
		),
		yade.InteractionLoop(
			[
				yade.Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False),
				yade.Ig2_Platen_Sphere_ScGeom(),
				yade.Ig2_CylinderWall_Sphere_ScGeom(),
			],
			[yade.Ip2_LinearMat_LinearMat_LinearPhys()],
			[yade.Law2_ScGeom_LinearPhys_Linear()],
		),
		*inner,
		yade.NewtonIntegrator(damping=damping),
	]


def state():
	"""Positions, velocities and spins of all bodies, one row a body."""
	from yade import O

	return np.array([tuple(b.state.pos) + tuple(b.state.vel) + tuple(b.state.angVel) for b in O.bodies])


def forces():
	"""Forces and torques of all bodies as of the last step, one row a body."""
	from yade import O

	return np.array([tuple(O.forces.f(b.id)) + tuple(O.forces.t(b.id)) for b in O.bodies])


def run(steps):
	"""That many steps in either tier; O.run's wait can lose an error, so the steps are counted."""
	from yade import O

	wanted = O.iter + steps
	if steps:  # O.run(0) never ends
		O.run(steps, True)
	assert O.iter == wanted, "stopped at step %d of %d" % (O.iter, wanted)
