# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE's scene of a test: materials, grains, membrane, platens and the list of engines; and handles to its parts.

Masks: grains and platens carry bit 1, membrane spheres bits 1 and 2, and the collider leaves out pairs that share bit 2: the
membrane meets grains and platens but not itself.
"""

import math

import yade
from yade import O, utils

from hexmembrane import measure, timestep
from hexmembrane.platens import platen

_MEMBRANE_BIT = 2


class Scene:
	"""Handles to the parts of the scene in ``O``, found by their types; make a new one after ``O.load``.

	Attributes: ``membrane``, ``bonds``, ``pressure``, ``servo``, ``oRings``, ``guard``, ``bottom`` and ``top`` (the platens' drives).

	:raises RuntimeError: the scene in ``O`` is not one of :func:`build`.
	"""

	def __init__(self):
		found = {}
		for engine in O.engines:
			found.setdefault(type(engine).__name__, []).append(engine)
		wanted = {"MembraneBonds": 1, "MembranePressure": 1, "MembraneRadialServo": 1, "MembraneORings": 1, "RunawayGuard": 1, "PlatenDrive": 2}
		for name, count in wanted.items():
			if len(found.get(name, ())) != count:
				raise RuntimeError(
					f"Scene.engines = {len(found.get(name, ()))} {name}: {count} expected; fix: load a state saved by this test"
				)
		self.bonds, self.pressure, self.servo, self.oRings, self.guard = (found[name][0] for name in list(wanted)[:5])
		self.membrane = self.bonds.membrane
		self.bottom, self.top = sorted(found["PlatenDrive"], key=lambda drive: -drive.direction[2])
		self._half = [O.bodies[drive.platen].shape.height / 2 for drive in (self.bottom, self.top)]

	def faces(self):
		"""Heights of the bottom and the top platen's face [m]."""
		return O.bodies[self.bottom.platen].state.pos[2] + self._half[0], O.bodies[self.top.platen].state.pos[2] - self._half[1]

	def platenArea(self):
		"""Area of a platen's face [m2]."""
		return math.pi * O.bodies[self.top.platen].shape.radius ** 2

	def approachSpeed(self):
		"""Speed at which the faces approach each other [m/s], compression positive."""
		return O.bodies[self.bottom.platen].state.vel[2] - O.bodies[self.top.platen].state.vel[2]

	def grainIds(self):
		"""Ids of the grains: spheres without the membrane's bit."""
		return [b.id for b in O.bodies if isinstance(b.shape, yade.Sphere) and not b.mask & _MEMBRANE_BIT]

	def setFriction(self, coefficient):
		"""Give the grains, and the contacts that they have, a coefficient of friction; the lesser of two materials acts."""
		O.materials["grain"].frictionAngle = math.atan(coefficient)
		for contact in O.interactions:
			angles = [O.bodies[i].material.frictionAngle for i in (contact.id1, contact.id2)]
			contact.phys.tangensOfFrictionAngle = math.tan(min(angles))

	def setPressure(self, pressure):
		"""Give membrane, servo and top platen the confining pressure [Pa]."""
		self.pressure.pressure = pressure
		self.servo.pressure = pressure
		self.top.stress = pressure


def _membrane(config, particleRadius, smallest, material):
	"""A membrane as configured, not generated yet."""
	given = config.membrane
	return yade.HexMembrane(
		specimenRadius=config.specimen.radius,
		specimenHeight=config.specimen.height,
		particleRadius=particleRadius,
		placement=given.placement,
		oRingRows=given.oRingRows,
		platenRows=given.platenRows,
		density=given.density,
		material=material,
		smallestGrain=smallest,
		mask=1 | _MEMBRANE_BIT,
		rotations=timestep.bondStiffness(given.young, given.thickness, given.poisson)[1] > 0,
	)


def soilRadius(config):
	"""Radius [m] of the cylinder that the grains are packed into: the membrane's inner surface as it will be generated.

	'centred' is found by generating the membrane in YADE's empty scene, which is left empty.

	:raises RuntimeError: there are bodies in the scene.
	"""
	if config.membrane.placement == "outside":
		return config.specimen.radius
	_wantEmpty()
	material = yade.FrictMat(label="membrane")
	O.materials.append(material)
	membrane = _membrane(config, config.membrane.particleRadius, math.nan, material)
	membrane.generate()
	inner = membrane.innerRadius
	O.reset()
	return inner


def _wantEmpty():
	if len(O.bodies):
		raise RuntimeError(f"O.bodies = {len(O.bodies)} bodies: an empty scene is needed; fix: O.reset() first, or save the scene and start anew")


def _materials(config):
	grain = config.specimen
	made = {
		"grain": (grain.density, grain.friction),
		"platen": (grain.density, config.platens.friction),
		"membrane": (config.membrane.density, 0.0),
	}
	for label, (density, friction) in made.items():
		O.materials.append(
			yade.FrictMat(young=grain.emod, poisson=1 / grain.kratio, frictionAngle=math.atan(friction), density=density, label=label)
		)


def _platens(config, membrane, radius):
	"""Append the two platens; their ids, bottom first."""
	travel = (config.shear.strain + 0.1) * config.specimen.height
	thickness = config.platens.thickness or (membrane.rings * membrane.ringSpacing - config.specimen.height) + travel
	ids = []
	for z, facing in ((0.0, 1), (config.specimen.height, -1)):
		ids.append(O.bodies.append(platen((0, 0, z), radius, thickness, facing=facing, material=O.materials["platen"])))
	return ids


def build(config, packing, say=print):
	"""Fill YADE's empty scene with the grains of ``packing``, membrane, platens and engines, at the pressure 0; the handles.

	:param config: a checked configuration. :param packing: a packing, see :mod:`hexmembrane.specimen`.
	:param say: takes lines of the log.
	:raises RuntimeError: there are bodies in the scene. :raises ValueError: the membrane is too coarse for the grains, and such.
	"""
	_wantEmpty()
	_materials(config)
	radii = packing.radii
	smallest, largest = float(min(radii)), float(max(radii))
	wished = config.membrane.particleRadius or config.membrane.sizeRatio * smallest
	membrane = _membrane(config, wished, smallest, O.materials["membrane"])
	O.bodies.append([utils.sphere(tuple(c), r, material="grain") for c, r in zip(packing.centres.tolist(), radii.tolist())])
	membrane.generate()
	bottom, top = _platens(config, membrane, packing.radius)
	kn, ks = timestep.bondStiffness(config.membrane.young, config.membrane.thickness, config.membrane.poisson)
	particleRadius = membrane.sphereRadius
	given = config.membrane
	O.engines = [
		yade.ForceResetter(),
		yade.InsertionSortCollider(
			[yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb()],
			verletDist=config.numerics.verlet * min(smallest, particleRadius),
			avoidSelfInteractionMask=_MEMBRANE_BIT,
		),
		yade.InteractionLoop(
			[yade.Ig2_Sphere_Sphere_ScGeom(), yade.Ig2_Platen_Sphere_ScGeom()],
			[yade.Ip2_FrictMat_FrictMat_FrictPhys()],
			[yade.Law2_ScGeom_FrictPhys_CundallStrack()],
		),
		yade.MembraneBonds(membrane=membrane, kn=kn, ks=ks, tensionOnly=given.tensionOnly),
		yade.MembranePressure(membrane=membrane, pressure=0.0, surface=given.surface),
		yade.MembraneRadialServo(membrane=membrane, pressure=0.0, areaRule=given.areaRule, gain=given.gain),
		yade.PlatenDrive(platen=bottom, direction=(0, 0, 1), mode="velocity", velocity=0.0),
		yade.PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=0.0, area=math.pi * packing.radius**2),
		yade.MembraneORings(membrane=membrane, mode=given.oRings, bottomPlaten=bottom, topPlaten=top),
		yade.NewtonIntegrator(damping=config.numerics.damping),
		yade.RunawayGuard(),
	]
	scene = Scene()
	_setTimeStep(config, smallest, largest, particleRadius, say)
	grains = measure.Grains.of(scene.grainIds())
	say(
		f"membrane: {len(membrane.ids)} spheres of R = {1e3 * particleRadius:.4g} mm in {membrane.rings} rings of {membrane.perRing}, "
		f"R/r = {particleRadius / smallest:.3g} with r = {1e3 * smallest:.4g} mm the smallest grain's radius; "
		f"E t = {given.young * given.thickness:.4g} N/m, bonds kn = {kn:.4g}, ks = {ks:.4g} N/m"
	)
	sag = config.consolidation.pressure * grains.meanDiameter / 2 / (given.young * given.thickness)
	if sag > 0.5:
		say(
			f"WARNING: pressure times grain radius is {sag:.2g} of E t: the membrane will sag deep between the grains and may fold; "
			"fix: raise membrane.young or membrane.thickness"
		)
	level = config.specimen.emod / (2 * config.consolidation.pressure)
	say(
		f"grains: {len(grains.ids)}, kn/(p d) = {level:.4g} at {1e-3 * config.consolidation.pressure:g} kPa"
		+ ("" if level >= 300 else "; WARNING: below 300 the grains are soft and overlaps are not small; fix: raise specimen.emod")
	)
	return scene


def _setTimeStep(config, smallest, largest, particleRadius, say):
	"""Set O.dt; a configured one above the critical is an error."""
	critical = timestep.estimate(config.specimen, config.membrane, smallest, largest, particleRadius)
	asked = config.numerics.dt
	if asked is not None and asked > min(critical):
		raise ValueError(
			f"numerics.dt = {asked:g} s: is above the critical time step {min(critical):.4g} s; fix: lower it or leave it out"
		)
	O.dt = asked or config.numerics.safety * min(critical)
	say(f"time step {O.dt:.4g} s; critical: grains {critical[0]:.4g} s, membrane {critical[1]:.4g} s")


def checkTimeStep(config, scene, say):
	"""Lower O.dt if the contacts that have formed ask for it by 10 % or more; an explicit one above the critical is an error."""
	critical = timestep.measured(scene)
	if config.numerics.dt is not None and config.numerics.dt > critical:
		raise ValueError(
			f"numerics.dt = {config.numerics.dt:g} s: is above the critical time step {critical:.4g} s of the present contacts; "
			"fix: lower it or leave it out"
		)
	allowed = config.numerics.safety * critical
	if config.numerics.dt is None and O.dt > 1.1 * allowed:
		say(f"time step lowered from {O.dt:.4g} s to {allowed:.4g} s: {config.numerics.safety:g} of the critical one of the present contacts")
		O.dt = allowed
