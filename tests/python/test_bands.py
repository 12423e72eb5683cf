# SPDX-License-Identifier: GPL-2.0-or-later
"""Bands found by the program: in fields with known bands in a real packing, with noise. The long form: syntheticBands.py."""

import math

import numpy as np
import pytest
from hexmembrane.measure import bands
from syntheticBands import HEIGHT, KINDS, packing, strains, trial


@pytest.fixture(scope="module")
def grains():
	return packing(7045)


@pytest.mark.parametrize("kind", KINDS)
def test_verdictDipAndThickness(kind, grains):
	"""A field of each kind without a band, two of each with one."""
	for seed in range(2 if kind in ("band", "pair") else 1):
		one = trial(kind, grains, seed)
		assert one.right, (seed, one.found)
		assert (abs(one.errors[:, 0]) < 2).all() and (abs(one.errors[:, 2]) < 1).all(), (seed, one.errors)
		assert len(one.found.planes) == max(1, len(one.planes))


def test_intervalsHoldWhatIsKnown():
	few = packing(1500)
	one = trial("band", few, 4, replicates=20)
	low, high = one.found.intervals["dip[0]"]
	plane = one.found.planes[0]
	assert low < plane.dip < high and high - low < 6 and one.found.certainty == 1
	assert low - 1 < one.planes[0][0] < high + 1
	for name, value in (("index", one.found.index), ("explained", one.found.explained), ("azimuth[0]", plane.azimuth), ("thickness[0]", plane.thickness)):
		low, high = one.found.intervals[name]
		assert low - 0.05 * abs(value) <= value <= high + 0.05 * abs(value), name
	again = trial("band", few, 4, replicates=20)
	assert again.found == one.found  # seeded


def test_aKnownPlane(grains):
	"""A slab of uniform shear without noise: plane, jump, slab and index are known."""
	x, d50 = grains
	plane = bands.Plane(60, 30, (0, 0, 0.004), 5 * d50)
	n = plane.normal
	assert np.linalg.norm(n) == pytest.approx(1) and n[2] > 0 and math.degrees(math.atan2(n[1], n[0])) == pytest.approx(30)
	jump = 1e-3 * np.array([n[0] * n[2], n[1] * n[2], n[2] ** 2 - 1])
	u = np.clip(plane.distance(x) / plane.thickness, -0.5, 0.5)[:, None] * jump
	volumes, deviatoric = strains(x, u, d50)
	found = bands.find(x, u, volumes, deviatoric, d50, axis=(0, 0))
	assert found.verdict == "band" and found.explained > 0.95 and found.index > 0.7
	best = found.planes[0]
	assert best.dip == pytest.approx(60, abs=0.5) and best.azimuth == pytest.approx(30, abs=0.7)
	assert best.thickness == pytest.approx(plane.thickness, rel=0.05) and best.point == pytest.approx(plane.point, abs=0.3 * d50)
	assert best.jump == pytest.approx(jump, abs=0.02 * np.linalg.norm(jump))
	shear = deviatoric * volumes
	assert shear[plane.inside(x)].sum() > 0.8 * shear.sum()
	shifted = bands.find(x + [1, 2, 3], u, volumes, deviatoric, d50)
	assert shifted.planes[0].dip == pytest.approx(best.dip, abs=0.1) and shifted.planes[0].point == pytest.approx(np.add(best.point, [1, 2, 3]), abs=1e-3)


def test_grainsWithoutACellAreLeftOut(grains):
	x, d50 = grains
	u = 0.01 * x * [0.5, 0.5, -1]
	volumes, deviatoric = strains(x, u, d50)
	volumes, deviatoric = volumes.copy(), deviatoric.copy()
	volumes[7], deviatoric[7] = 0, math.nan
	assert bands.find(x, u, volumes, deviatoric, d50).verdict == "none"


@pytest.mark.parametrize(
	"change, message",
	[
		({"positions": np.zeros((3, 2))}, r"bands.find: positions = an array \(3, 2\): \(7045, 3\) expected; fix: "),
		({"deviatoric": np.zeros(4)}, r"bands.find: deviatoric = an array \(4,\): .*; fix: "),
		({"diameter": 0}, r"bands.find: diameter = 0: is no length; fix: "),
		({"deviatoric": np.zeros(7045)}, r"bands.find: deviatoric = 0 in all grains: .*; fix: "),
		({"volumes": np.zeros(7045)}, r"bands.find: volumes = 0 grains with a cell .* less than 100; fix: "),
	],
)
def test_refuses(grains, change, message):
	x, d50 = grains
	given = {"positions": x, "displacements": x, "volumes": np.ones(len(x)), "deviatoric": np.ones(len(x)), "diameter": d50}
	with pytest.raises(ValueError, match=message):
		bands.find(**{**given, **change})


def test_expectedDips():
	assert bands.expectedDips(40, 10) == (65, 50, 57.5)


def test_medianDiameter():
	assert bands.medianDiameter([1.0] * 8 + [2.0, 0.5]) == 2.0


@pytest.mark.parametrize(
	"indices, found, strain",
	[
		([0, 0.1, 0.3, 0.4], [0, 0, 1, 1], 0.02),
		([0, 0.3, 0.1, 0.4], [0, 1, 0, 1], 0.025 + 0.01 / 3),
		([0, 0.1, 0.1], [0, 0, 0], math.nan),
		([0.3, 0.3], [1, 1], 0.005),
		([0.0, 0.3, 0.4], [0, 0, 1], 0.025),
	],
)
def test_onset(indices, found, strain):
	strains_ = [0.005 + 0.01 * k for k in range(len(indices))]
	assert bands.onset(strains_, indices, found) == pytest.approx(strain, nan_ok=True)


def test_heightOfAPlane():
	assert abs(bands.Plane(45, 0, (0, 0, 0.1 * HEIGHT), 0.01).distance([(0.1 * HEIGHT, 0, 0)])[0]) < 1e-12
