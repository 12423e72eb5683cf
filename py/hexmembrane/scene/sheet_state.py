# SPDX-License-Identifier: GPL-2.0-or-later
"""Strain and tension of a membrane's sheet, triangle by triangle. Uses nothing of YADE."""

import numpy


def sheetState(x, triangles, perRing, distance, bonds, forces):
	"""Strain and tension of a hexagonal sheet, triangle by triangle, as arrays by name.

	* ``hoop_strain``, ``axial_strain`` [-]: stretch of the triangle's edge in its ring, and of its height across it, less 1; from the stress-free lattice.
	* ``hoop_tension``, ``axial_tension`` [N/m]: along that edge and across it in the triangle's plane, tension positive, from the normal forces of its three
	  bonds; each bond is shared by the triangles beside it.

	:param x: places of the spheres [m], ring by ring. :param triangles: (M, 3). :param perRing: spheres in a ring. :param distance: of neighbours without stress [m].
	:param bonds: pairs of spheres, (B, 2). :param forces: their normal forces [N], tension positive.
	"""
	ring = triangles // perRing
	# the corner that is alone in its ring comes last
	alone = numpy.where(ring[:, 0] == ring[:, 1], 2, numpy.where(ring[:, 1] == ring[:, 2], 0, 1))
	a, b, top = (x[triangles[numpy.arange(len(triangles)), (alone + k) % 3]] for k in (1, 2, 0))
	edge, height = b - a, top - (a + b) / 2
	hoop = edge / numpy.linalg.norm(edge, axis=1)[:, None]
	area = numpy.linalg.norm(numpy.cross(edge, height), axis=1) / 2
	across = height - (height * hoop).sum(axis=1)[:, None] * hoop
	across /= numpy.linalg.norm(across, axis=1)[:, None]
	count = len(x)
	names = bonds.min(axis=1) * count + bonds.max(axis=1)
	order = numpy.argsort(names)
	sides = numpy.stack([triangles, numpy.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
	sideNames = sides.min(axis=1) * count + sides.max(axis=1)
	bond = order[numpy.searchsorted(names[order], sideNames)].reshape(-1, 3)
	owners = numpy.bincount(bond.ravel(), minlength=len(bonds))
	tension = numpy.zeros((2, len(triangles)))
	for k in range(3):
		along = x[bonds[bond[:, k], 1]] - x[bonds[bond[:, k], 0]]
		length = numpy.linalg.norm(along, axis=1)
		share = forces[bond[:, k]] / (owners[bond[:, k]] * area * length)
		for row, direction in zip(tension, (hoop, across)):
			row += share * (along * direction).sum(axis=1) ** 2
	return {
		"hoop_strain": numpy.linalg.norm(edge, axis=1) / distance - 1,
		"axial_strain": numpy.linalg.norm(height, axis=1) / (numpy.sqrt(0.75) * distance) - 1,
		"hoop_tension": tension[0],
		"axial_tension": tension[1],
	}
