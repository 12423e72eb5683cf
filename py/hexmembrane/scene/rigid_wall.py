# SPDX-License-Identifier: GPL-2.0-or-later
"""The rigid cylinder wall as a test's lateral boundary."""

import math

import numpy
import yade
from yade import O

from hexmembrane.scene.lateral_boundary import BoundaryParts, LateralBoundary, Surface, singleEngine

#: Platens' radius over the specimen's: they reach under the wall's rim, so that a specimen that widens stays between them.
_PLATENS = 1.5
#: The fastest that the radius widens in shear, over R/2 times the axial strain rate, which is what it takes at constant volume.
_HEADROOM = 4
#: Strips of the wall's picture round the circumference and along the height.
_STRIPS, _ROWS = 72, 24


class RigidWall(LateralBoundary):
	"""Handles: ``servo`` (RadialWallServo), ``shape`` (the CylinderWall), ``axis`` (its centre)."""

	name = "wall"

	def __init__(self, engines):
		self.servo = singleEngine(engines, "RadialWallServo")
		body = O.bodies[self.servo.wall]
		self.shape, self.axis = body.shape, body.state.pos

	@classmethod
	def make(cls, config, packing):
		"""A wall as wide as the packing; it reaches half the specimen's height beyond each end, so that no grain meets an end of it."""
		keys, grain, height = config.wall, config.specimen, config.specimen.height
		O.materials.append(
			yade.LinearMat(friction=keys.friction, density=grain.density, label="wall", **config.springs("wall").given())
		)
		body = yade.Body()
		body.shape = yade.CylinderWall(radius=packing.radius, height=2 * height)
		body.state.pos = body.state.refPos = (0, 0, height / 2)
		body.material = O.materials["wall"]
		body.dynamic = False
		wall = O.bodies.append(body)

		def engines(bottom, top):
			servo = yade.RadialWallServo(
				wall=wall, stress=0.0, bottomPlaten=bottom, topPlaten=top, damping=keys.damping, tolerance=keys.tolerance
			)
			return [], [servo]

		return BoundaryParts(
			engines=engines,
			platenRadius=config.platens.radius or _PLATENS * packing.radius,
			overhang=0.0,
			smallestRadius=math.inf,
			criticalStep=math.inf,
			around={"wall": wall},
			log=[f"rigid wall: radius {1e3 * packing.radius:.4g} mm, friction {keys.friction:g}"],
		)

	@property
	def around(self):
		return {"wall": self.servo.wall}

	@property
	def pressure(self):
		return self.servo.stress

	@property
	def appliedPressure(self):
		return self.servo.stress

	def setPressure(self, pressure):
		self.servo.stress = pressure

	def setMaxVelocity(self, speed):
		self.servo.maxVelocity = speed

	def allowStraining(self, rate):
		self.servo.maxRetreat = max(self.servo.maxVelocity, _HEADROOM * rate * self.shape.radius / 2)

	def saturated(self):
		if not self.servo.atLimit:
			return {}
		return {"wall.maxVelocity: the wall": (f"moves as fast as it may, {abs(self.servo.velocity):.3g} m/s", "softer grains, a larger wall.maxVelocity, or a slower test")}

	def setTimeLimit(self, limit):
		self.servo.timeLimit = limit

	def meanRadius(self):
		return self.shape.radius

	def volume(self, bottom, top):
		return math.pi * self.shape.radius**2 * (top - bottom)

	def endArea(self, face):
		return math.pi * self.shape.radius**2

	def pressedArea(self, bottom, top):
		return 2 * math.pi * self.shape.radius * (top - bottom)

	def transmittedPressures(self):
		"""The mean radial stress on the wall, the same for all groups."""
		return dict.fromkeys((0, 2, 3), self.servo.radialStress)

	def outside(self, ids):
		x, y, _ = yade.BodyArrays.positions(ids).T - numpy.array(self.axis)[:, None]
		return numpy.array(ids)[numpy.hypot(x, y) >= self.shape.radius].tolist()

	def surface(self, startRadius):
		"""The wall at its radius, from the height of the specimen's foot to its first head: pressure and normal displacement at points."""
		angle = 2 * math.pi * numpy.arange(_STRIPS) / _STRIPS
		z = numpy.repeat(numpy.linspace(self.axis[2] - self.shape.height / 4, self.axis[2] + self.shape.height / 4, _ROWS), _STRIPS)
		x, y = (self.axis[k] + self.shape.radius * numpy.tile(f(angle), _ROWS) for k, f in enumerate((numpy.cos, numpy.sin)))
		corner = numpy.arange((_ROWS - 1) * _STRIPS)
		after = corner - corner % _STRIPS + (corner + 1) % _STRIPS
		triangles = numpy.vstack(
			[numpy.column_stack([corner, after, after + _STRIPS]), numpy.column_stack([corner, after + _STRIPS, corner + _STRIPS])]
		)
		points = {
			"pressure": numpy.full(len(z), self.servo.stress),
			"normal_displacement": numpy.full(len(z), self.shape.radius - startRadius),
		}
		return Surface(numpy.column_stack([x, y, z]), triangles, points, {})
