# SPDX-License-Identifier: GPL-2.0-or-later
"""MembraneBonds in both tiers."""

import math

import numpy as np
import pytest
from membraneScene import forcesOn, makeMembrane, shake
from tiers import engines, run, state
from yade import HexMembrane, MembraneBonds, Vector3, utils

SHEET = dict(young=1.4e6, thickness=0.3e-3, poisson=1 / 3.0)


def bonded(O, tier, membrane, substeps=1, **springs):
	"""A scene of the membrane and its bonds alone; the bonds."""
	bonds = MembraneBonds(membrane=membrane, **(springs or SHEET))
	O.engines = engines(tier, [bonds], substeps=substeps)
	return bonds


def springForces(membrane, x, kn):
	"""Sum of springs bond by bond in numpy."""
	bonds = np.array([tuple(b) for b in membrane.bonds])
	branch = x[bonds[:, 1]] - x[bonds[:, 0]]
	length = np.linalg.norm(branch, axis=1)
	onFirst = (kn * (length - 2 * membrane.sphereRadius) / length)[:, None] * branch
	force = np.zeros_like(x)
	np.add.at(force, bonds[:, 0], onFirst)
	np.add.at(force, bonds[:, 1], -onFirst)
	return force


def test_forcesAreThoseOfSprings(O, tier):
	m = makeMembrane()
	x = shake(m, 2e-4)
	bonded(O, tier, m)
	O.dt = 1e-9  # positions stay
	O.step()
	kn = SHEET["young"] * SHEET["thickness"] / (math.sqrt(3) * (1 - SHEET["poisson"]))
	expected = springForces(m, x, kn)
	assert np.abs(forcesOn(m.ids) - expected).max() < 1e-12 * np.abs(expected).max()


def test_springsAreReadHoweverTheyAreGiven():
	from yade.wrapper import MembraneBonds

	sheet = MembraneBonds(young=1.4e6, thickness=0.3e-3, poisson=0.2)
	kn, ks = sheet.normalStiffness, sheet.shearStiffness
	assert 2 * math.sqrt(3) * kn * (kn + ks) / (3 * kn + ks) == pytest.approx(1.4e6 * 0.3e-3, rel=1e-12)
	assert (kn - ks) / (3 * kn + ks) == pytest.approx(0.2, rel=1e-12)
	assert math.isnan(sheet.kn) and math.isnan(sheet.ks)  # as given
	springs = MembraneBonds(kn=500.0)
	assert (springs.normalStiffness, springs.shearStiffness) == (500.0, 0.0)
	springs.ks = 20.0
	assert springs.shearStiffness == 20.0
	with pytest.raises(ValueError, match="MembraneBonds.kn = nan: not given"):
		MembraneBonds().normalStiffness


def test_generatedMembraneStaysAtRest(O, tier):
	m = makeMembrane()
	bonds = bonded(O, tier, m, substeps=100)
	O.dt = 0.3 * bonds.criticalTimeStep()
	before = state(m.ids)
	run(200)
	assert np.abs(state(m.ids)[:, :3] - before[:, :3]).max() < 1e-12 * m.sphereRadius


@pytest.mark.parametrize("springs", [SHEET, dict(kn=400.0, ks=150.0)], ids=["central", "shear"])
def test_energyIsKept(O, tier, springs):
	"""Without damping elastic and kinetic energy add up to the start's; they are read half a step apart: a bounded error, linear in the step."""
	m = makeMembrane(rotations="ks" in springs)
	shake(m, 1e-4)
	bonds = bonded(O, tier, m, substeps=120, **springs)
	O.dt = 0.02 * bonds.criticalTimeStep()
	run(1)
	start = bonds.elasticEnergy()
	totals = []
	for _ in range(20):
		run(120)
		totals.append(bonds.elasticEnergy() + utils.kineticEnergy())
	assert start > 0
	assert max(abs(t - start) for t in totals) < 0.01 * start
	if "ks" in springs:
		assert any(O.bodies[i].state.angVel.norm() > 0 for i in m.ids)


@pytest.mark.parametrize("springs", [SHEET, dict(kn=400.0, ks=50.0), dict(kn=400.0, ks=400.0)], ids=["central", "shear", "study"])
@pytest.mark.parametrize("share, steps, grows", [(0.8, 3000, False), (1.1, 15, True)], ids=["below", "above"])
def test_reportedStepIsTheCriticalOne(O, tier, springs, share, steps, grows):
	m = makeMembrane(rotations="ks" in springs)
	shake(m, 1e-7)
	bonds = bonded(O, tier, m, substeps=10, **springs)
	O.dt = share * bonds.criticalTimeStep()
	run(1)
	start = bonds.elasticEnergy() + utils.kineticEnergy()
	if grows and tier == "compact":
		with pytest.raises(RuntimeError, match="half a skin"):
			run(10 * steps)
		return
	run(steps)
	# the energies of leapfrog oscillate near the limit; beyond it the fastest mode grows by a factor of 2.4 a step
	assert (bonds.elasticEnergy() + utils.kineticEnergy() > 3 * start) == grows


def test_breaking(O, tier):
	m = makeMembrane()
	bonds = bonded(O, tier, m, kn=400.0, ks=0.0, tensileStrength=0.02)
	O.dt = 1e-9
	O.step()
	assert bonds.brokenCount == 0
	lifted = m.ids[m.perRing * (m.rings // 2) :]
	for i in lifted:
		O.bodies[i].state.pos += (0, 0, 1e-3)
	O.step()
	assert bonds.brokenCount == 2 * m.perRing
	assert np.abs(forcesOn(m.ids)).max() < 1e-12


def test_saveAndLoadContinueExactly(O, tier, tmp_path):
	m = makeMembrane(rotations=True)
	shake(m, 3e-4)
	bonds = bonded(O, tier, m, kn=400.0, ks=150.0, tensileStrength=0.08)
	O.dt = 0.2 * bonds.criticalTimeStep()
	run(60)
	assert bonds.brokenCount > 0
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	run(60)
	whole = state()
	for i in m.ids:
		O.bodies[i].state.pos += Vector3(1, 1, 1)
	O.reset()
	O.load(file)
	run(60)
	assert (state() == whole).all()


def test_energyTracker(O, tier):
	m = makeMembrane()
	shake(m, 1e-4)
	O.trackEnergy = True
	bonds = bonded(O, tier, m)
	O.dt = 1e-9
	O.step()
	assert O.energy["elastMembrane"] == pytest.approx(bonds.elasticEnergy(), rel=1e-12)


def test_erasedBodyIsNamed(O, tier):
	m = makeMembrane()
	bonded(O, tier, m)
	O.dt = 1e-6
	run(3)
	O.bodies.erase(m.ids[100])
	with pytest.raises(RuntimeError, match=r"body %d of the membrane is gone.*; fix: " % m.ids[100]):
		O.step()


def test_nanIsNamed(O, tier):
	m = makeMembrane()
	bonded(O, tier, m)
	O.dt = 1e-6
	O.bodies[m.ids[77]].state.pos = (float("nan"), 0, 0)
	with pytest.raises((RuntimeError, ValueError), match=r"body \d+ .*not finite.*; fix: "):
		O.step()


BAD = [
	(dict(), "MembraneBonds.kn"),
	(dict(kn=-1.0), "MembraneBonds.kn = -1"),
	(dict(kn=1.0, ks=-1.0), "MembraneBonds.ks"),
	(dict(kn=1.0, young=1e6), "given twice"),
	(dict(young=1e6, thickness=3e-4, poisson=0.5), "rubber"),
	(dict(young=1e6, thickness=3e-4), "MembraneBonds.poisson"),
	(dict(young=1e6, poisson=0.3), "MembraneBonds.thickness"),
	(dict(kn=1.0, tensileStrength=0.0), "MembraneBonds.tensileStrength"),
	(dict(kn=1.0, ks=1.0), "rotations=True"),
	(dict(kn=1.0, ks=0.5, tensionOnly=True), "MembraneBonds.tensionOnly"),
]


@pytest.mark.parametrize("springs, message", BAD, ids=[m for _, m in BAD])
def test_badInput(O, tier, springs, message):
	O.engines = engines(tier, [MembraneBonds(membrane=makeMembrane(), **springs)])
	with pytest.raises(ValueError) as error:
		O.step()
	assert message in str(error.value) and "fix:" in str(error.value)


def test_withoutMembrane(O, tier):
	for bonds, message in ((MembraneBonds(kn=1.0), "MembraneBonds.membrane = None"), (MembraneBonds(kn=1.0, membrane=HexMembrane()), "generate")):
		O.engines = engines(tier, [bonds])
		with pytest.raises(RuntimeError) as error:
			O.step()
		assert message in str(error.value) and "fix:" in str(error.value)
