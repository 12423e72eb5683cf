# SPDX-License-Identifier: GPL-2.0-or-later
"""One row of the records, measured on the scene as it stands. Columns, signs and formulas: :mod:`hexmembrane.records`."""

import dataclasses
import math

import numpy
from scipy.spatial import cKDTree
from yade import O, utils

from hexmembrane.vtk import normals


@dataclasses.dataclass
class Reference:
	"""The state that a stage's strains count from, and what does not change: grains, solid volume.

	:param height: distance of the platens' faces [m].
	:param radius: mean radius of the membrane's inner surface [m].
	:param volume: enclosed volume [m3].
	"""

	height: float
	radius: float
	volume: float

	@classmethod
	def of(cls, scene):
		"""The reference taken from the scene as it stands."""
		bottom, top = scene.faces()
		return cls(top - bottom, meanRadius(scene.membrane), scene.membrane.enclosedVolume(bottom, top))


@dataclasses.dataclass
class Grains:
	"""What the grains are once and for all: ids, solid volume [m3], mean diameter by volume [m], density [kg/m3]."""

	ids: list
	solid: float
	meanDiameter: float
	density: float
	smallest: float
	largest: float

	@classmethod
	def of(cls, ids):
		radii = numpy.array([O.bodies[i].shape.radius for i in ids])
		solid = 4 / 3 * math.pi * float((radii**3).sum())
		return cls(
			list(ids),
			solid,
			2 * float((radii**3).mean()) ** (1 / 3),
			sum(O.bodies[i].state.mass for i in ids) / solid,
			float(radii.min()),
			float(radii.max()),
		)


def meanRadius(membrane):
	"""Mean radius [m] of the inner surface for Eq. 6: over the particles of groups 2 and 3, each about its ring's centroid.

	The same rings all along, so that none enters or leaves the mean when a platen passes it.
	"""
	x = numpy.array(membrane.positions)[:, :2].reshape(membrane.rings, membrane.perRing, 2)
	rows = slice(membrane.oRingRows, membrane.rings - membrane.oRingRows)
	return float(numpy.linalg.norm(x - x.mean(axis=1, keepdims=True), axis=2)[rows].mean()) - membrane.sphereRadius


def insideTube(point, x, triangles, perRing):
	"""Whether a point is inside a tube of rings, its ends closed by fans, however much the tube is folded.

	By the solid angles of the triangles, 2 atan2(a.(b x c), abc + (a.b)c + (b.c)a + (c.a)b), whose sum is 4 pi inside and 0 outside
	an outward oriented surface (A. Van Oosterom, J. Strackee, The solid angle of a plane triangle, IEEE Trans. Biomed. Eng. 30, 1983).

	:param x: (rings * perRing, 3) points from the lower ring to the upper one. :param triangles: (M, 3), outward.
	"""
	ring = numpy.arange(perRing)
	after = numpy.roll(ring, -1)
	last, n = len(x) - perRing, len(x)
	points = numpy.vstack([x, x[:perRing].mean(axis=0), x[last:].mean(axis=0)]) - point
	lower = numpy.column_stack([after, ring, numpy.full(perRing, n)])
	upper = numpy.column_stack([last + ring, last + after, numpy.full(perRing, n + 1)])
	a, b, c = (points[numpy.vstack([triangles, lower, upper])[:, k]] for k in range(3))
	la, lb, lc = (numpy.linalg.norm(v, axis=1) for v in (a, b, c))
	dots = [(p * q).sum(axis=1) * r for p, q, r in ((a, b, lc), (b, c, la), (c, a, lb))]
	angles = 2 * numpy.arctan2((a * numpy.cross(b, c)).sum(axis=1), la * lb * lc + sum(dots))
	return float(angles.sum()) > 2 * math.pi


def escaped(scene, grains):
	"""Id of a grain whose centre is outside the membrane or behind a platen's face, None when all are inside.

	A grain on the inner side of the membrane particle nearest to it, by the surface's normal there, is inside; the few others, where
	the membrane is folded, are looked at by :func:`insideTube`.
	"""
	membrane = scene.membrane
	x = numpy.array(membrane.positions)
	triangles = numpy.array([tuple(t) for t in membrane.triangles])
	outward = normals(x, triangles)
	centre = numpy.array([tuple(O.bodies[i].state.pos) for i in grains.ids])
	nearest = cKDTree(x).query(centre)[1]
	bottom, top = scene.faces()
	lost = (centre[:, 2] <= bottom) | (centre[:, 2] >= top)
	for k in numpy.flatnonzero(((centre - x[nearest]) * outward[nearest]).sum(axis=1) >= 0):
		lost[k] = lost[k] or not insideTube(centre[k], x, triangles, membrane.perRing)
	return grains.ids[int(numpy.argmax(lost))] if lost.any() else None


def coordination(first, count):
	"""2 (contacts among grains that carry a normal force)/(grains); grains are bodies ``first`` .. ``first + count - 1``."""
	last = first + count
	touching = 0
	for contact in O.interactions:
		if first <= contact.id1 < last and first <= contact.id2 < last and contact.phys.normalForce.squaredNorm() > 0:
			touching += 1
	return 2 * touching / count


def row(scene, grains, reference, stage, elapsed):
	"""The measured row as a dict; see :data:`hexmembrane.records.COLUMNS`."""
	membrane = scene.membrane
	bottom, top = scene.faces()
	height = top - bottom
	volume = membrane.enclosedVolume(bottom, top)
	radius = meanRadius(membrane)
	pressure = scene.pressure.pressure
	forces = scene.bottom.force, scene.top.force
	q = (sum(forces) / 2 - pressure * scene.platenArea()) / (volume / height)
	speed = scene.approachSpeed()
	inertial = speed / height * grains.meanDiameter * math.sqrt(grains.density / pressure) if pressure > 0 else 0.0
	dz, dr = height / reference.height - 1, radius / reference.radius - 1
	return {
		"stage": stage,
		"step": O.iter,
		"time": O.time,
		"axial_strain": -dz,
		"q": q,
		"axial_stress": q + pressure,
		"sigma3_applied": pressure,
		"sigma3_transmitted_group3": membrane.transmittedPressure(3),
		"sigma3_transmitted_group2": membrane.transmittedPressure(2),
		"sigma3_transmitted_all": membrane.transmittedPressure(0),
		"volumetric_strain_radius": dz + 2 * dr,
		"volumetric_strain_volume": volume / reference.volume - 1,
		"porosity": 1 - grains.solid / volume,
		"coordination": coordination(grains.ids[0], len(grains.ids)),
		"unbalanced": utils.unbalancedForce(),
		"inertial_number": abs(inertial),
		"platen_force_bottom": forces[0],
		"platen_force_top": forces[1],
		"height": height,
		"mean_radius": radius,
		"volume": volume,
		"membrane_area": scene.pressure.area,
		"bonds_broken": scene.bonds.brokenCount,
		"elapsed": round(elapsed, 2),
	}
