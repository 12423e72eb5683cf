# SPDX-License-Identifier: GPL-2.0-or-later
"""MeasureRegions in both tiers: against loops over bodies and contacts, SoilMeasure, closed forms, and what it refuses."""

import math

import numpy as np
import pytest
import yade
from contactScene import sphere, springs, swarm
from hexmembrane.measure.regions import CarriedRegions
from specimenScene import HEIGHT, build
from tiers import contact, engines, run, writeContacts
from yade import BodyArrays, MeasureRegions, O, SoilMeasure, utils

SMALL = dict(grains=60, porosity=0.5, particleRadius=4e-3, spin=0.05, substeps=10, swell=1.02)


def lens(a, b, d):
	"""Volume that two balls share, by its caps."""
	if d >= a + b:
		return 0.0
	if d <= abs(a - b):
		return 4 / 3 * math.pi * min(a, b) ** 3
	x = (d * d + a * a - b * b) / (2 * d)
	return sum(math.pi * h * h * (3 * r - h) / 3 for r, h in ((a, a - x), (b, b - (d - x))))


def share(start, branch, radius):
	"""Share of a segment that lies in a ball round the origin, by the roots of a polynomial."""
	roots = np.roots([branch @ branch, 2 * branch @ start, start @ start - radius**2])
	if np.iscomplex(roots).any():
		return 0.0
	low, high = np.clip(sorted(roots.real), 0, 1)
	return high - low


def byLoops(grains, centre, radius):
	"""The oracle for one region: loops over O.bodies and O.interactions."""
	writeContacts()
	x = {i: np.array(O.bodies[i].state.pos) - centre for i in grains}
	size = {i: O.bodies[i].shape.radius for i in grains}
	inside = [i for i in grains if np.linalg.norm(x[i]) < radius]
	volume = 4 / 3 * math.pi * radius**3
	solid = sum(lens(radius, size[i], np.linalg.norm(x[i])) for i in grains)
	numbers, active, pairs, slides, stress, met = dict.fromkeys(grains, 0), 0, 0, 0, np.zeros((3, 3)), False
	for c in O.interactions:
		first, second = c.id1 in size, c.id2 in size
		if not first and not second:
			continue
		force, point = np.array(c.phys.normalForce + c.phys.shearForce), np.array(c.geom.contactPoint) - centre
		start = point - (c.geom.refR1 - c.geom.penetrationDepth / 2) * np.array(c.geom.normal) if first else point
		end = point + (c.geom.refR2 - c.geom.penetrationDepth / 2) * np.array(c.geom.normal) if second else point
		part = share(start, end - start, radius)
		stress += part * np.outer(force, end - start)
		met = met or part > 0
		normal, tangential = np.linalg.norm(c.phys.normalForce), np.linalg.norm(c.phys.shearForce)
		for i in {c.id1, c.id2} & set(grains):
			numbers[i] += normal > 0
		if np.linalg.norm(point) < radius and normal > 0:
			active += 1
			if first and second:
				pairs += 1
				slides += tangential > c.phys.tangensOfFrictionAngle * normal * (1 - 1e-6)
				solid -= lens(size[c.id1], size[c.id2], np.linalg.norm(end - start))
	return {
		"grains": len(inside),
		"contacts": active,
		"porosity": 1 - solid / volume,
		"coordination": np.mean([numbers[i] for i in inside]) if inside else math.nan,
		"sliding": slides / pairs if pairs else math.nan,
		"stress": stress / volume if met else np.full((3, 3), math.nan),
		"velocity": np.mean([O.bodies[i].state.vel for i in inside], axis=0) if inside else np.full(3, math.nan),
	}


def regionsOf(made):
	return MeasureRegions(membrane=made["bonds"].membrane) if "bonds" in made else MeasureRegions()


@pytest.mark.parametrize("lateral", ("membrane", "wall"))
def test_isTheSumOverBodiesAndContacts(O, tier, lateral):
	made = build(tier, lateral=lateral, membraneFriction=0.3, friction=0.1, **SMALL)
	run(40)
	centres = np.array([(0, 0, HEIGHT / 2), (0.01, 0.005, 0.01), (0, 0, 0.03), (-0.012, 0.004, 0.02), (0, 0, 0.04)])
	radii = np.array([0.05, 0.01, 0.012, 2e-3, 6e-3])
	found = regionsOf(made).measure(centres, radii)
	for k, (centre, radius) in enumerate(zip(centres, radii)):
		for name, expected in byLoops(range(SMALL["grains"]), centre, radius).items():
			scale = np.abs(found["stress"][0]).max() if name == "stress" else 1
			assert found[name][k] == pytest.approx(expected, rel=1e-6, abs=1e-9 * scale, nan_ok=True), (name, k)
	assert 0 < found["sliding"][0] < 1 and found["grains"][0] == SMALL["grains"]


@pytest.mark.parametrize("lateral", ("membrane", "wall"))
def test_oneRegionRoundAllIsTheWholeSoil(O, tier, lateral):
	"""V stress of a region that holds the specimen is that of SoilMeasure."""
	made = build(tier, lateral=lateral, **SMALL)
	run(40)
	around = {"membrane": made["bonds"].membrane} if lateral == "membrane" else {"wall": made["wall"].wall}
	whole = SoilMeasure(bottomPlaten=made["bottom"].platen, topPlaten=made["top"].platen, **around).stress()
	radius, ids = 0.06, list(range(SMALL["grains"]))
	found = regionsOf(made).measure([(0, 0, HEIGHT / 2)], radius, [0, 2 * BodyArrays.radii(ids).min() * (1 + 1e-9), 1])
	volume = 4 / 3 * math.pi * radius**3
	moment = whole["whole"] * whole["volume"]
	assert np.abs(found["stress"][0] * volume - moment).max() < 1e-12 * np.abs(moment).max()
	sizes = 4 / 3 * math.pi * BodyArrays.radii(ids) ** 3
	assert found["sizes"].shape == (1, 2) and found["sizes"][0] == pytest.approx([sizes.min(), sizes.sum() - sizes.min()], rel=1e-12)
	assert found["velocity"][0] == pytest.approx(BodyArrays.velocities(ids).mean(axis=0), rel=1e-9)
	start, members = regionsOf(made).members([(0, 0, HEIGHT / 2)], [radius])
	assert start.tolist() == [0, len(ids)] and members.tolist() == ids


def test_uniformStrainRate(O, tier):
	"""Grains that fly with v = v0 + a x: the gradient is a, the strain rate positive in compression."""
	springs()
	gradient = np.array([(-2, 0.5, 0), (0.1, 1, 0.3), (0.2, -0.4, -3.0)])
	swarm(count=64, speed=0)
	for body in O.bodies:
		body.state.vel = tuple(np.array([1.0, -2, 0.5]) + gradient @ np.array(body.state.pos))
	O.engines, O.dt = engines(tier), 1e-9
	run(1)
	centres = np.array([O.bodies[i].state.pos for i in range(64)]).mean(axis=0)[None]
	# a step moves the grains by less than 1e-8 of the gradient
	found = MeasureRegions().measure(centres, 3e-3)
	assert found["grains"][0] == 8
	assert found["velocityGradient"][0] == pytest.approx(gradient, abs=1e-7)
	assert found["strainRate"][0] == pytest.approx(-(gradient + gradient.T) / 2, abs=1e-7)


def pressed(bond=0.0):
	"""Two spheres that overlap, one above the other, with the ids 0 and 1."""
	springs(cbTensile=bond, cbShear=bond)
	for z in (0, 1.9e-3):
		sphere((0, 0, z), 1e-3, fixed=True)


def test_aContactAtItsLimitSlides(O, tier):
	pressed()
	O.engines, O.dt = engines(tier), 1e-6
	region = [(0, 0, 0.95e-3)], 5e-4
	run(1)
	found = MeasureRegions().measure(*region)
	assert found["sliding"][0] == 0 and found["contacts"][0] == 1 and found["grains"][0] == 0 and math.isnan(found["coordination"][0])
	O.bodies[1].state.vel = (10, 0, 0)
	run(20)
	assert MeasureRegions().measure(*region)["sliding"][0] == 1


def test_aBondedContactDoesNotSlide(O, tier):
	pressed(bond=1e9)
	O.engines, O.dt = engines("reference", bonds=True), 1e-6
	O.step()
	O.engines = engines(tier)
	O.bodies[1].state.vel = (10, 0, 0)
	run(20)
	assert np.linalg.norm(contact(0, 1).phys.shearForce) > 0.4 * np.linalg.norm(contact(0, 1).phys.normalForce)
	assert MeasureRegions().measure([(0, 0, 0.95e-3)], 1.5e-3)["sliding"][0] == 0


@pytest.mark.parametrize("hertz", (False, True))
def test_stockLawsOfSpheres(O, hertz):
	"""A row of spheres under YADE's own laws, a box that is no sphere, and one of another mask. Reference tier: no other knows these laws."""
	O.materials.append(yade.FrictMat(young=1e8, poisson=0.3, frictionAngle=0.4))
	for z in (1e-3, 2.95e-3, 4.9e-3):
		sphere((0, 0, z), 1e-3, fixed=True)
	apart = sphere((0, 0, 6.85e-3), 1e-3, fixed=True)
	O.bodies[apart].groupMask = 1 + 4
	O.bodies.append(utils.box((0, 0, -9.5e-4), (0.01, 0.01, 1e-3), fixed=True))
	physics, law = (
		(yade.Ip2_FrictMat_FrictMat_MindlinPhys(), yade.Law2_ScGeom_MindlinPhys_Mindlin())
		if hertz
		else (yade.Ip2_FrictMat_FrictMat_FrictPhys(), yade.Law2_ScGeom_FrictPhys_CundallStrack())
	)
	O.engines = [
		yade.ForceResetter(),
		yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), yade.Bo1_Box_Aabb()]),
		yade.InteractionLoop([yade.Ig2_Sphere_Sphere_ScGeom(), yade.Ig2_Box_Sphere_ScGeom()], [physics], [law]),
		yade.NewtonIntegrator(),
	]
	O.dt = 1e-9
	O.step()
	found = MeasureRegions(exclude=4).measure([(0, 0, 3e-3)], 0.01)
	assert found["grains"][0] == 3 and found["contacts"][0] == 4 and found["coordination"][0] == 2 and found["sliding"][0] == 0
	volume = 4 / 3 * math.pi * 0.01**3
	moment = 0.0
	for c in O.interactions:
		# among grains from centre to centre, to all else up to the contact point
		grains = [i for i in (c.id1, c.id2) if i < 3]
		length = 1.95e-3 if len(grains) == 2 else abs(c.geom.contactPoint[2] - O.bodies[grains[0]].state.pos[2])
		moment += np.linalg.norm(c.phys.normalForce) * length
	assert found["stress"][0, 2, 2] * volume == pytest.approx(moment, rel=1e-9) and moment > 0
	solid = 3 * 4 / 3 * math.pi * 1e-9 - 2 * lens(1e-3, 1e-3, 1.95e-3)
	assert found["porosity"][0] == pytest.approx(1 - solid / volume, rel=1e-12)


def test_gridFillsABox(O):
	centres = MeasureRegions.grid((0, 0, 0), (1, 2, 0.5), 0.5)
	assert centres.shape == (8, 3) and centres[0].tolist() == [0.25, 0.25, 0.25] and centres[1].tolist() == [0.75, 0.25, 0.25]
	assert MeasureRegions.grid((0, 0, 0), (0.1, 0.1, 0.1), 0.5).tolist() == [[0.05, 0.05, 0.05]]
	with pytest.raises(ValueError, match=r"MeasureRegions.grid.spacing = 0: .*; fix: "):
		MeasureRegions.grid((0, 0, 0), (1, 1, 1), 0)


def test_carriedRegionsMoveWithTheirGrains(O, tier):
	springs()
	swarm(count=27, speed=0)
	velocity = np.array([0.5, -1, 2])
	for body in O.bodies:
		body.state.vel = tuple(velocity)
	O.engines, O.dt = engines(tier), 1e-6
	run(1)
	start = np.array([(0, 0, 0), (2e-3, 0, 0), (1.2e-3, 1.2e-3, 1.2e-3)])
	carried = CarriedRegions(MeasureRegions(), start, [2e-3, 2e-3, 1e-5])
	assert carried.measure()["grains"].tolist()[2] == 0
	for _ in range(3):
		run(100)
		moved = carried.move()
	shift = 3e-4 * velocity
	assert moved - start == pytest.approx(np.array([shift, shift, 0 * shift]), rel=1e-9, abs=1e-15)


@pytest.mark.parametrize(
	"centres, radii, diameters, part",
	(
		([(0, 0, 0)], 0, (), r"MeasureRegions.radii\[0\] = 0"),
		([(0, 0, 0)] * 2, [1e-3, -1], (), r"MeasureRegions.radii\[1\] = -1"),
		([(0, 0, 0)], math.nan, (), r"MeasureRegions.radii\[0\]"),
		([(0, 0, 0)] * 3, [1e-3, 1e-3], (), "MeasureRegions.radii = 2"),
		([(0, 0, 0), (1, 0, 0)], 1e-3, (), r"MeasureRegions.centres\[1\] = \(1, 0, 0\): the region lies outside the specimen"),
		([(0, 0, math.inf)], 1e-3, (), r"MeasureRegions.centres\[0\] = inf"),
		([(0, 0)], 1e-3, (), r"MeasureRegions.centres = \(1, 2\): an array of the wrong shape"),
		("here", 1e-3, (), "MeasureRegions.centres = here: not an array of numbers"),
		([(0, 0, 0)], 1e-3, [1.0], "MeasureRegions.diameters = 1"),
		([(0, 0, 0)], 1e-3, [1.0, 0.5], r"MeasureRegions.diameters\[1\] = 0.5"),
	),
)
def test_refuses(O, centres, radii, diameters, part):
	springs()
	swarm(count=8)
	with pytest.raises(ValueError, match=part + ".*; fix: "):
		MeasureRegions().measure(centres, radii, diameters)


def test_refusesScenesThatItWouldMeasureWrongly(O):
	with pytest.raises(ValueError, match="MeasureRegions.exclude = 0: leaves no grain in the scene; fix: "):
		MeasureRegions().measure([(0, 0, 0)], 1)
	springs()
	O.bodies.appendClumped([utils.sphere((0, 0, 0), 1e-3), utils.sphere((1e-3, 0, 0), 1e-3)])
	with pytest.raises(RuntimeError, match="MeasureRegions: body 0 is of a clump.*; fix: "):
		MeasureRegions().measure([(0, 0, 0)], 1)
	O.reset()
	springs()
	sphere((0, 0, 0), 1e-3)
	O.periodic = True
	with pytest.raises(RuntimeError, match="MeasureRegions: O.periodic = True.*; fix: "):
		MeasureRegions().measure([(0, 0, 0)], 1)


def test_noRegionIsNoRow(O):
	springs()
	swarm(count=8)
	found = MeasureRegions().measure(np.zeros((0, 3)), [], [0, 1e-3, 1])
	assert found["porosity"].shape == (0,) and found["stress"].shape == (0, 3, 3) and found["sizes"].shape == (0, 2)
