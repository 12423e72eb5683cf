# SPDX-License-Identifier: GPL-2.0-or-later
"""SoilMeasure, SoilStressServo and BodyArrays in both tiers: against loops over bodies and contacts, closed forms, and what they refuse."""

import math

import numpy as np
import pytest
import yade
from contactScene import sphere, springs
from platenScene import GRAIN, HEIGHT, RADIUS, driven, stack
from specimenScene import build
from tiers import engines, find, forces, run, state, writeContacts
from yade import SoilStressServo, BodyArrays, O, SoilMeasure, utils

SMALL = dict(grains=60, porosity=0.5, particleRadius=4e-3, spin=0.05, substeps=10, swell=1.02)


def measureOf(made):
	lateral = {"membrane": made["bonds"].membrane} if "bonds" in made else {"wall": made["wall"].wall}
	return SoilMeasure(bottomPlaten=made["bottom"].platen, topPlaten=made["top"].platen, **lateral)


def share(a, b, low, high):
	"""Share of the interval a..b that lies between two heights."""
	a, b = min(a, b), max(a, b)
	return max(0.0, min(b, high) - max(a, low)) / (b - a) if b > a else float(low <= a < high)


def byLoops(made, measure):
	"""The oracle: sums over O.interactions, one contact after the other."""
	writeContacts()
	grains = set(range(SMALL["grains"]))
	low, high = measure.faces
	quarters = low + (high - low) / 4, high - (high - low) / 4
	whole, middle, boundary = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
	sizes, among, numbers = [], 0, [0] * len(O.bodies)
	for c in O.interactions:
		force, point = np.array(c.phys.normalForce + c.phys.shearForce), np.array(c.geom.contactPoint)
		sizes.append(np.linalg.norm(force))
		for i in (c.id1, c.id2):
			numbers[i] += 1
		first, second = c.id1 in grains, c.id2 in grains
		if not first and not second:
			continue
		# the contact point lies on the branch, overlap/2 inside each surface
		start = point - (c.geom.refR1 - c.geom.penetrationDepth / 2) * np.array(c.geom.normal) if first else point
		end = point + (c.geom.refR2 - c.geom.penetrationDepth / 2) * np.array(c.geom.normal) if second else point
		part = np.outer(force, end - start)
		whole += part
		middle += share(start[2], end[2], *quarters) * part
		among += first and second
		if not (first and second):
			boundary -= np.outer(force if second else -force, point)
	if measure.membrane:
		volume, half = (measure.membrane.enclosedVolume(*heights) for heights in ((low, high), quarters))
	else:
		area = math.pi * O.bodies[measure.wall].shape.radius ** 2
		volume, half = area * (high - low), area * (high - low) / 2
	return whole / volume, middle / half, boundary / volume, 2 * among / len(grains), np.mean(sizes), numbers


@pytest.mark.parametrize("lateral", ("membrane", "wall"))
def test_isTheSumOverTheContacts(O, tier, lateral):
	made = build(tier, lateral=lateral, membraneFriction=0.3, **SMALL)
	measure = measureOf(made)
	run(40)
	found = measure.stress()
	numbers = measure.coordinationNumbers(list(range(len(O.bodies))))
	edges, volumes, slabs = measure.profile(5)
	whole, middle, boundary, coordination, force, counted = byLoops(made, measure)
	scale = np.abs(whole).max()
	assert scale > 1e3
	for name, expected in (("whole", whole), ("middle", middle), ("boundary", boundary)):
		assert np.abs(found[name] - expected).max() < 1e-9 * scale, name
	assert found["coordination"] == pytest.approx(coordination) and coordination > 1
	assert found["contactForce"] == pytest.approx(force, rel=1e-9)
	assert (numbers == counted).all()
	assert edges[0] == measure.faces[0] and edges[-1] == pytest.approx(measure.faces[1], rel=1e-12)
	assert np.einsum("s,sij->ij", volumes, slabs) / volumes.sum() == pytest.approx(found["whole"], rel=1e-9, abs=1e-9 * scale)


@pytest.mark.parametrize("lateral, membraneFriction", (("membrane", 0.3), ("wall", 0)))
def test_contactsAreThoseOfTheScene(O, tier, lateral, membraneFriction):
	"""Each of O.interactions that a grain has, with its bodies, ends and forces."""
	made = build(tier, lateral=lateral, membraneFriction=membraneFriction, **SMALL)
	measure = measureOf(made)
	run(40)
	found = measure.contacts()
	writeContacts()
	grains, kinds = set(range(SMALL["grains"])), {measure.bottomPlaten: 2, measure.topPlaten: 3}
	sheet = set(measure.membrane.ids) if measure.membrane else set()
	expected = {}
	for c in O.interactions:
		first, second = c.id1 in grains, c.id2 in grains
		if not first and not second:
			continue
		point, normal, half = np.array(c.geom.contactPoint), np.array(c.geom.normal), c.geom.penetrationDepth / 2
		ends = [point - (c.geom.refR1 - half) * normal if first else point, point + (c.geom.refR2 - half) * normal if second else point]
		grain, other = (c.id1, c.id2) if first else (c.id2, c.id1)
		kind = 0 if first and second else 1 if other in sheet else kinds.get(other, 4)
		expected[frozenset((grain, other))] = kind, ends if first else ends[::-1], c.phys.normalForce.dot(c.geom.normal), c.phys.shearForce.norm()
	assert {frozenset(pair) for pair in found["ids"].tolist()} == set(expected) and len(found["ids"]) == len(expected)
	assert set(found["ids"][:, 0]) <= grains and {0, 1 if sheet else 4, 2, 3} == set(found["kind"])
	scale = found["normalForce"].max()
	for k, (grain, other) in enumerate(found["ids"].tolist()):
		kind, ends, normal, shear = expected[frozenset((grain, other))]
		# two grains may come either way round
		ends = min((ends, ends[::-1]) if kind == 0 else (ends,), key=lambda each: np.abs(found["ends"][k] - each).max())
		assert found["kind"][k] == kind and np.abs(found["ends"][k] - ends).max() < 1e-12
		assert found["normalForce"][k] == pytest.approx(normal, abs=1e-9 * scale) and found["shearForce"][k] == pytest.approx(shear, abs=1e-6 * scale)
	assert found["shearForce"].max() > 0.01 * scale
	with pytest.raises(RuntimeError, match="bottomPlaten = -1"):
		SoilMeasure(bottomPlaten=-1, topPlaten=made["top"].platen, membrane=measure.membrane, wall=measure.wall).contacts()


#: Facets so thick and soft that grains touch them in a sheet that is not stretched.
THICK = dict(offset=0.88 * SMALL["particleRadius"], kn=300.0)


@pytest.mark.parametrize("lateral, facets", (("membrane", None), ("membrane", THICK), ("wall", None)))
def test_boundaryAndContactsDifferByWhatInertiaTakes(O, tier, lateral, facets):
	"""V (contacts - boundary) = sum over the grains of resultant (x) centre, exactly."""
	made = build(tier, lateral=lateral, facets=facets, **SMALL)
	measure = measureOf(made)
	run(300 if facets else 40)  # grains sink into the hollows
	found = measure.stress()
	grains = list(range(SMALL["grains"]))
	x, f = BodyArrays.positions(grains), BodyArrays.forces(grains)
	x = x - O.dt * BodyArrays.velocities(grains)  # the forces' instant is that before the bodies moved
	apart = found["volume"] * (found["whole"] - found["boundary"])
	expected = np.einsum("gi,gj->ij", f, x)
	if facets:
		assert len(made["facets"].grains) > 3
	assert np.abs(expected).max() > 1e-9
	assert np.abs(apart - expected).max() < 1e-9 * found["volume"] * np.abs(found["whole"]).max()


def column(kn):
	"""Four spheres between two platens in a wide wall: ids of the platens and the wall."""
	platens = stack(O, 4, 1, kn)
	wall = yade.Body()
	wall.shape = yade.CylinderWall(radius=5 * RADIUS, height=1)
	wall.material, wall.dynamic = O.materials[0], False
	return *platens, O.bodies.append(wall)


def test_aColumnOfSpheres(O, tier):
	"""n spheres between two platens with the force F in each contact: V sigma_zz = F (h + u), nothing across.

	h is the platens' distance, u the overlap: the outer contacts' points lie half of it behind the faces.
	"""
	kn = 1e5
	bottom, top, wall = column(kn)
	drive = driven(O, tier, platen=top, mode="stress", stress=2e4, area=1e-5)
	run(8000)
	measure = SoilMeasure(wall=wall, bottomPlaten=bottom, topPlaten=top)
	low, high = measure.faces
	volume = math.pi * (5 * RADIUS) ** 2 * (high - low)
	assert drive.force == pytest.approx(0.2, rel=1e-3)
	found = measure.stress()
	for name in ("whole", "middle", "boundary"):
		reach = high - low + (0 if name == "middle" else drive.force / kn)
		assert found[name][2, 2] == pytest.approx(drive.force * reach / volume, rel=1e-8), name
		assert np.abs(found[name]).sum() == pytest.approx(found[name][2, 2], rel=1e-9)
	assert found["volume"] == pytest.approx(volume, rel=1e-12) and found["coordination"] == 2 * 3 / 4


def servoed(tier, target=30.0, **options):
	"""A servo of the column's stress over the wide wall's area, which is 31 Pa under a force of 0.25 N."""
	bottom, top, wall = column(1e5)
	drive = driven(O, tier, platen=top, mode="stress", stress=1.0, area=math.pi * (5 * RADIUS) ** 2, maxVelocity=0.01)
	measure = SoilMeasure(wall=wall, bottomPlaten=bottom, topPlaten=top)
	servo = SoilStressServo(measure=measure, drive=drive, stress=target, **{"timeConstant": 400 * O.dt, **options})
	O.engines = engines(tier, [servo, drive], damping=0.2)
	return drive, servo


def test_servoBringsTheSoilToItsTarget(O, tier):
	"""With an area of the drive that is twice too large its own target would be half of what the soil gets."""
	drive, servo = servoed(tier, maxFactor=4.0)
	drive.area *= 2
	run(20000)
	axial = servo.measure.stress()["middle"][2, 2]
	assert axial == pytest.approx(30, rel=1e-3) and servo.measured == pytest.approx(axial, rel=1e-3)
	assert servo.settled and not servo.saturated and servo.factor == pytest.approx(0.5, rel=0.01)
	assert drive.stress == servo.factor * 30


def test_servoKnowsItsFactorBeforeTheLoadHasArrived(O, tier):
	"""A load that takes time constants to come counts as far as it has come: the factor is nearly right when it is there, and was never wound up."""
	drive, servo = servoed(tier, maxFactor=4.0)
	drive.area *= 2
	drive.maxVelocity = 1e-4
	highest, touched = 0.0, 0
	while not drive.settled:
		run(50)
		highest = max(highest, servo.measure.stress()["middle"][2, 2])
		touched = touched or (drive.force > 0) * O.iter
		assert O.iter < 200000
	assert O.iter - touched > 5 * 400 and servo.factor == pytest.approx(0.5, rel=0.04)
	run(2000)
	assert max(highest, servo.measure.stress()["middle"][2, 2]) < 1.02 * 30 and servo.settled


def test_servoRestsWhileTheDriveHasAVelocity(O, tier):
	drive, servo = servoed(tier, target=20.0)
	run(4000)
	drive.mode, drive.velocity = "velocity", 0.01
	kept = servo.factor, drive.stress
	run(400)
	assert (servo.factor, drive.stress) == kept and servo.factor != 1


def test_servoSavedAndLoadedIsTheSameRun(O, tier, tmp_path):
	drive, servo = servoed(tier, target=20.0)
	run(4000)
	file = str(tmp_path / "half.yade.gz")
	O.save(file)
	run(300)
	whole, factor = state(), servo.factor
	assert factor != 1
	O.reset()
	O.load(file)
	run(300)
	assert (state() == whole).all() and find(SoilStressServo).factor == factor


def test_radialServoBringsTheSoilToItsTarget(O, tier):
	"""By the pressure of the main body and of the rows beside the platens; dead, it leaves them as they are."""
	made = build(tier, grains=60, porosity=0.5, particleRadius=4e-3, swell=1.0, pressure=1e4, servoTime=2e-4, pressureTime=2e-4, damping=0.4)
	made["top"].dead = made["bottom"].dead = True
	servo = SoilStressServo(
		measure=measureOf(made), pressure=made["pressure"], beside=made["servo"], stress=2e5, timeConstant=1e-3, tolerance=0.02
	)
	O.engines = engines(tier, [servo, *made.values()], damping=0.4, substeps=10)
	run(8000)
	middle = servo.measure.stress()["middle"]
	assert 0.5 * (middle[0, 0] + middle[1, 1]) == pytest.approx(2e5, rel=0.03) and servo.measured == pytest.approx(2e5, rel=0.03)
	assert servo.settled and servo.factor != 1
	assert made["pressure"].pressure == made["servo"].pressure == servo.factor * 2e5
	servo.dead, servo.stress = True, 1e5
	kept = made["pressure"].pressure
	run(20)
	assert made["pressure"].pressure == kept


def test_servoStopsAtItsTimeLimit(O, tier):
	drive, servo = servoed(tier, target=1e9, timeLimit=1e-4)
	with pytest.raises(RuntimeError, match="SoilStressServo.timeLimit = 0.0001: the soil's axial stress is .* at iteration .*; fix: "):
		run(200)


@pytest.mark.parametrize(
	"change, part",
	(
		({"stress": math.nan}, "SoilStressServo.stress = nan"),
		({"stress": 0.0}, "SoilStressServo.stress = 0"),
		({"timeConstant": math.nan}, "SoilStressServo.timeConstant = nan"),
		({"timeConstant": 1e-6}, "SoilStressServo.timeConstant = .*two time steps"),
		({"timeConstant": math.inf}, "SoilStressServo.timeConstant = inf"),
		({"maxFactor": 1.0}, "SoilStressServo.maxFactor = 1"),
		({"tolerance": 0.0}, "SoilStressServo.tolerance = 0"),
		({"timeLimit": 0.0}, "SoilStressServo.timeLimit = 0"),
		({"measure": None}, "SoilStressServo.measure = None"),
		({"drive": None}, "SoilStressServo.drive = None: what to press with"),
		({"pressure": yade.MembranePressure()}, "SoilStressServo.drive = given together with pressure"),
		({"beside": yade.MembraneRadialServo()}, "SoilStressServo.beside = given"),
		({"drive": None, "pressure": yade.MembranePressure(rampTime=1e-3)}, "SoilStressServo.pressure = has a rampTime"),
	),
)
def test_servoRefuses(O, tier, change, part):
	drive, servo = servoed(tier)
	for name, value in change.items():
		setattr(servo, name, value)
	before = state()
	with pytest.raises((ValueError, RuntimeError), match=part + ".*; fix: "):
		O.step()
	assert (state() == before).all()


@pytest.mark.parametrize(
	"change, part",
	(
		({"wall": -1}, "SoilMeasure.membrane = None"),
		({"wall": 0}, "SoilMeasure.wall = 0: the body's shape is no CylinderWall"),
		({"wall": 9999}, "SoilMeasure.wall = 9999: there is no such body"),
		({"topPlaten": -1}, "SoilMeasure.topPlaten = -1: there is no such body"),
		({"bottomPlaten": 0}, "SoilMeasure.bottomPlaten = 0: the body's shape is no Platen"),
	),
)
def test_measureRefuses(O, change, part):
	made = build("compact", lateral="wall", **SMALL)
	measure = measureOf(made)
	run(10)
	for name, value in change.items():
		setattr(measure, name, value)
	with pytest.raises((ValueError, RuntimeError), match=part + ".*; fix: "):
		measure.stress()
	swapped = measureOf(made)
	swapped.bottomPlaten, swapped.topPlaten = swapped.topPlaten, swapped.bottomPlaten
	with pytest.raises(ValueError, match="SoilMeasure.topPlaten.*not above"):
		swapped.stress()


def test_arraysAreTheBodies(O, tier):
	made = build(tier, lateral="wall", **SMALL)
	ids = list(range(SMALL["grains"]))[::-1]
	BodyArrays.setReference()
	start = BodyArrays.positions(ids)
	run(20)
	expected = state(ids)
	assert (BodyArrays.positions(ids) == expected[:, :3]).all() and (BodyArrays.velocities(ids) == expected[:, 3:6]).all()
	assert (BodyArrays.displacements(ids) == expected[:, :3] - start).all()
	assert (BodyArrays.forces(ids) == forces(ids)[:, :3]).all()
	assert (BodyArrays.radii(ids) == [O.bodies[i].shape.radius for i in ids]).all()
	assert (BodyArrays.masses(ids) == [O.bodies[i].state.mass for i in ids]).all()
	assert BodyArrays.positions([]).shape == (0, 3)
	for bad in (-1, len(O.bodies)):
		with pytest.raises(RuntimeError, match="BodyArrays.ids = %d: there is no such body; fix: " % bad):
			BodyArrays.positions([bad])
	with pytest.raises(RuntimeError, match="BodyArrays.ids = %d: the body is no Sphere; fix: " % made["wall"].wall):
		BodyArrays.radii([made["wall"].wall])


def test_unbalancedIsYades(O, tier):
	from hexmembrane.measure.rows import unbalanced

	made = build(tier, **SMALL)
	run(20)
	moving = [b.id for b in O.bodies if b.dynamic]
	found = unbalanced(moving, measureOf(made).stress()["contactForce"])
	writeContacts()
	assert found == pytest.approx(utils.unbalancedForce(), rel=1e-9) and found > 0


def test_withoutContacts(O, tier):
	"""Nothing touches: no stress, and no force to compare with."""
	springs()
	sphere((0, 0, 0), GRAIN, fixed=True)
	wall = yade.Body()
	wall.shape = yade.CylinderWall(radius=1, height=1)
	wall.material, wall.dynamic = O.materials[0], False
	wall = O.bodies.append(wall)
	from hexmembrane.scene.platens import platen

	bottom, top = (O.bodies.append(platen((0, 0, z), RADIUS, HEIGHT, facing)) for z, facing in ((-0.1, 1), (0.1, -1)))
	O.engines = engines(tier)
	O.dt = 1e-6
	O.step()
	found = SoilMeasure(wall=wall, bottomPlaten=bottom, topPlaten=top).stress()
	assert not any(np.abs(found[name]).max() for name in ("whole", "middle", "boundary"))
	assert found["coordination"] == 0 and found["contactForce"] == 0
