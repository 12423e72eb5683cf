# SPDX-License-Identifier: GPL-2.0-or-later
"""Parallel bonds between grains, in both tiers: closed forms of a pair and of a cantilever, breaks, energy, saved states, what measures see of them."""

import math

import contactScene as scene
import numpy as np
import pytest
import tiers
import yade
from yade import GrainBonds, O, utils

KN, KS = 1e9, 4e8
STRONG = dict(kn=KN, ks=KS, tensileStrength=math.inf, cohesion=math.inf)


def bondedPair(tier, r1=1e-3, r2=1.5e-3, overlap=-1e-8, velocity=(0, 0, 0), spin=(0, 0, 0), dt=1e-6, **changes):
	"""Two spheres that move as told, bonded along z, and a first step, in which nothing has moved."""
	scene.springs()
	a, b = scene.pair(r1, r2, overlap, velocity=velocity)
	O.bodies[b].state.angVel = spin
	bonds = GrainBonds(**{**STRONG, **changes})
	assert bonds.bond([a, b], gap=1e-6) == 1 and bonds.bond([a, b], gap=1e-6) == 0
	O.engines = tiers.engines(tier, [bonds])
	O.dt = dt
	O.trackEnergy = True
	tiers.run(1)
	return a, b, bonds


def section(radius):
	"""Area and second moment of a bond's disc."""
	return math.pi * radius**2, math.pi * radius**4 / 4


def near(found, wanted, size):
	assert np.abs(np.subtract(found, wanted)).max() < 1e-9 * size


def test_tensionAndTorsion(O, tier):
	speed, rate = 1e-2, 3.0
	a, b, bonds = bondedPair(tier, velocity=(0, 0, speed), spin=(0, 0, rate))
	assert bonds.elasticEnergy() == 0 and scene.force(b).norm() == 0
	tiers.run(10)
	area, inertia = section(1e-3)
	pull, twist = KN * area * speed * 1e-5, KS * 2 * inertia * rate * 1e-5
	near(scene.force(b), (0, 0, -pull), pull * 1e3)  # the way is a difference of distances
	near(scene.force(a), (0, 0, pull), pull * 1e3)
	near(scene.torque(b), (0, 0, -twist), twist)
	near(scene.torque(a), (0, 0, twist), twist)
	(tension,), (shear,) = bonds.bonds()["tension"], bonds.bonds()["shear"]
	assert tension == pytest.approx(pull / area, rel=1e-6) and shear == pytest.approx(twist * 1e-3 / (2 * inertia), rel=1e-9)
	assert O.energy["elastGrainBonds"] == pytest.approx(0.5 * pull * speed * 1e-5 + 0.5 * twist * rate * 1e-5, rel=1e-6)


def test_shearAndBending(O, tier):
	"""Body 2 goes along x and turns about y: the contact point moves by both."""
	speed, rate, r2 = 1e-7, 1e-4, 1.5e-3
	a, b, bonds = bondedPair(tier, velocity=(speed, 0, 0), spin=(0, rate, 0))
	tiers.run(10)
	area, inertia = section(1e-3)
	way = (speed - rate * r2) * 1e-5
	shear, bending = -KS * area * way, -KN * inertia * rate * 1e-5
	assert bonds.bonds()["force"][0] == pytest.approx((shear, 0, 0), rel=1e-5, abs=1e-5 * abs(shear))
	assert bonds.bonds()["moment"][0] == pytest.approx((0, bending, 0), rel=1e-9, abs=1e-9 * abs(bending))
	assert scene.torque(b)[1] == pytest.approx(bending - r2 * shear, rel=1e-5)
	assert scene.torque(a)[1] == pytest.approx(-bending - 1e-3 * shear, rel=1e-5)


def test_besideTheContact(O, tier):
	"""Overlapping grains: the bond's force begins at 0 and adds to the contact's, which has no tension; measures see one contact with both forces."""
	a, b, bonds = bondedPair(tier, overlap=2e-6, velocity=(0, 0, 1e-1))
	measured = yade.MeasureRegions()
	for step, bare in ((0, 1e5 * 2e-6), (5, 1e5 * 1.5e-6), (30, 0.0)):
		tiers.run(1 + step - O.iter)
		area, _ = section(1e-3)
		expected = bare - KN * area * 1e-7 * step
		assert scene.force(b)[2] == pytest.approx(expected, rel=1e-6)
		found = measured.measure([(0, 0, 1e-3)], 1e-2)
		assert found["contacts"] == [1] and (found["sliding"] == [0] or expected < 0)
		assert found["stress"][0, 2, 2] * 4 / 3 * math.pi * 1e-6 == pytest.approx(expected * (2.5e-3 - 2e-6 + 1e-7 * step), rel=1e-6)


@pytest.mark.parametrize("count", [2, 6])
def test_cantilever(O, tier, count):
	"""A beam of spheres under an end force, at rest: the deflection is that of its springs of shear and bending, by virtual work."""
	r, load = 1e-3, 4e-5
	area, inertia = section(r)
	scene.springs()
	ids = [scene.sphere((0, 0, (2 * r + 1e-7) * k), r, fixed=k == 0) for k in range(count)]
	bonds = GrainBonds(**STRONG)
	assert bonds.bond(ids, gap=1e-6) == count - 1
	O.engines = tiers.engines(tier, [bonds], damping=0.7, before=[yade.ForceEngine(force=(load, 0, 0), ids=[ids[-1]])])
	O.dt = 2e-5
	tiers.run(1500 * count)
	arms = [(2 * r + 1e-7) * (count - 1 - k - 0.5) for k in range(count - 1)]
	deflection = sum(load / (KS * area) + load * arm**2 / (KN * inertia) for arm in arms)
	assert O.bodies[ids[-1]].state.pos[0] == pytest.approx(deflection, rel=2e-4)
	assert scene.torque(ids[0])[1] == pytest.approx(load * (2 * r + 1e-7) * (count - 1), rel=2e-4)
	assert scene.force(ids[0])[0] == pytest.approx(load, rel=2e-4)


@pytest.mark.parametrize("strength, kind", [({"tensileStrength": 5.05e4}, "tensileBreaks"), ({"cohesion": 5.05e2, "frictionAngle": 0.5}, "shearBreaks")])
def test_breaks(O, tier, strength, kind):
	"""The stress kn times the way, or ks times it, against the strength; mean tension takes from the shear strength."""
	tension = kind == "tensileBreaks"
	velocity = (0, 0, 1) if tension else (1e-1, 0, 5e-2)
	a, b, bonds = bondedPair(tier, velocity=velocity, **strength)
	rate = KN * 1e-6 if tension else KS * 1e-7 + KN * 5e-8 * math.tan(0.5)
	last = math.floor(strength["tensileStrength" if tension else "cohesion"] / rate)
	tiers.run(last)
	assert bonds.count == 1 and scene.force(b).norm() > 0
	stored = bonds.elasticEnergy()
	tiers.run(1)
	assert bonds.count == 0 and getattr(bonds, kind) == 1 and bonds.tensileBreaks + bonds.shearBreaks == 1
	assert scene.force(b).norm() == 0 and scene.torque(a).norm() == 0
	assert O.energy["bondDissip"] == pytest.approx(stored * ((last + 1) / last) ** 2, rel=1e-2) and O.energy["elastGrainBonds"] == 0
	tiers.run(3)
	assert scene.force(b).norm() == 0


def cluster(tier, strength=math.inf, count=60):
	"""Grains of two sizes on a lattice, bonded, that spin and fly apart."""
	random = np.random.default_rng(4)
	scene.material()
	places = [np.array((i, j, k)) for i in range(4) for j in range(4) for k in range(4)][:count]
	for place in places:
		body = utils.sphere(tuple(2e-3 * place + random.uniform(-5e-5, 5e-5, 3)), random.uniform(0.9e-3, 1e-3))
		body.state.vel = tuple(0.5e3 * np.cross((0, 1, 2), body.state.pos) * 1e-1 + random.uniform(-0.1, 0.1, 3))
		body.state.angVel = tuple(random.uniform(-50, 50, 3))
		O.bodies.append(body)
	bonds = GrainBonds(emod=1e8, kratio=2.5, tensileStrength=strength, cohesion=2 * strength, frictionAngle=0.3, label="cement")
	made = bonds.bond([b.id for b in O.bodies], gap=2e-4)
	assert made > 1.5 * count
	O.engines = tiers.engines(tier, [bonds], substeps=7)
	O.dt = 2e-7
	O.trackEnergy = True
	return bonds


def total():
	energies = dict(O.energy.items())
	return sum(energies.get(name, 0.0) for name in ("elastPotential", "elastGrainBonds", "plastDissip", "rollDissip", "bondDissip")) + utils.kineticEnergy()


def test_tiersAgree(O):
	states, stored, broken = {}, {}, {}
	for strength in (math.inf, 3e5):
		for tier in tiers.TIERS:
			O.reset()
			bonds = cluster(tier, strength)
			tiers.run(350)
			states[tier], stored[tier], broken[tier] = tiers.state(), bonds.elasticEnergy(), (bonds.count, bonds.tensileBreaks, bonds.shearBreaks)
		assert broken["compact"] == broken["reference"] and (broken["compact"][1] > 0) == (strength < math.inf)
		assert stored["compact"] == pytest.approx(stored["reference"], rel=1e-6)
		difference = np.abs(states["compact"] - states["reference"]).max(axis=0)
		assert (difference < 1e-7 * np.abs(states["reference"]).max(axis=0)).all()


def test_energyIsKept(O, tier):
	"""What goes into breaks, contacts and motion adds up."""
	bonds = cluster(tier, 3e5)
	tiers.run(7)
	start = total()
	tiers.run(1400)
	assert bonds.tensileBreaks + bonds.shearBreaks > 20 and bonds.count > 0
	assert O.energy["bondDissip"] > 0.01 * start
	assert total() == pytest.approx(start, rel=5e-3)


def test_savedInMidRun(O, tier, tmp_path):
	"""A loaded state goes on as the one that was saved: bonds that hold, bonds that broke."""
	cluster(tier, 3e5)
	tiers.run(210)
	O.save(str(tmp_path / "state.yade.gz"))
	tiers.run(210)
	wanted, bonds = tiers.state(), tiers.find(GrainBonds)
	numbers = bonds.count, bonds.tensileBreaks, bonds.shearBreaks
	forces = bonds.bonds()["force"]
	O.load(str(tmp_path / "state.yade.gz"))
	bonds = tiers.find(GrainBonds)
	assert bonds.tensileBreaks > 0 and bonds.count > numbers[0]
	tiers.run(210)
	assert (bonds.count, bonds.tensileBreaks, bonds.shearBreaks) == numbers
	if tier == "compact":
		assert (tiers.state() == wanted).all() and (bonds.bonds()["force"] == forces).all()
	else:  # the collider's order of contacts is another after a load
		assert np.abs(tiers.state() - wanted).max() < 1e-9 * np.abs(wanted).max()


def test_tierIsChanged(O):
	"""From one list of engines into the other, with the bonds' history."""
	bonds = cluster("reference")
	tiers.run(70)
	stored = bonds.elasticEnergy()
	O.engines = tiers.engines("compact", [bonds])
	tiers.run(1)
	assert bonds.elasticEnergy() == pytest.approx(stored, rel=0.1)
	tiers.run(69)
	changed = tiers.state()
	O.reset()
	cluster("reference")
	tiers.run(140)
	assert np.abs(tiers.state() - changed).max() < 1e-7 * np.abs(changed).max()


def test_criticalTimeStep(O):
	"""Of a pair: along the bond, in shear, in bending and in torsion, whichever is fastest."""
	for properties, fastest in (
		(dict(kn=1e9, ks=0.0, radiusMultiplier=0.1), lambda A, I, m, J: 2 * 1e9 * A / m),
		(dict(kn=1e9, ks=1e9, radiusMultiplier=0.1), lambda A, I, m, J: 2 * 1e9 * A * (1 / m + 1e-6 / J)),
		(dict(kn=1e9, ks=0.0, radiusMultiplier=2.0), lambda A, I, m, J: 2 * 1e9 * I / J),
		(dict(kn=1e6, ks=1e9, radiusMultiplier=3.0), lambda A, I, m, J: 4 * 1e9 * I / J),
	):
		O.reset()
		scene.springs()
		ids = [scene.sphere((0, 0, 2.0001e-3 * k), 1e-3) for k in range(2)]
		bonds = GrainBonds(**{**STRONG, **properties})
		bonds.bond(ids, gap=1e-6)
		O.engines = tiers.engines("compact", [bonds])
		O.dt = 1e-9
		O.step()
		state = O.bodies[ids[0]].state
		square = fastest(*section(properties["radiusMultiplier"] * 1e-3), state.mass, state.inertia[0])
		assert tiers.loop().criticalTimeStep() == pytest.approx(2 / math.sqrt(square), rel=1e-3)


def test_released(O, tier):
	a, b, bonds = bondedPair(tier, velocity=(0, 0, 1e-2))
	tiers.run(5)
	assert bonds.release([a + b + 7]) == 0 and bonds.release([b]) == 1 and bonds.count == 0
	tiers.run(1)
	assert scene.force(a).norm() == 0 and bonds.tensileBreaks == 0 and O.energy["bondDissip"] > 0


TAKEN = ("ids", "radius", "kn", "ks", "force", "moment")


def test_taken(O, tier):
	"""Bonds of another engine's rows act as that engine's, from the step on in which they were told."""
	bonds = cluster(tier)
	tiers.run(70)
	told = bonds.bonds()
	forces, stored = told["force"], bonds.elasticEnergy()
	for body in O.bodies:  # back to where the loads were computed
		body.state.pos -= body.state.vel * O.dt
		body.state.vel = body.state.angVel = (0, 0, 0)
	other = GrainBonds(tensileStrength=math.inf, cohesion=math.inf)
	assert other.take(*(told[name] for name in TAKEN)) == bonds.count
	assert other.elasticEnergy() == pytest.approx(stored, rel=1e-6) and stored > 0
	O.engines = tiers.engines(tier, [other])
	tiers.run(1)
	order = {tuple(ids): k for k, ids in enumerate(other.bonds()["ids"].tolist())}
	again = other.bonds()["force"][[order[tuple(ids)] for ids in told["ids"].tolist()]]
	assert np.abs(again - forces).max() < 1e-9 * np.abs(forces).max()


def test_takenAreRefused(O):
	scene.springs()
	a, b = scene.pair(1e-3, 1e-3, 1e-6)
	wall = scene.floor(face=(0, 0, -1e-2))
	bonds = GrainBonds(tensileStrength=1e5, cohesion=1e5)
	sound = dict(ids=[(a, b)], radius=[1e-3], kn=[KN], ks=[KS], force=[(0, 0, 1)], moment=[(0, 0, 0)])
	for changes, message in (
		({"ids": [(a, wall)]}, f"GrainBonds.ids = {wall}: is no sphere"),
		({"ids": [(a, a)]}, "GrainBonds.take.ids = 0 and 0: are one grain; fix"),
		({"ids": [(a, b, b)]}, "GrainBonds.take.ids = .*wrong shape"),
		({"radius": [0]}, "GrainBonds.take.radius = 0"),
		({"radius": []}, "GrainBonds.take.radius = 0: has another number of rows than ids, 1; fix: one row for each bond"),
		({"kn": [-1]}, "GrainBonds.take.kn = -1"),
		({"ks": [-1]}, "GrainBonds.take.ks = -1"),
		({"force": [(0, math.nan, 0)]}, "GrainBonds.take.force = nan: is not finite"),
		({"moment": [(0, 0)]}, "GrainBonds.take.moment = .*wrong shape"),
	):
		with pytest.raises(ValueError, match=message):
			bonds.take(**{**sound, **changes})
	assert bonds.count == 0 and bonds.take(**sound) == 1
	with pytest.raises(ValueError, match="GrainBonds.take.ids = 0 and 1: have a bond of this engine already"):
		bonds.take(**sound)


@pytest.mark.parametrize(
	"changes, message",
	[
		({"kn": math.nan}, "GrainBonds.kn"),
		({"kn": -1.0}, "GrainBonds.kn = -1"),
		({"ks": -1.0}, "GrainBonds.ks = -1"),
		({"emod": 1e8}, "GrainBonds.kn = .*: stiffness is given twice"),
		({"tensileStrength": math.nan}, "GrainBonds.tensileStrength = .*: is not given; fix"),
		({"cohesion": -1.0}, "GrainBonds.cohesion = -1: a strength must not be negative"),
		({"frictionAngle": 2.0}, "GrainBonds.frictionAngle = 2: is out of range"),
		({"momentFactor": 1.5}, "GrainBonds.momentFactor = 1.5: is out of range"),
		({"radiusMultiplier": 0.0}, "GrainBonds.radiusMultiplier = 0"),
	],
)
def test_refused(O, changes, message):
	scene.springs()
	a, b = scene.pair(1e-3, 1e-3, 1e-6)
	with pytest.raises(ValueError, match=message):
		GrainBonds(**{**STRONG, **changes}).bond([a, b])


def test_refusedBodies(O, tier):
	scene.springs()
	a, b = scene.pair(1e-3, 1e-3, 1e-6)
	wall = scene.floor(face=(0, 0, -1e-2))
	bonds = GrainBonds(**STRONG)
	with pytest.raises(ValueError, match=f"GrainBonds.ids = {wall}: is no sphere; fix"):
		bonds.bond([a, wall])
	with pytest.raises(ValueError, match="GrainBonds.bond.gap = -1"):
		bonds.bond([a, b], gap=-1.0)
	assert bonds.bond([a, b]) == 1
	O.engines = tiers.engines(tier, [bonds])
	O.dt = 1e-6
	tiers.run(1)
	O.bodies.erase(b)
	with pytest.raises(ValueError, match=f"GrainBonds.ids = {b}: is bonded.*release"):
		tiers.run(1)
