# SPDX-License-Identifier: GPL-2.0-or-later
"""CylinderWall and RadialWallServo: seven spheres in a plane (one in six) inside a rigid wall."""

import math

import numpy as np
import pytest

R, r, HEIGHT = 0.03, 0.01, 0.02


def scene(stiffness=1e5, gap=2e-5, **servo):
	"""Six spheres round a seventh, the wall `gap` beyond touching; stiffness is the young that gives contacts of about that kn."""
	from yade import (
		Body,
		Bo1_Sphere_Aabb,
		ForceResetter,
		FrictMat,
		Ig2_Sphere_Sphere_ScGeom,
		InsertionSortCollider,
		InteractionLoop,
		Ip2_FrictMat_FrictMat_FrictPhys,
		Law2_ScGeom_FrictPhys_CundallStrack,
		NewtonIntegrator,
		O,
		utils,
	)
	from yade.wrapper import Bo1_CylinderWall_Aabb, CylinderWall, Ig2_CylinderWall_Sphere_ScGeom, RadialWallServo

	O.materials.append(FrictMat(young=stiffness / r, poisson=0.3, frictionAngle=0.4, density=2650))
	angles = np.arange(6) * math.pi / 3
	centres = [(0, 0, 0)] + [(2 * r * math.cos(a), 2 * r * math.sin(a), 0) for a in angles]
	grains = O.bodies.append([utils.sphere(c, r) for c in centres])
	wall = Body()
	wall.shape = CylinderWall(radius=R + gap, height=HEIGHT)
	wall.material = O.materials[0]
	wall.dynamic = False
	wall = O.bodies.append(wall)
	O.engines = [
		ForceResetter(),
		InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_CylinderWall_Aabb()], verletDist=0.05 * r),
		InteractionLoop(
			[Ig2_Sphere_Sphere_ScGeom(), Ig2_CylinderWall_Sphere_ScGeom()],
			[Ip2_FrictMat_FrictMat_FrictPhys()],
			[Law2_ScGeom_FrictPhys_CundallStrack()],
		),
		NewtonIntegrator(damping=0.2),
	]
	O.dt = 0.2 * math.sqrt(O.bodies[0].state.mass / stiffness)
	if servo:
		O.engines = O.engines[:3] + [RadialWallServo(wall=wall, **servo)] + O.engines[3:]
	return wall, grains


def test_normalForceIsStiffnessTimesOverlap(O):
	wall, grains = scene(gap=0.0)
	O.bodies[grains[1]].state.pos = (2 * r + 1e-4, 0, 0)
	O.dt = 1e-9
	O.step()
	contact = O.interactions[wall, grains[1]]
	assert (contact.id1, contact.id2) == (wall, grains[1])
	assert contact.geom.penetrationDepth == pytest.approx(1e-4, rel=1e-9)
	assert tuple(contact.geom.normal) == pytest.approx((-1, 0, 0), abs=1e-12)
	assert O.forces.f(grains[1])[0] == pytest.approx(-contact.phys.kn * 1e-4, rel=1e-9)
	assert tuple(O.forces.f(wall)) == pytest.approx(tuple(-O.forces.f(grains[1])), abs=1e-12)


def test_noTensionAndNothingBeyondTheEnds(O):
	wall, grains = scene(gap=0.0)
	O.bodies[grains[1]].state.pos = (2 * r - 1e-4, 0, 0)
	O.bodies[grains[2]].state.pos += (0.001, 0.001, HEIGHT)
	O.dt = 1e-9
	O.step()
	assert O.forces.f(wall).norm() == 0


def test_slipOnTheWall(O):
	"""A sphere pressed on the wall and drawn along it: friction grows with ks and ends at mu Fn."""
	wall, grains = scene(gap=0.0)
	b = O.bodies[grains[1]]
	b.state.pos, b.state.vel, b.state.blockedDOFs = (2 * r + 1e-4, 0, 0), (0, 0, 0.1), "xyzXYZ"
	O.run(5, True)
	contact = O.interactions[wall, grains[1]]
	fn = contact.phys.normalForce.norm()
	moved = b.state.pos[2]
	assert contact.phys.shearForce[2] != 0
	assert abs(contact.phys.shearForce[2]) == pytest.approx(contact.phys.ks * (moved - 0.1 * O.dt), rel=0.3)
	O.run(int(0.002 / (0.1 * O.dt)), True)
	assert contact.phys.shearForce.norm() == pytest.approx(math.tan(0.4) * fn, rel=1e-9)
	assert O.forces.f(grains[1])[2] == pytest.approx(-math.tan(0.4) * fn, rel=1e-9)


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e7])
def test_servoHoldsTheStressForAnyStiffness(O, stiffness):
	target = 0.002 * stiffness * 6 * r / (2 * math.pi * R * HEIGHT) / 3  # overlaps of about a thousandth
	wall, grains = scene(stiffness, stress=target, height=HEIGHT, maxVelocity=0.02)
	servo = O.engines[3]
	highest = 0
	for _ in range(150):
		O.run(20, True)
		highest = max(highest, servo.radialStress)
	assert servo.settled and servo.radialStress == pytest.approx(target, rel=1e-3)
	assert highest < 1.02 * target
	# an oracle of its own: sum of the contacts
	forces = [i.phys.normalForce.norm() for i in O.bodies[wall].intrs()]
	assert len(forces) == 6
	assert sum(forces) / (2 * math.pi * O.bodies[wall].shape.radius * HEIGHT) == pytest.approx(servo.radialStress, rel=1e-3)
	assert servo.work > 0


def test_saveAndLoadContinueExactly(O, tmp_path):
	wall, grains = scene(1e5, stress=2e3, height=HEIGHT, maxVelocity=0.02)
	O.run(300, True)
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	O.run(300, True)

	def state():
		return [tuple(O.bodies[g].state.pos) for g in grains] + [O.bodies[wall].shape.radius, O.engines[3].work, O.engines[3].velocity]

	whole = state()
	O.reset()
	O.load(file)
	O.run(300, True)
	assert state() == whole and O.engines[3].work > 0


def test_targetOutOfReachStopsTheRun(O):
	scene(1e5, gap=5e-3, stress=2e3, height=HEIGHT, maxVelocity=1e-3, timeLimit=0.01)
	with pytest.raises(RuntimeError, match="RadialWallServo.timeLimit = 0.01: the wall carries 0 Pa of 2000 Pa"):
		for _ in range(1000):
			O.step()  # O.run may lose the message: it waits for a run that has ended before it began to wait


BAD = [
	(dict(stress=float("nan")), ValueError, "RadialWallServo.stress"),
	(dict(stress=-1.0), ValueError, "RadialWallServo.stress = -1"),
	(dict(maxVelocity=float("nan")), ValueError, "RadialWallServo.maxVelocity"),
	(dict(height=float("nan")), ValueError, "bottomPlaten and topPlaten"),
	(dict(wall=-1), ValueError, "RadialWallServo.wall = -1"),
	(dict(wall=0), ValueError, "no CylinderWall"),
	(dict(wall=999), RuntimeError, "RadialWallServo.wall = 999"),
	(dict(bottomPlaten=0, topPlaten=1), ValueError, "no Platen"),
	(dict(damping=-1.0), ValueError, "RadialWallServo.damping"),
]


@pytest.mark.parametrize("changes, kind, message", BAD, ids=[b[2] + str(n) for n, b in enumerate(BAD)])
def test_badInput(O, changes, kind, message):
	from yade.wrapper import RadialWallServo

	wall, grains = scene()
	arguments = dict(wall=wall, stress=1e3, height=HEIGHT, maxVelocity=0.01)
	arguments.update(changes)
	with pytest.raises(kind) as error:
		RadialWallServo(**arguments)()
	assert message in str(error.value) and "fix:" in str(error.value)
	assert O.bodies[wall].shape.radius == R + 2e-5
