# SPDX-License-Identifier: GPL-2.0-or-later
"""The same small triaxial specimen for the reference tier and for the compact tier."""

import math

import numpy as np
import yade
from hexmembrane.scene.platens import platen
from tiers import engines
from yade import O, utils

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
	servoTime=math.inf,
	particleRadius=2e-3,
	porosity=0.45,
	springs=False,
	pressureTime=math.inf,
	facets=None,
):
	"""Fill YADE's empty scene; returns a dict of the inner engines by name.

	:param tier: 'reference' or 'compact'. :param lateral: 'membrane' or 'wall'. :param swell: growth of the touching packing's grains, for overlaps.
	:param spin: random velocities and spins of this size, for motion in every direction.
	:param servoTime: time constant of the servo beside the platens [s]. :param pressureTime: of the pressure on the main body [s].
	:param facets: attributes of a MembraneFacetContact, None: there is none.
	:param springs: stiffness of the grains' material as kn and ks, else as emod and kratio.
	"""

	def material(label, mu, mur, **stiffness):
		O.materials.append(yade.LinearMat(friction=mu, rollingFriction=mur, density=2650, label=label, **(stiffness or dict(emod=1e8, kratio=3))))

	material("grain", friction, rollingFriction, **(dict(kn=6e5, ks=2e5) if springs else {}))
	material("platen", 0.3, rollingFriction)
	material("membrane", membraneFriction, 0)
	random = np.random.default_rng(seed)
	packing = yade.CylinderPacking(radius=RADIUS, height=HEIGHT, radii=random.uniform(0.7, 1.3, grains).tolist(), porosity=porosity, seed=seed)
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
		if facets is not None:
			made["facets"] = yade.MembraneFacetContact(membrane=m, bonds=made["bonds"], **facets)
		made["pressure"] = yade.MembranePressure(membrane=m, pressure=pressure, timeConstant=pressureTime)
		made["servo"] = yade.MembraneRadialServo(membrane=m, pressure=pressure, timeConstant=servoTime)
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
	O.engines = engines(tier, made.values(), damping, substeps)
	O.dt = 2e-6
	return made


def bondGrains(strength, grains=150):
	"""Bond the grains' contacts with each other in O.interactions (reference tier), `strength` N for the weakest, up to 2187 times that; their number."""
	bonded = [i for i in O.interactions if i.isReal and max(i.id1, i.id2) < grains]
	for i in bonded:
		of = strength * 3 ** ((i.id1 + i.id2) % 8)
		i.phys.bond(of, of)
	return len(bonded)
