# SPDX-License-Identifier: GPL-2.0-or-later
"""The compact tier's state: saved and loaded, taken over from the reference tier and handed back, changed by scripts, and refused."""

import numpy as np
import pytest
import yade
from specimenScene import build
from tiers import engines, forces, loop, run, state

GRAINS = 150  # of specimenScene.build
MOVING = dict(spin=0.05, velocity=0.05)


@pytest.mark.parametrize("options", [MOVING, dict(lateral="wall"), dict(poisson=0.2, spin=0.02), dict(membraneFriction=0.2, spin=0.02)])
def test_saveAndLoadGoOnExactly(O, tmp_path, options):
	build("compact", **options)
	run(60)
	file = str(tmp_path / "state.yade.gz")
	O.save(file, quiet=True)
	run(130)
	whole = state(), forces()
	O.load(file, quiet=True)
	run(130)
	assert (state() == whole[0]).all()
	assert (forces() == whole[1]).all()


def test_savedTwiceBeforeAStepLosesNothing(O, tmp_path):
	build("compact", **MOVING)
	run(60)
	first, second = (str(tmp_path / name) for name in ("a.yade.gz", "b.yade.gz"))
	O.save(first, quiet=True)
	run(50)
	whole = state()
	O.load(first, quiet=True)
	O.save(second, quiet=True)
	O.load(second, quiet=True)
	run(50)
	assert (state() == whole).all()


def test_sameBatchesOrNot(O):
	"""The number of steps in an iteration changes nothing but when scripts see the scene."""
	found = []
	for substeps in (1, 40):
		O.reset()
		build("compact", substeps=substeps, **MOVING)
		run(80)
		found.append(state())
	assert (found[0] == found[1]).all()


def test_contactsMoveBetweenTiers(O):
	"""reference -> compact -> reference in the middle of a run: as if it had stayed in one."""
	made = build("reference", **MOVING)
	run(150)
	whole = state()
	O.reset()
	made = build("reference", **MOVING)
	run(50)
	O.engines = engines("compact", made.values(), damping=0.2, substeps=10)
	run(50)
	assert O.interactions.countReal() == 0
	loop().exportContacts()
	assert O.interactions.countReal() == loop().contactCount()
	O.engines = engines("reference", made.values(), damping=0.2)
	run(50)
	moved = np.abs(whole[:, 3:6]).max()
	assert np.abs(state() - whole)[:, 3:6].max() < 1e-7 * moved


def test_contactBondsMoveBetweenTiersAndBreakAlike(O):
	"""Bonds of PFC's linear contact bond, made in the reference tier, of strengths that some contacts exceed."""

	def bondAll():
		count = 0
		for i in O.interactions:
			if i.isReal and max(i.id1, i.id2) < GRAINS:
				strength = 0.02 * 3 ** ((i.id1 + i.id2) % 8)
				i.phys.bond(strength, strength)
				count += 1
		return count

	def bonded():
		return {tuple(sorted((i.id1, i.id2))) for i in O.interactions if i.isReal and i.phys.bonded}

	made = build("reference", **MOVING)
	run(20)
	begun = bondAll()
	run(40)
	whole, left = state(), bonded()
	assert 0.1 * begun < len(left) < 0.9 * begun
	O.reset()
	made = build("reference", **MOVING)
	run(20)
	bondAll()
	O.engines = engines("compact", made.values(), damping=0.2, substeps=10)
	run(20)
	O.saveTmp("bonds")
	O.reset()
	O.loadTmp("bonds")
	run(20)
	moved = np.abs(whole[:, 3:6]).max()
	assert np.abs(state() - whole)[:, 3:6].max() < 1e-7 * moved
	loop().exportContacts()
	assert bonded() == left


def test_bondsWithASmoothMembraneAreRefused(O):
	made = build("reference", **MOVING)
	run(20)
	contact = next(i for i in O.interactions if i.isReal and i.phys.spheres and max(i.id1, i.id2) >= GRAINS)
	contact.phys.bond(1, 1)
	O.engines = engines("compact", made.values(), damping=0.2)
	with pytest.raises(RuntimeError, match="bonded without friction, grain and membrane; fix: bonds among grains only"):
		run(1)
	assert contact.isReal and contact.phys.bonded, "nothing is lost"


def test_exportedContactsAreThoseOfTheReference(O):
	"""Forces, moments and geometry of every contact, as YADE's own tools read them."""

	def contacts():
		found = {}
		for i in O.interactions:
			n, sign = i.geom.normal, 1
			if i.id1 > i.id2 and "Sphere" in str(type(O.bodies[i.id1].shape)):
				sign = -1
			key = tuple(sorted((i.id1, i.id2)))
			found[key] = np.array([*(sign * n), *(sign * i.phys.normalForce), *(sign * i.phys.shearForce), *(sign * i.phys.moment), i.phys.kn, i.phys.ks])
		return found

	build("reference", **MOVING)
	run(40)
	reference = contacts()
	O.reset()
	made = build("compact", **MOVING)
	run(40)
	loop().exportContacts()
	compact = contacts()
	assert set(reference) == set(compact)
	common = [(reference[key], compact[key]) for key in reference]
	assert len(common) > 100
	a, b = (np.array([pair[k] for pair in common]) for k in (0, 1))
	for columns in (slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12), slice(12, 14)):
		assert np.abs(a - b)[:, columns].max() < 1e-9 * np.abs(a[:, columns]).max()
	run(20)
	assert O.interactions.countReal() == 0  # stale ones are gone


def test_scriptsMayMoveAndAddBodies(O):
	from yade import utils

	build("compact", velocity=0.05)
	run(20)
	O.bodies[3].state.vel = (0, 0, 1.5)
	run(1)
	assert O.bodies[3].state.vel[2] > 0.5
	new = O.bodies.append(utils.sphere((0.06, 0, 0.02), 1e-3, material="grain"))
	run(20)
	assert np.isfinite(state()).all()
	O.bodies.erase(new)
	run(20)
	assert np.isfinite(np.array([tuple(b.state.pos) for b in O.bodies])).all()


def test_forcesFromOutsideAct(O):
	"""A force that an engine before it adds is held for the iteration: a free sphere falls as told."""
	O.materials.append(yade.LinearMat(emod=1e7, kratio=3, friction=0, density=1000, label="m"))
	a, b = (O.bodies.append(yade.utils.sphere((x, 0, 0), 1e-3, material="m")) for x in (0.0, 0.1))
	O.engines = [yade.ForceResetter(), yade.PyRunner(command="O.forces.addF(%d, (0, 0, -1e-3))" % a, iterPeriod=1, initRun=True), yade.CompactLoop(damping=0, substeps=10)]
	O.dt = 1e-5
	run(20)
	steps = 20
	fall = -1e-3 / O.bodies[a].state.mass * O.dt**2 * steps * (steps + 1) / 2
	assert O.bodies[a].state.pos[2] == pytest.approx(fall, rel=1e-12)
	assert tuple(O.bodies[b].state.pos) == (0.1, 0, 0)


def test_aRunawaySphereStopsTheRun(O):
	build("compact", substeps=10)
	O.step()
	O.bodies[5].state.vel = (300, 0, 0)
	with pytest.raises(RuntimeError, match="body 5 at iteration .*half a skin.*fix"):
		for _ in range(3):
			O.step()


def test_orientationsTurn(O):
	O.materials.append(yade.LinearMat(emod=1e7, kratio=3, friction=0, density=1000, label="m"))
	b = O.bodies.append(yade.utils.sphere((0, 0, 0), 1e-3, material="m"))
	O.bodies[b].state.angVel = (0, 0, 2.0)
	O.engines = [yade.ForceResetter(), yade.CompactLoop(substeps=50)]
	O.dt = 1e-3
	run(200)
	axis, angle = O.bodies[b].state.ori.toAxisAngle()
	assert angle * axis[2] == pytest.approx(0.4, rel=1e-9)


def wrong(O, change):
	build("compact")
	change()
	with pytest.raises((RuntimeError, ValueError)) as caught:
		O.step()
		O.step()
	assert "fix: " in str(caught.value)
	return str(caught.value)


@pytest.mark.parametrize(
	"change, says",
	[
		(lambda: setattr(loop(), "damping", 1.5), "CompactLoop.damping = 1.5"),
		(lambda: setattr(loop(), "substeps", 0), "CompactLoop.substeps = 0"),
		(lambda: setattr(loop(), "skin", -1.0), "CompactLoop.skin = -1"),
		(lambda: setattr(loop(), "engines", loop().engines + [yade.NewtonIntegrator()]), "NewtonIntegrator"),
		(lambda: setattr(loop(), "engines", loop().engines * 2), "has two MembraneBonds"),
		(lambda: setattr(loop(), "engines", loop().engines[1:]), "without MembraneBonds"),
		(lambda: setattr(yade.O.bodies[0], "mat", yade.FrictMat()), "no LinearMat"),
		(lambda: setattr(yade.O.bodies[0], "shape", yade.Box(extents=(1, 1, 1))), "is a Box"),
		(lambda: setattr(yade.O.bodies[0].state, "blockedDOFs", "x"), "degrees of freedom"),
		(lambda: setattr(yade.O.bodies[0].state, "mass", 0.0), "mass = 0"),
		(lambda: setattr(yade.O.bodies[0], "mask", 4), "no bit in common"),
		(lambda: setattr(yade.O, "engines", [loop()]), "ForceResetter"),
		(lambda: yade.O.bodies.clump([0, 1]), "clump"),
		(lambda: setattr(yade.O, "periodic", True), "periodic"),
	],
)
def test_whatItDoesNotKnowIsRefused(O, change, says):
	assert says in wrong(O, change)


HARD = {
	"membrane": {},
	"wall": dict(lateral="wall"),
	"fine membrane": dict(particleRadius=8e-4),
	"membrane with shear springs": dict(poisson=0.1),
	"rough membrane": dict(membraneFriction=0.4, poisson=0.2),
	# these flow and collide for ever: see pkg/compact/README.md on what undamped collisions gain at long steps
	"smooth grains, damped": dict(friction=0.0, rollingFriction=0.0, damping=0.2),
	"rolling resistance beyond sliding": dict(friction=0.2, rollingFriction=2.0),
	"deep overlaps": dict(swell=1.03),
	"closed loop, shearing": dict(gain=0.2, velocity=0.02),
}


@pytest.mark.parametrize("options", HARD.values(), ids=HARD.keys())
def test_criticalStepIsHonest(O, options):
	"""Stable for long at 0.8 of it, without any damping unless stated, lost soon at twice it: the message names a body."""
	options = dict(options)
	damping = options.pop("damping", 0.0)

	def fastest():
		return np.abs(state()[:, 3:6]).max()

	made = build("compact", damping=0.6, **options)
	O.dt = 2e-7
	run(20)
	for _ in range(20):  # to rest; contacts form meanwhile
		O.dt = 0.3 * loop().criticalTimeStep()
		run(300)
	loop().damping = damping
	O.dt = 0.8 * loop().criticalTimeStep()
	run(200)
	before = fastest()
	run(3000)
	assert fastest() < 5 * before + 0.01  # an unstable mode would have grown by many orders
	O.dt = 2 * loop().criticalTimeStep()
	with pytest.raises(RuntimeError, match="half a skin"):
		for _ in range(300):
			O.step()
