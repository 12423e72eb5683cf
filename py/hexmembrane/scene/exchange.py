# SPDX-License-Identifier: GPL-2.0-or-later
"""From wall to membrane: the rigid wall goes, and a flexible membrane comes round the specimen in its place.

Between spheres of a membrane grains find hollows, which a wall does not have. The grains therefore stand still until the sheet bears on them with the pressure
that the wall had: their places, contacts and shear forces stay, and nothing falls into the hollows.
"""

import yade
from yade import BodyArrays, O

from hexmembrane.scene import builder
from hexmembrane.scene.flexible_membrane import FlexibleMembrane, Soil

_ALL = "xyzXYZ"


class Held:
	"""Grains and platens that stand still; :meth:`release` lets them go on as they moved before.

	:param scene: the :class:`hexmembrane.scene.handles.Scene`.
	"""

	def __init__(self, scene):
		self._motions = [(i, O.bodies[i].state.vel, O.bodies[i].state.angVel) for i in scene.grainIds()]
		for i, *_ in self._motions:
			state = O.bodies[i].state
			state.blockedDOFs, state.vel, state.angVel = _ALL, (0, 0, 0), (0, 0, 0)
		scene.topDrive.mode, scene.topDrive.velocity = "velocity", 0.0

	def release(self, scene):
		"""Let the grains move, and the top platen hold its stress; ``scene``: the handles of the scene as it is now."""
		for i, velocity, spin in self._motions:
			state = O.bodies[i].state
			state.blockedDOFs, state.vel, state.angVel = "", velocity, spin
		scene.topDrive.mode = "stress"


def putMembrane(config, scene, say):
	"""Take the wall of the scene in ``O`` away and put a membrane at its radius, between the platens' faces, with no pressure on it yet.

	:param scene: the :class:`hexmembrane.scene.handles.Scene`, of no use afterwards.
	:param say: takes lines of the log.
	:raises ValueError: the membrane is too coarse, or ``numerics.dt`` is above its critical step.
	"""
	wall, (bottom, top) = scene.lateralBoundary, scene.faces()
	x, y, _ = wall.axis
	soil = Soil(BodyArrays.radii(scene.grainIds()), wall.shape.radius, top - bottom, (x, y, bottom))
	parts = FlexibleMembrane.round(config, soil.radius, soil)
	builder.lowerTimeStep(config, parts.criticalStep, say)
	platens = [drive.platen for drive in (scene.bottomDrive, scene.topDrive)]
	for i in platens:
		O.bodies[i].shape.radius = parts.platenRadius
	before, after = parts.engines(*platens)
	measure = yade.SoilMeasure(bottomPlaten=platens[0], topPlaten=platens[1], **parts.around)
	servos = [scene.axialServo] if scene.axialServo else []
	for servo in servos:
		servo.measure = measure
	servos += builder.radialServo(config, soil.radii, measure, before)
	cement = [scene.cement] if scene.cement else []
	inner = [*cement, *servos, *before, scene.bottomDrive, scene.topDrive, *after]
	smallest = min(float(soil.radii.min()), parts.smallestRadius)
	if scene.loop:
		scene.loop.engines, scene.loop.skin = inner, config.numerics.skin * smallest
	else:
		O.engines = builder.engines(config, inner, smallest)
	O.bodies.erase(wall.servo.wall)
	for line in parts.log:
		say(line)
