# SPDX-License-Identifier: GPL-2.0-or-later
"""Gradations: curve, reader, cuts, numbers of grains, and samples whose own curve is that of the target."""

import math
import os

import numpy
import pytest

from hexmembrane.scene.gradation import Gradation, passingOf

EXAMPLE = os.path.join(os.path.dirname(__file__), "..", "..", "examples", "data", "toyoura.csv")
VOLUME = math.pi * 0.02**2 * 0.08


@pytest.fixture(scope="module")
def sand():
	return Gradation.fromCsv(EXAMPLE).cutPercent(3, 97)


def write(tmp_path, text):
	path = tmp_path / "grading.csv"
	path.write_text(text, encoding="utf-8")
	return path


def test_exampleIsAUniformSand(sand):
	whole = Gradation.fromCsv(EXAMPLE)
	assert whole.d50 == pytest.approx(0.201e-3, rel=0.01) and whole.uniformity == pytest.approx(1.30, rel=0.01)
	assert whole.curvature == pytest.approx(whole.d30**2 / whole.d10 / whole.d60)
	assert 2.4 < sand.largest / sand.smallest < 3.2


def test_curveIsLogLinear():
	curve = Gradation([1e-3, 4e-3], [0, 100])
	assert curve.diameterAt(50) == pytest.approx(2e-3, rel=1e-14)
	assert curve.percentPassing(2e-3) == pytest.approx(50, rel=1e-14)
	assert list(curve.percentPassing(numpy.array([0.5e-3, 1e-3, 4e-3, 9e-3]))) == [0, 0, 100, 100]
	assert (curve.d10, curve.d60) == (pytest.approx(1e-3 * 4**0.1), pytest.approx(1e-3 * 4**0.6))
	assert curve.uniformity == pytest.approx(2) and curve.curvature == pytest.approx(4 ** (0.6 - 0.1 - 0.6))


def test_passingOfTheSampleIsTheTarget(sand):
	"""Stated error: the mass share of the largest grain."""
	for count in (300, 1000, 7045):
		radii = sand.sample(count, seed=4)
		assert len(radii) == count and 2 * radii.min() >= sand.smallest and 2 * radii.max() <= sand.largest
		sizes = numpy.geomspace(sand.smallest, sand.largest, 60)
		error = numpy.abs(passingOf(radii, sizes) - sand.percentPassing(sizes)).max()
		largest = 100 * radii.max() ** 3 / (radii**3).sum()
		assert error <= 1.001 * largest
		assert largest < 130 * (sand.largest / sand.d50) ** 3 / count
	assert error < 0.15


def test_roundTripThroughTheSampleGivesTheCharacteristicSizes(sand):
	radii = numpy.sort(sand.sample(1000))
	mass = numpy.cumsum(radii**3) / (radii**3).sum()
	for percent in (10, 30, 50, 60, 90):
		assert 2 * radii[numpy.searchsorted(mass, percent / 100)] == pytest.approx(sand.diameterAt(percent), rel=0.01)


def test_volumeOfTheSampleIsExact(sand):
	radii = sand.sample(1234)
	assert (4 / 3 * math.pi * radii**3).sum() * sand.grainsPerVolume / 1234 == pytest.approx(1, rel=1e-12)


def test_grainsPerVolumeAgainstQuadrature(sand):
	"""The closed form against a fine sum over the curve."""
	percent = (numpy.arange(200000) + 0.5) / 2000
	diameters = numpy.exp(numpy.interp(percent, sand.passing, numpy.log(sand.diameters)))
	assert sand.grainsPerVolume == pytest.approx((6 / math.pi / diameters**3).mean(), rel=1e-7)


def test_sampledByMassNotByNumber():
	"""Two sizes, half of the mass each: eight small grains for one large one."""
	narrow = 1.000001
	curve = Gradation([1e-3, narrow * 1e-3, 2e-3, 2e-3 * narrow], [0, 50, 50, 100])
	radii = curve.sample(900)
	assert (radii < 0.6e-3).sum() == 800 and (radii > 0.9e-3).sum() == 100


def test_seedMixesTheOrderOnly(sand):
	a, b, c = sand.sample(500, seed=1), sand.sample(500, seed=1), sand.sample(500, seed=2)
	assert (a == b).all() and (a != c).any() and (numpy.sort(a) == numpy.sort(c)).all()
	assert abs(numpy.corrcoef(a, numpy.arange(500))[0, 1]) < 0.2


def test_oneGrainHasTheMeanVolume(sand):
	assert sand.sample(1)[0] == pytest.approx((3 / 4 / math.pi / sand.grainsPerVolume) ** (1 / 3), rel=1e-12)


def test_countAndScaleFollowFromEachOther(sand):
	scale = sand.scaleForGrains(7045, 0.389, VOLUME)
	scaled = sand.scaled(scale)
	assert scaled.grainCount(0.389, VOLUME) == 7045
	assert scaled.d50 == pytest.approx(scale * sand.d50, rel=1e-14) and scaled.uniformity == pytest.approx(sand.uniformity, rel=1e-12)
	solid = (4 / 3 * math.pi * scaled.sample(7045) ** 3).sum()
	assert 1 - solid / VOLUME == pytest.approx(0.389, abs=1e-9)


def test_cutRenormalises():
	curve = Gradation([1e-3, 2e-3, 4e-3, 8e-3], [0, 20, 60, 100])
	cut = curve.cut(cutBelow=2e-3, cutAbove=4e-3)
	assert list(cut.passing) == [0, 100] and list(cut.diameters) == [2e-3, 4e-3]
	half = curve.cut(cutBelow=2e-3 * 2**0.5)
	assert half.percentPassing(4e-3) == pytest.approx(100 * 20 / 60) and half.largest == 8e-3
	middle = curve.cutPercent(10, 80)
	assert (middle.smallest, middle.largest) == (pytest.approx(1e-3 * 2**0.5), pytest.approx(4e-3 * 2**0.5))
	assert middle.percentPassing(2e-3) == pytest.approx(100 * 10 / 70)
	assert list(curve.cut(cutBelow=1e-4, cutAbove=1).passing) == list(curve.passing)


def test_bins():
	curve = Gradation.fromBins([1e-3, 2e-3, 4e-3, 5e-3], [1, 0, 3])
	assert list(curve.passing) == [0, 25, 25, 100]
	radii = curve.sample(2000)
	# the one part that straddles the gap gives one grain of its mean volume
	assert ((2 * radii > 2e-3) & (2 * radii < 4e-3)).sum() <= 1
	assert passingOf(radii, [3e-3])[0] == pytest.approx(25, abs=0.2)


@pytest.mark.parametrize(
	"text",
	[
		"diameter (mm), percent passing\n0.1, 0\n0.2,40\n0.4,100\n",
		"# lab 7\n\nd [m]; P\n4e-4;100\n2e-4;40\n1e-4;0\n",
		"sieve/mm;passing\n0,1;0\n0,2;40\n0,4;100,0\n",
		"d_um\tpassing\n100\t0\n200\t40\n400\t100\n",
		"\ufeffsize (µm), %\r\n100, 0\r\n200, 40\r\n400, 100\r\n",
	],
)
def test_waysToWriteTheSameCurve(tmp_path, text):
	curve = Gradation.fromCsv(write(tmp_path, text))
	assert curve.diameters == pytest.approx([1e-4, 2e-4, 4e-4], rel=1e-14) and list(curve.passing) == [0, 40, 100]


HEAD = "d (mm), passing\n"


@pytest.mark.parametrize(
	"text, message",
	[
		("", "line 1: empty file"),
		("# only a comment\n", "empty file"),
		("0.1,0\n0.2,100\n", "line 1: .*no unit"),
		("diameter, passing (mm)\n0.1,0\n0.2,100\n", "no unit"),
		(HEAD + "0.1,0\n", "line 2: 1 rows"),
		(HEAD + "0.1,0\n0.2,50,3\n0.4,100\n", "line 3: .*3 columns"),
		(HEAD + "0.1,0\n0.2\n0.4,100\n", "line 3: .*1 columns"),
		(HEAD + "0.1,0\n0.2 mm,50\n0.4,100\n", "line 3: .*not two numbers"),
		(HEAD + "0.1,0\nnan,50\n0.4,100\n", "line 3: .*diameter is not a finite"),
		(HEAD + "0.1,0\n0.2,nan\n0.4,100\n", "line 3: .*outside 0 .. 100"),
		(HEAD + "-0.1,0\n0.4,100\n", "line 2: .*diameter is not"),
		(HEAD + "0.1,0\n0.4,101\n", "line 3: .*outside"),
		(HEAD + "0.1,0\n\n0.1,50\n0.4,100\n", "line 4: diameter .*repeated"),
		(HEAD + "0.1,0\n0.3,50\n0.2,60\n0.4,100\n", "line 4: diameter .*out of order"),
		(HEAD + "0.1,0\n0.2,50\n0.3,40\n0.4,100\n", "line 4: 40 percent: less passes"),
		(HEAD + "0.4,100\n0.2,50\n0.3,40\n0.1,0\n", "out of order"),
		(HEAD + "0.1,3\n0.4,100\n", r"passing\[0\] = 3.*how fine"),
		(HEAD + "0.1,0\n0.4,97\n", r"passing\[1\] = 97.*how coarse"),
	],
)
def test_badFiles(tmp_path, text, message):
	with pytest.raises(ValueError, match=message):
		Gradation.fromCsv(write(tmp_path, text))


def test_openEndsNeedACut(tmp_path):
	path = write(tmp_path, HEAD + "0.1,10\n0.2,60\n0.4,90\n")
	for cuts in ({"cutBelow": 1e-4}, {"cutAbove": 3e-4}, {"cutBelow": 0.9e-4, "cutAbove": 4e-4}):
		with pytest.raises(ValueError, match="how coarse|how fine"):
			Gradation.fromCsv(path, **cuts)
	curve = Gradation.fromCsv(path, cutBelow=1e-4, cutAbove=4e-4)
	assert curve.percentPassing(2e-4) == pytest.approx(100 * 50 / 80)


def test_missingFile(tmp_path):
	with pytest.raises(OSError, match="nothing.csv"):
		Gradation.fromCsv(tmp_path / "nothing.csv")


@pytest.mark.parametrize(
	"call, message",
	[
		(lambda g: Gradation([1e-3], [100]), "two points"),
		(lambda g: Gradation([1e-3, 2e-3], [0, 50, 100]), "not one for each"),
		(lambda g: Gradation([2e-3, 1e-3], [0, 100]), r"diameters\[1\]"),
		(lambda g: Gradation([0, 1e-3], [0, 100]), r"diameters\[0\]"),
		(lambda g: Gradation([1e-3, float("nan")], [0, 100]), r"diameters\[1\]"),
		(lambda g: Gradation([1e-3, 2e-3, 3e-3], [0, 100, 99]), r"passing\[2\]"),
		(lambda g: Gradation.fromBins([1, 2], [1, 1]), "2 bins"),
		(lambda g: Gradation.fromBins([1, 2, 3], [1, -1]), r"massFractions\[1\]"),
		(lambda g: Gradation.fromBins([1, 2], [0]), "no mass"),
		(lambda g: g.scaled(0), "factor"),
		(lambda g: g.scaled(float("nan")), "factor"),
		(lambda g: g.cut(cutBelow=1.0), "cutBelow"),
		(lambda g: g.cut(cutAbove=1e-9), "cutBelow"),
		(lambda g: g.cutPercent(50, 50), "cutPercent"),
		(lambda g: g.diameterAt(101), "percent"),
		(lambda g: g.sample(0), "count"),
		(lambda g: g.sample(2.5), "count"),
		(lambda g: g.sample(True), "count"),
		(lambda g: g.grainCount(1.0, 1.0), "porosity"),
		(lambda g: g.grainCount(0.4, -1.0), "volume"),
		(lambda g: g.scaleForGrains(-1, 0.4, 1.0), "count"),
		(lambda g: passingOf([], [1]), "radii"),
		(lambda g: passingOf([1, float("nan")], [1]), "radii"),
	],
)
def test_badInput(sand, call, message):
	with pytest.raises(ValueError, match=message):
		call(sand)


def test_curvesCannotBeChangedBehindTheirBack(sand):
	with pytest.raises(ValueError):
		sand.passing[0] = 5
