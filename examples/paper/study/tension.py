# SPDX-License-Identifier: GPL-2.0-or-later
"""The membrane's tensile test (the study's Fig. 3): a tube and a strip of the study's sheet, without soil, are pulled; E t and Poisson's ratio from forces and strains.

	scripts/yade -x examples/paper/study/tension.py [--strains 0.002 0.01 0.05 0.1 0.2] [--radius 0.75e-3]

A sheet of E t = 600 N/m is pulled with bonds that have central forces alone (nu = 1/3) and with kn = ks (nu = 0, the study's kn/ks = 1). E t is the pull
through the middle over the width at rest, over the axial strain there; nu is lateral over axial strain. Both are of the middle third, away from the ends, which are held along the
axis only. A tube's width is its circumference. The strip is the tube slit along its axis and laid flat: its long edges are free. The closed form holds for small strains: E t = 2 sqrt(3) kn (kn + ks)/(3 kn + ks), nu = (kn - ks)/(3 kn + ks). One line a strain; a bond's kn and ks for the E t and nu asked
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
SHAPES = ("tube", "strip")
#: Steps of a pull and of the rest after it, by the number of rings.
_PULL, _REST = 160, 320


def sheet(shape, radius, poisson):
	"""A tube or a strip whose end rows are held along the axis; (membrane, bonds)."""
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
	if shape == "strip":
		layFlat(membrane, bonds)
	O.engines = [yade.ForceResetter(), yade.CompactLoop(engines=[bonds], damping=0.4, substeps=100)]
	O.dt = 0.5 * bonds.criticalTimeStep()
	return membrane, bonds


def layFlat(membrane, bonds):
	"""Slit the tube along its axis and lay it on the plane y = 0, each bond at its rest length."""
	size = 2 * membrane.sphereRadius
	x = rows(membrane)
	# the places round the axis are whole and half numbers: the lattice's
	place = numpy.round(2 * numpy.arctan2(x[..., 1], x[..., 0]) * membrane.perRing / (2 * math.pi)) % (2 * membrane.perRing) / 2
	for row in range(membrane.rings):
		for column in range(membrane.perRing):
			O.bodies[membrane.ids[row * membrane.perRing + column]].state.pos = (place[row, column] * size, 0, row * size * math.sqrt(3) / 2)
	x = rows(membrane).reshape(-1, 3)
	bonds.broken = [int(numpy.linalg.norm(x[a] - x[b]) > 1.5 * size) for a, b in membrane.bonds]


def rows(membrane):
	"""Positions by row and column."""
	return yade.BodyArrays.positions(list(membrane.ids)).reshape(membrane.rings, membrane.perRing, 3)


def lateral(shape, x0, x):
	"""Lateral strain of rows: the tube's of its mean radius, the strip's by least squares of the displacement."""
	if shape == "strip":
		across = x0[..., 0] - x0[..., 0].mean(axis=1, keepdims=True)
		return float((across * (x - x0)[..., 0]).sum() / (across**2).sum())
	radius = [numpy.linalg.norm((y - y.mean(axis=1, keepdims=True))[..., :2], axis=2).mean() for y in (x0, x)]
	return radius[1] / radius[0] - 1


def pull(membrane, speed):
	for i in membrane.ids[-membrane.perRing :]:
		v = O.bodies[i].state.vel
		O.bodies[i].state.vel = (v[0], v[1], speed)


def test(shape, radius, poisson, strains):
	"""[(axial strain, E t [N/m], Poisson's ratio)] of a tube or strip pulled to each strain of its ends."""
	membrane, bonds = sheet(shape, radius, poisson)
	print(f"  kn = {bonds.normalStiffness:.6g} N/m, ks = {bonds.shearStiffness:.6g} N/m, {shape} of {membrane.rings} rows of {membrane.perRing}")
	first = rows(membrane)
	z0 = first[:, :, 2].mean(axis=1)
	middle = slice(membrane.rings // 3, membrane.rings - membrane.rings // 3)
	# a strip has half a place less: of the bonds between two rows one is missing
	width = 2 * math.pi * membrane.centreRadius if shape == "tube" else (membrane.perRing - 0.5) * 2 * membrane.sphereRadius
	found, at = [], 0.0
	for strain in strains:
		steps = 100 * math.ceil(_PULL * membrane.rings / 100)
		pull(membrane, (strain - at) * (z0[-1] - z0[0]) / (steps * O.dt))
		O.run(steps, True)
		pull(membrane, 0.0)
		O.run(_REST * membrane.rings, True)
		at = strain
		x = rows(membrane)
		z = x[:, :, 2].mean(axis=1)
		axial = numpy.polyfit(z0[middle], z[middle] - z0[middle], 1)[0]
		tension = bonds.axialTension([(z[0] + z[-1]) / 2])[0] / width
		found.append((axial, tension / axial, -lateral(shape, first[middle], x[middle]) / axial))
	return found


def main(argv):
	parser = argparse.ArgumentParser(prog="tension.py", description="E t and Poisson's ratio of the study's sheet from a tensile test.")
	parser.add_argument("--strains", type=float, nargs="+", default=[0.002, 0.01, 0.05, 0.1, 0.2])
	parser.add_argument("--radius", type=float, default=0.75e-3, help="of the membrane's spheres [m]")
	arguments = parser.parse_args(argv)
	for name, poisson in SHEETS.items():
		print(f"{name}: E t = {YOUNG * THICKNESS:g} N/m and nu = {poisson:.4f} asked for")
		for shape in SHAPES:
			for axial, young, ratio in test(shape, arguments.radius, poisson, arguments.strains):
				print(f"  strain {100 * axial:6.3f} %: E t {young:7.2f} N/m, nu {ratio:.4f}", flush=True)


if __name__ == "__main__":
	main(sys.argv[1:])
