# SPDX-License-Identifier: GPL-2.0-or-later
"""Cost of a contact: our linear law with rolling resistance against YADE's cohesive-frictional law with moments, on the same packing.

All laws in one run, in turns, so that the machine's mood is the same for all; medians over the turns. Every sphere moves as it is told, slowly and at random, so
that all scenes have the very same contacts and motions whatever their forces; some of the contacts slide and roll. ns a contact and step of InteractionLoop,
from YADE's own engine timers: geometry, law and everything between them, no collider.
Arguments: folder of the results, number of spheres (default 7000).
"""

import math
import os
import statistics
import sys

import hexmembrane  # noqa: F401
import numpy
from yade import (
	Bo1_Sphere_Aabb,
	CohFrictMat,
	CylinderPacking,
	ForceResetter,
	Ig2_Sphere_Sphere_LinearScGeom,
	Ig2_Sphere_Sphere_ScGeom,
	Ig2_Sphere_Sphere_ScGeom6D,
	InsertionSortCollider,
	InteractionLoop,
	Ip2_CohFrictMat_CohFrictMat_CohFrictPhys,
	Ip2_LinearMat_LinearMat_LinearPhys,
	Law2_ScGeom6D_CohFrictPhys_CohesionMoment,
	Law2_ScGeom_FrictPhys_CundallStrack,
	Law2_ScGeom_LinearPhys_Linear,
	LinearMat,
	NewtonIntegrator,
	O,
	timing,
	utils,
)

sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE runs scripts without their __file__
from table import write  # noqa: E402

WARM, STEPS, TURNS = 50, 150, 7
SWELL = 1.01  # of the touching spheres' radii, so that they overlap
OURS, STOCK = "linear with rolling resistance", "YADE cohesive-frictional, moments, incremental"


def packing(count):
	"""Centres and radii of a dense random packing in the study's cylinder."""
	random = numpy.random.default_rng(1)
	made = CylinderPacking(radius=0.02, height=0.08, radii=[float(r) for r in random.uniform(0.7, 1.3, count)], porosity=0.40, seed=1)
	made.generate()
	return [tuple(c) for c in made.centres], [r * SWELL for r in made.sizes]


def ours(rollingFriction, friction=0.4):
	return (
		LinearMat(emod=1e8, kratio=3, friction=friction, rollingFriction=rollingFriction, density=2650),
		[Ig2_Sphere_Sphere_LinearScGeom()],
		[Ip2_LinearMat_LinearMat_LinearPhys()],
		[Law2_ScGeom_LinearPhys_Linear()],
	)


def cundallStrack():
	return (ours(0)[0], [Ig2_Sphere_Sphere_ScGeom()], ours(0)[2], [Law2_ScGeom_FrictPhys_CundallStrack()])


def cohesive(incremental):
	return (
		CohFrictMat(
			young=0.5e8 * math.pi,
			poisson=1 / 3,
			frictionAngle=math.atan(0.4),
			density=2650,
			isCohesive=False,
			momentRotationLaw=True,
			alphaKr=0.25,
			alphaKtw=0,
			etaRoll=0.25,
			etaTwist=0,
		),
		[Ig2_Sphere_Sphere_ScGeom6D()],
		[Ip2_CohFrictMat_CohFrictMat_CohFrictPhys()],
		[Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True, useIncrementalForm=incremental)],
	)


LAWS = {
	OURS: lambda: ours(0.5),
	STOCK: lambda: cohesive(True),
	"YADE cohesive-frictional, moments, total form": lambda: cohesive(False),
	"linear": lambda: ours(0),
	"YADE CundallStrack": cundallStrack,
	"normal force only": lambda: ours(0, friction=0),
}


def measure(law, centres, radii):
	"""ns a contact and step, number of contacts."""
	O.reset()
	material, geometry, physics, laws = LAWS[law]()
	O.materials.append(material)
	random = numpy.random.default_rng(2)
	r = statistics.fmean(radii)
	for centre, radius in zip(centres, radii):
		body = utils.sphere(centre, radius, fixed=True)
		# in all steps together a hundredth of the overlaps' order in distance, as much at the surface by rotation
		body.state.vel = tuple(1e-4 * r * random.uniform(-1, 1, 3))
		body.state.angVel = tuple(1e-4 * random.uniform(-1, 1, 3))
		O.bodies.append(body)
	loop = InteractionLoop(geometry, physics, laws)
	O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=0.02 * r), loop, NewtonIntegrator()]
	O.dt = 1 / (WARM + STEPS)
	O.timingEnabled = True
	O.run(WARM, True)
	timing.reset()
	O.run(STEPS, True)
	contacts = sum(1 for i in O.interactions if i.isReal)
	return loop.execTime / loop.execCount / contacts, contacts


def main(folder, count):
	centres, radii = packing(count)
	figures = {law: [] for law in LAWS}
	counts = set()
	for _ in range(TURNS):
		for law in LAWS:
			figure, contacts = measure(law, centres, radii)
			figures[law].append(figure)
			counts.add(contacts)
	assert len(counts) == 1, "the scenes differ: %s contacts" % counts
	contacts = counts.pop()
	print("%d spheres, %d contacts" % (count, contacts))
	rows = []
	for law in LAWS:
		ratio = statistics.median(stock / mine for stock, mine in zip(figures[STOCK], figures[law]))
		rows.append((law, count, contacts, statistics.median(figures[law]), ratio))
		print("%-48s %6.1f ns a contact and step, %.2f times as fast as YADE's cohesive-frictional" % (law, rows[-1][3], ratio))
	write(os.path.join(folder, "contact.csv"), ["law", "spheres", "contacts", "cost (ns a contact and step)", "times as fast as " + STOCK], rows)


if __name__ == "__main__":
	arguments = sys.argv[1:]
	main(arguments[0] if arguments else "bench", int(arguments[1]) if len(arguments) > 1 else 7000)
