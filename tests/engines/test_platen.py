# SPDX-License-Identifier: GPL-2.0-or-later
"""Platen and its contacts in both tiers, against closed forms."""

import math

import numpy as np
import pytest
import yade
from contactScene import apart, floor, force, sphere, springs, torque
from hexmembrane.scene.platens import platen
from tiers import contact, engines, run, state
from yade import Bo1_Platen_Aabb, Ig2_Platen_Sphere_ScGeom6D, Quaternion, Vector3, utils

KN, KS, FRICTION = 1e5, 5e4, 0.4
RADIUS, HEIGHT, GRAIN = 0.02, 0.01, 0.002

#: Sphere centre from the platen's centre in its own axes, outward normal, overlap. Rim: 3-4-5.
PLACES = {
	"upper face": ((0.005, -0.003, 0.5 * HEIGHT + 0.9 * GRAIN), (0, 0, 1), 0.1 * GRAIN),
	"lower face": ((0.0, 0.011, -0.5 * HEIGHT - 0.95 * GRAIN), (0, 0, -1), 0.05 * GRAIN),
	"side": ((0.0, -RADIUS - 0.9 * GRAIN, 0.003), (0, -1, 0), 0.1 * GRAIN),
	"upper rim": ((RADIUS + 0.0012 * 0.9, 0.0, 0.5 * HEIGHT + 0.0016 * 0.9), (0.6, 0, 0.8), 0.1 * GRAIN),
	"lower rim": ((0.0, -RADIUS - 0.0016 * 0.9, -0.5 * HEIGHT - 0.0012 * 0.9), (0, -0.8, -0.6), 0.1 * GRAIN),
	"centre below the face": ((0.001, 0.002, 0.5 * HEIGHT - 0.1 * GRAIN), (0, 0, 1), 1.1 * GRAIN),
	"centre inside the side": ((RADIUS - 0.2 * GRAIN, 0.0, 0.001), (1, 0, 0), 1.2 * GRAIN),
}

ORIENTATIONS = {
	"upright": Quaternion.Identity,
	"spun": Quaternion((0, 0, 1), 1.1),
	"tilted": Quaternion((1, 2, 3), 0.8),
	"upside down": Quaternion((1, 0, 0), math.pi),
}


@pytest.mark.parametrize("orientation", ORIENTATIONS)
@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("platenFirst", (True, False))
def test_pressedSphereFeelsKnTimesOverlap(O, tier, place, orientation, platenFirst):
	local, normal, overlap = PLACES[place]
	turn = ORIENTATIONS[orientation]
	turn.normalize()
	centre = Vector3(0.3, -0.2, 0.1)
	springs(KN, KS)

	def addPlaten():
		body = platen((0, 0, 0), RADIUS, HEIGHT, +1)
		body.state.pos, body.state.ori = centre, turn
		return O.bodies.append(body)

	def addSphere():
		return sphere(centre + turn * Vector3(local), GRAIN, fixed=True)

	if platenFirst:
		plate, ball = addPlaten(), addSphere()
	else:
		ball, plate = addSphere(), addPlaten()
	O.engines = engines(tier)
	O.dt = 1e-6
	O.step()

	found = contact(plate, ball)
	assert found.isReal and (found.id1, found.id2) == (plate, ball)
	world = turn * Vector3(normal)
	assert apart(found.geom.normal, world) < 1e-12
	assert abs(found.geom.penetrationDepth - overlap) < 1e-12 * RADIUS
	point = centre + turn * Vector3(local) - world * (GRAIN - 0.5 * overlap)
	assert apart(found.geom.contactPoint, point) < 1e-14
	assert found.geom.refR1 == found.geom.refR2 == GRAIN
	pushed = force(ball)
	assert apart(pushed, world * (KN * overlap)) < 1e-12 * KN * GRAIN
	# Action is reaction, and the torque on the platen is that of its force at the contact point.
	assert force(plate) == -pushed
	assert apart(torque(plate), (point - centre).cross(-pushed)) < 1e-12 * KN * GRAIN * RADIUS


def test_aSphereJustOutsideHasNoContact(O, tier):
	springs(KN, KS)
	plate = floor(RADIUS, HEIGHT)
	ball = sphere((0, 0, GRAIN * (1 + 1e-9)), GRAIN, fixed=True)
	O.engines = engines(tier)
	O.step()
	assert contact(plate, ball) is None


def test_detectionFactorReachesAcrossAGap(O):
	"""Of the reference tier: the factors are YADE's."""
	springs(KN, KS)
	plate = floor(RADIUS, HEIGHT)
	ball = sphere((0, 0, 1.2 * GRAIN), GRAIN, fixed=True)
	O.engines = engines("reference")
	O.engines[1].boundDispatcher.functors[0].aabbEnlargeFactor = 1.25
	O.engines[2].geomDispatcher.functors[1].interactionDetectionFactor = 1.25
	O.engines[2].lawDispatcher.functors = [yade.Law2_ScGeom_FrictPhys_CundallStrack(neverErase=True)]
	O.step()
	assert abs(contact(plate, ball).geom.penetrationDepth + 0.2 * GRAIN) < 1e-15


def test_stiffnessIsThatOfABox(O):
	"""With YADE's own rule for kn from the moduli, a platen and a Box of the same material are equally stiff. A stock law: the reference tier's."""
	O.materials.append(yade.FrictMat(young=1e7, poisson=0.3, frictionAngle=0.4, density=2600))
	floor(RADIUS, HEIGHT)
	O.bodies.append(utils.box((1, 0, -0.5), (0.1, 0.1, 0.5), fixed=True))
	sphere((0, 0, 0.9 * GRAIN), GRAIN, fixed=True)
	sphere((1, 0, 0.9 * GRAIN), GRAIN, fixed=True)
	O.engines = [
		yade.ForceResetter(),
		yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), Bo1_Platen_Aabb(), yade.Bo1_Box_Aabb()], verletDist=0),
		yade.InteractionLoop(
			[yade.Ig2_Platen_Sphere_ScGeom(), yade.Ig2_Box_Sphere_ScGeom()],
			[yade.Ip2_FrictMat_FrictMat_FrictPhys()],
			[yade.Law2_ScGeom_FrictPhys_CundallStrack()],
		),
	]
	O.step()
	ours, theirs = contact(0, 2), contact(1, 3)
	assert ours.phys.kn == theirs.phys.kn and ours.phys.ks == theirs.phys.ks and ours.phys.kn > 0
	assert abs(ours.phys.normalForce[2] - theirs.phys.normalForce[2]) < 1e-12 * theirs.phys.normalForce[2]


def test_bounceOffFaceAndRim(O, tier):
	"""Undamped: the sphere leaves at the speed it came with, after half a period, pi sqrt(m/kn); along the normal of the rim too."""
	speed = 0.1
	springs(KN, KS)
	floor(RADIUS, HEIGHT)
	above = sphere((0, 0, GRAIN), GRAIN)
	beside = sphere((RADIUS + 0.6 * GRAIN, 0, 0.8 * GRAIN), GRAIN)
	O.bodies[above].state.vel = (0, 0, -speed)
	O.bodies[beside].state.vel = (-0.6 * speed, 0, -0.8 * speed)
	O.engines = engines(tier)
	mass = O.bodies[above].state.mass
	half = math.pi * math.sqrt(mass / KN)
	O.dt = half / 2000
	steps = {}
	for step in range(2100):
		O.step()
		for ball in (above, beside):
			if ball not in steps and step > 10 and contact(0, ball) is None:
				steps[ball] = step
	for ball in (above, beside):
		assert abs(steps[ball] * O.dt / half - 1) < 2e-3  # two steps of 2000
	assert apart(O.bodies[above].state.vel, (0, 0, speed)) < 2e-3 * speed
	assert apart(O.bodies[beside].state.vel, (0.6 * speed, 0, 0.8 * speed)) < 2e-3 * speed


@pytest.mark.parametrize("moves", ("sphere", "platen"))
def test_shearGrowsByKsAndSlipsAtMuFn(O, tier, moves):
	"""Dragged at constant overlap, the shear force on the sphere is ks v t until mu Fn and stays there; it does not matter which of the two moves."""
	overlap, speed = 1e-4, 0.5
	springs(KN, KS, FRICTION)
	plate = floor(RADIUS, HEIGHT)
	ball = sphere((0, 0, GRAIN - overlap), GRAIN, fixed=True)
	O.bodies[ball if moves == "sphere" else plate].state.vel = (speed, 0, 0)
	O.engines = engines(tier)
	O.dt = 1e-6
	sign = -1 if moves == "sphere" else 1
	limit = FRICTION * KN * overlap
	slipAt = limit / (KS * speed * O.dt)
	assert 100 < slipAt < 400
	for step in range(1, 500):
		O.step()
		shear = force(ball)
		# The velocity that was set is counted in the step that makes the contact, too.
		expected = min(KS * speed * O.dt * step, limit)
		assert abs(shear[0] - sign * expected) < 1e-10 * limit
		assert abs(shear[1]) < 1e-12 * limit and abs(shear[2] - KN * overlap) < 1e-10 * KN * overlap
		assert force(plate) == -shear
	# Torque on the sphere: the force acts half way through the overlap.
	turning = torque(ball)
	assert abs(turning[1] + (GRAIN - 0.5 * overlap) * sign * limit) < 1e-10 * limit * GRAIN


def test_movingTogetherMakesNoShear(O, tier):
	overlap = 1e-4
	springs(KN, KS)
	plate = floor(RADIUS, HEIGHT)
	ball = sphere((0.01, 0, GRAIN - overlap), GRAIN, fixed=True)
	for body in (plate, ball):
		O.bodies[body].state.vel = (3, -2, 5)
	O.engines = engines(tier)
	O.dt = 1e-5
	run(2000)  # 0.12 m away
	assert O.bodies[plate].state.pos[2] > 0.09
	assert apart(force(ball), (0, 0, KN * overlap)) < 1e-8 * KN * overlap


def test_platenTurningUnderASphere(O, tier):
	"""A platen that spins on its axis drags a sphere at distance rho by omega rho, tangentially; the sphere's own place decides, not the platen's centre."""
	overlap, omega, rho = 1e-4, 20.0, 0.012
	springs(KN, KS)
	plate = floor(RADIUS, HEIGHT)
	ball = sphere((rho, 0, GRAIN - overlap), GRAIN, fixed=True)
	O.bodies[plate].state.angVel = (0, 0, omega)
	O.engines = engines(tier)
	O.dt = 1e-6
	for step in range(1, 100):
		O.step()
		shear = force(ball)
		# YADE turns the old shear force by half the spin, dt omega/2 a step, towards -x: second order here.
		assert abs(shear[1] - KS * omega * rho * O.dt * step) < 1e-5 * KS * omega * rho * O.dt * step
		assert abs(shear[0]) <= 0.5 * omega * O.dt * step * shear[1]
	found = contact(plate, ball)
	assert apart(found.geom.incidentVel(found, False), (0, -omega * rho, 0)) < 1e-12


def test_rigidMotionOfBothMakesNoRelativeVelocity(O, tier):
	"""Platen and sphere move as one rigid body that turns about a far axis: nothing slides at the contact, whatever the turn."""
	springs(KN, KS)
	plate = floor(RADIUS, HEIGHT)
	ball = sphere((RADIUS + 0.9 * GRAIN, 0, -0.3 * HEIGHT), GRAIN, fixed=True)
	# the compact tier's answer to a platen that turns about another axis is a row of test_compact_contract
	omega, pivot = Vector3(3, -4, 5) if tier == "reference" else Vector3(0, 0, 5), Vector3(0.7, 0.1, -0.4)
	for body in (plate, ball):
		state = O.bodies[body].state
		state.angVel = omega
		state.vel = omega.cross(state.pos - pivot)
	O.engines = engines(tier)
	O.dt = 1e-12  # nothing moves: the velocities of this instant
	O.step()
	slide = O.bodies[ball].state.vel.norm() * O.dt
	assert contact(plate, ball).phys.shearForce.norm() < 1e-12 * KS * slide


def test_boundIsExactAtAnyOrientation(O):
	"""Of the reference tier: the compact tier has no bounds."""
	springs(KN, KS)
	body = platen((0, 0, 0), 0.3, 0.2, -1)
	turn = Quaternion((1, 2, 3), 0.8)
	turn.normalize()
	body.state.ori = turn
	O.bodies.append(body)
	sphere((5, 5, 5), 0.1, fixed=True)
	O.engines = engines("reference")
	O.step()
	sweep = body.bound.sweepLength
	assert abs(sweep - 0.05 * 0.1) < 1e-15  # the collider's, on top
	axis = turn * Vector3(0, 0, 1)
	for i in range(3):
		half = 0.3 * math.sqrt(1 - axis[i] ** 2) + 0.1 * abs(axis[i]) + sweep
		assert abs(body.bound.max[i] - body.state.pos[i] - half) < 1e-14
		assert abs(body.bound.min[i] - body.state.pos[i] + half) < 1e-14


def test_platenThatTipsFindsWhatItTurnsInto(O):
	"""The collider looks at movement only, and nothing moves here: the bound must allow for the turn from the start.

	The compact tier's answer to such a turn is a row of test_compact_contract.
	"""
	springs(KN, KS)
	rod = platen((0, 0, 0.5), 0.1, 1.0, +1)  # centre at the origin, tall
	rod.state.angVel = (0, math.pi / 2, 0)  # a quarter turn in 1 s
	plate = O.bodies.append(rod)
	ball = sphere((0.55, 0, 0), 0.06, fixed=True)
	O.engines = engines("reference")
	O.dt = 1e-3
	run(500)
	assert contact(plate, ball) is None
	run(500)
	O.bodies[plate].state.angVel = (0, 0, 0)
	O.step()
	found = contact(plate, ball)
	assert abs(found.geom.penetrationDepth - 0.01) < 1e-6
	assert apart(found.geom.normal, (1, 0, 0)) < 1e-6


def test_platenThatTravelsFindsWhatItMeets(O, tier):
	springs(KN, KS)
	plate = floor(RADIUS, HEIGHT)
	ball = sphere((0, 0, 0.2), GRAIN, fixed=True)
	O.bodies[plate].state.vel = (0, 0, 1)
	O.engines = engines(tier)
	O.dt = 1e-5
	met = 0.2 - GRAIN  # m = s here
	run(int(met / O.dt) - 5)
	assert contact(plate, ball) is None
	run(25)
	overlap = O.bodies[plate].state.pos[2] - O.dt + 0.5 * HEIGHT - met  # positions of the last contact search
	assert 1e-4 < overlap < 3e-4
	assert abs(force(ball)[2] - KN * overlap) < 1e-9 * KN * overlap


def test_sixDegreesOfFreedomFollowTheRotation(O):
	"""A sphere rolled by 0.01 about y and spun by 0.02 about the normal against a resting platen. Of the reference tier: a functor of YADE's."""
	springs(KN, KS)
	plate = floor(RADIUS, HEIGHT)
	ball = sphere((0, 0, 0.9 * GRAIN), GRAIN, fixed=True)
	O.engines = engines("reference")
	O.engines[2].geomDispatcher.functors = [Ig2_Platen_Sphere_ScGeom6D()]
	O.dt = 1e-6
	O.step()
	geom = O.interactions[plate, ball].geom
	assert type(geom).__name__ == "ScGeom6D" and geom.twist == 0 and geom.bending.norm() == 0
	turn = Quaternion(Vector3(0, 0.01, 0.02).normalized(), math.hypot(0.01, 0.02))
	O.bodies[ball].state.ori = turn
	O.step()
	# YADE's sign: the rotation that takes body 2 back to body 1's frame.
	assert abs(abs(geom.twist) - 0.02) < 1e-12
	assert abs(geom.bending.norm() - 0.01) < 1e-12
	assert abs(geom.bending[0]) < 1e-12 and abs(geom.bending[2]) < 1e-12


def test_savedAndLoadedMidRunIsTheSameRun(O, tier, tmp_path):
	"""Spheres that fall on a turning platen, bounce and roll on it."""
	springs(KN, KS)
	plate = floor(RADIUS, HEIGHT)
	for i in range(6):
		ball = sphere((0.006 * i - 0.013, 0.002 * i, GRAIN * (1 + 0.3 * i)), GRAIN)
		O.bodies[ball].state.vel = (0.4, -0.1 * i, -0.2)
	O.bodies[plate].state.angVel = (0, 0, 5)
	O.engines = engines(tier, damping=0.1, before=[yade.GravityEngine(gravity=(0, 0, -9.81))])
	O.dt = 5e-6
	run(1500)
	file = str(tmp_path / "half.yade.gz")
	O.save(file)
	run(1500)
	whole = state()
	assert np.abs(whole[1:, 6:]).max() > 1  # contacts have turned the spheres
	O.reset()
	O.load(file)
	run(1500)
	if O.numThreads == 1:
		assert (state() == whole).all()
	else:
		assert np.abs(state() - whole).max() < 1e-9


def test_drawFunctorIsRegistered():
	"""YADE's renderer finds it by its base class."""
	functor = yade.Gl1_Platen()
	assert isinstance(functor, yade.GlShapeFunctor) and functor.slices == 48
