# SPDX-License-Identifier: GPL-2.0-or-later
"""Stress and radius along the specimen's height: what the membrane hands over row by row, and what the soil carries slice by slice (SoilMeasure.profile)."""

import dataclasses

import numpy
from yade import BodyArrays


@dataclasses.dataclass
class Profile:
	"""Stresses along the height [Pa], compression and inward pressure positive; heights above the bottom platen's face [m].

	:param height: of the specimen, between the faces.
	:param rowHeight: of each membrane row, mean of its particles; O-ring rows included; none in a rigid wall.
	:param rowPressure: transmitted radial pressure of each row, see ``HexMembrane.transmittedByRing``.
	:param edges: of the n slices, n + 1.
	:param volume: of each slice inside the membrane's inner surface [m3], n.
	:param radial: mean horizontal stress (s_xx + s_yy)/2 of each slice, the mean of radial and hoop stress, n.
	:param axial: s_zz of each slice, n.
	"""

	height: float
	rowHeight: numpy.ndarray
	rowPressure: numpy.ndarray
	edges: numpy.ndarray
	volume: numpy.ndarray
	radial: numpy.ndarray
	axial: numpy.ndarray

	@property
	def middle(self):
		"""Heights of the slices' middles [m]."""
		return 0.5 * (self.edges[1:] + self.edges[:-1])

	@property
	def radius(self):
		"""Mean radius of the lateral boundary in each slice [m], that of a cylinder of the slice's volume: the bulging profile."""
		return numpy.sqrt(self.volume / (numpy.pi * numpy.diff(self.edges)))


def measure(scene, count=16):
	"""The :class:`Profile` of the scene as it stands, from the contacts of the last step.

	:param scene: handles, :class:`hexmembrane.scene.handles.Scene`, of a test.
	:param count: slices, >= 1.
	:raises ValueError: no slice.
	"""
	membrane = scene.measure.membrane
	edges, volume, stress = scene.measure.profile(count)
	rows = BodyArrays.positions(membrane.ids)[:, 2].reshape(membrane.rings, membrane.perRing).mean(axis=1) if membrane else numpy.zeros(0)
	return Profile(
		height=edges[-1] - edges[0],
		rowHeight=rows - edges[0],
		rowPressure=numpy.array(membrane.transmittedByRing() if membrane else ()),
		edges=edges - edges[0],
		volume=volume,
		radial=0.5 * (stress[:, 0, 0] + stress[:, 1, 1]),
		axial=stress[:, 2, 2],
	)
