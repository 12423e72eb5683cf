# SPDX-License-Identifier: GPL-2.0-or-later
"""The study's specimen as the benchmarks run it: in its membrane or a rigid wall, in the compact tier, in the reference tier's laws, or in stock YADE.

Stock: YADE's collider, loop and integrator, its cohesive-frictional law with moments for the soil, its cohesive bonds for the membrane, and the pressure
already in C++ (MembranePressure). Same packing, radii, membrane, platens, step and stiffness.
"""

import math

import yade
from study import HEIGHT, RADIUS
from yade import O, utils

from hexmembrane.scene.platens import platen

PRESSURE, EMOD = 5e4, 6e7
SUBSTEPS = 100


def material(tier, label, friction, rolling, bonded=False):
	if tier != "stock":
		O.materials.append(yade.LinearMat(emod=EMOD, kratio=3, friction=friction, rollingFriction=rolling, density=2650, label=label))
		return
	cohesion = dict(normalCohesion=1e20, shearCohesion=1e20, isCohesive=True) if bonded else dict(isCohesive=False)
	moments = dict(momentRotationLaw=rolling > 0, alphaKr=0.25, alphaKtw=0, etaRoll=rolling / 2, etaTwist=0)
	O.materials.append(
		yade.CohFrictMat(young=0.5 * math.pi * EMOD, poisson=1 / 3, frictionAngle=math.atan(friction), density=2650, label=label, **moments, **cohesion)
	)


def flexible(tier, packed, particleRadius, sheet=()):
	"""The specimen in its membrane.

	:param sheet: of the compact tier: functions of the membrane that make engines beside its bonds.
	"""
	O.reset()
	material(tier, "grain", 0.4, 0.5)
	material(tier, "platen", 0.3, 0)
	material(tier, "membrane", 0, 0, bonded=True)
	O.bodies.append([utils.sphere(tuple(c), r, material="grain") for c, r in zip(packed.centres.tolist(), packed.radii.tolist())])
	bottom, top = (O.bodies.append(platen((0, 0, z), RADIUS, 0.03, facing=f, material=O.materials["platen"])) for z, f in ((0, 1), (HEIGHT, -1)))
	membrane = yade.HexMembrane(
		specimenRadius=RADIUS, specimenHeight=HEIGHT, particleRadius=particleRadius, density=1000, material=O.materials["membrane"], mask=3 if tier == "compact" else 1
	)
	membrane.generate()
	pressing = [yade.MembranePressure(membrane=membrane, pressure=PRESSURE), yade.MembraneRadialServo(membrane=membrane, pressure=PRESSURE)]
	drives = [
		yade.PlatenDrive(platen=bottom, direction=(0, 0, 1), mode="velocity", velocity=0.0),
		yade.PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=PRESSURE, area=math.pi * RADIUS**2),
	]
	rings = yade.MembraneORings(membrane=membrane, mode="platens", bottomPlaten=bottom, topPlaten=top)
	smallest = min(float(packed.radii.min()), membrane.sphereRadius)
	if tier == "compact":
		bonds = yade.MembraneBonds(membrane=membrane, young=1e6, thickness=3e-4, poisson=1 / 3)
		O.engines = [yade.ForceResetter(), yade.CompactLoop(engines=[bonds, *(make(membrane) for make in sheet), *pressing, *drives, rings], damping=0.2, substeps=SUBSTEPS)]
	else:
		O.engines = [
			yade.ForceResetter(),
			yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(aabbEnlargeFactor=1.001), yade.Bo1_Platen_Aabb()], verletDist=0.2 * smallest),
			yade.InteractionLoop(
				[yade.Ig2_Sphere_Sphere_ScGeom6D(), yade.Ig2_Platen_Sphere_ScGeom6D()],
				[yade.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True)],
				[yade.Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True, useIncrementalForm=True)],
			),
			*pressing,
			*drives,
			rings,
			yade.NewtonIntegrator(damping=0.2),
		]
		detection = O.engines[2].geomDispatcher.functors[0]
		detection.interactionDetectionFactor = 1.001  # so that the neighbours in the membrane, which just touch, bond
		O.dt = 1e-9
		O.step()
		detection.interactionDetectionFactor = 1
	O.dt = 0.3 * math.sqrt(smallest**3 * 1000 / (EMOD * smallest))
	return len(membrane.ids)


def rigid(tier, packed):
	"""The same specimen in a rigid wall, compact or reference tier."""
	O.reset()
	material(tier, "grain", 0.4, 0.5)
	material(tier, "platen", 0.3, 0)
	material(tier, "wall", 0, 0)
	O.bodies.append([utils.sphere(tuple(c), r, material="grain") for c, r in zip(packed.centres.tolist(), packed.radii.tolist())])
	bottom, top = (O.bodies.append(platen((0, 0, z), 1.2 * RADIUS, 0.03, facing=f, material=O.materials["platen"])) for z, f in ((0, 1), (HEIGHT, -1)))
	body = yade.Body()
	body.shape = yade.CylinderWall(radius=RADIUS, height=2 * HEIGHT)
	body.state.pos = (0, 0, HEIGHT / 2)
	body.material = O.materials["wall"]
	body.dynamic = False
	wall = O.bodies.append(body)
	engines = [
		yade.PlatenDrive(platen=bottom, direction=(0, 0, 1), mode="velocity", velocity=0.0),
		yade.PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=PRESSURE, area=math.pi * RADIUS**2),
		yade.RadialWallServo(wall=wall, stress=PRESSURE, bottomPlaten=bottom, topPlaten=top, maxVelocity=0.05),
	]
	if tier == "compact":
		O.engines = [yade.ForceResetter(), yade.CompactLoop(engines=engines, damping=0.2, substeps=SUBSTEPS)]
	else:
		boxes = [yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb(), yade.Bo1_CylinderWall_Aabb()]
		loop = yade.InteractionLoop(
			[yade.Ig2_Sphere_Sphere_LinearScGeom(), yade.Ig2_Platen_Sphere_ScGeom(), yade.Ig2_CylinderWall_Sphere_ScGeom()],
			[yade.Ip2_LinearMat_LinearMat_LinearPhys()],
			[yade.Law2_ScGeom_LinearPhys_Linear()],
		)
		collider = yade.InsertionSortCollider(boxes, verletDist=0.2 * float(packed.radii.min()))
		O.engines = [yade.ForceResetter(), collider, loop, *engines, yade.NewtonIntegrator(damping=0.2)]


def contacts():
	loop = next((e for e in O.engines if isinstance(e, yade.CompactLoop)), None)
	return loop.contactCount() if loop else O.interactions.countReal()
