# SPDX-License-Identifier: GPL-2.0-or-later
"""LocalMeasure in both tiers: its identities with the boundary's sums, its triangulation against a hull in four dimensions, what it refuses."""

import numpy as np
import pytest
import yade
from scipy.spatial import ConvexHull
from specimenScene import build
from test_soil_measure import SMALL, measureOf
from tiers import run
from yade import BodyArrays, LocalMeasure, O, utils


def localOf(made):
	return LocalMeasure(soil=measureOf(made))


def overTube(corners, triangles, u, low, high):
	"""Sum of u (x) n over the part of the triangles between two heights, u linear in each."""
	whole = np.zeros((3, 3))
	for t in triangles:
		polygon = [(corners[i], u[i]) for i in t]
		for height, sign in ((low, 1), (high, -1)):
			kept = []
			for (xa, ua), (xb, ub) in zip(polygon, polygon[1:] + polygon[:1]):
				da, db = sign * (xa[2] - height), sign * (xb[2] - height)
				if da >= 0:
					kept.append((xa, ua))
				if da * db < 0:
					s = da / (da - db)
					kept.append((xa + s * (xb - xa), ua + s * (ub - ua)))
			polygon = kept
		for (xb, ub), (xc, uc) in zip(polygon[1:], polygon[2:]):
			whole += np.outer((polygon[0][1] + ub + uc) / 3, np.cross(xb - polygon[0][0], xc - polygon[0][0]) / 2)
	return whole


def weighted(volumes, tensors):
	return np.einsum("g,gij->ij", volumes, tensors)


def test_meansAreThoseOfTheBoundary(O, tier):
	made = build(tier, velocity=0.05, membraneFriction=0.3, **SMALL)
	local = localOf(made)
	soil, membrane = local.soil, made["bonds"].membrane
	run(20)
	before, faces = local.mesh()["corners"], soil.faces
	volume = membrane.enclosedVolume(*faces)
	local.setReference()
	run(100)
	found, after, stress = local.measure(), local.mesh()["corners"], soil.stress()
	ids = list(range(SMALL["grains"]))
	assert list(found["ids"]) == ids

	assert found["referenceVolume"].sum() == pytest.approx(volume, rel=1e-10)
	assert found["volume"].sum() == pytest.approx(membrane.enclosedVolume(*soil.faces), rel=1e-10)
	assert found["volume"].sum() == pytest.approx(stress["volume"], rel=1e-10)
	assert found["voidRatio"] == pytest.approx(found["volume"] / (4 / 3 * np.pi * BodyArrays.radii(ids) ** 3) - 1, rel=1e-10)

	mean = weighted(found["referenceVolume"], found["gradient"])
	n, m = len(ids), len(membrane.ids)
	moved = after[: n + m] - before[: n + m]
	expected = overTube(before, np.array([tuple(t) for t in membrane.triangles]) + n, moved, *faces)
	assert np.abs(mean).max() > 1e-4 * volume
	assert np.abs((mean - expected)[:, :2]).max() < 1e-10 * np.abs(mean).max()  # the faces have no sideways normal
	strain = (found["gradient"] + found["gradient"].transpose(0, 2, 1)) / 2
	assert found["volumetric"] == pytest.approx(np.trace(strain, axis1=1, axis2=2), abs=1e-14)
	deviator = strain - found["volumetric"][:, None, None] / 3 * np.eye(3)
	assert found["deviatoric"] == pytest.approx(np.sqrt(2 / 3 * (deviator**2).sum(axis=(1, 2))), rel=1e-9)
	assert (found["nonAffine"] >= 0).all() and found["rotation"].shape == (n, 3)

	scale = np.abs(stress["whole"]).max()
	assert scale > 1e3
	mean = weighted(found["volume"], found["stress"]) / found["volume"].sum()
	assert np.abs(mean - stress["whole"]).max() < 1e-10 * scale
	# the grains' inertia is what is between that and the boundary's sum of force times position
	x, f = BodyArrays.positions(ids) - O.dt * BodyArrays.velocities(ids), BodyArrays.forces(ids)
	inertia = np.einsum("gi,gj->ij", f, x) / found["volume"].sum()
	assert np.abs(mean - stress["boundary"] - inertia).max() < 1e-9 * scale


def test_advanceMakesTheStateTheReference(O, tier):
	local = localOf(build(tier, velocity=0.05, **SMALL))
	run(20)
	assert "gradient" not in local.measure(advance=True)
	first = local.measure(advance=True)
	assert np.abs(first["gradient"]).max() == 0
	run(20)
	assert np.abs(local.measure()["gradient"]).max() > 0
	assert (local.measure()["referenceVolume"] == first["volume"]).all()


def test_triangulationIsTheLowerHullOfLiftedSpheres(O):
	"""A power triangulation is the lower side of the convex hull of (x, x^2 - r^2) in four dimensions."""
	random = np.random.default_rng(3)
	x, r = random.uniform(0, 1, (400, 3)), random.uniform(0, 0.1, 400)
	ids = [O.bodies.append(utils.sphere(tuple(c), size)) for c, size in zip(x, r)]
	found = LocalMeasure.triangulation(ids)
	hull = ConvexHull(np.column_stack([x, (x**2).sum(axis=1) - r**2]))
	expected = hull.simplices[hull.equations[:, 3] < 0]
	assert {tuple(sorted(t)) for t in found} == {tuple(sorted(t)) for t in expected}
	a, b, c, d = (x[found[:, k]] for k in range(4))
	assert (np.linalg.det(np.stack([b - a, c - a, d - a], axis=1)) > 0).all()


def test_refuses(O):
	with pytest.raises(ValueError, match=r"LocalMeasure.soil = None: .*; fix: "):
		LocalMeasure().setReference()
	with pytest.raises(RuntimeError, match=r"LocalMeasure.triangulation: ids = 5: there is no such sphere; fix: "):
		LocalMeasure.triangulation([5])


def test_meansInAWall(O, tier):
	"""The wall is taken for triangles that enclose its volume: cells, strain and stress have the means of that body's boundary."""
	made = build(tier, lateral="wall", velocity=0.05, membraneFriction=0.3, **SMALL)
	local = localOf(made)
	soil, wall = local.soil, O.bodies[made["wall"].wall]
	run(20)
	before, faces, radius = local.mesh(), soil.faces, wall.shape.radius
	local.setReference()
	run(100)
	found, after, stress = local.measure(), local.mesh()["corners"], soil.stress()
	assert wall.shape.radius != radius
	assert found["referenceVolume"].sum() == pytest.approx(np.pi * radius**2 * (faces[1] - faces[0]), rel=1e-10)
	assert found["volume"].sum() == pytest.approx(stress["volume"], rel=1e-10)
	tube = before["triangles"]
	moved = after[: tube.max() + 1] - before["corners"][: tube.max() + 1]
	mean, expected = weighted(found["referenceVolume"], found["gradient"]), overTube(before["corners"], tube, moved, *faces)
	assert np.abs((mean - expected)[:, :2]).max() < 1e-10 * np.abs(mean).max()
	# seen from the wall itself: radius and height change
	growth = (wall.shape.radius**2 / radius**2) * np.diff(soil.faces)[0] / np.diff(faces)[0] - 1
	assert np.trace(mean) / found["referenceVolume"].sum() == pytest.approx(growth, rel=0.01)
	mean = weighted(found["volume"], found["stress"]) / found["volume"].sum()
	assert np.abs(mean - stress["whole"]).max() < 1e-10 * np.abs(stress["whole"]).max()


@pytest.mark.parametrize("lateral", ["membrane", "wall"])
def test_aSavedReference(O, tmp_path, lateral):
	"""Strain counts on from a reference that was saved beside the scene."""
	local = localOf(build("compact", lateral=lateral, velocity=0.05, **SMALL))
	assert local.reference is None
	run(20)
	local.setReference()
	places = local.reference
	assert places["centres"] == pytest.approx(BodyArrays.positions(places["ids"].tolist())) and len(places["wall"]) == (5 if lateral == "wall" else 0)
	run(60)
	expected = local.measure()
	other = LocalMeasure(soil=local.soil)
	other.setReference({name: values.tolist() for name, values in places.items()})
	found = other.measure()
	for name, values in expected.items():
		assert np.array_equal(found[name], values, equal_nan=True), name
	with pytest.raises(RuntimeError, match=r"LocalMeasure.setReference: places are not of this scene's .*; fix: "):
		other.setReference({**places, "ids": places["ids"][:-1]})
	with pytest.raises(ValueError, match=r"LocalMeasure.setReference: places\['faces'\] = None: is missing; fix: "):
		other.setReference({name: values for name, values in places.items() if name != "faces"})


def test_refusesOtherGrainsThanTheReferences(O):
	local = localOf(build("reference", **SMALL))
	local.setReference()
	O.bodies.erase(3)
	with pytest.raises(RuntimeError, match=r"LocalMeasure.measure: the grains are not those .* \(59, not 60\); fix: "):
		local.measure()


def test_refusesAMembraneThatEndsBetweenTheFaces(O):
	made = build("reference", **SMALL)
	top = made["top"].platen
	O.bodies[top].state.pos += yade.Vector3(0, 0, 0.1)
	with pytest.raises(RuntimeError, match=r"LocalMeasure.soil.membrane: particle = \d+: .*open between the faces; fix: "):
		localOf(made).measure()
