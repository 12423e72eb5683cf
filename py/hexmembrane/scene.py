# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE's scene of a test: materials, grains, lateral boundary, platens and the list of engines of its tier; and handles to its parts."""

import math

import yade
from yade import O, utils

from hexmembrane import flexible_membrane, lateral, measure, timestep
from hexmembrane.platens import platen


class Scene:
	"""Handles to the parts of the scene in ``O``, found by their types; make a new one after ``O.load``.

	Attributes: ``lateral`` (the boundary's handles, see :mod:`hexmembrane.lateral`), ``guard``, ``bottom`` and ``top`` (the platens' drives),
	``loop`` (the compact tier's engine, None in the reference tier).

	:raises RuntimeError: the scene in ``O`` is not one of :func:`build`.
	"""

	def __init__(self):
		found = {}
		self.loop = _loop()
		for engine in [*O.engines, *(self.loop.engines if self.loop else ())]:
			found.setdefault(type(engine).__name__, []).append(engine)
		self.lateral = lateral.of(found)
		self.guard = lateral.only(found, "RunawayGuard")
		drives = found.get("PlatenDrive", ())
		if len(drives) != 2:
			raise RuntimeError(f"Scene.engines = {len(drives)} PlatenDrive: 2 expected; fix: load a state saved by this test")
		self.bottom, self.top = sorted(drives, key=lambda drive: -drive.direction[2])
		self._half = [O.bodies[drive.platen].shape.height / 2 for drive in (self.bottom, self.top)]

	def faces(self):
		"""Heights of the bottom and the top platen's face [m]."""
		return O.bodies[self.bottom.platen].state.pos[2] + self._half[0], O.bodies[self.top.platen].state.pos[2] - self._half[1]

	def endArea(self):
		"""Area of the specimen's ends [m2], that the axial stress acts on: the platens' faces, or what a rigid wall leaves of them."""
		return self.lateral.endArea(math.pi * O.bodies[self.top.platen].shape.radius ** 2)

	def approachSpeed(self):
		"""Speed at which the faces approach each other [m/s], compression positive."""
		return O.bodies[self.bottom.platen].state.vel[2] - O.bodies[self.top.platen].state.vel[2]

	def grainIds(self):
		"""Ids of the grains: spheres without the membrane's bit."""
		return [b.id for b in O.bodies if isinstance(b.shape, yade.Sphere) and not b.mask & flexible_membrane.MASK]

	def showContacts(self):
		"""See to it that ``O.interactions`` holds the contacts of the last step, in either tier."""
		if self.loop:
			self.loop.exportContacts()

	def criticalTimeStep(self):
		"""Critical time step [s] of the contacts as they are: the true one in the compact tier, a bound from below in the reference tier."""
		return self.loop.criticalTimeStep() if self.loop else timestep.measured(self)

	def setFriction(self, coefficient):
		"""Give the grains, and the contacts that they have, a coefficient of friction; the lesser of two materials acts."""
		O.materials["grain"].friction = coefficient
		for contact in O.interactions:
			contact.phys.tangensOfFrictionAngle = min(O.bodies[i].material.friction for i in (contact.id1, contact.id2))

	def setPressure(self, pressure):
		"""Give the boundary and the top platen the confining pressure [Pa]."""
		self.lateral.setPressure(pressure)
		self.top.stress = pressure
		# A new target would start the platen's time limit anew: a wall that moves by less than 0.05 % of its radius makes none.
		if abs(self.top.area / self.endArea() - 1) > 1e-3:
			self.top.area = self.endArea()

	def setTimeLimit(self, limit):
		"""Time [s] that each servo has to reach its target once, none without."""
		limit = math.nan if limit is None else limit
		self.top.timeLimit = limit
		self.lateral.setTimeLimit(limit)


def soilRadius(config):
	"""Radius [m] of the cylinder that the grains are packed into, whatever the boundary: the membrane's inner surface as generated.

	'centred' is found by generating the membrane in YADE's empty scene, which is left empty.

	:raises RuntimeError: there are bodies in the scene.
	"""
	if config.membrane.placement == "outside":
		return config.specimen.radius
	_wantEmpty()
	inner = flexible_membrane.generate(config, config.membrane.particleRadius, math.nan).innerRadius
	O.reset()
	return inner


def _wantEmpty():
	if len(O.bodies):
		raise RuntimeError(f"O.bodies = {len(O.bodies)} bodies: an empty scene is needed; fix: O.reset() first, or save the scene and start anew")


def _materials(config):
	given, platens = config.specimen, config.platens
	common = {"emod": given.emod, "kratio": given.kratio, "density": given.density}
	O.materials.append(yade.LinearMat(friction=given.friction, rollingFriction=given.rollingFriction, label="grain", **common))
	O.materials.append(yade.LinearMat(friction=platens.friction, label="platen", **common))


def _platens(config, parts):
	"""Append the two platens; their ids, bottom first."""
	travel = (config.shear.strain + 0.1) * config.specimen.height
	thickness = config.platens.thickness or parts.overhang + travel
	ids = []
	for z, facing in ((0.0, 1), (config.specimen.height, -1)):
		ids.append(O.bodies.append(platen((0, 0, z), parts.platenRadius, thickness, facing=facing, material=O.materials["platen"])))
	return ids


def _loop():
	return next((engine for engine in O.engines if isinstance(engine, yade.CompactLoop)), None)


def _engines(config, inner, smallest):
	"""The list of engines of the configuration's tier round those of boundary and platens, which both tiers share.

	:param smallest: radius of the smallest sphere [m].
	"""
	given = config.numerics
	if config.tier == "compact":
		loop = yade.CompactLoop(engines=inner, damping=given.damping, substeps=given.substeps, skin=given.skin * smallest)
		return [yade.ForceResetter(), loop, yade.RunawayGuard(iterPeriod=1)]
	return [
		yade.ForceResetter(),
		yade.MemoryOrder(),
		yade.InsertionSortCollider(
			[yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb(), yade.Bo1_CylinderWall_Aabb()],
			verletDist=given.verlet * smallest,
			avoidSelfInteractionMask=flexible_membrane.MASK,
		),
		yade.InteractionLoop(
			[
				yade.Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False),
				yade.Ig2_Platen_Sphere_ScGeom(),
				yade.Ig2_CylinderWall_Sphere_ScGeom(),
			],
			[yade.Ip2_LinearMat_LinearMat_LinearPhys()],
			[yade.Law2_ScGeom_LinearPhys_Linear()],
		),
		*inner,
		yade.NewtonIntegrator(damping=given.damping),
		yade.RunawayGuard(),
	]


def setTier(config):
	"""Bring the scene in ``O``, one of :func:`build`, to the configuration's tier; contacts keep their forces and history.

	From the compact tier one step is taken, which writes the contacts.
	"""
	loop = _loop()
	if (loop is not None) == (config.tier == "compact"):
		return
	names = ("MembraneBonds", "MembranePressure", "MembraneRadialServo", "MembraneORings", "RadialWallServo", "PlatenDrive")
	if loop:
		loop.substeps = 1
		O.step()
		loop.exportContacts()
	inner = list(loop.engines) if loop else [engine for engine in O.engines if type(engine).__name__ in names]
	radii = [body.shape.radius for body in O.bodies if isinstance(body.shape, yade.Sphere)]
	O.engines = _engines(config, inner, min(radii))


def build(config, packing, say=print):
	"""Fill YADE's empty scene with the grains of ``packing``, lateral boundary, platens and engines, at the pressure 0; the handles.

	:param config: a checked configuration. :param packing: a packing, see :mod:`hexmembrane.specimen`.
	:param say: takes lines of the log.
	:raises RuntimeError: there are bodies in the scene. :raises ValueError: the membrane is too coarse for the grains, and such.
	"""
	_wantEmpty()
	_materials(config)
	O.bodies.append([utils.sphere(tuple(c), r, material="grain") for c, r in zip(packing.centres.tolist(), packing.radii.tolist())])
	parts = lateral.classes()[config.boundary].make(config, packing)
	bottom, top = _platens(config, parts)
	smallest = float(packing.radii.min())
	before, after = parts.engines(bottom, top)
	drives = [
		yade.PlatenDrive(platen=bottom, direction=(0, 0, 1), mode="velocity", velocity=0.0),
		yade.PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=0.0, area=math.pi * packing.radius**2),
	]
	O.engines = _engines(config, [*before, *drives, *after], min(smallest, parts.smallest))
	O.trackEnergy = config.output.energy
	scene = Scene()
	_setTimeStep(config, timestep.grainStep(config.specimen, smallest), parts, say)
	for line in parts.log:
		say(line)
	grains = measure.Grains.of(scene.grainIds())
	level = timestep.stiffnessLevel(config.specimen.emod, config.consolidation.pressure)
	say(
		f"grains: {len(grains.ids)}, kn/(p d) = {level:.4g} at {1e-3 * config.consolidation.pressure:g} kPa"
		+ ("" if level >= 300 else "; WARNING: below 300 the grains are soft and overlaps are not small; fix: raise specimen.emod")
	)
	return scene


def _setTimeStep(config, grains, parts, say):
	"""Set O.dt; a configured one above the critical of grains or boundary is an error."""
	critical = min(grains, parts.critical)
	asked = config.numerics.dt
	if asked is not None and asked > critical:
		raise ValueError(f"numerics.dt = {asked:g} s: is above the critical time step {critical:.4g} s; fix: lower it or leave it out")
	O.dt = asked or config.numerics.safety * critical
	boundary = f", {config.boundary} {parts.critical:.4g} s" if math.isfinite(parts.critical) else ""
	say(f"time step {O.dt:.4g} s; critical: grains {grains:.4g} s{boundary}")


def checkTimeStep(config, scene, say):
	"""Lower O.dt if the contacts that have formed ask for it by 10 % or more; an explicit one above the critical is an error."""
	critical = scene.criticalTimeStep()
	if config.numerics.dt is not None and config.numerics.dt > critical:
		raise ValueError(
			f"numerics.dt = {config.numerics.dt:g} s: is above the critical time step {critical:.4g} s of the present contacts; "
			"fix: lower it or leave it out"
		)
	allowed = config.numerics.safety * critical
	if config.numerics.dt is None and O.dt > 1.1 * allowed:
		say(f"time step lowered from {O.dt:.4g} s to {allowed:.4g} s: {config.numerics.safety:g} of the critical one of the present contacts")
		O.dt = allowed
