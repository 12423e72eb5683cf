# SPDX-License-Identifier: GPL-2.0-or-later
"""Bonds and pressure of a membrane in a scene, against the bonds of the same membrane in YADE's own cohesive-frictional law.

Both in one run, in turns, so that the machine's mood is the same for both; medians over the turns. ns a membrane particle and step, from YADE's
own engine timers. The stock bonds are YADE's interactions made with CohFrictMat; their cost is InteractionLoop's alone (no collider).
Arguments: radii of the membrane's spheres in mm (default 0.5 0.25).
"""

import os
import statistics
import sys

import hexmembrane  # noqa: F401
from yade import (
	Bo1_Sphere_Aabb,
	CohFrictMat,
	ForceResetter,
	FrictMat,
	Ig2_Sphere_Sphere_ScGeom6D,
	InsertionSortCollider,
	InteractionLoop,
	Ip2_CohFrictMat_CohFrictMat_CohFrictPhys,
	Law2_ScGeom6D_CohFrictPhys_CohesionMoment,
	NewtonIntegrator,
	O,
	timing,
)
from yade.wrapper import HexMembrane, MembraneBonds, MembranePressure

sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE runs scripts without their __file__
from table import write  # noqa: E402

WARM, STEPS, TURNS = 100, 150, 5


def membrane(material, radius):
	O.materials.append(material)
	m = HexMembrane(specimenRadius=0.02, specimenHeight=0.08, particleRadius=radius, placement="centred")
	m.generate()
	return m


def ours(radius):
	m = membrane(FrictMat(density=1000, frictionAngle=0), radius)
	bonds = MembraneBonds(membrane=m, young=1.4e6, thickness=3e-4, poisson=1 / 3.0)
	pressure = MembranePressure(membrane=m, pressure=1.0)
	O.engines = [ForceResetter(), bonds, pressure, NewtonIntegrator(damping=0.2)]
	O.dt = 0.2 * bonds.criticalTimeStep()
	return [bonds, pressure], len(m.ids)


def stock(radius):
	m = membrane(CohFrictMat(density=1000, young=1e6, poisson=1.0, normalCohesion=1e20, shearCohesion=1e20, isCohesive=True), radius)
	loop = InteractionLoop(
		[Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=1.001)],
		[Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True)],
		[Law2_ScGeom6D_CohFrictPhys_CohesionMoment()],
	)
	O.engines = [
		ForceResetter(),
		InsertionSortCollider([Bo1_Sphere_Aabb(aabbEnlargeFactor=1.001)], verletDist=0.01 * radius),
		loop,
		NewtonIntegrator(damping=0.2),
	]
	O.dt = 1e-7
	O.step()
	made = sum(1 for i in O.interactions)
	assert made == len(m.bonds), "stock scene has %d bonds of %d" % (made, len(m.bonds))
	return [loop], len(m.ids)


def measure(build, radius):
	O.reset()
	engines, particles = build(radius)
	O.timingEnabled = True
	O.run(WARM, True)
	timing.reset()
	O.run(STEPS, True)
	return [e.execTime / e.execCount / particles for e in engines], particles


def main(radii, folder):
	rows = []
	for radius in radii:
		mine, theirs = [], []
		for _ in range(TURNS):
			figures, particles = measure(ours, radius)
			mine.append(figures)
			theirs.append(measure(stock, radius)[0][0])
		bonds = statistics.median(m[0] for m in mine)
		pressure = statistics.median(m[1] for m in mine)
		both = statistics.median(sum(m) for m in mine)
		reference = statistics.median(theirs)
		ratio = statistics.median(t / sum(m) for t, m in zip(theirs, mine))
		rows.append((radius * 1e3, particles, bonds, pressure, both, reference, ratio))
		print(
			"R = %.3g mm, %6d particles: bonds %.1f + pressure %.1f = %.1f ns a particle and step; stock bonds alone %.0f ns; %.1f times"
			% rows[-1],
			flush=True,
		)
	write(os.path.join(folder, "membrane.csv"), ["radius (mm)", "particles", "bonds (ns)", "pressure (ns)", "bonds + pressure (ns)", "stock bonds (ns)", "ratio"], rows)


if __name__ == "__main__":
	arguments = sys.argv[1:]
	main([float(a) * 1e-3 for a in arguments[1:]] or [0.5e-3, 0.25e-3], arguments[0] if arguments else "bench")
