# SPDX-License-Identifier: GPL-2.0-or-later
"""A membrane round a body that is no cylinder: pressure on any triangulated set of bodies, here a ball of grains in a skin of stock cohesive spheres."""

import os
from math import pi, sqrt

import hexmembrane  # noqa: F401  (makes the classes known to YADE)
import numpy
from scipy.spatial import ConvexHull
from yade import *
from yade import pack, utils
from yade.wrapper import *

radius, grain, count, pressure = 0.02, 1.5e-3, 1200, 20e3  # m, m, spheres of the skin, Pa
grains = O.materials.append(CohFrictMat(young=2e7, poisson=0.3, frictionAngle=0.4, density=2650, isCohesive=False))
skin = O.materials.append(CohFrictMat(young=2e6, poisson=0.3, frictionAngle=0, density=2650, normalCohesion=1e9, shearCohesion=1e9))
O.bodies.append(pack.regularHexa(pack.inSphere((0, 0, 0), radius), radius=grain, gap=0, material=grains))

# the skin: points spread evenly over a sphere, its triangles counter-clockwise seen from outside, where the pressure is
k = numpy.arange(count) + 0.5
z, turn = 1 - 2 * k / count, pi * (1 + sqrt(5)) * k
points = numpy.column_stack([numpy.sqrt(1 - z**2) * numpy.cos(turn), numpy.sqrt(1 - z**2) * numpy.sin(turn), z])
triangles = ConvexHull(points).simplices
a, b, c = (points[triangles[:, i]] for i in range(3))
turned = (numpy.cross(b - a, c - a) * a).sum(axis=1) < 0
triangles[turned] = triangles[turned][:, ::-1]
size = 0.6 * radius * sqrt(4 * pi / count)
ids = O.bodies.append([utils.sphere(p, size, material=skin) for p in (radius + size) * points])
for i in ids:
	O.bodies[i].mask = 3

O.engines = [
	ForceResetter(),
	InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=2e-4),
	InteractionLoop(
		[Ig2_Sphere_Sphere_ScGeom6D()],
		[Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True)],
		[Law2_ScGeom6D_CohFrictPhys_CohesionMoment()],
	),
	MembranePressure(ids=ids, triangles=triangles.tolist(), surface="inner", surfaceOffset=size, pressure=pressure, rampTime=2e-3, label="water"),
	NewtonIntegrator(damping=0.4),
]
O.dt = 0.3 * utils.PWaveTimeStep()
O.step()
for i in O.interactions:  # bonds are at rest where the skin's spheres have begun
	if {i.id1, i.id2} <= set(ids):
		i.phys.unp = i.geom.penetrationDepth
O.run(200 if "SHORT" in os.environ else 6000, True)
print(f"{len(ids)} spheres, {len(triangles)} triangles, {water.applied:.4g} Pa on {1e4 * water.area:.4g} cm2, resultant {water.resultant.norm():.2g} N")
