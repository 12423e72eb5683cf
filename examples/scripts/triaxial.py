# SPDX-License-Identifier: GPL-2.0-or-later
"""A triaxial test in a flexible membrane from the classes alone, in YADE's own loop. Run: scripts/yade examples/scripts/triaxial.py"""

import os
from math import pi, sqrt

import hexmembrane  # noqa: F401  (makes the classes known to YADE)
from yade import *
from yade import plot, utils
from yade.wrapper import *

from hexmembrane.scene.platens import platen

short = "SHORT" in os.environ  # the tests take a few steps only
radius, height, pressure, emod = 0.02, 0.04, 100e3, 2e7  # m, m, Pa, Pa

# materials: kn = pi emod r1 r2/(r1 + r2) or so, kn/ks = kratio
for name, friction, density in ("grain", 0.5, 2650), ("platen", 0.3, 2650), ("membrane", 0.0, 4000):
	O.materials.append(LinearMat(emod=emod, kratio=3, friction=friction, rollingFriction=0.1, density=density, label=name))

# grains that already touch, at a mean stress of 1 kPa
packing = CylinderPacking(radius=radius, height=height, radii=[1, 1.2, 1.5] * 60, porosity=0.46, stress=1e3, emod=emod, friction=0.5)
packing.generate()
grains = O.bodies.append([utils.sphere(c, r, material="grain") for c, r in zip(packing.centres, packing.sizes)])
bottom = O.bodies.append(platen((0, 0, 0), radius, 0.01, facing=1, material="platen"))
top = O.bodies.append(platen((0, 0, height), radius, 0.02, facing=-1, material="platen"))

# mask 3: its spheres meet the grains (bit 1), and each other not (bit 2, see the collider)
membrane = HexMembrane(
	specimenRadius=radius, specimenHeight=height, particleRadius=1.5e-3, smallestGrain=min(packing.sizes), mask=3, material=O.materials["membrane"]
)
membrane.generate()

rise = 0.02  # s, in which the pressure comes on
bonds = MembraneBonds(membrane=membrane, young=1.4e6, thickness=0.5e-3, poisson=1 / 3)
O.engines = [
	ForceResetter(),
	InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Platen_Aabb()], verletDist=1e-4, avoidSelfInteractionMask=2),
	InteractionLoop(
		[Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False), Ig2_Platen_Sphere_ScGeom()],
		[Ip2_LinearMat_LinearMat_LinearPhys()],
		[Law2_ScGeom_LinearPhys_Linear()],
	),
	bonds,
	MembranePressure(membrane=membrane, pressure=pressure, rampTime=rise, label="confining"),
	MembraneRadialServo(membrane=membrane, pressure=pressure, rampTime=rise),
	PlatenDrive(platen=bottom, direction=(0, 0, 1), velocity=0, label="lower"),
	PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=pressure, rampTime=rise, label="upper"),
	MembraneORings(membrane=membrane, mode="platens", bottomPlaten=bottom, topPlaten=top),
	NewtonIntegrator(damping=0.2),
	RunawayGuard(),
	PyRunner(command="record()", iterPeriod=100, label="recorder"),
]
smallest = min(packing.sizes)
O.dt = min(0.3 * sqrt(4 / 3 * pi * smallest**3 * 2650 / (pi * emod * smallest)), 0.5 * bonds.criticalTimeStep())

soil = SoilMeasure(membrane=membrane, bottomPlaten=bottom, topPlaten=top)
start = {}


def record():
	stress, (low, high) = soil.stress(), soil.faces
	axial, radial = stress["whole"][2, 2], (stress["whole"][0, 0] + stress["whole"][1, 1]) / 2
	start.setdefault("height", high - low)
	start.setdefault("volume", stress["volume"])
	strain, dilation = 1 - (high - low) / start["height"], stress["volume"] / start["volume"] - 1
	plot.addData(strain=strain, q=axial - radial, radial=radial, transmitted=membrane.transmittedPressure(3), dilation=dilation)


plot.plots = {"strain": ("q", "radial", "transmitted", None, ("dilation", "g--"))}
if "DISPLAY" in os.environ:
	from yade import qt

	plot.plot(noShow=False)
	qt.View()

O.run(150 if short else int(2 * rise / O.dt), True)  # consolidation
start.clear()  # strains count from here
upper.mode, upper.velocity = "velocity", 0.08  # m/s, positive compresses
O.run(150 if short else int(0.1 * height / upper.velocity / O.dt), True)  # shear to 10 %
print(f"strain {plot.data['strain'][-1]:.4f}, q {plot.data['q'][-1]:.4g} Pa, pressure on the soil {plot.data['transmitted'][-1]:.4g} Pa")
