# SPDX-License-Identifier: GPL-2.0-or-later
"""Stiffness and friction that contacts of two materials have of their own (LinearMat.setPair), against closed forms in both tiers."""

import math

import pytest
from contactScene import floor, force, pair, sphere
from tiers import contact, engines, run
from yade import LinearMat

R, OVERLAP = 2e-3, 1e-5
KN, KS, FRICTION, ROLLING = 3e6, 1e6, 0.6, 0.2


def materials(O, **own):
	"""Grain and platen, soft and smooth by themselves; `own` is what contacts of them have."""
	O.materials.append(LinearMat(emod=1e7, kratio=2, friction=0.1, label="grain"))
	O.materials.append(LinearMat(kn=1e5, ks=1e5, friction=0.05, label="platen"))
	if own:
		O.materials["grain"].setPair("platen", **own)


def pressed(O, tier, speed=0.0):
	"""A sphere pressed onto a platen, and sliding over it; the contact."""
	bottom, ball = floor(), sphere((0, 0, R - OVERLAP), R, fixed=True)
	O.bodies[bottom].material, O.bodies[ball].material = O.materials["platen"], O.materials["grain"]
	O.bodies[ball].state.vel = (speed, 0, 0)
	O.engines = engines(tier)
	O.dt = 1e-6
	return bottom, ball


@pytest.mark.parametrize("holder", ("grain", "platen"))
def test_twoBalls(O, tier, holder):
	"""Fn = kn u with the pair's own kn, whatever the two bodies' springs are, and whichever of the two holds it."""
	materials(O)
	O.materials[holder].setPair({"grain": "platen", "platen": "grain"}[holder], kn=KN, ks=KS, friction=FRICTION, rollingFriction=ROLLING)
	a, b = pair(R, 2 * R, OVERLAP)
	O.bodies[a].material, O.bodies[b].material = O.materials["grain"], O.materials["platen"]
	O.engines = engines(tier)
	O.dt = 1e-9
	O.step()
	phys, lever = contact(a, b).phys, 2 / 3 * R
	assert force(b)[2] == pytest.approx(KN * OVERLAP, rel=1e-9)
	assert (phys.kn, phys.ks) == pytest.approx((KN, KS), rel=1e-14) and phys.tangensOfFrictionAngle == pytest.approx(FRICTION, rel=1e-14)
	assert (phys.kr, phys.rollingArm) == pytest.approx((KS * lever**2, ROLLING * lever), rel=1e-13)


def test_ballOnAPlaten(O, tier):
	"""PFC's deformability by pair: kn = pi E* R; shear grows by ks and is cut at the pair's mu Fn, above the friction of both bodies."""
	emod, kratio, speed = 2e8, 4.0, 0.5
	materials(O, emod=emod, kratio=kratio, friction=FRICTION)
	bottom, ball = pressed(O, tier, speed)
	kn = math.pi * emod * R
	normal = kn * OVERLAP
	run(3)
	assert contact(bottom, ball).phys.kn == pytest.approx(kn, rel=1e-14)
	assert force(ball)[2] == pytest.approx(normal, rel=1e-9)
	assert -force(ball)[0] == pytest.approx(3 * kn / kratio * speed * 1e-6, rel=1e-9)
	run(100)
	assert -force(ball)[0] == pytest.approx(FRICTION * normal, rel=1e-9)


def test_whatIsNotGivenFollowsFromBoth(O, tier):
	materials(O, friction=FRICTION)
	bottom, ball = pressed(O, tier)
	O.step()
	phys, grain = contact(bottom, ball).phys, 2 * math.pi * 1e7 * R
	assert phys.kn == pytest.approx(grain * 1e5 / (grain + 1e5), rel=1e-14) and phys.tangensOfFrictionAngle == pytest.approx(FRICTION, rel=1e-14)
	assert O.materials["grain"].pairFriction(O.materials["platen"]) == O.materials["platen"].pairFriction(O.materials["grain"]) == FRICTION
	assert O.materials["grain"].pairFriction(O.materials["grain"]) == pytest.approx(0.1)


def test_otherPairsStay(O, tier):
	"""Two grains have what they had."""
	materials(O, kn=KN, ks=KS)
	a, b = pair(R, R, OVERLAP)
	O.bodies[a].material = O.bodies[b].material = O.materials["grain"]
	O.engines = engines(tier)
	O.dt = 1e-9
	O.step()
	assert contact(a, b).phys.kn == pytest.approx(math.pi * 1e7 * R / 2, rel=1e-14)


def test_savedWithTheScene(O, tier, tmp_path):
	materials(O, kn=KN, ks=KS, friction=FRICTION)
	bottom, ball = pressed(O, tier, 0.5)
	run(3)
	before = tuple(force(ball))
	O.save(str(tmp_path / "s.yade.gz"), quiet=True)
	run(4)
	after = tuple(force(ball))
	O.load(str(tmp_path / "s.yade.gz"), quiet=True)
	assert O.materials["grain"].pairs() == {"platen": {"kn": KN, "ks": KS, "friction": FRICTION}}
	run(4)
	assert tuple(force(ball)) == after != before
	# a contact made after the load has it too
	O.interactions.clear()
	new = sphere((0.01, 0, R - OVERLAP), R, fixed=True)
	O.bodies[new].material = O.materials["grain"]
	run(1)
	assert contact(bottom, new).phys.kn == pytest.approx(KN, rel=1e-14)


def test_compactContactsFollowAtOnce(O):
	materials(O)
	bottom, ball = pressed(O, "compact")
	O.step()
	O.materials["grain"].setPair("platen", kn=KN, ks=KS)
	O.step()
	assert contact(bottom, ball).phys.kn == pytest.approx(KN, rel=1e-14)
	O.materials["grain"].setPair("platen", friction=FRICTION)
	O.step()
	phys = contact(bottom, ball).phys
	assert phys.kn < 1e5 and phys.tangensOfFrictionAngle == pytest.approx(FRICTION)
	O.materials["grain"].removePair("platen")
	O.step()
	assert contact(bottom, ball).phys.tangensOfFrictionAngle == pytest.approx(0.05)


def test_criticalStepFollows(O):
	"""A sphere on a platen: 2/omega, omega^2 = kn/m without shear."""
	materials(O, kn=KN, ks=0.0, friction=0.0)
	bottom, ball = pressed(O, "compact")
	O.bodies[ball].dynamic = True
	O.bodies[ball].state.mass, O.bodies[ball].state.inertia = 1e-4, (1e-10, 1e-10, 1e-10)
	O.step()
	assert O.engines[1].criticalTimeStep() == pytest.approx(2 / math.sqrt(KN / 1e-4), rel=0.01)


def test_twoOpinionsAreRefused(O):
	materials(O, kn=KN, ks=KS)
	O.materials["platen"].setPair("grain", kn=KN, ks=KS)  # the same once more
	pressed(O, "compact")
	O.step()
	O.materials["platen"].setPair("grain", kn=KN, ks=2 * KS)
	with pytest.raises((ValueError, RuntimeError), match="'(grain|platen)' and '(grain|platen)' each have other properties for the other; fix: LinearMat.removePair"):
		O.step()


BAD = (
	(dict(kn=0, ks=1), "setPair.kn = 0: must be positive"),
	(dict(kn=1e5), "setPair.ks = nan: the stiffness is given in half"),
	(dict(ks=1e5), "setPair.kn = nan: the stiffness is given in half"),
	(dict(emod=1e8), "setPair.kratio = nan: the stiffness is given in half"),
	(dict(kn=1e5, ks=-1), "setPair.ks = -1: must not be negative"),
	(dict(kn=1e5, ks=1e5, emod=1e8, kratio=2), "setPair.kn = 100000: stiffness is given twice"),
	(dict(friction=-1), "setPair.friction = -1: is out of range"),
	(dict(rollingFriction=-1), "setPair.rollingFriction = -1: is out of range"),
	(dict(), "setPair.kn = nan: nothing is given"),
)


@pytest.mark.parametrize("values, message", BAD)
def test_badInput(values, message):
	m = LinearMat(emod=1e7, kratio=2, friction=0.1)
	m.setPair("platen", friction=0.2)
	with pytest.raises(ValueError) as error:
		m.setPair("platen", **values)
	assert "LinearMat." + message in str(error.value) and "; fix: " in str(error.value)
	assert m.pairs() == {"platen": {"friction": 0.2}}


def test_labelsAreAsked():
	m = LinearMat(emod=1e7, kratio=2, friction=0.1)
	with pytest.raises(ValueError, match="LinearMat.setPair.partner = '': a material without a label"):
		m.setPair("", friction=0.2)
	with pytest.raises(ValueError, match="LinearMat.removePair.partner = 'wall': has no properties here"):
		m.removePair("wall")
