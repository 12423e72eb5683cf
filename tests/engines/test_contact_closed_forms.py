# SPDX-License-Identifier: GPL-2.0-or-later
"""The contact laws in both tiers against closed forms, each with its formula."""

import math

import pytest
import yade
from contactScene import EMOD, FRICTION, KRATIO, ROLLING, apart, bonded, floor, force, law, material, pair, sphere, torque
from tiers import contact, engines, run
from yade import Vector3

R1, R2 = 2e-3, 3e-3
KN = EMOD * math.pi * R1**2 / (R1 + R2)  # two spheres, PFC's deformability
KS = KN / KRATIO
RBAR = R1 * R2 / (R1 + R2)
OVERLAP = 1e-5


@pytest.mark.parametrize("direction", ((0, 0, 1), (1, -2, 0.5)))
def test_normalForceIsKnTimesOverlap(O, tier, direction):
	"""F = kn u along the normal on both, opposite; kn = pi E* min(R)^2/(R1+R2), ks = kn/k*, kr = ks Rbar^2."""
	material()
	a, b = pair(R1, R2, OVERLAP, direction)
	O.engines = engines(tier)
	O.dt = 1e-7
	O.step()
	phys = contact(a, b).phys
	assert (phys.kn, phys.ks, phys.kr) == pytest.approx((KN, KS, KS * RBAR**2), rel=1e-12)
	assert (phys.tangensOfFrictionAngle, phys.rollingArm) == pytest.approx((FRICTION, ROLLING * RBAR), rel=1e-12)
	n = Vector3(direction).normalized()
	assert apart(force(b), n * (KN * OVERLAP)) < 1e-9 * KN * OVERLAP  # the overlap is a small difference
	assert force(a) == -force(b)
	assert torque(a).norm() == torque(b).norm() == 0


def test_boundaryTakesTheSpheresRadius(O, tier):
	"""On a platen kn = pi E* R, Rbar = R."""
	material()
	plate = floor()
	ball = sphere((0, 0, R1 - OVERLAP), R1, fixed=True)
	O.engines = engines(tier)
	O.dt = 1e-7
	O.step()
	phys = contact(plate, ball).phys
	kn = math.pi * EMOD * R1
	assert (phys.kn, phys.ks, phys.kr, phys.rollingArm) == pytest.approx((kn, kn / KRATIO, kn / KRATIO * R1**2, ROLLING * R1), rel=1e-12)
	assert force(ball)[2] == pytest.approx(kn * OVERLAP, rel=1e-9)


def test_noTension(O, tier):
	material()
	a, b = pair(R1, R2, OVERLAP, velocity=(0, 0, 0.1))
	O.engines = engines(tier)
	O.dt = 1e-5
	for _ in range(9):
		O.step()
		assert force(b)[2] > 0
	run(3)
	assert force(b).norm() == 0 and contact(a, b) is None


def test_reboundTakesHalfAPeriod(O, tier):
	"""Two equal spheres at +-v part at -+v after pi sqrt(m/(2 kn)), kn = pi E* R/2."""
	material(friction=0, rollingFriction=0)
	for x, v in ((-R1, 0.2), (R1, -0.2)):
		sphere((x, 0, 0), R1)
		O.bodies[-1].state.vel = (v, 0, 0)
	O.engines = engines(tier)
	half = math.pi * math.sqrt(O.bodies[0].state.mass / (2 * math.pi * EMOD * R1 / 2))
	O.dt = half / 1000
	run(990)
	assert contact(0, 1)
	run(20)
	assert contact(0, 1) is None
	assert O.bodies[0].state.vel[0] == pytest.approx(-0.2, rel=2e-3) and O.bodies[1].state.vel[0] == pytest.approx(0.2, rel=2e-3)


def test_shearGrowsByKsAndSlipsAtMuFn(O, tier):
	"""Fs = min(ks v t, mu Fn) against the motion; torque (R - u/2) Fs on either sphere. The upper sphere spins in its place, so that the overlap stays."""
	material(rollingFriction=0)
	a, b = pair(R1, R2, OVERLAP)
	O.engines = engines(tier)
	O.dt = 1e-7
	spin = 40.0  # about x: its surface passes the contact at spin (R2 - u/2) along +y
	O.bodies[b].state.angVel = (spin, 0, 0)
	limit = FRICTION * KN * OVERLAP
	steps = limit / (KS * spin * R2 * O.dt)
	assert 100 < steps < 2000
	for step in range(1, int(1.5 * steps)):
		O.step()
		size = min(KS * spin * (R2 - 0.5 * OVERLAP) * O.dt * step, limit)
		shear = force(b)
		assert shear[1] == pytest.approx(-size, rel=1e-6, abs=1e-9 * limit)
		assert torque(b)[0] == pytest.approx((R2 - 0.5 * OVERLAP) * shear[1], rel=1e-9)
		assert torque(a)[0] == pytest.approx((R1 - 0.5 * OVERLAP) * shear[1], rel=1e-9)
	assert force(b)[1] == pytest.approx(-limit, rel=1e-8)


def test_withoutFrictionOnlyTheNormalForce(O, tier):
	material(friction=0, rollingFriction=0)
	a, b = pair(R1, R2, OVERLAP)
	O.engines = engines(tier)
	O.dt = 1e-7
	O.bodies[b].state.angVel = (10, 20, 30)
	run(100)
	assert apart(force(b), (0, 0, KN * OVERLAP)) < 1e-9 * KN * OVERLAP
	assert torque(a).norm() == torque(b).norm() == 0
	assert contact(a, b).phys.shearForce.norm() == 0


@pytest.mark.parametrize("back", (False, True))
def test_pureBendingUpToThePlasticMoment(O, tier, back):
	"""Two gears: (R1-u/2) w1 = -(R2-u/2) w2 makes no shear. M = min(kr dw t, mu_r Rbar Fn); turned back it unloads elastically."""
	material()
	a, b = pair(R1, R2, OVERLAP)
	O.engines = engines(tier)
	O.dt = 1e-6
	w2 = 2.0
	w1 = -w2 * (R2 - 0.5 * OVERLAP) / (R1 - 0.5 * OVERLAP)
	O.bodies[a].state.angVel, O.bodies[b].state.angVel = (0, w1, 0), (0, w2, 0)
	kr, limit = KS * RBAR**2, ROLLING * RBAR * KN * OVERLAP
	turn = abs(w2 - w1) * O.dt
	steps = int(2 * limit / (kr * turn))
	assert 100 < steps < 20000
	for step in range(1, steps):
		O.step()
		if step % 50 == 0 or step < 5:
			moment = min(kr * turn * step, limit)
			assert torque(b)[1] == pytest.approx(-moment, rel=1e-8)
			assert torque(a)[1] == pytest.approx(moment, rel=1e-8)
	assert torque(b)[1] == pytest.approx(-limit, rel=1e-8)
	assert contact(a, b).phys.shearForce.norm() < 1e-9 * KN * OVERLAP
	if back:
		O.bodies[a].state.angVel, O.bodies[b].state.angVel = (0, -w1, 0), (0, -w2, 0)
		run(50)
		assert torque(b)[1] == pytest.approx(-limit + 50 * kr * turn, rel=1e-8)


def test_twistMeetsNoResistance(O, tier):
	material()
	_, b = pair(R1, R2, OVERLAP)
	O.engines = engines(tier)
	O.dt = 1e-6
	O.bodies[b].state.angVel = (0, 0, 100)
	run(100)
	assert torque(b).norm() < 1e-12 * KN * OVERLAP * R1 and force(b)[2] == pytest.approx(KN * OVERLAP, rel=1e-9)


#: slope of the plane, whether it rolls on
ROLLS = {"slows down on the level": 0.0, "rolls down": 0.2, "slows down on a gentle slope": 0.04}


@pytest.mark.parametrize("case", ROLLS)
def test_rollingOnAPlane(O, tier, case):
	"""A sphere that rolls without slip: dv/dt = (5/7) g (sin(slope) - mu_r cos(slope)), as M = mu_r R N brakes m v and (2/5) m R^2 v/R."""
	slope, rolling, speed, radius = ROLLS[case], 0.06, 0.3, 0.01
	material(emod=1e9, rollingFriction=rolling)
	plate = floor(radius=5.0)
	g = 9.81
	mass = 4 / 3 * math.pi * radius**3 * 2650
	rest = mass * g * math.cos(slope) / (math.pi * 1e9 * radius)
	ball = sphere((0, 0, radius - rest), radius)
	state = O.bodies[ball].state
	state.vel, state.angVel = (speed, 0, 0), (0, speed / radius, 0)
	O.engines = engines(tier, before=[yade.GravityEngine(gravity=(g * math.sin(slope), 0, -g * math.cos(slope)))], substeps=100)
	O.dt = 0.1 * math.sqrt(mass / (math.pi * 1e9 * radius))
	run(3000)  # the moment has grown to its limit, within 1e-4 m of way
	start, t = state.vel[0], O.time
	run(10000)
	acceleration = (state.vel[0] - start) / (O.time - t)
	# 1e-3: what the vibration of the shear spring is worth at both ends
	assert acceleration == pytest.approx(5 / 7 * g * (math.sin(slope) - rolling * math.cos(slope)), rel=1e-3)
	assert state.vel[0] == pytest.approx(radius * state.angVel[1], rel=1e-3)
	assert contact(plate, ball).phys.moment[1] == pytest.approx(-rolling * radius * mass * g * math.cos(slope), rel=1e-3)


def test_rollingResistanceHoldsOnAGentleSlope(O, tier):
	"""At rest where tan(slope) < mu_r, and only there."""
	rolling, radius = 0.1, 0.01
	for slope, rests in ((0.09, True), (0.11, False)):
		O.reset()
		material(emod=1e7, rollingFriction=rolling)
		floor(radius=5.0)
		ball = sphere((0, 0, radius), radius)
		gravity = yade.GravityEngine(gravity=(9.81 * math.sin(slope), 0, -9.81 * math.cos(slope)))
		O.engines = engines(tier, before=[gravity], damping=0.3, substeps=100)
		O.dt = 0.1 * math.sqrt(O.bodies[ball].state.mass / (math.pi * 1e7 * radius))
		run(20000)
		assert (O.bodies[ball].state.vel.norm() < 1e-6) == rests


@pytest.mark.parametrize("speedRatio", (4.0, 8.0))
def test_obliqueImpactThatSlides(O, tier, speedRatio):
	"""Normal speed reverses (e = 1); sliding throughout, the tangential impulse is mu (1+e) m vn: dvx = -2 mu vn, R dw = (5/2) 2 mu vn."""
	radius, vn = 0.01, 0.1
	material(emod=1e9, rollingFriction=0)
	floor()
	ball = sphere((0, 0, radius * (1 + 1e-6)), radius)
	state = O.bodies[ball].state
	state.vel = (speedRatio * vn, 0, -vn)
	O.engines = engines(tier)
	# The surface must still slide at the end, speedRatio > mu (1 + e) 7/2, and from the start on, speedRatio > mu k*.
	assert speedRatio > 7 * FRICTION and speedRatio > FRICTION * KRATIO
	half = math.pi * math.sqrt(state.mass / (math.pi * 1e9 * radius))
	O.dt = half / 2000
	run(2500)
	assert contact(0, ball) is None
	assert state.vel[2] == pytest.approx(vn, rel=1e-3)  # 1e-3: two steps of 2000
	assert state.vel[0] == pytest.approx(vn * (speedRatio - 2 * FRICTION), rel=1e-3)
	# lever R - u/2, u/R below 1e-3
	assert radius * state.angVel[1] == pytest.approx(2.5 * 2 * FRICTION * vn, rel=2e-3)


def test_bondBreaksInTension(O, tier):
	"""F = -kn gap until it is more than cb_tenf; then nothing at all is left, and the spring's kn gap^2/2 is booked."""
	strength = 2.0
	material(cbTensile=strength, cbShear=1e9)
	a, b = pair(R1, R2, OVERLAP, velocity=(0, 0, 0.01))
	O.trackEnergy = True
	O.dt = 1e-6
	bonded(tier)
	gap = -OVERLAP
	while KN * gap <= strength:
		assert -force(b)[2] == pytest.approx(KN * gap, abs=1e-7 * strength)
		assert contact(a, b).phys.bonded
		O.step()
		gap += 0.01 * O.dt
	assert strength < KN * gap < 1.01 * strength
	assert force(b).norm() == 0 and contact(a, b) is None
	assert O.energy["bondDissip"] == pytest.approx(0.5 * KN * gap**2, rel=1e-6)
	if tier == "reference":  # the counters are the law's
		assert (law().tensileBreaks, law().shearBreaks) == (1, 0)


@pytest.mark.parametrize("overlap", (OVERLAP, -OVERLAP))
def test_bondBreaksInShear(O, tier, overlap):
	"""Fs = ks v t, beyond mu Fn, until more than cb_shearf; then mu Fn in compression, nothing across a gap. Rolling meets no resistance meanwhile."""
	strength = 1.5 * FRICTION * KN * OVERLAP
	material(cbTensile=math.inf, cbShear=strength)
	a, b = pair(R1, R2, overlap)
	O.trackEnergy = True
	O.dt = 1e-7
	spin = 20.0
	O.bodies[b].state.angVel = (spin, 0, 0)
	bonded(tier, reach=1.1)
	step = KS * spin * (R2 - 0.5 * overlap) * O.dt
	size = step
	while size <= strength:
		assert -force(b)[1] == pytest.approx(size, rel=1e-6)
		assert contact(a, b).phys.bonded and contact(a, b).phys.moment.norm() == 0
		O.step()
		size += step
	assert strength < size < 1.1 * strength
	kept = FRICTION * KN * OVERLAP if overlap > 0 else 0
	gone = 0.5 * (size**2 - kept**2) / KS + (0 if overlap > 0 else 0.5 * KN * overlap**2)
	assert O.energy["bondDissip"] == pytest.approx(gone, rel=1e-6)
	if overlap > 0:
		assert -force(b)[1] == pytest.approx(kept, rel=1e-8)
		assert force(b)[2] == pytest.approx(KN * OVERLAP, rel=1e-8)
		assert not contact(a, b).phys.bonded
	else:
		assert force(b).norm() == 0 and torque(b).norm() == 0
	if tier == "reference":
		assert (law().tensileBreaks, law().shearBreaks) == (0, 1)
