# SPDX-License-Identifier: GPL-2.0-or-later
"""Handles to the parts of a test's scene in ``O``, found by their types."""

import math

import numpy
import yade
from yade import O

from hexmembrane.scene import boundaries, timestep
from hexmembrane.scene.flexible_membrane import MASK
from hexmembrane.scene.lateral_boundary import atFactor, optionalEngine, singleEngine


class Scene:
	"""Handles to the parts of the scene in ``O``; make a new one after ``O.load``.

	Attributes: ``lateralBoundary`` (a :class:`hexmembrane.scene.lateral_boundary.LateralBoundary`), ``guard`` (RunawayGuard, None without),
	``bottomDrive`` and ``topDrive`` (the PlatenDrive of each end platen), ``axialServo`` and ``radialServo`` (SoilStressServo, None where the platen's force or the transmitted pressure is held),
	``cement`` (the GrainBonds between grains, None without), ``measure`` (a SoilMeasure), ``loop`` (the compact tier's engine, None in the reference tier).

	A scene of one's own will do. What it needs: two PlatenDrive, and either a RadialWallServo, or one each of MembraneBonds, MembranePressure and
	MembraneORings; in ``O.engines``, or in those of a CompactLoop. Grains have masks without the membrane's bit 2.

	:raises RuntimeError: some of it is missing.
	"""

	def __init__(self):
		self.loop = compactLoop()
		byType = {}
		for engine in [*O.engines, *(self.loop.engines if self.loop else ())]:
			byType.setdefault(type(engine).__name__, []).append(engine)
		self.lateralBoundary = boundaries.ofEngines(byType)
		self.guard = optionalEngine(byType, "RunawayGuard")
		drives = byType.get("PlatenDrive", ())
		if len(drives) != 2:
			raise RuntimeError(f"Scene.engines = {len(drives)} PlatenDrive: 2 expected; fix: one for each end platen")
		self.bottomDrive, self.topDrive = sorted(drives, key=lambda drive: -drive.direction[2])
		servos = byType.get("SoilStressServo", ())
		self.axialServo = next((servo for servo in servos if servo.drive), None)
		self.radialServo = next((servo for servo in servos if servo.pressure), None)
		self.cement = next(iter(byType.get("GrainBonds", ())), None)
		self.measure = yade.SoilMeasure(bottomPlaten=self.bottomDrive.platen, topPlaten=self.topDrive.platen, **self.lateralBoundary.around)
		self._half = [O.bodies[drive.platen].shape.height / 2 for drive in (self.bottomDrive, self.topDrive)]

	def faces(self):
		"""Heights of the bottom and the top platen's face [m]."""
		bottom, top = (O.bodies[drive.platen].state.pos[2] for drive in (self.bottomDrive, self.topDrive))
		return bottom + self._half[0], top - self._half[1]

	def endArea(self):
		"""Area of the specimen's ends [m2], that the axial stress acts on: the platens' faces, or what a rigid wall leaves of them."""
		return self.lateralBoundary.endArea(math.pi * O.bodies[self.topDrive.platen].shape.radius ** 2)

	def approachSpeed(self):
		"""Speed at which the faces approach each other [m/s], compression positive."""
		return O.bodies[self.bottomDrive.platen].state.vel[2] - O.bodies[self.topDrive.platen].state.vel[2]

	def grainIds(self):
		"""Ids of the grains: spheres without the membrane's bit."""
		return [b.id for b in O.bodies if isinstance(b.shape, yade.Sphere) and not b.mask & MASK]

	def addCement(self, bonds):
		"""Have an engine of bonds act, before all that measures."""
		self.cement = bonds
		if self.loop:
			self.loop.engines = [bonds, *self.loop.engines]
			return
		before = next(k for k, engine in enumerate(O.engines) if isinstance(engine, yade.InteractionLoop)) + 1
		O.engines = [*O.engines[:before], bonds, *O.engines[before:]]

	def exportContacts(self):
		"""See to it that ``O.interactions`` holds the contacts of the last step, in either tier."""
		if self.loop:
			self.loop.exportContacts()

	def criticalTimeStep(self):
		"""Critical time step [s] of central differences, 2/omega, for the contacts and bonds that there are now.

		omega is the highest frequency of the linearised system, rotations included, with every contact that can carry shear taken as
		sticking. Forces' own stiffness (a force times a rotation of its line of action) is left out in both tiers.

		* Compact tier: 2/omega itself, by power iteration. The iteration ends at a relative change of 1e-4 and comes from above.
		* Reference tier: a lower bound of 2/omega, see :func:`hexmembrane.scene.timestep.contactStep`.
		"""
		if self.loop:
			return self.loop.criticalTimeStep()
		square = numpy.zeros(len(O.bodies))
		self.lateralBoundary.addFrequencySquare(square)
		return timestep.contactStep(*_springs(self.cement), *_masses(), square)

	def setFriction(self, grains, platens, pairs=None):
		"""Give the grains and the platens, and the contacts that they have, coefficients of friction; the lesser of two materials acts.

		:param pairs: {(label, label): the friction of this pair's contacts instead, None: the lesser}; None: pairs stay as they are.
		"""
		O.materials["grain"].friction = grains
		O.materials["platen"].friction = platens
		for (one, other), friction in (pairs or {}).items():
			_setPairFriction(one, other, friction)
		for contact in O.interactions:
			one, other = (O.bodies[i].material for i in (contact.id1, contact.id2))
			contact.phys.tangensOfFrictionAngle = one.pairFriction(other)

	def setPressure(self, pressure):
		"""Give the lateral boundary and the top platen the confining pressure [Pa]."""
		for servo in (self.axialServo, self.radialServo):
			if servo:
				servo.stress = pressure
		self.lateralBoundary.setPressure(pressure * (self.radialServo.factor if self.radialServo else 1))
		self.topDrive.stress = pressure * (self.axialServo.factor if self.axialServo else 1)
		# A new target would start the platen's time limit anew: a wall that moves by less than 0.05 % of its radius makes none.
		if abs(self.topDrive.area / self.endArea() - 1) > 1e-3:
			self.topDrive.area = self.endArea()

	@property
	def pressure(self):
		"""Confining pressure asked for [Pa]."""
		return self.radialServo.stress if self.radialServo else self.lateralBoundary.pressure

	def consolidateAgain(self):
		"""After a shear: the bottom platen stands, the top one holds its stress, and the membrane's pressure follows the soil's radial stress again."""
		self.bottomDrive.mode, self.bottomDrive.velocity = "velocity", 0.0
		self.topDrive.mode = "stress"
		for drive in (self.bottomDrive, self.topDrive):
			drive.rampTime = 0.0
		if self.radialServo:
			self.radialServo.dead = False

	def saturated(self):
		"""The closed loops that stand at a limit, of the lateral boundary and on the soil, as :meth:`hexmembrane.scene.lateral_boundary.LateralBoundary.saturated`."""
		loops = {"axial": self.axialServo, "radial": self.radialServo}
		working = {name: loop for name, loop in loops.items() if loop and loop.saturated and not loop.dead and (name == "radial" or self.topDrive.mode == "stress")}
		own = {f"consolidation.maxFactor = {loop.maxFactor:g}: the load that gives the soil its {name} stress": atFactor(loop) for name, loop in working.items()}
		return {**self.lateralBoundary.saturated(), **own}

	def holdRadialLoad(self):
		"""Leave the membrane's pressure at what has brought the soil's radial stress to its target: from here on the transmitted pressure is held."""
		if self.radialServo:
			self.radialServo.dead = True

	def tellCheckpoint(self, file):
		"""Have the guard, if there is one, name this file when it stops a run."""
		if self.guard:
			self.guard.checkpoint = str(file)

	def setTimeLimit(self, limit):
		"""Time [s] that each servo has to reach its target once, none without."""
		limit = math.nan if limit is None else limit
		(self.axialServo or self.topDrive).timeLimit = limit
		self.lateralBoundary.setTimeLimit(limit)


def _setPairFriction(owner, partner, friction):
	"""Give contacts of two materials, by their labels, a friction of their own, None: none."""
	material = O.materials[owner]
	before = material.pairs().get(partner, {})
	own = {name: value for name, value in before.items() if name != "friction"}
	if friction is not None:
		own["friction"] = friction
	if own:
		material.setPair(partner, **own)
	elif before:
		material.removePair(partner)


def compactLoop():
	"""The compact tier's engine in ``O``, None in the reference tier."""
	return next((engine for engine in O.engines if isinstance(engine, yade.CompactLoop)), None)


def _springs(cement):
	"""The contacts in ``O`` and the bonds as :func:`hexmembrane.scene.timestep.contactStep` takes them: pairs, normals, stiffness, arms."""
	radii = numpy.zeros(len(O.bodies))
	for body in O.bodies:
		if isinstance(body.shape, yade.Sphere):
			radii[body.id] = body.shape.radius
	pairs, normals, stiffness = [], [], []
	for contact in O.interactions:
		phys = contact.phys
		shear = phys.ks if phys.tangensOfFrictionAngle > 0 or phys.bonded else 0.0
		pairs.append((contact.id1, contact.id2))
		normals.append(tuple(contact.geom.normal))
		stiffness.append((phys.kn, shear, phys.kr, 0.0))
	pairs = numpy.array(pairs, dtype=int).reshape(-1, 2)
	found = pairs, numpy.array(normals).reshape(-1, 3), numpy.array(stiffness).reshape(-1, 4), radii[pairs]
	return [numpy.concatenate(parts) for parts in zip(found, cement.springs())] if cement else found


def _masses():
	"""Mass and moment of inertia of each body, inf for what does not move or turn, or is gone."""
	mass, inertia = numpy.full((2, len(O.bodies)), math.inf)
	for body in O.bodies:
		blocked = set(body.state.blockedDOFs) if body.dynamic else set("xyzXYZ")
		if not set("xyz") <= blocked:
			mass[body.id] = body.state.mass
		if not set("XYZ") <= blocked:
			inertia[body.id] = min(body.state.inertia)
	return mass, inertia
