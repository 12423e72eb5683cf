# SPDX-License-Identifier: GPL-2.0-or-later
"""What a flexible membrane itself carries, read from the forces of its sheet (bonds, bending, self-contact) and of its pressure.

The free body of half a specimen, at rest: N = F + P + T_mid - T_end, with N the soil's axial force at mid-height and F a platen's. A platen
that carries sigma3 Ae does not give the soil sigma3: N acts on Am, which the membrane's sag makes less than Ae; P is less than the
sigma3 (Ae - Am) of a sheet that the pressure reaches everywhere; and the pulls T of a sheet that is stretched between the grains and at
the O-rings differ. The soil's own stress is measured from its contacts (SoilMeasure).
"""

import dataclasses

import numpy


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


def endHeights(z):
	"""Heights [m] of the planes midway between the innermost O-ring row and the row inside it, at the lower and the upper end.

	:param z: present heights [m] of the particles of :func:`endRows`.
	"""
	return z.reshape(2, -1).mean(axis=1).tolist()


def membraneLoads(ends, sheet, pressureEngine, bottom, top):
	"""The :class:`MembraneLoads` of the last step.

	:param ends: of :func:`endHeights`.
	:param sheet: the engines of its own mechanics, such as MembraneBonds, a step run.
	:param pressureEngine: its MembranePressure.
	:param bottom: height of the bottom platen's face [m].
	:param top: height of the top platen's face [m].
	"""
	middle = 0.5 * (bottom + top)
	pulls = [sum(pull) for pull in zip(*(engine.axialTension([middle, *ends]) for engine in sheet))]
	return MembraneLoads(
		axialPush=pressureEngine.axialPush(middle),
		axialPullMiddle=pulls[0],
		axialPullEnd=sum(pulls[1:]) / 2,
		radialPressure=sum(engine.radialShare(3) for engine in sheet),
	)
