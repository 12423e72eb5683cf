# SPDX-License-Identifier: GPL-2.0-or-later
"""LinearMat, how two of them combine, bonds by hand, and what is refused."""

import math
import os
import subprocess
import sys

import pytest
from contactScene import EMOD, FRICTION, SOIL, law, material, pair, referenceEngines, swarm
from tiers import contact, engines
from yade import LinearMat, LinearPhys, utils

R1, R2 = 2e-3, 3e-3
SHAPE = math.pi * R1**2 / (R1 + R2)


def contactOf(O, tier, one, other, bonds=False):
	"""Phys of the contact of a sphere R1 of material `one` and a sphere R2 of material `other`."""
	O.materials.append(LinearMat(**one))
	O.materials.append(LinearMat(**other))
	a, b = pair(R1, R2, 1e-6)
	O.bodies[a].material, O.bodies[b].material = O.materials[0], O.materials[1]
	O.engines = engines(tier, bonds=bonds)
	O.dt = 1e-9
	O.step()
	return contact(a, b).phys


def series(a, b):
	return a * b / (a + b)


@pytest.mark.parametrize("swapped", (False, True))
def test_twoMaterials(O, tier, swapped):
	"""Springs in series, a modulus brings 2 pi E* min(R)^2/(R1+R2); friction, rolling friction and bond strengths are the smaller ones."""
	one = dict(kn=2e5, ks=1e5, friction=0.3, rollingFriction=0.2, cbTensile=3.0, cbShear=4.0)
	other = dict(emod=EMOD, kratio=2.0, friction=0.5, rollingFriction=0.1, cbTensile=2.0, cbShear=math.inf)
	phys = contactOf(O, tier, *((other, one) if swapped else (one, other)), bonds=tier == "reference")
	brought = 2 * EMOD * SHAPE
	assert phys.kn == pytest.approx(series(2e5, brought), rel=1e-12) and phys.ks == pytest.approx(series(1e5, brought / 2), rel=1e-12)
	rbar = R1 * R2 / (R1 + R2)
	assert (phys.tangensOfFrictionAngle, phys.rollingArm) == pytest.approx((0.3, 0.1 * rbar), rel=1e-12)
	assert phys.kr == pytest.approx(phys.ks * rbar**2, rel=1e-12)
	if tier == "reference":  # who bonds contacts is its Ip2
		assert (phys.bonded, phys.tensileStrength, phys.shearStrength) == (True, 2.0, 4.0)


def test_withoutShearStiffnessInOne(O, tier):
	phys = contactOf(O, tier, dict(kn=2e5, ks=0, friction=0.3, rollingFriction=0.3), dict(kn=2e5, ks=1e5, friction=0.3, rollingFriction=0.3))
	assert (phys.kn, phys.ks, phys.kr) == (1e5, 0, 0)


def test_noBondWhereOneMaterialHasNone(O):
	phys = contactOf(O, "reference", dict(SOIL, cbTensile=1, cbShear=1), dict(SOIL, cbTensile=1), bonds=True)
	assert not phys.bonded


def test_bondContactsBondsWhatIsThere(O):
	material(cbTensile=2.0, cbShear=3.0)
	a, b = pair(R1, R2, 1e-6)
	O.engines = referenceEngines()
	O.dt = 1e-9
	functor = O.engines[2].physDispatcher.functors[0]
	assert functor.bondContacts() == 0
	O.step()
	assert not O.interactions[a, b].phys.bonded
	assert functor.bondContacts() == 1 and functor.bondContacts() == 0
	phys = O.interactions[a, b].phys
	assert (phys.bonded, phys.tensileStrength, phys.shearStrength) == (True, 2.0, 3.0)


def test_bondingLetsGoOfTheMoment(O):
	material()
	a, b = pair(R1, R2, 1e-6)
	O.engines = referenceEngines()
	O.dt = 1e-6
	O.bodies[b].state.angVel = (0, 1, 0)
	O.run(10, True)
	phys = O.interactions[a, b].phys
	assert phys.moment.norm() > 0
	phys.bond(math.inf, math.inf)
	O.step()
	assert phys.moment.norm() == 0 and phys.shearForce.norm() > 0


@pytest.mark.parametrize("tensile, shear, part", ((0, 1, "tensile"), (1, -1, "shear"), (math.nan, 1, "tensile")))
def test_bondRefuses(tensile, shear, part):
	phys = LinearPhys()
	with pytest.raises(ValueError, match="LinearPhys.bond.%s = " % part):
		phys.bond(tensile, shear)
	assert not phys.bonded


def test_frictionIsTheAnglesTangent():
	m = LinearMat(**SOIL)
	assert m.friction == pytest.approx(FRICTION, rel=1e-15) and m.frictionAngle == math.atan(FRICTION)
	m.friction = 0
	assert m.frictionAngle == 0
	m.frictionAngle = 0.5
	assert m.friction == math.tan(0.5)


def test_yadesToolSetsFriction(O):
	"""setContactFriction, made for FrictMat: materials and contacts."""
	material()
	swarm()
	a, b = pair(R1, R2, 1e-6)
	O.bodies[a].dynamic = O.bodies[b].dynamic = True
	O.engines = referenceEngines()
	O.dt = 1e-9
	O.step()
	utils.setContactFriction(0.1)
	assert O.materials[0].friction == pytest.approx(math.tan(0.1), rel=1e-14)
	assert O.interactions[a, b].phys.tangensOfFrictionAngle == pytest.approx(math.tan(0.1), rel=1e-14)


def test_frictionSwitchedOffLetsGoOfTheShear(O):
	material(rollingFriction=0)
	a, b = pair(R1, R2, 1e-6)
	O.engines = referenceEngines()
	O.dt = 1e-6
	O.bodies[b].state.angVel = (0, 1, 0)
	O.run(10, True)
	phys = O.interactions[a, b].phys
	assert phys.shearForce.norm() > 0
	phys.tangensOfFrictionAngle = 0
	O.step()
	assert phys.shearForce.norm() == 0


def test_timeStepTools(O):
	"""PWaveTimeStep = R sqrt(rho/E) with E = pi E*/2; the stiffness timestepper knows kr."""
	material()
	O.bodies.append(utils.sphere((0, 0, 0), R1))
	assert utils.PWaveTimeStep() == pytest.approx(R1 * math.sqrt(SOIL["density"] / (0.5 * math.pi * EMOD)), rel=1e-12)


def test_laterValuesAreTaken():
	m = LinearMat(**SOIL)
	m.emod = 2 * EMOD
	assert m.young == math.pi * EMOD
	m.emod = m.kratio = math.nan
	m.kn, m.ks = 1e5, 2e4
	assert math.isnan(m.young) and m.poisson == pytest.approx(0.2)


BAD = [
	(dict(emod=0), "LinearMat.emod = 0: must be positive"),
	(dict(emod=-1e8), "LinearMat.emod"),
	(dict(emod=math.inf), "LinearMat.emod = inf: not finite"),
	(dict(kratio=0), "LinearMat.kratio"),
	(dict(kn=1e5), "LinearMat.emod = 1e+08: stiffness is given twice"),
	(dict(ks=1e5), "stiffness is given twice"),
	(dict(friction=-0.1), "LinearMat.friction = -0.1: is out of range"),
	(dict(friction=math.nan), "LinearMat.friction"),
	(dict(frictionAngle=0.4), "friction is given twice"),
	(dict(rollingFriction=-1), "LinearMat.rollingFriction"),
	(dict(rollingFriction=math.nan), "LinearMat.rollingFriction"),
	(dict(cbTensile=-1), "LinearMat.cbTensile"),
	(dict(cbShear=math.nan), "LinearMat.cbShear"),
	(dict(young=1e9), "LinearMat.young = 1e+09: follows from the stiffness"),
	(dict(poisson=0.3), "LinearMat.poisson"),
]


@pytest.mark.parametrize("change, message", BAD)
def test_badInput(change, message):
	with pytest.raises(ValueError) as error:
		LinearMat(**{**SOIL, **change})
	assert message in str(error.value) and "; fix: " in str(error.value)


@pytest.mark.parametrize("name, value", [(n, v) for change, _ in BAD for n, v in change.items() if n not in ("young", "poisson", "frictionAngle")])
def test_aRefusedAssignmentChangesNothing(name, value):
	good = LinearMat(**SOIL)
	before = {**good.dict(), "friction": good.friction}
	with pytest.raises(ValueError):
		setattr(good, name, value)
	after = {**good.dict(), "friction": good.friction}
	assert all(before[k] == after[k] or (before[k] != before[k] and after[k] != after[k]) for k in before)


def test_unknownNameIsRefused():
	with pytest.raises(AttributeError):
		LinearMat(frictoin=0.4)


INCOMPLETE = {
	"no stiffness": (dict(friction=0.4), "LinearMat.kn = nan: no stiffness is given"),
	"no ks": (dict(kn=1e5, friction=0.4), "LinearMat.ks = nan: not given"),
	"no kratio": (dict(emod=1e8, friction=0.4), "LinearMat.kratio = nan: not given"),
	"no friction": (dict(emod=1e8, kratio=3), "LinearMat.friction = nan: not given"),
}


@pytest.mark.parametrize("case", INCOMPLETE)
def test_incompleteMaterialIsNamed(case):
	values, message = INCOMPLETE[case]
	with pytest.raises(ValueError) as error:
		LinearMat(**values).requireComplete()
	assert message in str(error.value) and "; fix: " in str(error.value)
	LinearMat(**{"kn": 1e5, "ks": 0, "friction": 0} if "kn" in values else SOIL).requireComplete()


def test_incompleteMaterialEndsTheRunWithItsMessage():
	"""YADE makes contacts in a parallel loop, out of which no exception comes: the program ends, with the message."""
	here = os.path.dirname(os.path.abspath(__file__))
	script = (
		"import sys; sys.path[:0] = [%r, %r]\n"
		"import conftest, yade, contactScene\n"
		"from yade import O\n"
		"O.materials.append(yade.LinearMat(emod=1e8, friction=0.4))\n"
		"contactScene.pair(1, 1, 1e-3)\n"
		"O.engines = contactScene.referenceEngines()\n"
		"O.step()\n"
	) % (os.path.dirname(here), here)
	done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)
	assert done.returncode != 0
	assert "LinearMat.kratio = nan: not given" in done.stderr + done.stdout


def test_nothingBrokeHere(O):
	"""The counters start at nothing and are not moved by contacts that open without a bond."""
	material()
	swarm()
	O.engines = referenceEngines()
	O.dt = 5e-7
	O.run(2000, True)
	assert (law().tensileBreaks, law().shearBreaks) == (0, 0)
