# SPDX-License-Identifier: GPL-2.0-or-later
"""The compact tier's state: saved and loaded, taken over from the reference tier and handed back, changed by scripts, and refused."""

import builtins

import numpy as np
import pytest
import yade
from hexmembrane.measure import rows as measure
from hexmembrane.scene.handles import Scene
from specimenScene import bondGrains, build
from tiers import TIERS, engines, forces, loop, owed, run, state, writeContacts

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


@pytest.mark.xfail(strict=False, reason="lead: a change of tier loses half a step's work; back in the reference tier the way since is booked with old forces")
def test_worksGoOnBetweenTiers(O):
	"""reference -> compact -> reference: each engine has done the work that it does in one tier."""
	works = []
	for second in ("reference", "compact"):
		O.reset()
		made = build("reference", grains=40, porosity=0.5, particleRadius=4e-3, **MOVING)
		for tier in ("reference", second, "reference"):
			if tier != "reference" or loop():
				writeContacts()
				O.engines = engines(tier, made.values(), damping=0.2, substeps=10)
			run(20)
		works.append({name: engine.work for name, engine in made.items() if hasattr(engine, "work")})
	assert all(works[0][name] for name in ("pressure", "servo", "top", "oRings"))
	assert works[1] == pytest.approx(works[0], rel=1e-6)


def test_contactBondsMoveBetweenTiersAndBreakAlike(O):
	"""Bonds of PFC's linear contact bond, made in the reference tier, of strengths that some contacts exceed."""

	def bonded():
		return {tuple(sorted((i.id1, i.id2))) for i in O.interactions if i.isReal and i.phys.bonded}

	made = build("reference", **MOVING)
	run(20)
	begun = bondGrains(0.02)
	O.trackEnergy = True
	run(40)
	whole, left, setFree = state(), bonded(), O.energy["bondDissip"]
	assert setFree > 0
	assert 0.1 * begun < len(left) < 0.9 * begun
	O.reset()
	made = build("reference", **MOVING)
	run(20)
	bondGrains(0.02)
	O.trackEnergy = True
	O.engines = engines("compact", made.values(), damping=0.2, substeps=10)
	run(20)
	O.saveTmp("bonds")
	O.reset()
	O.loadTmp("bonds")
	run(20)
	assert O.energy["bondDissip"] == pytest.approx(setFree, rel=1e-6)
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
	build("compact", **MOVING)
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


def test_labelsOfEngines(O, tier, tmp_path, request):
	"""An engine's label is a variable, as YADE makes it, wherever the engine stands; after O.load it is the loaded engine's."""
	owed(request, tier, "engines inside have no labels")
	made = build(tier, velocity=0.05)
	made["top"].label = "topDriveOfATest"
	O.engines = O.engines
	try:
		assert builtins.topDriveOfATest == made["top"] and O.labeledEngine("topDriveOfATest") == made["top"]
		run(20)
		file = str(tmp_path / "state.yade.gz")
		O.save(file, quiet=True)
		O.load(file, quiet=True)
		drive = builtins.topDriveOfATest
		assert not drive == made["top"] and drive.force == made["top"].force
		before = drive.displacement
		drive.velocity = 0.1  # a handle to the engine that runs
		run(20)
		assert drive.displacement - before == pytest.approx(20 * 0.1 * O.dt, rel=0.03)  # the first of the 20 steps is still of before
	finally:
		vars(builtins).pop("topDriveOfATest", None)


@pytest.mark.parametrize(
	"options",
	[
		pytest.param(dict(servoTime=4e-4, pressureTime=4e-4), marks=pytest.mark.xfail(strict=False, reason="lead: a row of records reads O.interactions")),
		pytest.param(dict(lateral="wall"), marks=pytest.mark.xfail(strict=False, reason="lead: a row of records reads O.interactions")),
	],
	ids=["membrane", "wall"],
)
def test_aRowOfRecordsNeedsNoExport(O, options):
	"""Each column as in the reference tier, from the arrays as they are."""
	rows = []
	for tier in TIERS:
		O.reset()
		O.trackEnergy = True
		build(tier, spin=0.02, velocity=0.05, **options)
		O.engines = [*O.engines, yade.RunawayGuard()]
		scene = Scene()
		run(20)
		reference = measure.Reference.of(scene)
		run(100)
		rows.append(measure.row(scene, measure.Grains.of(scene.grainIds()), reference, "shear", 0.0))
	apart = {name: (value, rows[1][name]) for name, value in rows[0].items() if rows[1][name] != pytest.approx(value, rel=1e-6, abs=1e-12)}
	assert not apart


def test_forcesFromOutsideAct(O, tier):
	"""A force that an engine before it adds is held for the iteration: a free sphere falls as told."""
	O.materials.append(yade.LinearMat(emod=1e7, kratio=3, friction=0, density=1000))
	a, b = (O.bodies.append(yade.utils.sphere((x, 0, 0), 1e-3)) for x in (0.0, 0.1))
	pushing = yade.PyRunner(command="O.forces.addF(%d, (0, 0, -1e-3))" % a, iterPeriod=1, initRun=True)
	O.engines = engines(tier, before=[pushing], substeps=10)
	O.dt = 1e-5
	steps = 20
	run(steps)
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


def test_orientationsTurn(O, tier):
	O.materials.append(yade.LinearMat(emod=1e7, kratio=3, friction=0, density=1000))
	b = O.bodies.append(yade.utils.sphere((0, 0, 0), 1e-3))
	O.bodies[b].state.angVel = (0, 0, 2.0)
	O.engines = engines(tier, substeps=50)
	O.dt = 1e-3
	run(200)
	axis, angle = O.bodies[b].state.ori.toAxisAngle()
	assert angle * axis[2] == pytest.approx(0.4, rel=1e-9)


@pytest.mark.parametrize(
	"change, says",
	[
		(lambda: setattr(loop(), "damping", 1.5), "CompactLoop.damping = 1.5"),
		(lambda: setattr(loop(), "substeps", 0), "CompactLoop.substeps = 0"),
		(lambda: setattr(loop(), "skin", -1.0), "CompactLoop.skin = -1"),
		(lambda: setattr(loop(), "engines", loop().engines + [yade.NewtonIntegrator()]), "NewtonIntegrator"),
		(lambda: setattr(loop(), "engines", loop().engines * 2), "has two MembraneBonds"),
		(lambda: setattr(loop(), "engines", loop().engines[1:]), "without MembraneBonds"),
		(lambda: setattr(yade.O, "engines", [loop()]), "ForceResetter"),
	],
)
def test_enginesThatAreNotRight(O, change, says):
	"""What is refused of bodies and scene is in test_compact_contract."""
	build("compact")
	change()
	with pytest.raises((RuntimeError, ValueError)) as caught:
		O.step()
		O.step()
	assert says in str(caught.value) and "fix: " in str(caught.value)


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
	"closed loop, shearing": dict(servoTime=1e-4, velocity=0.02),
}


@pytest.mark.parametrize("options", HARD.values(), ids=HARD.keys())
def test_criticalStepIsHonest(O, options):
	"""Stable for long at 0.8 of it, without any damping unless stated, lost soon at twice it: the message names a body."""
	options = dict(options)
	damping = options.pop("damping", 0.0)

	def fastest():
		return np.abs(state()[:, 3:6]).max()

	build("compact", damping=0.6, **options)
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
