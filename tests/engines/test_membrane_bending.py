# SPDX-License-Identifier: GPL-2.0-or-later
"""MembraneBending in both tiers. Plates, the cantilever and the buckling load: tests/kernels/BendingForceTest.cpp."""

import math

import numpy as np
import pytest
from membraneScene import forcesOn, makeMembrane, positions, shake, slack
from tiers import engines, find, loop, run, state
from yade import HexMembrane, MembraneBending, MembraneBonds, Vector3, utils

D = 5e-5


def bent(O, tier, membrane, substeps=1, stiffness=D):
	"""A scene of the membrane and its bending alone."""
	bending = MembraneBending(membrane=membrane, stiffness=stiffness)
	O.engines = engines(tier, [slack(membrane), bending], substeps=substeps)
	return bending


def departures(membrane, x):
	"""x less the mean of its six neighbours, zero where there are not six, in numpy."""
	bonds = np.array([tuple(b) for b in membrane.bonds])
	both = np.concatenate([bonds, bonds[:, ::-1]])
	total = np.zeros_like(x)
	np.add.at(total, both[:, 0], x[both[:, 1]])
	six = np.bincount(both[:, 0], minlength=len(x)) == 6
	return np.where(six[:, None], x - total / 6, 0)


def transposed(membrane, b):
	"""B^T b: a row of b acts on its own particle and, less a sixth, on each of its neighbours."""
	bonds = np.array([tuple(pair) for pair in membrane.bonds])
	answer = b.copy()
	np.add.at(answer, bonds[:, 0], -b[bonds[:, 1]] / 6)
	np.add.at(answer, bonds[:, 1], -b[bonds[:, 0]] / 6)
	return answer


def test_forcesAndEnergyAreThoseOfThePlate(O, tier):
	m = makeMembrane()
	rest = positions(m)
	x = shake(m, 2e-4)
	bending = bent(O, tier, m)
	O.trackEnergy = True
	O.dt = 1e-9  # positions stay
	O.step()
	spring = 8 * math.sqrt(3) * D / (2 * m.sphereRadius) ** 2
	assert bending.springStiffness == pytest.approx(spring, rel=1e-14)
	change = departures(m, x) - departures(m, rest)
	expected = -spring * transposed(m, change)
	assert np.abs(forcesOn(m.ids) - expected).max() < 1e-12 * np.abs(expected).max()
	assert bending.elasticEnergy() == pytest.approx(0.5 * spring * (change**2).sum(), rel=1e-12)
	assert dict(O.energy.items())["elastBending"] == bending.elasticEnergy()


def test_generatedMembraneStaysAtRestWhereverItStands(O, tier):
	m = makeMembrane(origin=(0.1, -0.2, 0.3))
	bending = bent(O, tier, m, substeps=100)
	O.dt = 0.3 * bending.criticalTimeStep()
	before = positions(m)
	run(200)
	assert np.abs(positions(m) - before).max() < 1e-10 * m.sphereRadius


def test_energyIsKept(O, tier):
	m = makeMembrane()
	shake(m, 1e-4)
	bending = bent(O, tier, m, substeps=120)
	O.dt = 0.02 * bending.criticalTimeStep()
	run(1)
	start = bending.elasticEnergy()
	totals = []
	for _ in range(10):
		run(120)
		totals.append(bending.elasticEnergy() + utils.kineticEnergy())
	assert start > 0
	assert max(abs(t - start) for t in totals) < 0.01 * start


@pytest.mark.parametrize("share, steps, grows", [(0.95, 3000, False), (1.05, 40, True)], ids=["below", "above"])
def test_reportedStepIsTheCriticalOne(O, tier, share, steps, grows):
	"""Of bending alone: 0.95 and 1.05 of it; the tube's own is within 1 %."""
	m = makeMembrane()
	shake(m, 1e-8)
	bending = bent(O, tier, m, substeps=10)
	O.dt = share * bending.criticalTimeStep()
	run(1)
	start = bending.elasticEnergy() + utils.kineticEnergy()
	if grows and tier == "compact":
		with pytest.raises(RuntimeError, match="half a skin"):
			run(10 * steps)
		return
	run(steps)
	assert (bending.elasticEnergy() + utils.kineticEnergy() > 100 * start) == grows


def test_compactCriticalStepCountsBonds(O):
	"""Bonds and bending at once, by power iteration: above the sum of both squares, at most either's own; stable at 0.95, lost at 1.05."""
	m = makeMembrane()
	shake(m, 1e-8)
	bonds = MembraneBonds(membrane=m, kn=400.0, ks=0.0)
	bending = MembraneBending(membrane=m, stiffness=1e-4)
	O.engines = engines("compact", [bonds, bending], substeps=10)
	alone = [engine.criticalTimeStep() for engine in (bonds, bending)]
	O.dt = 1e-9
	O.step()
	step = loop().criticalTimeStep()
	assert 0.99 * sum(s**-2 for s in alone) ** -0.5 < step < 0.99 * min(alone)
	O.dt = 0.95 * step
	run(2000)
	assert max(O.bodies[i].state.vel.norm() for i in m.ids) * O.dt < 1e-3 * m.sphereRadius
	O.dt = 1.05 * step
	with pytest.raises(RuntimeError, match="half a skin"):
		run(1000)


def test_stiffnessAgainstBreathing(O, tier):
	"""All rings wider by w = a R: the restoring force a particle is k_b b^2 w with b of one ring, and tends to a plate's D w/R^4 an area."""
	m = makeMembrane(specimenHeight=0.02)
	bending = bent(O, tier, m)
	# four of the six neighbours stand half a step further round, two a whole one
	b = 1 - (2 * math.cos(2 * math.pi / m.perRing) + 4 * math.cos(math.pi / m.perRing)) / 6
	a = 1e-4
	for i in m.ids:
		x, y, _ = O.bodies[i].state.pos
		O.bodies[i].state.pos += a * Vector3(x, y, 0)
	O.dt = 1e-9
	O.step()
	middle = slice(m.perRing * (m.rings // 2), m.perRing * (m.rings // 2 + 1))
	inwards = np.linalg.norm(forcesOn(m.ids)[middle], axis=1)
	w = a * m.centreRadius
	assert inwards == pytest.approx(bending.springStiffness * b**2 * w, rel=1e-9)
	assert inwards == pytest.approx(2 * math.sqrt(3) * m.sphereRadius**2 * D * w / m.centreRadius**4, rel=0.02)


def test_tiersAgree(O):
	found = []
	for tier in ("reference", "compact"):
		O.reset()
		m = makeMembrane()
		shake(m, 2e-4)
		O.engines = engines(tier, [MembraneBonds(membrane=m, kn=400.0), MembraneBending(membrane=m, stiffness=D)], damping=0.2)
		O.dt = 1e-5
		run(1)
		found.append(state(m.ids))
	assert np.abs(found[0] - found[1]).max() < 1e-11 * np.abs(found[0]).max()


def test_saveAndLoadContinueExactly(O, tier, tmp_path):
	m = makeMembrane()
	shake(m, 3e-4)
	O.engines = engines(tier, [MembraneBonds(membrane=m, kn=400.0), MembraneBending(membrane=m, stiffness=D)])
	O.dt = 1e-5
	run(60)
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	run(60)
	whole = state(m.ids)
	O.reset()
	O.load(file)
	run(60)
	assert (state(find(MembraneBending).membrane.ids) == whole).all()


def test_ownLoads(O, tier):
	"""What the bending carries balances what it does to the particles: through a plane the axial forces above it, and nothing beyond the ends."""
	m = makeMembrane()
	shake(m, 2e-4)
	bending = bent(O, tier, m)
	O.dt = 1e-9
	O.step()
	z = positions(m)[:, 2]
	force = forcesOn(m.ids)
	middle = 0.5 * (z.min() + z.max())
	assert bending.axialTension([middle])[0] == pytest.approx(force[z < middle, 2].sum(), rel=1e-9)
	assert abs(bending.axialTension([z.min() - 1])[0]) < 1e-12 * np.abs(force).max() * len(z)
	assert bending.axialTension([z.max() + 1])[0] == 0
	inwards = bending.radialShare(3)
	bending.stiffness = 2 * D
	O.step()
	assert bending.radialShare(3) == pytest.approx(2 * inwards, rel=1e-3) != 0


def test_badInput(O):
	m = makeMembrane()
	O.dt = 1e-6
	for arguments, message in (
		(dict(membrane=m), "MembraneBending.stiffness = nan"),
		(dict(membrane=m, stiffness=-1.0), "MembraneBending.stiffness = -1"),
		(dict(stiffness=D), "MembraneBending.membrane = None"),
		(dict(membrane=HexMembrane(), stiffness=D), "no particles"),
	):
		O.engines = engines("reference", [MembraneBending(**arguments)])
		with pytest.raises((ValueError, RuntimeError), match=message):
			O.step()
	with pytest.raises(RuntimeError, match="MembraneBending.elasticEnergy: nothing computed yet"):
		MembraneBending(membrane=m, stiffness=D).elasticEnergy()
	O.engines = engines("compact", [MembraneBending(membrane=m, stiffness=D)])
	with pytest.raises(RuntimeError, match="MembraneBending acts on a membrane without MembraneBonds"):
		O.step()


def test_aTornSheetDoesNotBend(O, tier):
	"""A particle that has lost a bond has no row in B any more; what it stored is entered as that of a broken bond, once, also across a save."""
	m = makeMembrane()
	rest = positions(m)
	x = shake(m, 2e-4)
	lengths = [(Vector3(*x[a]) - Vector3(*x[b])).norm() for a, b in m.bonds]
	weakest = 1e4 * (sorted(lengths)[-5] - 2 * m.sphereRadius)  # the five longest bonds break
	bonds = MembraneBonds(membrane=m, kn=1e4)
	bending = MembraneBending(membrane=m, stiffness=D, bonds=bonds)
	O.engines = engines(tier, [bonds, bending])
	O.trackEnergy = True
	O.dt = 1e-12  # positions stay
	O.step()
	bonds.tensileStrength = weakest * (1 - 1e-9)
	O.step()
	O.step()
	assert bonds.brokenCount == 5
	spring = bending.springStiffness
	change = departures(m, x) - departures(m, rest)
	torn = sorted({i for pair, broken in zip(m.bonds, bonds.broken) if broken for i in pair})
	left = change.copy()
	left[torn] = 0
	assert bending.elasticEnergy() == pytest.approx(0.5 * spring * (left**2).sum(), rel=1e-9)
	freed = 0.5 * spring * ((change**2).sum() - (left**2).sum())
	assert freed > 0 and O.energy["bondDissip"] >= freed * (1 - 1e-9)
	held = forcesOn(m.ids)
	bending.dead = True
	O.step()
	ofBending = held - forcesOn(m.ids)
	assert np.abs(ofBending + spring * transposed(m, left)).max() < 1e-9 * np.abs(held).max()
