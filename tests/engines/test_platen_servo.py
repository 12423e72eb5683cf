# SPDX-License-Identifier: GPL-2.0-or-later
"""PlatenDrive under stress in both tiers: its servo, approach, the stiffness that it goes by, and its time limit."""

import math

import pytest
from contactScene import DENSITY, force, sphere, springs
from platenScene import GRAIN, HEIGHT, RADIUS, bystander, driven, stack, topPlaten
from tiers import run


def test_stressSetEveryStepIsFollowed(O, tier):
	"""A stress that rises in every step: it is carried, half a ramp behind, and the servo settles when the rise has ended."""
	kn, ramp, area = 1e5, 1000, 1e-5
	bottom, top = stack(O, 3, 1, kn)
	drive = driven(O, tier, platen=top, mode="stress", stress=1e4, area=area, timeLimit=8000 * O.dt)
	run(6000)
	assert drive.settled
	drive.rampTime = ramp * O.dt
	for step in range(10000):
		drive.stress = 1e4 * (1 + step / 5000)
		O.step()
		if step > 2000:
			assert abs(drive.force / area / (1e4 * (1 + (step - ramp / 2) / 5000)) - 1) < 0.02
			assert not drive.settled
	run(2000)
	assert drive.settled and abs(drive.force / area / drive.stress - 1) < 1e-3


@pytest.mark.parametrize("kn", (1e3, 1e5, 1e7))
@pytest.mark.parametrize("layers, side, ramp", ((3, 1, 0), (3, 1, 400), (8, 3, 0), (8, 3, 2000)))
def test_stressServoReachesItsTargetWithoutOvershoot(O, tier, kn, layers, side, ramp):
	"""0.2 N a column, from a gap: overlaps from 1e-5 to 0.1 of a grain's diameter. No setting is changed with the stiffness."""
	target = 0.2 * side**2
	area = target / 1e5
	bottom, top = stack(O, layers, side, kn)
	drive = driven(O, tier, platen=top, mode="stress", stress=1e5, area=area, rampTime=ramp * O.dt)
	peak, settledAt = 0.0, None
	for block in range(4000):
		for _ in range(10):
			O.step()
			peak = max(peak, drive.force)
		if settledAt is None and drive.settled:
			settledAt = 10 * block
		if drive.settled and abs(drive.force / target - 1) < 1e-4 and abs(O.bodies[top].state.vel[2]) * O.dt * kn < 1e-6 * target:
			break
	assert settledAt is not None
	assert abs(drive.force / target - 1) < 1e-3
	assert peak < 1.02 * target
	# What the top platen carries is what arrives below.
	assert abs(force(bottom)[2] / -target - 1) < 5e-3


def test_givenMassIsAFreeBody(O, tier):
	"""Nothing in its way: the platen falls with a = sigma A/m, to the velocity limit and no further."""
	springs()
	bystander()
	top = topPlaten(O, 0.1)
	drive = driven(O, tier, platen=top, mode="stress", stress=1e5, mass=0.5, maxVelocity=0.3, area=1e-5)
	O.dt = 1e-4
	for step in range(1, 1500):
		O.step()
		expected = min(step * O.dt * 1e5 * 1e-5 / 0.5, 0.3)
		assert abs(O.bodies[top].state.vel[2] + expected) < 1e-12
	assert drive.stiffness == 0 and not drive.settled


def test_approachFollowsStressAndDensity(O, tier):
	"""maxVelocity = 1e-3 sqrt(stress/density), density from the movable spheres alone."""
	springs()
	sphere((0, 0, -1), 0.1, fixed=True)
	ball = sphere((0, 0, -2), 0.1)
	O.bodies[0].state.mass = 1e9
	top = topPlaten(O, 0.1)
	driven(O, tier, platen=top, mode="stress", stress=1e5)
	O.dt = 1e-6
	O.step()
	assert O.bodies[ball].dynamic
	assert abs(O.bodies[top].state.vel[2] + 1e-3 * math.sqrt(1e5 / DENSITY)) < 1e-12


@pytest.mark.parametrize("scaling", (1e-3, 1e4))
def test_approachTakesTheGrainsDensityBesideAScaledMembrane(O, tier, scaling):
	"""Many small spheres of another density, less than half of the volume."""
	springs()
	for i in range(9):
		sphere((0.3 * i, 0, -1), 0.1)
		for j in range(7):
			light = sphere((0.3 * i, 0.1 * j, -2), 0.05)
			O.bodies[light].state.mass *= scaling
	top = topPlaten(O, 0.1)
	driven(O, tier, platen=top, mode="stress", stress=1e5)
	O.dt = 1e-6
	O.step()
	assert abs(O.bodies[top].state.vel[2] + 1e-3 * math.sqrt(1e5 / DENSITY)) < 1e-12


def test_stiffnessIsTheSumOverTheContacts(O, tier):
	"""Face contacts count with kn, a contact at the side of the platen with ks."""
	kn = 1e4
	springs(kn, 0.5 * kn)
	top = topPlaten(O, 0)
	for x in (-0.005, 0, 0.005):
		sphere((x, 0, -0.99 * GRAIN), GRAIN, fixed=True)
	sphere((RADIUS + 0.99 * GRAIN, 0, 0.5 * HEIGHT), GRAIN, fixed=True)
	drive = driven(O, tier, platen=top, mode="stress", stress=1e5, maxVelocity=1e-9)
	O.step()
	assert abs(drive.stiffness - (3 * kn + 0.5 * kn)) < 1e-9 * kn


def test_stiffnessMayBeGiven(O, tier):
	springs()
	top = topPlaten(O, 0)
	sphere((0, 0, -0.99 * GRAIN), GRAIN, fixed=True)
	drive = driven(O, tier, platen=top, mode="stress", stress=1e5, maxVelocity=1e-9, contactStiffness=123.0)
	O.step()
	assert drive.stiffness == 123.0


def test_timeLimitStopsTheRun(O, tier):
	_, top = stack(O, 2, 1, 1e5)
	O.bodies.erase(2)
	driven(O, tier, platen=top, mode="stress", stress=1e5, maxVelocity=1e-6, timeLimit=20 * O.dt)
	for _ in range(20):
		O.step()
	with pytest.raises(RuntimeError, match=r"PlatenDrive.timeLimit = .*: platen 3 carries 0 N of 31.4159 N .*at iteration 2\d"):
		for _ in range(5):
			O.step()


def test_timeLimitIsMetByASettledServo(O, tier):
	_, top = stack(O, 2, 1, 1e5)
	drive = driven(O, tier, platen=top, mode="stress", stress=1e4, area=1e-5, timeLimit=4000 * O.dt)
	run(6000)
	assert drive.settled
