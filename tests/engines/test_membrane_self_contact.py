# SPDX-License-Identifier: GPL-2.0-or-later
"""MembraneSelfContact in both tiers. All pairs by an oracle: tests/kernels/SelfContactTest.cpp."""

import math

import numpy as np
import pytest
from membraneScene import KN, forcesOn, makeMembrane, positions, shake, slack
from tiers import engines, find, loop, run, state
from yade import FrictMat, HexMembrane, MembraneBonds, MembraneSelfContact, Vector3, utils

STIFF = 2e3


def squeeze(O, membrane, share):
	"""Bring the two sides of the tube together: x times `share`."""
	for i in membrane.ids:
		x, y, z = O.bodies[i].state.pos
		O.bodies[i].state.pos = Vector3(share * x, y, z)
	return positions(membrane)


def touching(membrane, x):
	"""Pairs of particles nearer than 2R without a bond, and their overlaps, in numpy."""
	distance = np.linalg.norm(x[:, None] - x[None], axis=2)
	bonds = np.array([tuple(b) for b in membrane.bonds])
	distance[bonds[:, 0], bonds[:, 1]] = distance[bonds[:, 1], bonds[:, 0]] = np.inf
	pairs = np.argwhere(np.triu(distance < 2 * membrane.sphereRadius, 1))
	return pairs, 2 * membrane.sphereRadius - distance[tuple(pairs.T)]


def test_forcesAndEnergyAreThoseOfThePairs(O, tier):
	m = makeMembrane()
	shake(m, 2e-4)
	x = squeeze(O, m, 0.1)
	contact = MembraneSelfContact(membrane=m, kn=STIFF)
	O.engines = engines(tier, [slack(m), contact])
	O.trackEnergy = True
	O.dt = 1e-9  # positions stay
	O.step()
	pairs, overlap = touching(m, x)
	assert len(pairs) > 100
	assert [tuple(p) for p in contact.pairs] == [tuple(p) for p in pairs.tolist()]
	branch = x[pairs[:, 1]] - x[pairs[:, 0]]
	push = (STIFF * overlap / np.linalg.norm(branch, axis=1))[:, None] * branch
	expected = np.zeros_like(x)
	np.add.at(expected, pairs[:, 0], -push)
	np.add.at(expected, pairs[:, 1], push)
	assert np.abs(forcesOn(m.ids) - expected).max() < 1e-12 * np.abs(expected).max()
	assert contact.elasticEnergy() == pytest.approx(0.5 * STIFF * (overlap**2).sum(), rel=1e-12)
	assert dict(O.energy.items())["elastSelfContact"] == contact.elasticEnergy()
	z = x[:, 2]
	middle = z.mean()
	assert contact.axialTension([middle])[0] == pytest.approx(expected[z < middle, 2].sum(), rel=1e-9)
	most = np.bincount(pairs.ravel()).max()
	assert contact.criticalTimeStep() == pytest.approx(2 * math.sqrt(O.bodies[m.ids[0]].state.mass / (2 * most * STIFF)), rel=1e-12)


def test_stiffnessIsTheMaterials(O):
	m = makeMembrane()
	assert MembraneSelfContact(membrane=m).normalStiffness == pytest.approx(KN, rel=1e-14)  # two springs of 2 KN in series
	assert MembraneSelfContact(membrane=m, kn=5.0).normalStiffness == 5.0


def test_energyIsKept(O, tier):
	"""A squeezed tube that is let go: what its contacts stored becomes kinetic, to the error of the step."""
	m = makeMembrane()
	squeeze(O, m, 0.1)
	for i in m.ids:
		O.bodies[i].state.blockedDOFs = "XYZ"  # O-ring rows too
	contact = MembraneSelfContact(membrane=m, kn=STIFF)
	O.engines = engines(tier, [slack(m), contact], substeps=50)
	O.dt = 0.01 * math.sqrt(O.bodies[m.ids[0]].state.mass / STIFF)
	run(1)
	start = contact.elasticEnergy()
	stored = [start]
	for _ in range(20):
		run(50)
		stored.append(contact.elasticEnergy())
		assert stored[-1] + utils.kineticEnergy() == pytest.approx(start, rel=0.01)
	assert min(stored) < 0.2 * start
	momentum = sum(np.array(O.bodies[i].state.vel) for i in m.ids)
	assert np.abs(momentum).max() < 1e-9 * math.sqrt(2 * start / O.bodies[m.ids[0]].state.mass)


def test_compactCriticalStepCountsContacts(O):
	m = makeMembrane()
	squeeze(O, m, 0.1)
	contact = MembraneSelfContact(membrane=m, kn=STIFF)
	O.engines = engines("compact", [slack(m), contact])
	O.dt = 1e-9
	O.step()
	assert contact.criticalTimeStep() <= loop().criticalTimeStep() < math.sqrt(6) * contact.criticalTimeStep()


def test_tiersAgree(O):
	found = []
	for tier in ("reference", "compact"):
		O.reset()
		m = makeMembrane()
		shake(m, 2e-4)
		squeeze(O, m, 0.1)
		O.engines = engines(tier, [MembraneBonds(membrane=m, kn=400.0), MembraneSelfContact(membrane=m, kn=STIFF)], damping=0.2)
		O.dt = 1e-6
		run(1)
		found.append(state(m.ids))
	assert np.abs(found[0] - found[1]).max() < 1e-11 * np.abs(found[0]).max()


def test_saveAndLoadContinueExactly(O, tier, tmp_path):
	"""The list of near pairs is not saved: the loaded run makes its own, and has the same bits."""
	m = makeMembrane()
	shake(m, 2e-4)
	x = squeeze(O, m, 0.3)
	for i, at in zip(m.ids, x):
		O.bodies[i].state.vel = Vector3(-2 * np.sign(at[0]), 0, 0)
	contact = MembraneSelfContact(membrane=m, kn=STIFF)
	O.engines = engines(tier, [MembraneBonds(membrane=m, kn=4.0), contact], substeps=20)
	O.dt = 1e-5
	run(200)
	assert contact.pairs and contact.listsMade > 1
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	run(100)
	whole = state(m.ids)
	O.reset()
	O.load(file)
	run(100)
	loaded = find(MembraneSelfContact)
	assert loaded.listsMade < contact.listsMade
	assert (state(loaded.membrane.ids) == whole).all()


def test_badInput(O):
	m = makeMembrane()
	O.dt = 1e-6
	for arguments, message in (
		(dict(membrane=m, kn=0.0), "MembraneSelfContact.kn = 0"),
		(dict(membrane=m, kn=-1.0), "MembraneSelfContact.kn = -1"),
		(dict(kn=STIFF), "MembraneSelfContact.membrane = None"),
		(dict(membrane=HexMembrane(), kn=STIFF), "no particles"),
	):
		O.engines = engines("reference", [MembraneSelfContact(**arguments)])
		with pytest.raises((ValueError, RuntimeError), match=message):
			O.step()
	with pytest.raises(RuntimeError, match="MembraneSelfContact.pairs: nothing computed yet"):
		MembraneSelfContact(membrane=m).pairs
	O.reset()
	O.materials.append(FrictMat(density=1000))
	other = HexMembrane(specimenRadius=0.02, specimenHeight=0.03, particleRadius=0.002, mask=3)
	other.generate()
	with pytest.raises(ValueError, match="MembraneSelfContact.kn = nan: not given, and the membrane's material .FrictMat. tells no stiffness"):
		MembraneSelfContact(membrane=other).normalStiffness
