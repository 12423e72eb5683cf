# SPDX-License-Identifier: GPL-2.0-or-later
"""The small specimen that the scripts of this folder share: 180 grains, 40 x 40 mm, in a membrane between two platens."""

from functools import cache
from math import pi, sqrt
from types import SimpleNamespace

import hexmembrane  # noqa: F401  (makes the classes known to YADE)
import yade
from yade import O, utils

from hexmembrane.scene.platens import platen

RADIUS, HEIGHT, EMOD, DENSITY = 0.02, 0.04, 2e7, 2650  # m, m, Pa, kg/m3
LINEAR = (
	[yade.Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False)],
	[yade.Ip2_LinearMat_LinearMat_LinearPhys()],
	[yade.Law2_ScGeom_LinearPhys_Linear()],
)


def linear(friction, density):
	return yade.LinearMat(emod=EMOD, kratio=3, friction=friction, rollingFriction=0.1, density=density)


@cache
def pack():
	"""Centres and radii of touching grains."""
	packing = yade.CylinderPacking(radius=RADIUS, height=HEIGHT, radii=[1, 1.2, 1.5] * 60, porosity=0.46, stress=1e3, emod=EMOD, friction=0.5)
	packing.generate()
	return list(zip(packing.centres, packing.sizes))


def build(tier="reference", spheres=None, radius=RADIUS, height=HEIGHT, pressure=50e3, material=linear, law=LINEAR):
	"""Fill the empty scene; grains, platens, membrane, inner engines and SoilMeasure as attributes.

	:param tier: 'reference' or 'compact'. :param spheres: centres [m] and radii [m] of the grains; None: those of pack().
	:param radius: of the specimen [m]. :param height: of the specimen [m], from z = 0. :param pressure: confining pressure [Pa].
	:param material: makes a material from friction [-] and density [kg/m3]. :param law: lists of Ig2, Ip2 and Law2 (reference tier).
	"""
	spheres = spheres or pack()
	grain, plate, sheet = (material(friction, density) for friction, density in ((0.5, DENSITY), (0.3, DENSITY), (0.0, 4000)))
	for each in grain, plate, sheet:
		O.materials.append(each)
	s = SimpleNamespace(grains=O.bodies.append([utils.sphere(centre, r, material=grain) for centre, r in spheres]))
	bottom = O.bodies.append(platen((0, 0, 0), radius, 0.02, facing=1, material=plate))
	top = O.bodies.append(platen((0, 0, height), radius, 0.02, facing=-1, material=plate))
	s.membrane = yade.HexMembrane(specimenRadius=radius, specimenHeight=height, particleRadius=1.5e-3, mask=3, material=sheet)
	s.membrane.generate()
	s.bonds = yade.MembraneBonds(membrane=s.membrane, young=1.4e6, thickness=0.5e-3, poisson=1 / 3)
	s.pressure = yade.MembranePressure(membrane=s.membrane, pressure=pressure)
	s.beside = yade.MembraneRadialServo(membrane=s.membrane, pressure=pressure)
	s.lower = yade.PlatenDrive(platen=bottom, direction=(0, 0, 1), velocity=0)
	s.upper = yade.PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=pressure)
	s.rings = yade.MembraneORings(membrane=s.membrane, mode="platens", bottomPlaten=bottom, topPlaten=top)
	s.soil = yade.SoilMeasure(membrane=s.membrane, bottomPlaten=bottom, topPlaten=top)
	inner = [s.bonds, s.pressure, s.beside, s.lower, s.upper, s.rings]
	if tier == "compact":
		s.loop = yade.CompactLoop(engines=inner, damping=0.2, substeps=50)
		O.engines = [yade.ForceResetter(), s.loop, yade.RunawayGuard(iterPeriod=1)]
	else:
		collider = yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb()], verletDist=1e-4, avoidSelfInteractionMask=2)
		contacts = yade.InteractionLoop([*law[0], yade.Ig2_Platen_Sphere_ScGeom()], *law[1:])
		O.engines = [yade.ForceResetter(), collider, contacts, *inner, yade.NewtonIntegrator(damping=0.2), yade.RunawayGuard()]
	smallest = min(r for _, r in spheres)
	O.dt = min(0.3 * sqrt(4 / 3 * pi * smallest**3 * DENSITY / (pi * EMOD * smallest)), 0.5 * s.bonds.criticalTimeStep())
	return s


def stresses(soil):
	"""Axial and radial stress of the soil [Pa], compression positive."""
	stress = soil.stress()["whole"]
	return stress[2, 2], (stress[0, 0] + stress[1, 1]) / 2
