# SPDX-License-Identifier: GPL-2.0-or-later
"""MembraneORings in both tiers."""

import numpy as np
import pytest
from contactScene import sphere
from membraneScene import makeMembrane, positions, slack
from tiers import engines, find, run
from yade import MembraneBonds, MembraneORings, NewtonIntegrator, O


def platens(below=(0, 0, 0), above=(0, 0, 0)):
	"""Two fixed spheres with these velocities, which stand for the platens; massless, as their kinetic energy is nobody's work here."""
	ids = [sphere((0, 0, z), 0.01, fixed=True) for z in (-0.02, 0.05)]
	for i, velocity in zip(ids, (below, above)):
		O.bodies[i].state.mass = 0
		O.bodies[i].state.vel = velocity
	return ids


def test_ridingAndFixed(O, tier):
	m = makeMembrane()
	low, high = platens((0, 0, 0.1), (0.05, 0, -0.3))
	rings = MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = engines(tier, [slack(m), rings])
	O.dt = 1e-4
	before = positions(m)
	run(100)
	moved = positions(m) - before
	rows = m.oRingRows * m.perRing
	assert np.allclose(moved[:rows], (0, 0, 0.1 * 0.01), rtol=1e-9, atol=1e-15)
	assert np.allclose(moved[-rows:], (0.05 * 0.01, 0, -0.3 * 0.01), rtol=1e-9, atol=1e-15)
	assert np.abs(moved[rows:-rows]).max() < 1e-20  # the slack bonds'
	rings.mode = "fixed"
	before = positions(m)
	run(10)
	still = positions(m) - before
	assert (still[:rows] == 0).all() and (still[-rows:] == 0).all() and np.abs(still).max() < 1e-20


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_energyOfATubeStretchedByItsORings(O, tier, damping):
	"""elastic + kinetic + damped = work of the O-rings, which ride on platens that part and stop again.

	Kinetic energy and damping are read half a step off: an error linear in the step, small here.
	"""
	m = makeMembrane()
	low, high = platens()
	bonds = MembraneBonds(membrane=m, kn=500.0)
	rings = MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = engines(tier, [bonds, rings], damping=damping, substeps=150)
	O.trackEnergy = True
	O.dt = 0.02 * bonds.criticalTimeStep()
	largest = 0
	for speed in (0.05, 0.2, 0.0, -0.1):
		O.bodies[low].state.vel, O.bodies[high].state.vel = (0, 0, -speed), (0.3 * speed, 0, speed)
		for _ in range(8):
			run(150)
			names = dict(O.energy.items())
			total = names["elastMembrane"] + names["kinetic"] + names.get("nonviscDamp", 0.0)
			largest = max(largest, rings.work)
			assert total == pytest.approx(rings.work, abs=3e-3 * largest)
			assert names["oRingWork"] == -rings.work
	assert largest > 1e-5 and (damping == 0) == ("nonviscDamp" not in names or names["nonviscDamp"] == 0)


def test_workOfAPullAtRest(O, tier):
	"""One ring pulled against springs that answer linearly: the trapezoidal rule gives the stored energy exactly, the inertia's part apart."""
	m = makeMembrane()
	for i in m.ids:
		O.bodies[i].state.blockedDOFs = "xyzXYZ"  # no inertia but that of the O-rings
	low, high = platens(above=(0, 0, 1e-3))
	bonds = MembraneBonds(membrane=m, kn=500.0)
	rings = MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = engines(tier, [bonds, rings], damping=0.2)
	O.dt = 1e-4
	run(101)
	kinetic = 0.5 * m.oRingRows * m.perRing * O.bodies[m.ids[0]].state.mass * 1e-6
	assert rings.work == pytest.approx(bonds.elasticEnergy() + kinetic, rel=1e-4)
	assert kinetic < 0.5 * rings.work


def test_workGoesOnAfterLoad(O, tier, tmp_path):
	m = makeMembrane()
	low, high = platens((0, 0, 0.1), (0.05, 0, -0.3))
	rings = MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = engines(tier, [MembraneBonds(membrane=m, kn=500.0), rings])
	O.dt = 1e-6
	run(30)
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	run(30)
	work = rings.work
	O.reset()
	O.load(file)
	run(30)
	assert find(MembraneORings).work == work and work > 0


def test_wrongPlace(O):
	"""Of the reference tier: the compact tier's steps have one order."""
	rings = MembraneORings(membrane=makeMembrane())
	O.engines = [NewtonIntegrator(), rings]
	with pytest.raises(RuntimeError, match="comes after NewtonIntegrator"):
		rings()


def test_badInput(O, tier):
	m = makeMembrane()
	for rings, kind, message in (
		(MembraneORings(membrane=m, mode="free"), ValueError, "'fixed' or 'platens'"),
		(MembraneORings(membrane=m, mode="platens"), RuntimeError, "MembraneORings.bottomPlaten = -1"),
		(MembraneORings(), RuntimeError, "MembraneORings"),
	):
		O.engines = engines(tier, [slack(m), rings])
		with pytest.raises(kind) as error:
			O.step()
		assert message in str(error.value) and "fix:" in str(error.value)
