# SPDX-License-Identifier: GPL-2.0-or-later
"""Builds YADE's scene of a test: materials, grains, lateral boundary, end platens and the list of engines of its tier; sets its time step."""

import dataclasses
import math

import yade
from yade import O, utils

from hexmembrane.configuration.stages import boundaries
from hexmembrane.scene import timestep
from hexmembrane.scene.boundaries import CLASSES
from hexmembrane.scene.flexible_membrane import MASK, WIDE, overhang, wide
from hexmembrane.scene.handles import Scene, compactLoop
from hexmembrane.scene.platens import platen


def _wantEmpty():
	if len(O.bodies):
		raise RuntimeError(f"O.bodies = {len(O.bodies)} bodies: an empty scene is needed; fix: O.reset() first, or save the scene and start anew")


def _materials(config):
	grain, platens = config.specimen, config.platens
	O.materials.append(
		yade.LinearMat(friction=grain.friction, rollingFriction=grain.rollingFriction, density=grain.density, label="grain", **grain.springs.given())
	)
	O.materials.append(yade.LinearMat(friction=platens.friction, density=grain.density, label="platen", **config.springs("platens").given()))
	for (one, other), pair in config.contacts.pairs().items():
		if pair.given():
			O.materials[one].setPair(other, **pair.given())


def _raiseMasses(config, ids, radii, say):
	"""Give the grains the masses of ``specimen.massScaling``; the material keeps the grains' true density."""
	factors = timestep.massFactors(radii, config.specimen.springs.direct)
	for state, factor in zip((O.bodies[i].state for i in ids), factors.tolist()):
		state.mass *= factor
		state.inertia *= factor
	steps = [timestep.grainStep(dataclasses.replace(config.specimen, massScaling=raised), radii) for raised in (True, False)]
	say(
		f"grains' mass times {timestep.meanMassFactor(radii, config.specimen.springs.direct):.3g}, {factors.max():.3g} for the smallest: their "
		f"critical step is {steps[0]:.4g} s instead of {steps[1]:.4g} s"
	)


def _platens(config, parts, laterOverhang):
	"""Append the two platens; their ids, bottom first.

	:param laterOverhang: how far the boundary that takes the present one's place will reach beyond the specimen, both ends together [m]; 0: none does.
	"""
	travel = (config.shear.strain + 0.1) * config.specimen.height
	thickness = config.platens.thickness or max(parts.overhang, laterOverhang) + travel
	ids = []
	for z, facing in ((0.0, 1), (config.specimen.height, -1)):
		made = platen((0, 0, z), parts.platenRadius, thickness, facing=facing, material=O.materials["platen"], mask=WIDE if wide(config) else 1)
		ids.append(O.bodies.append(made))
	return ids


def boxes():
	"""The reference tier's functors of bounding boxes."""
	return [yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb(), yade.Bo1_CylinderWall_Aabb()]


def interactionLoop():
	"""The reference tier's InteractionLoop, for spheres, platens and cylinder walls of LinearMat."""
	return yade.InteractionLoop(
		[
			yade.Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False),
			yade.Ig2_Platen_Sphere_ScGeom(),
			yade.Ig2_CylinderWall_Sphere_ScGeom(),
		],
		[yade.Ip2_LinearMat_LinearMat_LinearPhys()],
		[yade.Law2_ScGeom_LinearPhys_Linear()],
	)


def engines(config, inner, smallest):
	"""The list of engines of the configuration's tier round those of lateral boundary and end platens, which both tiers share.

	:param smallest: radius of the smallest sphere [m].
	"""
	numerics = config.numerics
	if config.tier == "compact":
		loop = yade.CompactLoop(engines=inner, damping=numerics.damping, substeps=numerics.substeps, skin=numerics.skin * smallest)
		return [yade.ForceResetter(), loop, yade.RunawayGuard(iterPeriod=1)]
	return [
		yade.ForceResetter(),
		yade.MemoryOrder(),
		yade.InsertionSortCollider(
			boxes(),
			verletDist=numerics.verlet * smallest,
			avoidSelfInteractionMask=MASK,
		),
		interactionLoop(),
		*inner,
		yade.NewtonIntegrator(damping=numerics.damping),
		yade.RunawayGuard(),
	]


def setTier(config):
	"""Bring the scene in ``O``, one of :func:`build`, to the configuration's tier; contacts keep their forces and history.

	From the compact tier one step is taken, which writes the contacts.
	"""
	loop = compactLoop()
	if (loop is not None) == (config.tier == "compact"):
		return
	if loop:
		loop.substeps = 1
		O.step()
		loop.exportContacts()
	inner = list(loop.engines) if loop else [engine for engine in O.engines if yade.CompactLoop.canStep(engine)]
	radii = [body.shape.radius for body in O.bodies if isinstance(body.shape, yade.Sphere)]
	O.engines = engines(config, inner, min(radii))


def build(config, packing, say=print):
	"""Fill YADE's empty scene with the grains of ``packing``, lateral boundary, platens and engines, at the pressure 0; the handles.

	:param config: a checked configuration.
	:param packing: a packing, see :class:`hexmembrane.scene.packing_file.Packing`.
	:param say: takes lines of the log.
	:raises RuntimeError: there are bodies in the scene.
	:raises ValueError: the membrane is too coarse for the grains, and such.
	"""
	_wantEmpty()
	_materials(config)
	mask = 1 | WIDE if wide(config) else 1
	grains = O.bodies.append([utils.sphere(tuple(c), r, material="grain", mask=mask) for c, r in zip(packing.centres.tolist(), packing.radii.tolist())])
	if config.specimen.massScaling:
		_raiseMasses(config, grains, packing.radii, say)
	parts = CLASSES[config.boundary].make(config, packing)
	later = "membrane" in boundaries(config) and config.boundary == "wall"
	bottom, top = _platens(config, parts, overhang(config.membrane, float(packing.radii.min())) if later else 0.0)
	smallest = float(packing.radii.min())
	before, after = parts.engines(bottom, top)
	drives = [
		yade.PlatenDrive(platen=bottom, direction=(0, 0, 1), mode="velocity", velocity=0.0),
		yade.PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=0.0, area=math.pi * packing.radius**2),
	]
	measure = yade.SoilMeasure(bottomPlaten=bottom, topPlaten=top, **parts.around)
	servos = [*_axialServo(config, packing.radii, measure, drives[1]), *radialServo(config, packing.radii, measure, before)]
	O.engines = engines(config, [*servos, *before, *drives, *after], min(smallest, parts.smallestRadius))
	O.trackEnergy = config.output.energy
	scene = Scene()
	_setTimeStep(config, timestep.grainsStep(config, packing.radii), parts, say)
	for line in parts.log:
		say(line)
	level = timestep.levelOf(config.specimen.springs, packing.radii, config.consolidation.pressure)
	say(
		f"grains: {len(packing.radii)}, kn/(p d) = {level:.4g} at {1e-3 * config.consolidation.pressure:g} kPa"
		+ ("" if level >= 300 else f"; WARNING: below 300 the grains are soft and overlaps are not small, see the error budget; fix: raise {config.specimen.stiffnessKey}")
	)
	return scene


def _axialServo(config, radii, measure, drive):
	"""The engine that closes the top platen's stress on the soil's own, where that is asked for: a list of one or none."""
	keys = config.consolidation
	if keys.axial != "soil":
		return []
	time = keys.stressTime or 5 * timestep.inertialTime(radii, config.specimen.density, keys.pressure)
	return [yade.SoilStressServo(measure=measure, drive=drive, stress=0.0, timeConstant=time, maxFactor=keys.maxFactor)]


def radialServo(config, radii, measure, lateral):
	"""The engine that closes the membrane's pressure on the soil's own stress, where that is asked for and there is a membrane: a list of one or none.

	:param radii: of the grains [m]. :param measure: the SoilMeasure. :param lateral: engines of the lateral boundary.
	"""
	keys, byName = config.consolidation, {type(engine).__name__: engine for engine in lateral}
	closed = config.membrane.pressureTime != math.inf
	if "MembranePressure" not in byName or (keys.radial or ("soil" if closed else "transmitted")) != "soil":
		return []
	loads = {"pressure": byName["MembranePressure"], "beside": byName.get("MembraneRadialServo")}
	time = keys.stressTime or 10 * timestep.inertialTime(radii, config.specimen.density, keys.pressure)
	return [yade.SoilStressServo(measure=measure, stress=0.0, timeConstant=time, maxFactor=keys.maxFactor, **loads)]


def _setTimeStep(config, grains, parts, say):
	"""Set O.dt; a configured one above the critical of grains or boundary is an error."""
	critical = min(grains, parts.criticalStep)
	asked = config.numerics.dt
	if asked is not None and asked > critical:
		raise ValueError(f"numerics.dt = {asked:g} s: is above the critical time step {critical:.4g} s; fix: lower it or leave it out")
	O.dt = asked or config.numerics.safety * critical
	boundary = f", {config.boundary} {parts.criticalStep:.4g} s" if math.isfinite(parts.criticalStep) else ""
	say(f"time step {O.dt:.4g} s; critical: grains {grains:.4g} s{boundary}")


def lowerTimeStep(config, critical, say):
	"""Lower O.dt for a part that comes later, with this critical step [s]; an explicit one above it is an error."""
	if config.numerics.dt is not None and config.numerics.dt > critical:
		raise ValueError(f"numerics.dt = {config.numerics.dt:g} s: is above the critical time step {critical:.4g} s of what comes; fix: lower it or leave it out")
	allowed = config.numerics.safety * critical
	if config.numerics.dt is None and O.dt > allowed:
		say(f"time step lowered from {O.dt:.4g} s to {allowed:.4g} s")
		O.dt = allowed


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
