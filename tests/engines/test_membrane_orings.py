# SPDX-License-Identifier: GPL-2.0-or-later
import numpy as np
import pytest

from membraneScene import makeMembrane, positions


def platens():
	from yade import O, utils

	low, high = O.bodies.append([utils.sphere((0, 0, z), 0.01, fixed=True) for z in (-0.02, 0.05)])
	O.bodies[low].state.vel = (0, 0, 0.1)
	O.bodies[high].state.vel = (0.05, 0, -0.3)
	return low, high


def test_ridingAndFixed(O):
	from yade import NewtonIntegrator
	from yade.wrapper import MembraneORings

	m = makeMembrane()
	low, high = platens()
	rings = MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = [rings, NewtonIntegrator()]
	O.dt = 1e-3
	before = positions(m)
	O.run(10, True)
	moved = positions(m) - before
	rows = m.oRingRows * m.perRing
	assert np.allclose(moved[:rows], (0, 0, 0.1 * 0.01), rtol=1e-9, atol=1e-15)
	assert np.allclose(moved[-rows:], (0.05 * 0.01, 0, -0.3 * 0.01), rtol=1e-9, atol=1e-15)
	assert (moved[rows:-rows] == 0).all()
	rings.mode = "fixed"
	before = positions(m)
	O.run(10, True)
	assert (positions(m) == before).all()


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_energyOfATubeStretchedByItsORings(O, damping):
	"""elastic + kinetic + damped = work of the O-rings, which ride on platens that part and stop again.

	Kinetic energy and damping are read half a step off: an error linear in the step, small here.
	"""
	import yade

	m = makeMembrane()
	low, high = O.bodies.append([yade.utils.sphere((0, 0, z), 0.01, fixed=True) for z in (-0.02, 0.05)])
	for i in (low, high):
		O.bodies[i].state.mass = 0  # their kinetic energy is nobody's work here
	bonds = yade.MembraneBonds(membrane=m, kn=500.0)
	rings = yade.MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = [yade.ForceResetter(), bonds, rings, yade.NewtonIntegrator(damping=damping)]
	O.trackEnergy = True
	O.dt = 0.02 * bonds.criticalTimeStep()
	largest = 0
	for speed in (0.05, 0.2, 0.0, -0.1):
		O.bodies[low].state.vel, O.bodies[high].state.vel = (0, 0, -speed), (0.3 * speed, 0, speed)
		for _ in range(8):
			for _ in range(150):
				O.step()
			names = dict(O.energy.items())
			total = names["elastMembrane"] + names["kinetic"] + names.get("nonviscDamp", 0.0)
			largest = max(largest, rings.work)
			assert total == pytest.approx(rings.work, abs=3e-3 * largest)
			assert names["oRingWork"] == -rings.work
	assert largest > 1e-5 and (damping == 0) == ("nonviscDamp" not in names or names["nonviscDamp"] == 0)


def test_workOfAPullAtRest(O):
	"""One ring pulled against springs that answer linearly: the trapezoidal rule gives the stored energy exactly, the inertia's part apart."""
	import yade

	m = makeMembrane()
	for i in m.ids:
		O.bodies[i].state.blockedDOFs = "xyzXYZ"  # no inertia but that of the O-rings
	low, high = O.bodies.append([yade.utils.sphere((0, 0, z), 0.01, fixed=True) for z in (-0.02, 0.05)])
	O.bodies[high].state.vel = (0, 0, 1e-3)
	bonds = yade.MembraneBonds(membrane=m, kn=500.0)
	rings = yade.MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = [yade.ForceResetter(), bonds, rings, yade.NewtonIntegrator(damping=0.2)]
	O.dt = 1e-4
	for _ in range(101):
		O.step()
	kinetic = 0.5 * m.oRingRows * m.perRing * O.bodies[m.ids[0]].state.mass * 1e-6
	assert rings.work == pytest.approx(bonds.elasticEnergy() + kinetic, rel=1e-4)
	assert kinetic < 0.5 * rings.work


def test_workGoesOnAfterLoad(O, tmp_path):
	import yade

	m = makeMembrane()
	low, high = platens()
	rings = yade.MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = [yade.ForceResetter(), yade.MembraneBonds(membrane=m, kn=500.0), rings, yade.NewtonIntegrator()]
	O.dt = 1e-6
	O.run(30, True)
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	O.run(30, True)
	work = rings.work
	O.reset()
	O.load(file)
	O.run(30, True)
	assert O.engines[2].work == work and work > 0


def test_wrongPlace(O):
	from yade import NewtonIntegrator
	from yade.wrapper import MembraneORings

	rings = MembraneORings(membrane=makeMembrane())
	O.engines = [NewtonIntegrator(), rings]
	with pytest.raises(RuntimeError, match="comes after NewtonIntegrator"):
		rings()


def test_badInput(O):
	from yade.wrapper import MembraneORings

	m = makeMembrane()
	with pytest.raises(ValueError, match="'fixed' or 'platens'"):
		MembraneORings(membrane=m, mode="free")()
	with pytest.raises(RuntimeError, match="MembraneORings.bottomPlaten = -1"):
		MembraneORings(membrane=m, mode="platens")()
	with pytest.raises(RuntimeError, match="MembraneORings.membrane = None"):
		MembraneORings()()
