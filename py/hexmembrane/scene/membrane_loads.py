# SPDX-License-Identifier: GPL-2.0-or-later
"""What a flexible membrane itself carries, read from the forces of its sheet (bonds, bending, self-contact) and of its pressure.

The free body of half a specimen, at rest: N = F + P + T_mid - T_end, with N the soil's axial force at mid-height and F a platen's. A platen
that carries sigma3 Ae does not give the soil sigma3: N acts on Am, which the membrane's sag makes less than Ae; P is less than the
sigma3 (Ae - Am) of a sheet that the pressure reaches everywhere; and the pulls T of a sheet that is stretched between the grains and at
the O-rings differ. The soil's own stress is measured from its contacts (SoilMeasure).
"""

import dataclasses

import numpy

import numpy
from yade import BodyArrays


@dataclasses.dataclass
class MembraneLoads:
	"""Loads in the membrane; all 0 where there is none.

	:param axialPush: P, axial parts of the confining pressure's forces towards mid-height, mean of both halves [N].
	:param axialPullMiddle: T_mid, axial pull of the membrane through the plane at mid-height, tension positive [N].
	:param axialPullEnd: T_end, the same just inside the O-ring rows, mean of both ends [N].
	:param radialPressure: the sheet's forces towards the axis over the inner area of the main body, inwards positive [Pa].
	"""

	axialPush: float = 0.0
	axialPullMiddle: float = 0.0
	axialPullEnd: float = 0.0
	radialPressure: float = 0.0


def endRows(membrane):
	"""Ids of the rows on both sides of the planes of :func:`endHeights`: the innermost O-ring row and the row inside it, lower end first."""
	rows, k = numpy.array(membrane.ids).reshape(membrane.rings, membrane.perRing), membrane.oRingRows
	return rows[[k - 1, k, -k - 1, -k]].ravel().tolist()


def endHeights(rows):
	"""Heights [m] of the planes midway between the innermost O-ring row and the row inside it, at the lower and the upper end.

	:param rows: of :func:`endRows`.
	"""
	return BodyArrays.positions(rows)[:, 2].reshape(2, -1).mean(axis=1).tolist()


def membraneLoads(rows, sheet, pressureEngine, bottom, top):
	"""The :class:`MembraneLoads` of the last step.

	:param rows: of :func:`endRows`, of a HexMembrane with O-ring rows.
	:param sheet: the engines of its own mechanics, such as MembraneBonds, a step run.
	:param pressureEngine: its MembranePressure.
	:param bottom: height of the bottom platen's face [m].
	:param top: height of the top platen's face [m].
	"""
	middle = 0.5 * (bottom + top)

	def pull(height):
		return sum(engine.axialTension(height) for engine in sheet)

	return MembraneLoads(
		axialPush=pressureEngine.axialPush(middle),
		axialPullMiddle=pull(middle),
		axialPullEnd=sum(pull(height) for height in endHeights(rows)) / 2,
		radialPressure=sum(engine.radialShare(3) for engine in sheet),
	)


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
