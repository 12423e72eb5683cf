# SPDX-License-Identifier: GPL-2.0-or-later
"""PlatenDrive: velocity and stress, what it records, and what it refuses."""

import math

import pytest
import yade
from hexmembrane.scene.platens import platen
from platenScene import DENSITY, engines, floor, material, sphere
from yade import PlatenDrive, Quaternion, Vector3

RADIUS, HEIGHT, GRAIN = 0.01, 0.004, 0.001


def topPlaten(O, face, radius=RADIUS):
	return O.bodies.append(platen((0, 0, face), radius, HEIGHT, -1))


def driven(O, kn=1e5, **drive):
	"""Engines with a drive of the top platen, which is returned."""
	drive = PlatenDrive(**{"direction": (0, 0, -1), **drive})
	engines(O, kn, 0.5 * kn, before=[drive], damping=0.2)
	return drive


def grainMass():
	return DENSITY * 4 / 3 * math.pi * GRAIN**3


def stack(O, layers, side, kn, platenRadius=RADIUS):
	"""side x side columns of `layers` spheres that slide in frictionless tubes, of uneven height; returns (bottom, top) platen ids.

	The tubes are the blocked horizontal directions. The columns end at different heights, by up to a few overlaps under 0.2 N, so that the number of
	contacts grows as the platen comes down.
	"""
	uneven = 0.5 / kn
	material(O)
	bottom = floor(O, platenRadius, HEIGHT)
	for i in range(side):
		for j in range(side):
			low = uneven * ((3 * i + 5 * j) % 7) / 7
			for k in range(layers):
				ball = sphere(O, (3 * GRAIN * (i - 0.5 * (side - 1)), 3 * GRAIN * (j - 0.5 * (side - 1)), low + GRAIN * (2 * k + 1)), GRAIN)
				O.bodies[ball].state.blockedDOFs = "xyXYZ"
	top = topPlaten(O, 2 * GRAIN * layers + 1.2 * uneven, platenRadius)
	O.dt = 0.3 * math.sqrt(grainMass() / kn)
	return bottom, top


def test_velocityRampIsTheCosineAndExactInSum(O):
	speed, ramp = 0.05, 2e-3
	material(O)
	top = topPlaten(O, 0.1)
	drive = driven(O, platen=top, velocity=speed, rampTime=ramp)
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
def test_forceAndWorkOfALinearContact(O, direction):
	"""Driven against a fixed sphere, along any axis: F = kn un, W = kn un^2/2, which the trapezoid gives exactly for a linear spring."""
	kn, speed = 2e5, 0.1
	unit = Vector3(direction).normalized()
	material(O)
	body = platen((0, 0, 0), RADIUS, HEIGHT, +1)
	body.state.ori = Quaternion()
	body.state.ori.setFromTwoVectors(Vector3(0, 0, 1), unit)
	turn = Quaternion()
	turn.setFromTwoVectors(Vector3(0, 0, 1), unit)
	body.state.ori, body.state.pos = turn, Vector3.Zero
	plate = O.bodies.append(body)
	ball = sphere(O, unit * (0.5 * HEIGHT + GRAIN), GRAIN, fixed=True)
	drive = driven(O, kn, platen=plate, direction=direction, velocity=speed)
	O.dt = 1e-6
	O.run(1001, True)
	overlap = speed * 1000 * O.dt
	assert abs(drive.displacement - overlap) < 1e-12 * overlap
	assert abs(drive.force - kn * overlap) < 1e-10 * kn * overlap
	# One contact at overlap 0 is lost or not by rounding, so the first step may be missing: far below the tolerance.
	assert abs(drive.work - 0.5 * kn * overlap**2) < 1e-9 * kn * overlap**2
	pushed = O.forces.f(ball, sync=True)
	assert (pushed - unit * drive.force).norm() < 1e-10 * drive.force  # action = reaction


def test_workIsTheForceIntegralAndEnergyCloses(O):
	"""A stack loaded, unloaded and loaded again: the recorded work is the integral of the recorded force, and equals what the grains hold and have lost."""
	kn = 1e5
	bottom, top = stack(O, 4, 1, kn)
	drive = driven(O, kn, platen=top, velocity=0.2, rampTime=1e-4)
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


def test_newTargetStartsFromThePresentVelocity(O):
	"""Through changes of velocity and both changes of mode, no step of a ramp changes the velocity by more than the ramp's steepest part."""
	kn, ramp = 1e5, 2e-3
	bottom, top = stack(O, 3, 1, kn)
	drive = driven(O, kn, platen=top, velocity=0.02, rampTime=ramp, maxVelocity=0.05)
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


@pytest.mark.parametrize("kn", (1e3, 1e5, 1e7))
@pytest.mark.parametrize("layers, side, ramp", ((3, 1, 0), (3, 1, 400), (8, 3, 0), (8, 3, 2000)))
def test_stressServoReachesItsTargetWithoutOvershoot(O, kn, layers, side, ramp):
	"""0.2 N a column, from a gap: overlaps from 1e-5 to 0.1 of a grain's diameter. No setting is changed with the stiffness."""
	target = 0.2 * side**2
	area = target / 1e5
	bottom, top = stack(O, layers, side, kn)
	drive = driven(O, kn, platen=top, mode="stress", stress=1e5, area=area, rampTime=ramp * O.dt)
	peak, settledAt = 0.0, None
	for block in range(4000):
		for _ in range(10):
			O.step()
			peak = max(peak, drive.force)
		if settledAt is None and drive.settled:
			settledAt = 10 * block
		if drive.settled and abs(drive.force / target - 1) < 1e-4 and abs(O.bodies[top].state.vel[2]) * O.dt * kn < 1e-6 * target:
			break
	print("kn %g N/m, %d layers x %d, ramp %d steps: settled (1 %%) at step %s, peak %.4f of the target" % (kn, layers, side**2, ramp, settledAt, peak / target))
	assert settledAt is not None
	assert abs(drive.force / target - 1) < 1e-3
	assert peak < 1.02 * target
	# What the top platen carries is what arrives below.
	assert abs(O.forces.f(bottom, sync=True)[2] / -target - 1) < 5e-3


def test_givenMassIsAFreeBody(O):
	"""Nothing in its way: the platen falls with a = sigma A/m, to the velocity limit and no further."""
	material(O)
	top = topPlaten(O, 0.1)
	drive = driven(O, platen=top, mode="stress", stress=1e5, mass=0.5, maxVelocity=0.3, area=1e-5)
	O.dt = 1e-4
	for step in range(1, 1500):
		O.step()
		expected = min(step * O.dt * 1e5 * 1e-5 / 0.5, 0.3)
		assert abs(O.bodies[top].state.vel[2] + expected) < 1e-12
	assert drive.stiffness == 0 and not drive.settled


def test_approachFollowsStressAndDensity(O):
	"""maxVelocity = 1e-3 sqrt(stress/density), density from the movable spheres alone."""
	material(O)
	sphere(O, (0, 0, -1), 0.1, fixed=True)
	ball = sphere(O, (0, 0, -2), 0.1)
	O.bodies[0].state.mass = 1e9
	top = topPlaten(O, 0.1)
	driven(O, platen=top, mode="stress", stress=1e5)
	O.dt = 1e-6
	O.step()
	assert O.bodies[ball].dynamic
	assert abs(O.bodies[top].state.vel[2] + 1e-3 * math.sqrt(1e5 / DENSITY)) < 1e-12


def test_stiffnessIsTheSumOverTheContacts(O):
	"""Face contacts count with kn, a contact at the side of the platen with ks."""
	kn = 1e4
	material(O)
	top = topPlaten(O, 0)
	for x in (-0.005, 0, 0.005):
		sphere(O, (x, 0, -0.99 * GRAIN), GRAIN, fixed=True)
	sphere(O, (RADIUS + 0.99 * GRAIN, 0, 0.5 * HEIGHT), GRAIN, fixed=True)
	drive = driven(O, kn, platen=top, mode="stress", stress=1e5, maxVelocity=1e-9)
	O.step()
	assert abs(drive.stiffness - (3 * kn + 0.5 * kn)) < 1e-9 * kn
	drive.contactStiffness = 123.0
	O.step()
	assert drive.stiffness == 123.0


def test_timeLimitStopsTheRun(O):
	bottom, top = stack(O, 2, 1, 1e5)
	O.bodies.erase(2)
	drive = driven(O, platen=top, mode="stress", stress=1e5, maxVelocity=1e-6, timeLimit=20 * O.dt)
	for _ in range(20):
		O.step()
	with pytest.raises(RuntimeError, match=r"PlatenDrive.timeLimit = .*: platen 3 carries 0 N of 31.4159 N .*at iteration 2\d"):
		for _ in range(5):
			O.step()


def test_timeLimitIsMetByASettledServo(O):
	bottom, top = stack(O, 2, 1, 1e5)
	drive = driven(O, platen=top, mode="stress", stress=1e4, area=1e-5, timeLimit=4000 * O.dt)
	O.run(6000, True)
	assert drive.settled


def state(O, drive):
	kept = [(tuple(b.state.pos), tuple(b.state.vel)) for b in O.bodies]
	return kept, drive.force, drive.work, drive.displacement, drive.stiffness, drive.settled


@pytest.mark.parametrize("at", (300, 1200, 2000))
def test_savedAndLoadedInEveryPhaseIsTheSameRun(O, tmp_path, at):
	"""Saved in the middle of a velocity ramp, in the middle of a stress ramp, under constant stress: exactly the run that was not."""
	kn = 1e5

	def go(drive, start, end):
		for step in range(start, end):
			if step == 1000:
				drive.mode, drive.stress = "stress", 2e4
			O.step()

	bottom, top = stack(O, 3, 1, kn)
	drive = driven(O, kn, platen=top, velocity=0.02, area=1e-5, rampTime=500 * O.dt)
	go(drive, 0, at)
	file = str(tmp_path / "half.yade.gz")
	O.save(file)
	go(drive, at, 3000)
	whole = state(O, drive)
	assert drive.force > 0
	O.reset()
	O.load(file)
	loaded = O.engines[3]
	assert isinstance(loaded, PlatenDrive)
	go(loaded, at, 3000)
	assert state(O, loaded) == whole


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
def test_refusesBeforeAnythingMoves(O, change, part):
	material(O)
	sphere(O, (0, 0, -1), GRAIN)
	top = topPlaten(O, 0.1)
	drive = driven(O, **{"platen": top, **GOOD, **change})
	before = O.bodies[top].state.vel
	with pytest.raises(ValueError, match=part):
		drive()
	assert O.bodies[top].state.vel == before and O.bodies[0].state.blockedDOFs == ""


def test_refusesAnApproachWithoutAVelocity(O):
	material(O)
	top = topPlaten(O, 0.1)
	drive = driven(O, platen=top, **{**GOOD, **STRESS})
	with pytest.raises(ValueError, match="PlatenDrive.maxVelocity = nan: no movable sphere"):
		drive()


def test_missingAndErasedBodies(O):
	material(O)
	top = topPlaten(O, 0.1)
	drive = driven(O, platen=17, **GOOD)
	with pytest.raises(RuntimeError, match=r"PlatenDrive.platen = 17: there is no such body"):
		drive()
	drive.platen = top
	O.run(10, True)
	O.bodies.erase(top)
	with pytest.raises(RuntimeError, match=r"PlatenDrive.platen = 0: there is no such body \(erased\?\)"):
		O.step()


def test_platenInAClumpIsRefused(O):
	material(O)
	top = topPlaten(O, 0.1)
	ball = sphere(O, (0, 0, 0), GRAIN)
	drive = driven(O, platen=top, **GOOD)
	O.bodies.clump([top, ball])
	with pytest.raises(ValueError, match="belongs to a clump"):
		drive()


def test_orderOfEnginesIsChecked(O):
	material(O)
	top = topPlaten(O, 0.1)
	drive = driven(O, platen=top, **GOOD)
	O.engines = O.engines[:3] + [O.engines[4], drive]
	with pytest.raises(RuntimeError, match="comes after NewtonIntegrator"):
		O.step()


def test_pausedDriveBooksNoWork(O):
	"""What happens while the engine is dead is not its doing: neither way nor work."""
	kn = 1e5
	material(O)
	top = topPlaten(O, 0)
	sphere(O, (0, 0, -GRAIN), GRAIN, fixed=True)
	drive = driven(O, kn, platen=top, velocity=0.1)
	O.dt = 1e-6
	O.run(101, True)
	way, work = drive.displacement, drive.work
	assert abs(way - 1e-5) < 1e-15
	drive.dead = True
	O.run(100, True)  # the platen keeps its velocity
	drive.dead = False
	O.step()
	assert (drive.displacement, drive.work) == (way, work)
	O.step()
	assert abs(drive.displacement - way - 1e-7) < 1e-15 and drive.work > work
