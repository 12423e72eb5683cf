# SPDX-License-Identifier: GPL-2.0-or-later
"""Engines that book work, paused by ``dead``: what happens meanwhile is not their doing."""

import pytest
from membraneScene import makeMembrane


def pressing(m):
	import yade

	return yade.MembranePressure(membrane=m, pressure=1e5)


def pressingOnAMesh(m):
	import yade

	return yade.MembranePressure(ids=m.ids, triangles=m.triangles, surface="centre", pressure=1e5)


def pressingRadially(m):
	import yade

	return yade.MembraneRadialServo(membrane=m, pressure=1e5)


def gripping(m):
	"""O-rings that ride on bodies which part at a steady velocity."""
	import yade
	from yade import O

	low, high = O.bodies.append([yade.utils.sphere((0, 0, z), 0.01, fixed=True) for z in (-0.02, 0.05)])
	O.bodies[low].state.vel, O.bodies[high].state.vel = (0, 0, -0.1), (0, 0, 0.1)
	return yade.MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)


@pytest.mark.parametrize("make", (pressing, pressingOnAMesh, pressingRadially, gripping), ids=lambda make: make.__name__)
def test_workOverAPauseIsNobodysWork(O, make):
	import yade

	m = makeMembrane()
	engine = make(m)
	O.engines = [yade.ForceResetter(), yade.MembraneBonds(membrane=m, kn=5e3), engine, yade.NewtonIntegrator(damping=0.2)]
	O.dt = 0.1 * O.engines[1].criticalTimeStep()
	O.run(200, True)
	before = engine.work
	assert before > 0
	O.step()
	usual = engine.work - before
	work = engine.work
	engine.dead = True
	O.run(200, True)
	engine.dead = False
	O.step()
	assert engine.work == work
	O.step()
	assert 0 < abs(engine.work - work) < 20 * abs(usual)


def test_aWallServoBooksNoWorkOverAPause(O):
	from test_cylinder_wall import HEIGHT, scene

	wall, grains = scene(1e5, stress=2e3, height=HEIGHT, maxVelocity=0.02)
	servo = O.engines[3]
	O.run(600, True)
	work, radius = servo.work, O.bodies[wall].shape.radius
	assert work > 0
	servo.dead = True
	O.bodies[wall].shape.radius = 0.999 * radius  # by somebody else
	O.run(10, True)
	servo.dead = False
	O.step()
	assert servo.work == work
	O.step()
	assert servo.work != work
