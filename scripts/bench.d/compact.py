# SPDX-License-Identifier: GPL-2.0-or-later
"""Cost of a step in the compact tier against stock YADE, on the study's specimen; how it ages, scales with size and with threads.

Stock: YADE's collider, loop and integrator, its cohesive-frictional law with moments for the soil, its cohesive bonds for the membrane, and the pressure
already in C++ (MembranePressure). Same packing, radii, membrane, platens, step and stiffness. Wall clock of O.run, medians over windows of steps after
warming up; the number of contacts is printed beside, the two laws differ in details of stiffness.
Arguments: folder of the results, parts to run (default: all that one process can):
  membrane   flexible against stock, R = 0.5 and 0.25 mm, and against the rigid wall
  age        the flexible scene of R = 0.5 mm fresh, after 5,000 and after 50,000 steps
  threads    the flexible and the rigid scene in this process's number of threads
  size       soil alone, 7,000 to 1,000,000 spheres
"""

import math
import os
import resource
import statistics
import sys
import time

import hexmembrane  # noqa: F401
import numpy
import yade
from yade import O, utils

sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE runs scripts without their __file__
from study import HEIGHT, RADIUS, packing  # noqa: E402
from table import write  # noqa: E402

from hexmembrane.platens import platen  # noqa: E402

PRESSURE, EMOD = 5e4, 6e7
WINDOW, WINDOWS, WARM = 200, 7, 5000


def material(tier, label, friction, rolling, bonded=False):
	if tier == "compact":
		O.materials.append(yade.LinearMat(emod=EMOD, kratio=3, friction=friction, rollingFriction=rolling, density=2650, label=label))
		return
	cohesion = dict(normalCohesion=1e20, shearCohesion=1e20, isCohesive=True) if bonded else dict(isCohesive=False)
	moments = dict(momentRotationLaw=rolling > 0, alphaKr=0.25, alphaKtw=0, etaRoll=rolling / 2, etaTwist=0)
	O.materials.append(
		yade.CohFrictMat(young=0.5 * math.pi * EMOD, poisson=1 / 3, frictionAngle=math.atan(friction), density=2650, label=label, **moments, **cohesion)
	)


def flexible(tier, packed, particleRadius):
	"""The specimen in its membrane."""
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
		O.engines = [yade.ForceResetter(), yade.CompactLoop(engines=[bonds, *pressing, *drives, rings], damping=0.2, substeps=WINDOW)]
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


def rigid(packed):
	"""The same specimen in a rigid wall, compact tier."""
	O.reset()
	material("compact", "grain", 0.4, 0.5)
	material("compact", "platen", 0.3, 0)
	material("compact", "wall", 0, 0)
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
	O.engines = [yade.ForceResetter(), yade.CompactLoop(engines=engines, damping=0.2, substeps=WINDOW)]


def contacts():
	loop = next((e for e in O.engines if isinstance(e, yade.CompactLoop)), None)
	return loop.contactCount() if loop else O.interactions.countReal()


def measure(warm, window=WINDOW, windows=WINDOWS):
	"""Median ms a step after `warm` steps."""
	if warm:
		O.run(warm, True)
	times = []
	for _ in range(windows):
		begun = time.perf_counter()
		O.run(window, True)
		times.append((time.perf_counter() - begun) / window * 1e3)
	return statistics.median(times)


def membranes(packed, rows):
	rigidTime = None
	for radius in (0.5e-3, 0.25e-3):
		particles = flexible("compact", packed, radius)
		step = O.dt
		mine, touching = measure(WARM), contacts()
		flexible("stock", packed, radius)
		assert O.dt == step
		stock, theirs = measure(WARM, 20), contacts() - len(O.engines[-2].membrane.bonds)
		rows.append(("flexible, R = %.2f mm" % (1e3 * radius), len(packed.radii) + particles, touching, mine, stock, stock / mine))
		print("R = %.2f mm, %d particles: compact %.3f ms, %d contacts; stock %.1f ms, %d contacts; %.1f times" % (1e3 * radius, particles, mine, touching, stock, theirs, stock / mine), flush=True)
		if rigidTime is None:
			rigid(packed)
			O.dt = step
			rigidTime = measure(WARM)
			rows.append(("rigid", len(packed.radii), contacts(), rigidTime, "", mine / rigidTime))
			print("rigid wall: compact %.3f ms, %d contacts; the membrane of R = 0.5 mm costs %.2f times that" % (rigidTime, contacts(), mine / rigidTime), flush=True)


def age(packed, rows):
	flexible("compact", packed, 0.5e-3)
	done = 0
	for steps in (500, 5000, 50000):
		O.run(steps - done, True)
		value = measure(0)
		done = steps + WINDOW * WINDOWS
		rows.append(("flexible, R = 0.50 mm, after %d steps" % steps, "", contacts(), value, "", ""))
		print("after %6d steps: %.3f ms" % (steps, value), flush=True)


def threads(packed, rows):
	for name, build in (("flexible, R = 0.50 mm", lambda: flexible("compact", packed, 0.5e-3)), ("flexible, R = 0.25 mm", lambda: flexible("compact", packed, 0.25e-3)), ("rigid", lambda: rigid(packed))):
		build()
		O.dt = 1e-6
		value = measure(1000)
		rows.append((name + ", %d threads" % O.numThreads, "", contacts(), value, "", ""))
		print("%s, %d threads: %.3f ms" % (name, O.numThreads, value), flush=True)


def sizes(rows):
	"""A face-centred lattice of spheres that overlap a little, at random slow speeds: the same surroundings for every sphere and size."""
	for wished in (7000, 30000, 100000, 300000, 1000000):
		O.reset()
		material("compact", "grain", 0.4, 0.5)
		random = numpy.random.default_rng(1)
		n = round((wished / 4) ** (1 / 3))
		spacing = 1e-3 * math.sqrt(2) * 1.998
		for shift in ((0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)):
			grid = (numpy.stack(numpy.meshgrid(*[numpy.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3) + shift) * spacing
			for place in grid:
				body = utils.sphere(tuple(place), 1e-3, material="grain")
				body.state.vel = tuple(1e-3 * random.uniform(-1, 1, 3))
				O.bodies.append(body)
		O.engines = [yade.ForceResetter(), yade.CompactLoop(damping=0.2, substeps=20)]
		O.dt = 1e-7
		window = max(20, 200000 // len(O.bodies))
		value = measure(40, window, 5)
		perSphere = value * 1e6 / len(O.bodies)
		memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / len(O.bodies)
		rows.append(("soil alone, lattice", len(O.bodies), contacts(), value, "", perSphere))
		print("%7d spheres, %.2f contacts a sphere: %.2f ms, %.0f ns a sphere and step; whole process %.2f kB a sphere" % (len(O.bodies), contacts() / len(O.bodies), value, perSphere, memory), flush=True)


def main(arguments):
	folder = arguments[0] if arguments else "bench"
	parts = arguments[1:] or ["membrane", "age", "size"]
	os.makedirs(folder, exist_ok=True)
	rows = []
	for part in parts:
		if part == "size":
			sizes(rows)
		else:
			{"membrane": membranes, "age": age, "threads": threads}[part](packing(folder), rows)
	write(os.path.join(folder, "compact-%s-%d.csv" % ("-".join(parts), O.numThreads)), ["scene", "spheres", "contacts", "compact (ms)", "stock (ms)", "ratio, or ns a sphere"], rows)


main(sys.argv[1:])
