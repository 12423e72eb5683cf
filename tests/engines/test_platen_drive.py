# SPDX-License-Identifier: GPL-2.0-or-later
"""PlatenDrive in both tiers: velocity and change of mode, what it records, and what it refuses. Its servo: test_platen_servo.py."""

import math

import pytest
from contactScene import force, sphere, springs
from hexmembrane.scene.platens import platen
from platenScene import GRAIN, HEIGHT, RADIUS, bystander, driven, stack, topPlaten
from tiers import find, run, state
from yade import PlatenDrive, Quaternion, Vector3


def test_velocityRampIsTheCosineAndExactInSum(O, tier):
	speed, ramp = 0.05, 2e-3
	springs()
	bystander()
	top = topPlaten(O, 0.1)
	drive = driven(O, tier, platen=top, velocity=speed, rampTime=ramp)
	O.dt = 1e-5  # 200 steps
	start = O.bodies[top].state.pos[2]
	before = 0.0
	for step in range(1, 401):
		O.step()
		middle = (step - 0.5) * O.dt
		expected = speed * (1 if middle > ramp else 0.5 * (1 - math.cos(math.pi * middle / ramp)))
		velocity = O.bodies[top].state.vel
		assert abs(velocity[2] + expected) < 1e-12 * speed and velocity[0] == velocity[1] == 0
		assert abs(expected - before) < 1.01 * 0.5 * math.pi * speed * O.dt / ramp
		before = expected
	# Half of the ramp is lost; the midpoint rule is exact for a whole ramp.
	way = speed * (400 * O.dt - 0.5 * ramp)
	assert abs(start - O.bodies[top].state.pos[2] - way) < 1e-12 * way
	O.step()  # what the engine knows is as old as its last call
	assert abs(drive.displacement - way) < 1e-12 * way
	assert drive.force == 0 and drive.work == 0
	assert O.bodies[top].state.blockedDOFs == "xyzXYZ"


@pytest.mark.parametrize("direction", ((0, 0, -1), (0, 0, 1), (3, 0, 4)))
def test_forceAndWorkOfALinearContact(O, tier, direction):
	"""Driven against a fixed sphere, along any axis: F = kn un, W = kn un^2/2, which the trapezoid gives exactly for a linear spring."""
	kn, speed = 2e5, 0.1
	unit = Vector3(direction).normalized()
	springs(kn, 0.5 * kn)
	body = platen((0, 0, 0), RADIUS, HEIGHT, +1)
	body.state.ori = Quaternion()
	body.state.ori.setFromTwoVectors(Vector3(0, 0, 1), unit)
	turn = Quaternion()
	turn.setFromTwoVectors(Vector3(0, 0, 1), unit)
	body.state.ori, body.state.pos = turn, Vector3.Zero
	plate = O.bodies.append(body)
	ball = sphere(unit * (0.5 * HEIGHT + GRAIN), GRAIN, fixed=True)
	drive = driven(O, tier, platen=plate, direction=direction, velocity=speed)
	O.dt = 1e-6
	run(1001)
	overlap = speed * 1000 * O.dt
	assert abs(drive.displacement - overlap) < 1e-12 * overlap
	assert abs(drive.force - kn * overlap) < 1e-10 * kn * overlap
	# One contact at overlap 0 is lost or not by rounding, so the first step may be missing: far below the tolerance.
	assert abs(drive.work - 0.5 * kn * overlap**2) < 1e-9 * kn * overlap**2
	pushed = force(ball)
	assert (pushed - unit * drive.force).norm() < 1e-10 * drive.force  # action = reaction


def test_workIsTheForceIntegralAndEnergyCloses(O, tier):
	"""A stack loaded, unloaded and loaded again: the recorded work is the integral of the recorded force, and equals what the grains hold and have lost."""
	kn = 1e5
	_, top = stack(O, 4, 1, kn)
	drive = driven(O, tier, platen=top, velocity=0.2, rampTime=1e-4)
	O.trackEnergy = True
	O.dt *= 0.1
	work, force, place = 0.0, 0.0, O.bodies[top].state.pos[2]
	for step in range(4000):
		here = O.bodies[top].state.pos[2]
		if step in (1500, 2500):
			drive.velocity = (-0.1, 0.15)[step == 2500]
		O.step()
		work += 0.5 * (force + drive.force) * (place - here)
		force, place = drive.force, here
	assert drive.force > 0 and drive.work > 0
	assert abs(drive.work - work) < 1e-12 * abs(work)
	assert abs(O.energy["platenWork"] + drive.work) < 1e-12 * drive.work
	# YADE books kinetic energy half a step before the rest, and damping at first order: the sum closes in proportion to the step, here to 1.3e-5.
	assert abs(O.energy.total()) < 1e-4 * drive.work


def test_newTargetStartsFromThePresentVelocity(O, tier):
	"""Through changes of velocity and both changes of mode, no step of a ramp changes the velocity by more than the ramp's steepest part."""
	kn, ramp = 1e5, 2e-3
	_, top = stack(O, 3, 1, kn)
	drive = driven(O, tier, platen=top, velocity=0.02, rampTime=ramp, maxVelocity=0.05)
	O.dt = 2e-6
	area = math.pi * RADIUS**2
	changes = {
		1500: dict(velocity=0.05),
		2000: dict(velocity=0.01),  # in the middle of a ramp
		5000: dict(mode="stress", stress=20 / area),
		15000: dict(mode="velocity", velocity=0.03),
	}
	old, changed = 0.0, 0
	for step in range(20000):
		changed = step if step in changes else changed
		for name, value in changes.get(step, {}).items():
			setattr(drive, name, value)
		O.step()
		new = -O.bodies[top].state.vel[2]
		if step < changed + 1000:
			assert abs(new - old) <= 1.2 * 0.5 * math.pi * 0.06 / ramp * O.dt
		if step == 14999:
			assert drive.settled and abs(drive.force - 20) < 0.01
		old = new
	assert abs(old - 0.03) < 1e-15


def ramped(changes, ramp, time):
	"""Sum of the cosine ramps of (moment, size) of all changes, from its definition."""
	passed = ((min(max((time - moment) / ramp, 0), 1), size) for moment, size in changes)
	return sum(0.5 * size * (1 - math.cos(math.pi * share)) for share, size in passed)


def test_velocitySetEveryStepIsFollowed(O, tier):
	"""By a script, up and down again: half a ramp behind, as the sum of the ramps of its changes; every step by itself, and every tenth."""
	ramp, speed = 200, 0.05
	for every in (1, 10):
		O.reset()
		springs()
		bystander()
		top = topPlaten(O, 0.1)
		drive = driven(O, tier, platen=top, velocity=0.0)
		O.dt = 1e-5
		O.step()
		drive.rampTime = ramp * O.dt
		changes, wanted = [], [speed * (1 - math.cos(math.pi * step / 1000)) for step in range(2001)]
		for step in range(1, 2500):
			if step % every == 0 and step <= 2000:
				changes.append((step, wanted[step] - drive.velocity))
				drive.velocity = wanted[step]
			O.step()
			velocity = -O.bodies[top].state.vel[2]
			assert abs(velocity - ramped(changes, ramp, step + 0.5)) < 1e-12 * speed
			if 200 < step <= 2000:
				assert abs(velocity - wanted[step - ramp // 2]) < 0.03 * speed
		assert velocity == wanted[2000]


def motionAnd(drive):
	return state(), drive.force, drive.work, drive.displacement, drive.stiffness, drive.settled


@pytest.mark.parametrize("at", (300, 1200, 2000))
def test_savedAndLoadedInEveryPhaseIsTheSameRun(O, tier, tmp_path, at):
	"""Saved in the middle of a velocity ramp, in the middle of a stress ramp, under constant stress: exactly the run that was not."""
	kn = 1e5

	def go(drive, start, end):
		for step in range(start, end):
			if step == 1000:
				drive.mode, drive.stress = "stress", 2e4
			O.step()

	_, top = stack(O, 3, 1, kn)
	drive = driven(O, tier, platen=top, velocity=0.02, area=1e-5, rampTime=500 * O.dt)
	go(drive, 0, at)
	file = str(tmp_path / "half.yade.gz")
	O.save(file)
	go(drive, at, 3000)
	whole, *records = motionAnd(drive)
	assert drive.force > 0
	O.reset()
	O.load(file)
	loaded = find(PlatenDrive)
	go(loaded, at, 3000)
	again, *loadedRecords = motionAnd(loaded)
	assert (again == whole).all() and loadedRecords == records


GOOD = {"velocity": 0.01, "direction": (0, 0, -1), "rampTime": 0.0}
STRESS = {"mode": "stress", "stress": 1e5}


@pytest.mark.parametrize(
	"change, part",
	(
		({"platen": -1}, "PlatenDrive.platen = -1: no body given"),
		({"platen": 0}, "PlatenDrive.platen = 0: the body's shape is no Platen"),
		({"direction": (0, 0, 0)}, "PlatenDrive.direction"),
		({"direction": (0, math.nan, 1)}, r"PlatenDrive.direction\[1\]"),
		({"velocity": math.nan}, "PlatenDrive.velocity = nan: not given"),
		({"velocity": math.inf}, "PlatenDrive.velocity = inf"),
		({"mode": "force"}, "PlatenDrive.mode = 'force': unknown mode"),
		({"rampTime": -1}, "PlatenDrive.rampTime"),
		({"rampTime": math.nan}, "PlatenDrive.rampTime"),
		({"area": 0}, "PlatenDrive.area"),
		({"mode": "stress"}, "PlatenDrive.stress = nan: not given"),
		({**STRESS, "stress": -1e5}, "PlatenDrive.stress"),
		({**STRESS, "stress": 0}, "PlatenDrive.stress"),
		({**STRESS, "mass": 0}, "PlatenDrive.mass"),
		({**STRESS, "maxVelocity": -1}, "PlatenDrive.maxVelocity"),
		({**STRESS, "damping": -0.1}, "PlatenDrive.damping"),
		({**STRESS, "tolerance": 0}, "PlatenDrive.tolerance"),
		({**STRESS, "timeLimit": 0}, "PlatenDrive.timeLimit"),
		({**STRESS, "contactStiffness": -5}, "PlatenDrive.contactStiffness"),
	),
)
def test_refusesBeforeAnythingMoves(O, tier, change, part):
	springs()
	sphere((0, 0, -1), GRAIN)
	top = topPlaten(O, 0.1)
	driven(O, tier, **{"platen": top, **GOOD, **change})
	before = state()
	with pytest.raises(ValueError, match=part):
		O.step()
	assert (state() == before).all() and O.bodies[0].state.blockedDOFs == ""


def test_refusesAnApproachWithoutAVelocity(O, tier):
	springs()
	bystander()
	driven(O, tier, platen=topPlaten(O, 0.1), **{**GOOD, **STRESS})
	with pytest.raises(ValueError, match="PlatenDrive.maxVelocity = nan: no movable sphere"):
		O.step()


def test_missingAndErasedBodies(O, tier):
	springs()
	bystander()
	top = topPlaten(O, 0.1)
	drive = driven(O, tier, platen=17, **GOOD)
	with pytest.raises(RuntimeError, match=r"PlatenDrive.platen = 17: there is no such body"):
		O.step()
	drive.platen = top
	run(10)
	O.bodies.erase(top)
	with pytest.raises(RuntimeError, match=r"PlatenDrive.platen = %d: there is no such body \(erased\?\)" % top):
		O.step()


def test_aPlatenThatIsTurnedIsRefused(O, tier):
	"""Tilted before the first step it keeps its tilt; turned between two steps it is an error, for the work of that would be booked nowhere."""
	springs()
	bystander()
	top = topPlaten(O, 0.1)
	tilt = Quaternion((1, 0, 0), 0.03)
	O.bodies[top].state.ori = tilt
	driven(O, tier, platen=top, **GOOD)
	run(50)
	assert abs((O.bodies[top].state.ori.conjugate() * tilt).toAxisAngle()[1]) < 1e-14
	O.bodies[top].state.ori = Quaternion((1, 0, 0), 0.03 + 1e-6)
	with pytest.raises(RuntimeError, match=f"PlatenDrive.platen = {top}: the platen was turned by 1e-06 rad before iteration .*; fix: tilt it before"):
		run(2)


def test_platenInAClumpIsRefused(O, tier):
	springs()
	top = topPlaten(O, 0.1)
	ball = sphere((0, 0, 0), GRAIN)
	driven(O, tier, platen=top, **GOOD)
	O.bodies.clump([top, ball])
	with pytest.raises((ValueError, RuntimeError), match="clump.*; fix: "):
		O.step()


def test_orderOfEnginesIsChecked(O):
	"""Of the reference tier: the compact tier's steps have one order."""
	springs()
	top = topPlaten(O, 0.1)
	drive = driven(O, "reference", platen=top, **GOOD)
	O.engines = O.engines[:3] + [O.engines[4], drive]
	with pytest.raises(RuntimeError, match="comes after NewtonIntegrator"):
		O.step()


def test_pausedDriveBooksNoWork(O, tier):
	"""What happens while the engine is dead is not its doing: neither way nor work."""
	kn = 1e5
	springs(kn, 0.5 * kn)
	top = topPlaten(O, 0)
	sphere((0, 0, -GRAIN), GRAIN, fixed=True)
	drive = driven(O, tier, platen=top, velocity=0.1)
	O.dt = 1e-6
	run(101)
	way, work = drive.displacement, drive.work
	assert abs(way - 1e-5) < 1e-15
	drive.dead = True
	run(100)  # the platen keeps its velocity
	drive.dead = False
	O.step()
	assert (drive.displacement, drive.work) == (way, work)
	O.step()
	assert abs(drive.displacement - way - 1e-7) < 1e-15 and drive.work > work
