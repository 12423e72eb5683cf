# SPDX-License-Identifier: GPL-2.0-or-later
"""The membrane's tensile test (the study's Fig. 3): a tube of the study's sheet, without soil, is pulled along its axis; E t and Poisson's ratio from forces and strains.

	scripts/yade -x examples/paper/study/tension.py [--strains 0.002 0.01 0.05 0.1 0.2] [--radius 0.75e-3]

A sheet of E t = 600 N/m is pulled with bonds that have central forces alone (nu = 1/3) and with kn = ks (nu = 0, the study's kn/ks = 1). E t is the pull
through the middle over the circumference at rest, over the axial strain there; nu is hoop over axial strain. Both are of the middle third, away from the ends, which are held along the
axis only. The closed form holds for small strains: E t = 2 sqrt(3) kn (kn + ks)/(3 kn + ks), nu = (kn - ks)/(3 kn + ks). One line a strain; a bond's kn and ks for the E t and nu asked
for stand above them.
"""

import argparse
import math
import sys

import hexmembrane  # noqa: F401  (makes the classes known to YADE)
import numpy
import yade
from yade import O

YOUNG, THICKNESS = 1.0e6, 0.6e-3  # Pa, m: E t = 600 N/m, as in ../flexible-100.yaml
RADIUS, HEIGHT = 0.02, 0.08  # m
SHEETS = {"central bonds": 1 / 3, "kn/ks = 1": 0.0}
#: Steps of a pull and of the rest after it, by the number of rings.
_PULL, _REST = 160, 320


def tube(radius, poisson):
	"""A tube whose end rings are held along the axis; (membrane, bonds)."""
	O.reset()
	O.materials.append(yade.LinearMat(kn=1e5, ks=1e5, friction=0, density=1000, label="sheet"))
	membrane = yade.HexMembrane(
		specimenRadius=RADIUS, specimenHeight=HEIGHT, particleRadius=radius, placement="centred", oRingRows=1, platenRows=0,
		material=O.materials["sheet"], mask=3, rotations=poisson < 1 / 3,
	)  # fmt: skip
	membrane.generate()
	for i in (*membrane.ids[: membrane.perRing], *membrane.ids[-membrane.perRing :]):
		O.bodies[i].state.blockedDOFs = "zXYZ"
	bonds = yade.MembraneBonds(membrane=membrane, young=YOUNG, thickness=THICKNESS, poisson=poisson)
	O.engines = [yade.ForceResetter(), yade.CompactLoop(engines=[bonds], damping=0.4, substeps=100)]
	O.dt = 0.5 * bonds.criticalTimeStep()
	return membrane, bonds


def rings(membrane):
	"""(mean radius, height) of each ring."""
	x = yade.BodyArrays.positions(list(membrane.ids)).reshape(membrane.rings, membrane.perRing, 3)
	centre = x.mean(axis=1, keepdims=True)
	return numpy.linalg.norm((x - centre)[:, :, :2], axis=2).mean(axis=1), centre[:, 0, 2]


def pull(membrane, speed):
	for i in membrane.ids[-membrane.perRing :]:
		v = O.bodies[i].state.vel
		O.bodies[i].state.vel = (v[0], v[1], speed)


def test(radius, poisson, strains):
	"""[(axial strain, E t [N/m], Poisson's ratio)] of a tube pulled to each strain of its ends."""
	membrane, bonds = tube(radius, poisson)
	print(f"  kn = {bonds.normalStiffness:.6g} N/m, ks = {bonds.shearStiffness:.6g} N/m, {membrane.rings} rings of {membrane.perRing}")
	r0, z0 = rings(membrane)
	middle = slice(membrane.rings // 3, membrane.rings - membrane.rings // 3)
	found, at = [], 0.0
	for strain in strains:
		steps = 100 * math.ceil(_PULL * membrane.rings / 100)
		pull(membrane, (strain - at) * (z0[-1] - z0[0]) / (steps * O.dt))
		O.run(steps, True)
		pull(membrane, 0.0)
		O.run(_REST * membrane.rings, True)
		at = strain
		r, z = rings(membrane)
		axial = numpy.polyfit(z0[middle], z[middle] - z0[middle], 1)[0]
		hoop = (r[middle] / r0[middle] - 1).mean()
		tension = bonds.axialTension([(z[0] + z[-1]) / 2])[0] / (2 * math.pi * membrane.centreRadius)
		found.append((axial, tension / axial, -hoop / axial))
	return found


def main(argv):
	parser = argparse.ArgumentParser(prog="tension.py", description="E t and Poisson's ratio of the study's sheet from a tensile test.")
	parser.add_argument("--strains", type=float, nargs="+", default=[0.002, 0.01, 0.05, 0.1, 0.2])
	parser.add_argument("--radius", type=float, default=0.75e-3, help="of the membrane's spheres [m]")
	arguments = parser.parse_args(argv)
	for name, poisson in SHEETS.items():
		print(f"{name}: E t = {YOUNG * THICKNESS:g} N/m and nu = {poisson:.4f} asked for")
		for axial, young, ratio in test(arguments.radius, poisson, arguments.strains):
			print(f"  strain {100 * axial:6.3f} %: E t {young:7.2f} N/m, nu {ratio:.4f}", flush=True)


if __name__ == "__main__":
	main(sys.argv[1:])
