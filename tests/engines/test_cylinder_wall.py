# SPDX-License-Identifier: GPL-2.0-or-later
"""CylinderWall and RadialWallServo: seven spheres in a plane (one in six) inside a rigid wall."""

import math

import numpy as np
import pytest
import yade
from contactScene import force, sphere, springs
from tiers import contact, engines, find, run, state, writeContacts
from yade import O, RadialWallServo

R, r, HEIGHT, FRICTION = 0.03, 0.01, 0.02, 0.4


def scene(tier, stiffness=1e5, gap=2e-5, **servo):
	"""Six spheres round a seventh, the wall `gap` beyond touching, all contacts of this kn (N/m); the servo when it is asked for."""
	springs(stiffness, 0.3 * stiffness, friction=FRICTION)
	angles = np.arange(6) * math.pi / 3
	centres = [(0, 0, 0)] + [(2 * r * math.cos(a), 2 * r * math.sin(a), 0) for a in angles]
	grains = [sphere(c, r) for c in centres]
	wall = yade.Body()
	wall.shape = yade.CylinderWall(radius=R + gap, height=HEIGHT)
	wall.material = O.materials[0]
	wall.dynamic = False
	wall = O.bodies.append(wall)
	O.engines = engines(tier, [yade.RadialWallServo(wall=wall, **servo)] if servo else [], damping=0.2)
	O.dt = 0.2 * math.sqrt(O.bodies[0].state.mass / stiffness)
	return wall, grains


def test_normalForceIsStiffnessTimesOverlap(O, tier):
	wall, grains = scene(tier, gap=0.0)
	O.bodies[grains[1]].state.pos = (2 * r + 1e-4, 0, 0)
	O.dt = 1e-9
	O.step()
	found = contact(wall, grains[1])
	assert (found.id1, found.id2) == (wall, grains[1])
	assert found.geom.penetrationDepth == pytest.approx(1e-4, rel=1e-9)
	assert tuple(found.geom.normal) == pytest.approx((-1, 0, 0), abs=1e-12)
	assert force(grains[1])[0] == pytest.approx(-1e5 * 1e-4, rel=1e-9)
	assert tuple(force(wall)) == pytest.approx(tuple(-force(grains[1])), abs=1e-12)


def test_noTensionAndNothingBeyondTheEnds(O, tier):
	wall, grains = scene(tier, gap=0.0)
	O.bodies[grains[1]].state.pos = (2 * r - 1e-4, 0, 0)
	O.bodies[grains[2]].state.pos += (0.001, 0.001, HEIGHT)
	O.dt = 1e-9
	O.step()
	assert force(wall).norm() == 0


def test_slipOnTheWall(O, tier):
	"""A sphere pressed on the wall and drawn along it: friction is ks v t up to mu Fn."""
	wall, grains = scene(tier, gap=0.0)
	b = O.bodies[grains[1]]
	b.state.pos, b.state.vel, b.state.blockedDOFs = (2 * r + 1e-4, 0, 0), (0, 0, 0.1), "xyzXYZ"
	run(5)
	kn, ks = 1e5, 3e4
	# the velocity that was set counts in the step that makes the contact, too
	assert contact(wall, grains[1]).phys.shearForce[2] == pytest.approx(-ks * 0.1 * 5 * O.dt, rel=1e-9)
	run(int(0.002 / (0.1 * O.dt)))
	assert contact(wall, grains[1]).phys.shearForce.norm() == pytest.approx(FRICTION * kn * 1e-4, rel=1e-9)
	assert force(grains[1])[2] == pytest.approx(-FRICTION * kn * 1e-4, rel=1e-9)


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e7])
def test_servoHoldsTheStressForAnyStiffness(O, tier, stiffness):
	target = 0.002 * stiffness * 6 * r / (2 * math.pi * R * HEIGHT) / 3  # overlaps of about a thousandth
	wall, _ = scene(tier, stiffness, stress=target, height=HEIGHT, maxVelocity=0.02)
	servo = find(RadialWallServo)
	highest = 0
	for _ in range(150):
		run(20)
		highest = max(highest, servo.radialStress)
	assert servo.settled and servo.radialStress == pytest.approx(target, rel=1e-3)
	assert highest < 1.02 * target
	# an oracle of its own: sum of the contacts
	writeContacts()
	forces = [i.phys.normalForce.norm() for i in O.bodies[wall].intrs()]
	assert len(forces) == 6
	assert sum(forces) / (2 * math.pi * O.bodies[wall].shape.radius * HEIGHT) == pytest.approx(servo.radialStress, rel=1e-3)
	assert servo.work > 0


def test_theDashpotLetsAFlowPassOnceTheWallHasStopped(O, tier):
	"""A wall that overshoots closes above its target: there the whole dashpot still brakes it, and the flow begins when it has stopped."""
	target = 4e3
	scene(tier, 1e5, stress=target, height=HEIGHT, maxVelocity=0.5)
	servo, velocity, stopped, above = find(RadialWallServo), math.inf, False, 0
	for _ in range(400):
		run(1)
		stopped |= servo.radialStress >= target and velocity <= 0
		above += servo.radialStress >= target and not stopped
		velocity = servo.velocity
		assert (servo.flow != 0) == stopped
	assert above > 1 and stopped


def test_saveAndLoadContinueExactly(O, tier, tmp_path):
	wall, _ = scene(tier, 1e5, stress=2e3, height=HEIGHT, maxVelocity=0.02)

	def servoAndRadius():
		servo = find(RadialWallServo)
		return servo.work, servo.velocity, servo.radialStress, O.bodies[wall].shape.radius

	run(300)
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	run(300)
	whole, records = state(), servoAndRadius()
	O.reset()
	O.load(file)
	run(300)
	assert (state() == whole).all() and servoAndRadius() == records and records[0] > 0


def test_targetOutOfReachStopsTheRun(O, tier):
	scene(tier, 1e5, gap=5e-3, stress=2e3, height=HEIGHT, maxVelocity=1e-3, timeLimit=0.01)
	with pytest.raises(RuntimeError, match="RadialWallServo.timeLimit = 0.01: the wall carries 0 Pa of 2000 Pa"):
		for _ in range(1000):
			O.step()


BAD = [
	(dict(stress=float("nan")), ValueError, "RadialWallServo.stress"),
	(dict(stress=-1.0), ValueError, "RadialWallServo.stress = -1"),
	(dict(maxVelocity=float("nan")), ValueError, "RadialWallServo.maxVelocity"),
	(dict(maxRetreat=-1.0), ValueError, "RadialWallServo.maxRetreat = -1"),
	(dict(height=float("nan")), ValueError, "bottomPlaten and topPlaten"),
	(dict(wall=-1), ValueError, "RadialWallServo.wall = -1"),
	(dict(wall=0), ValueError, "no CylinderWall"),
	(dict(wall=999), RuntimeError, "RadialWallServo.wall = 999"),
	(dict(bottomPlaten=0, topPlaten=1), ValueError, "no Platen"),
	(dict(damping=-1.0), ValueError, "RadialWallServo.damping"),
]


@pytest.mark.parametrize("changes, kind, message", BAD, ids=[b[2] + str(n) for n, b in enumerate(BAD)])
def test_badInput(O, tier, changes, kind, message):
	wall, _ = scene(tier)
	arguments = dict(wall=wall, stress=1e3, height=HEIGHT, maxVelocity=0.01)
	arguments.update(changes)
	O.engines = engines(tier, [RadialWallServo(**arguments)])
	with pytest.raises(kind) as error:
		O.step()
	assert message in str(error.value) and "fix:" in str(error.value)
	assert O.bodies[wall].shape.radius == R + 2e-5
