# SPDX-License-Identifier: GPL-2.0-or-later
"""The flexible membrane as a test's lateral boundary.

Masks: grains and platens carry bit 1, membrane spheres bits 1 and 2, and the collider leaves out pairs that share bit 2: the
membrane meets grains and platens but not itself. Platens that are wider than the specimen carry bit 4 alone, and grains bits 1 and 4: the O-ring rows stand
inside such platens.
"""

import dataclasses
import math

import numpy
import yade
from yade import O

from hexmembrane.scene import geometry, timestep
from hexmembrane.scene.lateral_boundary import BoundaryParts, LateralBoundary, Surface, atFactor, optionalEngine, singleEngine
from hexmembrane.scene.membrane_loads import endHeights, endRows, membraneLoads
from hexmembrane.scene.sheet_state import sheetState

#: What a sheet holds, by measurement: pressure times grain radius over E t, whatever D is; sag that D allows over the grain radius, whatever E t is.
MOST_STRETCHED, MOST_SAG = 0.25, 0.05
#: Bit of the membrane's spheres in a body's mask.
MASK = 2
#: Bit of platens that the membrane does not meet, and of the grains with them.
WIDE = 4


def wide(config):
	"""Whether the platens are wider than the specimen, so that the membrane does not meet them."""
	return config.platens.radius is not None and config.platens.radius > config.specimen.radius


def platenRows(wished, particleRadius, smallest):
	"""Rows beside each platen: as wished, or as many as stand beside the smallest grain (rows are sqrt(3) R apart), 2 at least.

	A fine membrane leaves the O-ring's radius over about a grain; rows that all lie in this neck do not reach the soil, however hard they are pressed.

	:param particleRadius: R [m].
	:param smallest: the smallest grain's radius [m].
	"""
	if wished is not None:
		return wished
	return max(2, math.ceil(2 * smallest / (math.sqrt(3) * particleRadius)))


def overhang(keys, smallest):
	"""How far the O-ring rows reach beyond the specimen at most, both ends together [m].

	:param keys: configuration's membrane section. :param smallest: the smallest grain's radius [m].
	"""
	return 2 * (keys.oRingRows + 1) * math.sqrt(3) * (keys.particleRadius or keys.sizeRatio * smallest)


@dataclasses.dataclass
class Soil:
	"""What a membrane is put round.

	:param radii: of the grains [m].
	:param radius: of the cylinder that they fill [m].
	:param height: of it [m].
	:param origin: centre of its lower end [m].
	"""

	radii: numpy.ndarray
	radius: float
	height: float
	origin: tuple = (0.0, 0.0, 0.0)


def generate(config, radius, soil, particleRadius, smallest):
	"""A membrane as configured, its density not scaled, generated with a material of its own.

	:param radius: of the specimen as HexMembrane wants it [m].
	:param soil: the :class:`Soil` that it is put round.
	:param particleRadius: wished radius of its spheres [m].
	:param smallest: smallest grain's radius [m].
	:raises ValueError: it is too coarse for the specimen or the grains, and such.
	"""
	keys = config.membrane
	O.materials.append(yade.LinearMat(friction=0, density=keys.density, label="membrane", **config.springs("membrane").given()))
	membrane = yade.HexMembrane(
		specimenRadius=radius,
		specimenHeight=soil.height,
		origin=soil.origin,
		particleRadius=particleRadius,
		placement=keys.placement,
		oRingRows=keys.oRingRows,
		platenRows=platenRows(keys.platenRows, particleRadius, smallest),
		density=keys.density,
		material=O.materials["membrane"],
		smallestGrain=smallest,
		mask=1 | MASK,
		rotations=not keys.centralBonds,
	)
	membrane.generate()
	return membrane


def scaleDensity(membrane, factor):
	"""Multiply the mass of a generated membrane's spheres, which lengthens its critical time step by the root of it."""
	if factor == 1:
		return
	membrane.density *= factor
	membrane.material.density = membrane.density
	for state in (O.bodies[i].state for i in membrane.ids):
		state.mass *= factor
		state.inertia *= factor


def bendingStiffness(config, radii):
	"""D of the sheet [N m], as configured, or so that it sags over a hollow of the mean grain's radius r by the configured share of r.

	A clamped plate of radius a under the pressure p sags by p a^4/(64 D).

	:param radii: of the grains [m].
	"""
	keys = config.membrane
	if keys.bendingStiffness is not None:
		return keys.bendingStiffness
	return config.consolidation.pressure * float((radii**3).mean()) / (64 * keys.sag)


def sheetEngines(keys, membrane, bending):
	"""The engines of the sheet's own mechanics, as configured: MembraneBonds first; what is off is not made.

	:param keys: configuration's membrane section.
	:param bending: D of the sheet [N m].
	"""
	strengths = {name: value for name in ("tensileStrength", "shearStrength") if (value := getattr(keys, name)) is not None}
	sheet = [
		yade.MembraneBonds(
			membrane=membrane, young=keys.young, thickness=keys.thickness, poisson=keys.poisson, tensionOnly=keys.tensionOnly, **strengths
		)
	]
	if bending > 0:
		sheet.append(yade.MembraneBending(membrane=membrane, stiffness=bending, bonds=sheet[0]))
	if keys.selfContact:
		sheet.append(yade.MembraneSelfContact(membrane=membrane))
	return sheet


def facetEngines(keys, membrane, bonds, own):
	"""The engine that keeps grains from pressing themselves through a stretched mesh, as configured: a list of one or none.

	:param own: what contacts of grains and membrane have of their own, a :class:`hexmembrane.configuration.contacts.PairContact`.
	"""
	stiffness = {"kn": own.normal(membrane.sphereRadius / 2)} if own.stiff else {}
	return [yade.MembraneFacetContact(membrane=membrane, bonds=bonds, **stiffness)] if keys.facets else []


def sheetStep(sheet):
	"""A lower bound of the critical step [s] of the sheet alone: the highest squares of the frequencies of its engines at once."""
	return sum(engine.criticalTimeStep() ** -2 for engine in sheet) ** -0.5


class FlexibleMembrane(LateralBoundary):
	"""Handles: ``membrane``, ``bonds``, ``sheet`` (the engines of :func:`sheetEngines`), ``facets`` (MembraneFacetContact, None when off),
	``pressureEngine`` (MembranePressure), ``radialServo`` (MembraneRadialServo, None without rows beside the platens), ``oRings``."""

	name = "membrane"

	def __init__(self, engines):
		self.bonds = singleEngine(engines, "MembraneBonds")
		others = (optionalEngine(engines, name) for name in ("MembraneBending", "MembraneSelfContact"))
		self.sheet = [self.bonds, *(engine for engine in others if engine)]
		self.facets = optionalEngine(engines, "MembraneFacetContact")
		self.pressureEngine = singleEngine(engines, "MembranePressure")
		self.radialServo = optionalEngine(engines, "MembraneRadialServo")
		self.oRings = singleEngine(engines, "MembraneORings")
		self.membrane = self.bonds.membrane
		self._triangles = numpy.array([tuple(t) for t in self.membrane.triangles])
		self._bonds = numpy.array([tuple(bond) for bond in self.membrane.bonds])
		self._group = numpy.array(self.membrane.groups, dtype=numpy.int32)
		self._endRows = endRows(self.membrane)
		self._moving = [i for i, group in zip(self.membrane.ids, self._group) if group != 1]

	@classmethod
	def make(cls, config, packing):
		return cls.round(config, config.specimen.radius, Soil(packing.radii, packing.radius, config.specimen.height))

	@classmethod
	def round(cls, config, radius, soil):
		"""As :meth:`make`, round any :class:`Soil`; ``radius``: of the specimen as HexMembrane wants it [m]."""
		keys = config.membrane
		smallest, largest = float(soil.radii.min()), float(soil.radii.max())
		membrane = generate(config, radius, soil, keys.particleRadius or keys.sizeRatio * smallest, smallest)
		bending = bendingStiffness(config, soil.radii)
		sheet = sheetEngines(keys, membrane, bending)
		springs = config.specimen.springs, config.springs("membrane")
		unscaled = timestep.membraneStep(*springs, keys.density, largest, membrane.sphereRadius, sheetStep(sheet), config.contacts.grainMembrane)
		scaling = timestep.densityScaling(keys.densityScaling, timestep.grainStep(config.specimen, soil.radii), unscaled)
		scaleDensity(membrane, scaling)

		inertial = timestep.inertialTime(soil.radii, config.specimen.density, config.consolidation.pressure)
		servoTime = keys.servoTime or 4 * inertial
		pressureTime = keys.pressureTime or 10 * inertial

		def engines(bottom, top):
			before = [
				*sheet,
				*facetEngines(keys, membrane, sheet[0], config.contacts.grainMembrane),
				yade.MembranePressure(membrane=membrane, pressure=0.0, surface=keys.surface, timeConstant=pressureTime, maxFactor=keys.maxFactor),
			]
			if 2 in membrane.groups:
				before.append(yade.MembraneRadialServo(membrane=membrane, pressure=0.0, areaRule=keys.areaRule, timeConstant=servoTime, maxFactor=keys.servoMaxFactor))
			return before, [yade.MembraneORings(membrane=membrane, mode=keys.oRings, bottomPlaten=bottom, topPlaten=top)]

		return BoundaryParts(
			engines=engines,
			platenRadius=config.platens.radius or soil.radius,
			overhang=membrane.rings * membrane.ringSpacing - soil.height,
			smallestRadius=membrane.sphereRadius,
			criticalStep=math.sqrt(scaling) * unscaled,
			around={"membrane": membrane},
			log=[
				cls._description(keys, membrane, smallest, bending),
				*cls._scaled(config, soil.radii, membrane, scaling, unscaled),
				*cls._warning(config, soil.radii, bending),
			],
		)

	@staticmethod
	def _description(keys, membrane, smallest, bending):
		radius = membrane.sphereRadius
		return (
			f"membrane: {len(membrane.ids)} spheres of R = {1e3 * radius:.4g} mm in {membrane.rings} rings of {membrane.perRing}, "
			f"R/r = {radius / smallest:.3g} with r = {1e3 * smallest:.4g} mm the smallest grain's radius; "
			f"E t = {keys.young * keys.thickness:.4g} N/m, nu = {keys.poisson:.3g}, D = {bending:.3g} N m"
		)

	@staticmethod
	def _scaled(config, radii, membrane, scaling, unscaled):
		if scaling == 1:
			return []
		mass = len(membrane.ids) * timestep.sphereMass(membrane.sphereRadius, scaling * config.membrane.density)
		share = mass / timestep.sphereMass(radii, config.specimen.density).sum()
		return [
			f"membrane's density times {scaling:.3g}: its critical step is {math.sqrt(scaling) * unscaled:.4g} s instead of {unscaled:.4g} s, its mass "
			f"{100 * share:.2g} % of the grains' instead of {100 * share / scaling:.2g} %; what that does is the column membrane_unbalanced"
		]

	@staticmethod
	def _warning(config, radii, bending):
		"""The rule of a sheet that is too weak for its grains, from what became of tests to 20 % strain (README of pkg/membrane, Weak sheets)."""
		radius, pressure = float((radii**3).mean()) ** (1 / 3), config.consolidation.pressure
		stretched = pressure * radius / (config.membrane.young * config.membrane.thickness)
		sag = pressure * radius**3 / (64 * bending) if bending > 0 else math.inf
		if stretched <= MOST_STRETCHED or sag <= MOST_SAG:
			return []
		bent = f"its bending stiffness lets it sag by {sag:.2g} of a grain" if bending > 0 else "it has no bending stiffness"
		return [
			f"WARNING: pressure times grain radius is {stretched:.2g} of E t (limit {MOST_STRETCHED:g}), and {bent} (limit {MOST_SAG:g}): the membrane may "
			"fold between the grains and turn inside out; fix: leave membrane.bendingStiffness out, or raise membrane.young or thickness"
		]

	@property
	def around(self):
		return {"membrane": self.membrane}

	def movingIds(self):
		return self._moving

	@property
	def pressure(self):
		return self.pressureEngine.pressure

	@property
	def appliedPressure(self):
		return self.pressureEngine.applied

	def setPressure(self, pressure):
		self.pressureEngine.pressure = pressure
		if self.radialServo:
			self.radialServo.pressure = pressure

	def meanRadius(self):
		"""Mean radius [m] of the inner surface for Eq. 6: over the particles of groups 2 and 3, each about its ring's centroid.

		The same rings all along, so that none enters or leaves the mean when a platen passes it.
		"""
		return self.membrane.meanRadius(*self._ends())

	def _ends(self):
		return endHeights(yade.BodyArrays.positions(self._endRows)[:, 2])

	def volume(self, bottom, top):
		return self.membrane.enclosedVolume(bottom, top)

	def endArea(self, face):
		return math.pi * self.membrane.innerRadius**2

	def pressedArea(self, bottom, top):
		return self.pressureEngine.area

	def transmittedPressures(self):
		pressures = self.membrane.transmittedByGroup()
		return pressures if self.radialServo else {**pressures, 2: pressures[3]}

	def saturated(self):
		loops = {"maxFactor": ("main body", self.pressureEngine), "servoMaxFactor": ("rows beside the platens", self.radialServo)}
		working = {key: (part, loop) for key, (part, loop) in loops.items() if loop and loop.saturated}
		return {f"membrane.{key} = {loop.maxFactor:g}: the pressure of the membrane's {part}": atFactor(loop) for key, (part, loop) in working.items()}

	def brokenBonds(self):
		return self.bonds.brokenCount

	def unbalanced(self):
		"""Mean resultant force on the particles of groups 2 and 3, their mass times acceleration, over the confining pressure on a particle's area."""
		membrane, pressure = self.membrane, self.pressure
		force = yade.BodyArrays.forces(self._moving)
		particle = 2 * math.sqrt(3) * membrane.sphereRadius**2
		return float(numpy.linalg.norm(force, axis=1).mean()) / (pressure * particle) if pressure > 0 else 0.0

	def ownLoads(self, bottom, top):
		return membraneLoads(self._ends(), self.sheet, self.pressureEngine, bottom, top)

	def outside(self, ids):
		return self.membrane.outside(ids)

	def addFrequencySquare(self, square):
		square[self.membrane.ids] += (2 / sheetStep(self.sheet)) ** 2
		step = self.facets.criticalTimeStep() if self.facets else math.inf
		if step < math.inf:
			square[[*self.membrane.ids, *self.facets.grains]] += (2 / step) ** 2

	def surface(self, startRadius):
		"""A surface through the centres; arrays: :mod:`hexmembrane.output.vtk`."""
		membrane = self.membrane
		ids, triangles, group = membrane.ids, self._triangles, self._group
		x, u = yade.BodyArrays.positions(ids), yade.BodyArrays.displacements(ids)
		beside = self.radialServo.factor * self.radialServo.pressure if self.radialServo else self.appliedPressure
		points = {
			"id": numpy.array(ids),
			"group": group,
			"radius": numpy.full(len(x), membrane.sphereRadius),
			"velocity": yade.BodyArrays.velocities(ids),
			"displacement": u,
			"normal_displacement": (u * geometry.normals(x - u, triangles)).sum(axis=1),
			"pressure": numpy.where(group == 1, 0.0, numpy.where(group == 2, beside, self.appliedPressure)),
		}
		forces = numpy.array(self.bonds.normalForces())
		cells = sheetState(x, triangles, membrane.perRing, 2 * membrane.sphereRadius, self._bonds, forces)
		cells.update(group=group[triangles].min(axis=1), pressure=points["pressure"][triangles].mean(axis=1))
		return Surface(x, triangles, points, cells)
