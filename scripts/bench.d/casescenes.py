# SPDX-License-Identifier: GPL-2.0-or-later
"""What the hard cases do beside a usual test: drives, which take the place of the shear of a consolidated test, and scenes of few bodies.

A scene takes (folder, short) and gives measurements; it runs in the YADE that asks for it, on an empty scene.
"""

import math

import numpy
import yade
from hexmembrane.scene.platens import platen
from yade import BodyArrays, O, utils

RADIUS, DENSITY, KN, KRATIO = 1e-3, 2650.0, 1e5, 3.0  #: of the equal spheres (m, kg/m3) and of each contact (N/m)
MASS = 4 / 3 * math.pi * RADIUS**3 * DENSITY
PAIR_STEP = 2 / math.sqrt(2 * KN / MASS)  #: critical step of two spheres that touch each other and nothing else


# Drives


def _rows(test, velocities, steps):
	"""One row after each ``steps`` steps of the top platen at the velocity that ``velocities(row)`` gives; goes on where the test was resumed."""
	while test.rowCount <= test.config.output.records:
		test.scene.topDrive.velocity = velocities(test.rowCount)
		test.advance(steps)
		test.row()
		test.maybeCheckpoint()


def _stepsOf(test, strain):
	return math.ceil(strain * test.reference.height / (test.config.shear.velocity * O.dt))


def cycles(test):
	"""Loads and unloads in turn by 0.5 % of strain, a row at each turning point."""
	speed = test.config.shear.velocity
	_rows(test, lambda row: speed if row % 2 else -speed, _stepsOf(test, 0.005))


def extension(test):
	"""Draws the platens apart by 5 % of strain and a little more."""
	_rows(test, lambda row: -test.config.shear.velocity, _stepsOf(test, 0.052 / test.config.output.records))


def tooLong(test):
	"""Three times the critical step of the contacts that there are, behind the back of every check; rows as usual."""
	O.dt = 3 * test.scene.criticalTimeStep()
	_rows(test, lambda row: test.config.shear.velocity, 20)


def rest(steps):
	"""So many steps of the consolidated specimen with the servos left on."""

	def drive(test):
		test.scene.topDrive.mode = "stress"
		while test.rowCount <= test.config.output.records:
			test.advance(steps // test.config.output.records)
			test.row()
			test.maybeCheckpoint()

	return drive


def tilting(test):
	"""Shears by 2 % while a script turns the top platen by 2 degrees; its drive holds the spin at 0, so the script sets the orientation."""
	records = test.config.output.records

	def velocity(row):
		O.bodies[test.scene.topDrive.platen].state.ori = yade.Quaternion((1, 0, 0), math.radians(2) * row / records)
		return test.config.shear.velocity

	_rows(test, velocity, _stepsOf(test, 0.02 / records))


# Scenes


def _engines(tier, inner=(), substeps=1):
	if tier == "compact":
		return [yade.ForceResetter(), yade.CompactLoop(engines=list(inner), damping=0, substeps=substeps), yade.RunawayGuard(iterPeriod=1)]
	shapes = [yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb(), yade.Bo1_CylinderWall_Aabb()]
	contacts = [yade.Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False), yade.Ig2_Platen_Sphere_ScGeom(), yade.Ig2_CylinderWall_Sphere_ScGeom()]
	return [
		yade.ForceResetter(),
		yade.InsertionSortCollider(shapes, verletDist=-0.05),
		yade.InteractionLoop(contacts, [yade.Ip2_LinearMat_LinearMat_LinearPhys()], [yade.Law2_ScGeom_LinearPhys_Linear()]),
		*inner,
		yade.NewtonIntegrator(damping=0),
		yade.RunawayGuard(),
	]


def _begin():
	O.reset()
	O.materials.append(yade.LinearMat(kn=2 * KN, ks=2 * KN / KRATIO, friction=0.0, density=DENSITY))


def _sphere(centre, velocity=(0, 0, 0), fixed=False):
	body = utils.sphere(tuple(centre), RADIUS, fixed=fixed)
	body.state.vel = tuple(velocity)
	return O.bodies.append(body)


def leapfrog(gap, speed, dt, steps):
	"""Central differences of two equal spheres that meet head-on: their relative speed after the steps, approach negative; arrays over gaps."""
	gap, rate = numpy.array(gap, dtype=float), numpy.full(len(gap), -speed)
	for _ in range(steps):
		rate += numpy.maximum(0.0, -gap) * KN * 2 / MASS * dt
		gap += rate * dt
	return rate


def pairs(tier):
	"""Two spheres that meet head-on, at 64 phases of the step and five steps: the scheme's own result, and what energy it gains."""

	def scene(folder, short):
		seen, apart = {}, 0.0
		for share in (0.2, 0.4, 0.6, 0.8, 0.95):
			_begin()
			dt, speed = share * PAIR_STEP, 0.02
			gaps = (2 + (numpy.arange(64) + 0.5) / 64) * speed * dt
			for k, gap in enumerate(gaps):
				for side in (-1, 1):
					_sphere((side * (RADIUS + gap / 2), 0.01 * (k % 8), 0.01 * (k // 8)), (-side * speed / 2, 0, 0))
			O.engines, O.dt = _engines(tier), dt
			steps = 6 + math.ceil(math.pi / share)
			for _ in range(steps):
				O.step()
			velocity = BodyArrays.velocities(list(range(len(O.bodies))))[:, 0]
			wanted = leapfrog(gaps, speed, dt, steps)
			apart = max(apart, float(numpy.abs(velocity[1::2] - velocity[::2] - wanted).max()) / speed)
			gain = (wanted / speed) ** 2 - 1
			seen[f"mean gain at {share}"], seen[f"largest gain at {share}"] = float(gain.mean()), float(gain.max())
		return {"against central differences": apart, **seen}

	return scene


def gas(folder, short):
	"""Frictionless spheres that fly at up to 1 m/s in a cage of fixed ones for 50 ms: the growth of their energy, by the share of a pair's critical step.

	Each meets another about a hundred times. A run that RunawayGuard stops has grown without limit.
	"""
	shares = (0.2, 0.8) if short else (0.1, 0.2, 0.3, 0.4, 0.6, 0.8)
	growth = {f"growth at {share}": _gasGrowth(share, 0.02 if short else 0.05) for share in shares}
	return {"a grain's step before contacts, over a pair's": _grainStep() / PAIR_STEP, **growth}


def _grainStep():
	"""What builder.build takes for the critical step of such spheres before there are contacts."""
	from hexmembrane.configuration.specimen import Specimen
	from hexmembrane.scene import timestep

	emod = 2 * KN / (math.pi * RADIUS)  # PFC's deformability: kn = pi emod R/2 for equal spheres
	return timestep.grainStep(Specimen(radius=1, height=1, emod=emod, kratio=KRATIO, density=DENSITY), RADIUS)


def _gasGrowth(share, duration):
	"""Energy after a time [s] over the energy at the start, kinetic and elastic."""
	_begin()
	side, pitch = 6, 2.6 * RADIUS
	random = numpy.random.default_rng(1)
	for k in numpy.ndindex(side, side, side):
		inside = all(0 < i < side - 1 for i in k)
		place = pitch * numpy.array(k) if inside else 0.95 * pitch * (numpy.array(k) - 2.5) + 2.5 * pitch
		_sphere(place, random.uniform(-1, 1, 3) if inside else (0, 0, 0), fixed=not inside)
	O.engines, O.dt, O.trackEnergy = _engines("compact"), share * PAIR_STEP, True

	def energy():
		found = []
		for _ in range(20):
			O.step()
			found.append(sum(value for name, value in O.energy.items() if name in ("kinetic", "elastPotential")))
		return sum(found) / len(found)

	first = energy()
	O.engines[1].substeps = 100
	try:
		while O.time < duration:
			O.step()
	except RuntimeError as error:
		if "RunawayGuard" not in str(error) and "CompactLoop: body" not in str(error):
			raise
		return math.inf
	O.engines[1].substeps = 1
	return energy() / first


def tilted(tier):
	"""A platen that is tilted, and one that turns: the force on a sphere against the closed form; a driven one keeps its tilt."""

	def scene(folder, short):
		_begin()
		top = O.bodies.append(platen((0, 0, 0), 0.02, 0.005, +1))
		place = numpy.array((0.004, 0.008, 0.0))
		O.bodies[top].state.ori = yade.Quaternion((1, 0, 0), 0.05)
		ball = _sphere(place + (0, 0, _faceAt(top, place) + 0.9 * RADIUS), fixed=True)
		O.engines, O.dt = _engines(tier), 1e-6
		seen = {"force": _forceError(top, ball)}
		O.bodies[top].state.angVel = (0.5, 0, 0)
		before = O.time
		for _ in range(100):
			O.step()
		seen["turning force"] = _forceError(top, ball)
		seen["turned"] = abs(O.bodies[top].state.ori.toAxisAngle()[1] - 0.05 - 0.5 * (O.time - before))
		drive = yade.PlatenDrive(platen=top, direction=(0, 0, 1), mode="velocity", velocity=0.0)
		O.engines = _engines(tier, [drive])
		angle = O.bodies[top].state.ori.toAxisAngle()[1]
		O.bodies[top].state.angVel = (0.5, 0, 0)
		for _ in range(100):
			O.step()
		seen["driven tilt"] = abs(O.bodies[top].state.ori.toAxisAngle()[1] - angle)
		return seen

	return scene


def _normal(id):
	return numpy.array(tuple(O.bodies[id].state.ori * yade.Vector3(0, 0, 1)))


def _faceAt(id, place):
	"""Height of the platen's upper face above a place."""
	normal = _normal(id)
	face = numpy.array(tuple(O.bodies[id].state.pos)) + O.bodies[id].shape.height / 2 * normal
	return face[2] - (normal[:2] @ (place[:2] - face[:2])) / normal[2]


def _forceError(id, ball):
	"""The force on the sphere in one step against kn times the overlap, over it."""
	normal = _normal(id)
	face = numpy.array(tuple(O.bodies[id].state.pos)) + O.bodies[id].shape.height / 2 * normal
	centre = numpy.array(tuple(O.bodies[ball].state.pos))
	O.step()
	force = numpy.array(tuple(O.forces.f(ball)))
	wanted = KN * (RADIUS - (centre - face) @ normal) * normal
	return float(numpy.linalg.norm(force - wanted) / numpy.linalg.norm(wanted))
