# SPDX-License-Identifier: GPL-2.0-or-later
"""The linear law with rolling resistance in a periodic cell, without any membrane: isotropic compression by YADE's PeriTriaxController."""

import os

import hexmembrane  # noqa: F401  (makes the classes known to YADE)
from yade import *
from yade import pack, utils
from yade.wrapper import *

edge = 0.02  # m
cloud = pack.SpherePack()
cloud.makeCloud((0, 0, 0), (edge, edge, edge), rMean=1e-3, rRelFuzz=0.3, periodic=True, seed=1)
O.materials.append(LinearMat(emod=2e7, kratio=3, friction=0.5, rollingFriction=0.1, density=2650))
cloud.toSimulation()
O.engines = [
	ForceResetter(),
	InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=1e-4),
	InteractionLoop(
		[Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False)], [Ip2_LinearMat_LinearMat_LinearPhys()], [Law2_ScGeom_LinearPhys_Linear()]
	),
	PeriTriaxController(
		goal=(-1e5, -1e5, -1e5), stressMask=7, dynCell=True, maxStrainRate=(5, 5, 5), maxUnbalanced=1e-2, relStressTol=1e-2, doneHook="O.pause()", label="cell"
	),
	NewtonIntegrator(damping=0.2),
]
O.dt = 4e-6
O.run(300 if "SHORT" in os.environ else 60000, True)
# in a cell without boundaries utils.getStress() is the soil's own; YADE counts compression negative
print(f"mean stress {-utils.getStress().trace() / 3:.4g} Pa, porosity {utils.porosity():.4f}, contacts a grain {utils.avgNumInteractions():.3g}")
