# SPDX-License-Identifier: GPL-2.0-or-later
"""The flexible membrane as a test's lateral boundary; interface: :mod:`hexmembrane.lateral`.

Masks: grains and platens carry bit 1, membrane spheres bits 1 and 2, and the collider leaves out pairs that share bit 2: the
membrane meets grains and platens but not itself.
"""

import math

import numpy
import yade
from scipy.spatial import cKDTree
from yade import O

from hexmembrane import correction, timestep, vtk
from hexmembrane.lateral import Parts, only

#: Bit of the membrane's spheres in a body's mask.
MASK = 2


def platenRows(wished, particleRadius, smallest):
	"""Rows beside each platen: as wished, or as many as stand beside the smallest grain (rows are sqrt(3) R apart), 2 at least.

	A fine membrane leaves the O-ring's radius over about a grain; rows that all lie in this neck do not reach the soil, however hard they are pressed.

	:param particleRadius: R [m]. :param smallest: the smallest grain's radius [m], nan: unknown.
	"""
	if wished is not None:
		return wished
	return max(2, math.ceil(2 * smallest / (math.sqrt(3) * particleRadius))) if smallest > 0 else 2


def generate(config, particleRadius, smallest, scaling=1.0):
	"""A membrane as configured, generated, with a material of its own.

	:param particleRadius: wished radius of its spheres [m]. :param smallest: smallest grain's radius [m], nan: unknown.
	:param scaling: factor on its density.
	:raises ValueError: it is too coarse for the specimen or the grains, and such.
	"""
	given, grain = config.membrane, config.specimen
	O.materials.append(yade.LinearMat(emod=grain.emod, kratio=grain.kratio, friction=0, density=scaling * given.density, label="membrane"))
	membrane = yade.HexMembrane(
		specimenRadius=grain.radius,
		specimenHeight=grain.height,
		particleRadius=particleRadius,
		placement=given.placement,
		oRingRows=given.oRingRows,
		platenRows=platenRows(given.platenRows, particleRadius, smallest),
		density=scaling * given.density,
		material=O.materials["membrane"],
		smallestGrain=smallest,
		mask=1 | MASK,
		rotations=timestep.bondStiffness(given.young, given.thickness, given.poisson)[1] > 0,
	)
	membrane.generate()
	return membrane


class FlexibleMembrane:
	"""Handles: ``membrane``, ``bonds``, ``pressing`` (MembranePressure), ``servo`` (MembraneRadialServo), ``oRings``."""

	name = "membrane"

	def __init__(self, engines):
		self.bonds = only(engines, "MembraneBonds")
		self.pressing = only(engines, "MembranePressure")
		self.servo = only(engines, "MembraneRadialServo")
		self.oRings = only(engines, "MembraneORings")
		self.membrane = self.bonds.membrane

	@classmethod
	def make(cls, config, packing):
		"""The membrane as configured round the packing."""
		given = config.membrane
		smallest, largest = float(packing.radii.min()), float(packing.radii.max())
		particleRadius = given.particleRadius or given.sizeRatio * smallest
		grains = timestep.grainStep(config.specimen, smallest)
		scaling = timestep.densityScaling(given.densityScaling, grains, timestep.membraneStep(config.specimen, given, largest, particleRadius))
		membrane = generate(config, particleRadius, smallest, scaling)
		radius = membrane.sphereRadius
		unscaled = timestep.membraneStep(config.specimen, given, largest, radius)
		kn, ks = timestep.bondStiffness(given.young, given.thickness, given.poisson)

		def engines(bottom, top):
			before = [
				yade.MembraneBonds(membrane=membrane, kn=kn, ks=ks, tensionOnly=given.tensionOnly),
				yade.MembranePressure(membrane=membrane, pressure=0.0, surface=given.surface, gain=given.pressureGain),
				yade.MembraneRadialServo(membrane=membrane, pressure=0.0, areaRule=given.areaRule, gain=given.gain),
			]
			return before, [yade.MembraneORings(membrane=membrane, mode=given.oRings, bottomPlaten=bottom, topPlaten=top)]

		return Parts(
			engines=engines,
			platenRadius=packing.radius,
			overhang=membrane.rings * membrane.ringSpacing - config.specimen.height,
			smallest=radius,
			critical=math.sqrt(scaling) * unscaled,
			log=[
				cls._description(given, membrane, smallest, kn, ks),
				*cls._scaled(config, packing, membrane, scaling, unscaled),
				*cls._warning(config, packing),
			],
		)

	@staticmethod
	def _description(given, membrane, smallest, kn, ks):
		radius = membrane.sphereRadius
		return (
			f"membrane: {len(membrane.ids)} spheres of R = {1e3 * radius:.4g} mm in {membrane.rings} rings of {membrane.perRing}, "
			f"R/r = {radius / smallest:.3g} with r = {1e3 * smallest:.4g} mm the smallest grain's radius; "
			f"E t = {given.young * given.thickness:.4g} N/m, bonds kn = {kn:.4g}, ks = {ks:.4g} N/m"
		)

	@staticmethod
	def _scaled(config, packing, membrane, scaling, unscaled):
		if scaling == 1:
			return []
		mass = len(membrane.ids) * timestep.sphereMass(membrane.sphereRadius, scaling * config.membrane.density)
		share = mass / timestep.sphereMass(packing.radii, config.specimen.density).sum()
		return [
			f"membrane's density times {scaling:.3g}: its critical step is {math.sqrt(scaling) * unscaled:.4g} s instead of {unscaled:.4g} s, its mass "
			f"{100 * share:.2g} % of the grains' instead of {100 * share / scaling:.2g} %; what that does is the column membrane_unbalanced"
		]

	@staticmethod
	def _warning(config, packing):
		meanRadius = float((packing.radii**3).mean()) ** (1 / 3)
		sag = config.consolidation.pressure * meanRadius / (config.membrane.young * config.membrane.thickness)
		if sag <= 0.5:
			return []
		return [
			f"WARNING: pressure times grain radius is {sag:.2g} of E t: the membrane will sag deep between the grains and may fold; "
			"fix: raise membrane.young or membrane.thickness"
		]

	@property
	def pressure(self):
		return self.pressing.pressure

	@property
	def applied(self):
		return self.pressing.applied

	def setPressure(self, pressure):
		self.pressing.pressure = pressure
		self.servo.pressure = pressure

	def setMaxVelocity(self, _speed):
		"""Nothing: the pressure is applied, not approached."""

	def setTimeLimit(self, _limit):
		"""Nothing, as above."""

	def meanRadius(self):
		"""Mean radius [m] of the inner surface for Eq. 6: over the particles of groups 2 and 3, each about its ring's centroid.

		The same rings all along, so that none enters or leaves the mean when a platen passes it.
		"""
		membrane = self.membrane
		x = numpy.array(membrane.positions)[:, :2].reshape(membrane.rings, membrane.perRing, 2)
		rows = slice(membrane.oRingRows, membrane.rings - membrane.oRingRows)
		return float(numpy.linalg.norm(x - x.mean(axis=1, keepdims=True), axis=2)[rows].mean()) - membrane.sphereRadius

	def volume(self, bottom, top):
		return self.membrane.enclosedVolume(bottom, top)

	def endArea(self, face):
		return face

	def pressedArea(self, _bottom, _top):
		return self.pressing.area

	def transmitted(self, group):
		return self.membrane.transmittedPressure(group)

	def brokenBonds(self):
		return self.bonds.brokenCount

	def unbalanced(self):
		"""Mean resultant force on the particles of groups 2 and 3, their mass times acceleration, over the confining pressure on a particle's area."""
		membrane, pressure = self.membrane, self.pressure
		free = [i for i, group in zip(membrane.ids, membrane.groups) if group != 1]
		force = numpy.array([tuple(O.forces.f(i)) for i in free])
		particle = 2 * math.sqrt(3) * membrane.sphereRadius**2
		return float(numpy.linalg.norm(force, axis=1).mean()) / (pressure * particle) if pressure > 0 else 0.0

	def carried(self, bottom, top):
		return correction.terms(self.membrane, self.bonds, self.pressing, bottom, top)

	def outside(self, points):
		"""Which points are outside.

		A point on the inner side of the membrane particle nearest to it, by the surface's normal there, is inside; the few others, where
		the membrane is folded, are looked at by :func:`insideTube`.
		"""
		x = numpy.array(self.membrane.positions)
		triangles = numpy.array([tuple(t) for t in self.membrane.triangles])
		nearest = cKDTree(x).query(points)[1]
		lost = ((points - x[nearest]) * vtk.normals(x, triangles)[nearest]).sum(axis=1) >= 0
		for k in numpy.flatnonzero(lost):
			lost[k] = not insideTube(points[k], x, triangles, self.membrane.perRing)
		return lost

	def addStiffness(self, stiffness):
		"""The bonds': a lattice mode sees at most 6 (kn + ks), half of it here, see :func:`hexmembrane.timestep.bound`."""
		stiffness[self.membrane.ids] += 3 * (self.bonds.kn + self.bonds.ks)

	def writeFrame(self, path, _start):
		"""A surface through the centres; arrays: :mod:`hexmembrane.vtk`."""
		membrane = self.membrane
		x, v, u = vtk.states(O.bodies[i].state for i in membrane.ids)
		triangles = numpy.array([tuple(t) for t in membrane.triangles])
		group = numpy.array(membrane.groups, dtype=numpy.int32)
		points = {
			"id": numpy.array(membrane.ids),
			"group": group,
			"radius": numpy.full(len(x), membrane.sphereRadius),
			"velocity": v,
			"displacement": u,
			"normal_displacement": (u * vtk.normals(x - u, triangles)).sum(axis=1),
			"pressure": numpy.where(group == 1, 0.0, numpy.where(group == 2, self.servo.factor * self.servo.pressure, self.applied)),
		}
		vtk.write(path, x, triangles, points, {"group": group[triangles].min(axis=1)})


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
