# SPDX-License-Identifier: GPL-2.0-or-later
"""Calibration: the statistics on a made-up soil with known parameters, the file's checks, what is left in the folder, going on."""

import argparse
import importlib
import json
import pathlib
import sys

import numpy
import pytest
from hexmembrane.configuration import ConfigError
from hexmembrane.laboratory.curve import Curve, Series

ROOT = pathlib.Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "scripts" / "calibrate.d"), str(ROOT / "scripts" / "sweep.d")]
calibrate, calibrationfile, evaluate, inside, likelihood, report, sampling = (
	importlib.import_module(name) for name in ("calibrate", "calibrationfile", "evaluate", "inside", "likelihood", "report", "sampling")
)

STRAIN = numpy.linspace(0, 0.15, 61)
#: Columns of records.csv that a laboratory's curve is compared with.
STRAINED = "axial_strain [-]", "q_cell [Pa]", "sigma3_target [Pa]", "volumetric_strain_volume [-]"
RANGES = {"specimen.friction": {"low": 0.2, "high": 0.8}, "specimen.rollingFriction": {"low": 0.0, "high": 0.5}}


def soil(friction, rolling, random=None, scatter=1.0):
	"""A made-up soil: peak, softening and dilation hang on both parameters; a packing's scatter is smooth along the strain."""
	peak, end, slope = 2.0 + 3 * friction + 2.5 * rolling, 2.5 + 1.5 * friction + 0.5 * rolling, 0.25 + 0.3 * friction + 1.2 * rolling
	rise = STRAIN / (0.006 + STRAIN)
	ratio = 1 + (peak - 1) * rise - (peak - end) * (1 - numpy.exp(-(((STRAIN / 0.08)) ** 2)))
	volume = slope * (STRAIN - 0.01 * (1 - numpy.exp(-STRAIN / 0.01)) * 1.5) * numpy.exp(-STRAIN / 0.3)
	if random is not None:
		ratio = ratio + scatter * 0.08 * random.normal() * rise + scatter * 0.05 * random.normal() * numpy.sin(40 * STRAIN)
		volume = volume + scatter * 0.002 * random.normal() * STRAIN / 0.15
	return {"stress_ratio": Series(STRAIN, ratio), "volumetric_strain": Series(STRAIN, volume)}


def writeCurve(folder, series):
	lines = ["e [%],sr,v [%]"] + [f"{100 * e},{sr},{100 * v}" for e, sr, v in zip(STRAIN, series["stress_ratio"].value, series["volumetric_strain"].value)]
	(folder / "lab.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


def declared(**changes):
	keys = {
		"base": str(ROOT / "examples" / "quick.yaml"),
		"changes": {"shear": {"strain": 0.15}},
		"curves": {"lab": {"file": "lab.csv", "strain": "e [%]", "stress_ratio": "sr", "volumetric_strain": "v [%]", "volumetric": "dilation"}},
		"parameters": RANGES,
		"seeds": 2,
		"samples": 40,
		"generations": 5,
		**changes,
	}
	return {key: value for key, value in keys.items() if value is not None}


def write(folder, **changes):
	path = folder / "c.yaml"
	path.write_text(json.dumps(declared(**changes)), encoding="utf-8")
	if not (folder / "lab.csv").exists():
		writeCurve(folder, soil(0.5, 0.2, numpy.random.default_rng(1)))
	return path


class MadeUp:
	"""In place of evaluate.Tests: the made-up soil instead of tests; counts what it runs."""

	def __init__(self, calibration, folder, arguments, say):
		self.calibration, self.folder, self.ran = calibration, pathlib.Path(folder) / "tests", []

	def run(self, sets):
		self.ran.append(len(sets))

	def series(self, sets):
		found = {}
		for name, point in sets:
			seed = [int(part) for part in name.split(".")]
			found[name] = {"lab": [soil(*self.calibration.values(point).values(), numpy.random.default_rng([*seed, k])) for k in self.calibration.seeds]}
		return found, {name: [] for name, _ in sets}

	def gather(self, sets):
		pass


@pytest.fixture
def madeUp(monkeypatch):
	monkeypatch.setattr(calibrate.evaluate, "Tests", MadeUp)


def search(folder, **changes):
	"""The posterior of a made-up calibration."""
	folder.mkdir(exist_ok=True)
	calibration = calibrationfile.load(write(folder, **changes))
	out = folder / "out"
	assert calibrate.calibrate(calibration, out, argparse.Namespace(again=False, inside=False), lambda text: None) == 0
	return out


def test_recovers(tmp_path, madeUp, monkeypatch):
	"""Known friction and rolling friction, with the scatter of a packing on the curve: within the intervals in 9 of 10 trials, medians off by 0.03 in the mean."""
	for picture in ("_drawPosterior", "_drawPredictions"):
		monkeypatch.setattr(report, picture, lambda *_: None)  # others draw them
	covered, errors = 0, []
	truths = numpy.random.default_rng(5).uniform([0.3, 0.1], [0.7, 0.4], (10, 2))
	for k, (friction, rolling) in enumerate(truths):
		folder = tmp_path / str(k)
		folder.mkdir()
		writeCurve(folder, soil(friction, rolling, numpy.random.default_rng([77, k]), 0.5))
		found = json.loads((search(folder) / "posterior.json").read_text(encoding="utf-8"))
		parameters = found["parameters"]
		for key, truth in zip(RANGES, (friction, rolling)):
			errors.append(abs(parameters[key]["median"] - truth))
		covered += all(parameters[key]["low"] <= truth <= parameters[key]["high"] for key, truth in zip(RANGES, (friction, rolling)))
		assert found["effective_sets"] > 10
	assert covered >= 9
	assert numpy.mean(errors) < 0.03, errors


def test_bestFit(tmp_path, madeUp):
	out = search(tmp_path, method="best", seeds=1, samples=30, generations=5)
	rows = (out / "sets.csv").read_text(encoding="utf-8").splitlines()
	best = next(row.split(",") for row in rows[1:] if row.split(",")[4] == "1.0")
	assert abs(float(best[1]) - 0.5) < 0.1 and abs(float(best[2]) - 0.2) < 0.1
	numbers = [row.split(",") for row in (out / "misfit.csv").read_text(encoding="utf-8").splitlines()[1:]]
	assert len(numbers) == 8 and abs(float(numbers[0][5])) < 0.5 and numbers[0][1] == "peak of sigma1/sigma3"
	assert (out / "best.yaml").is_file() and (out / "prediction.png").is_file() and not (out / "posterior.json").exists()


def test_goesOn(tmp_path, madeUp):
	"""A second call draws nothing anew; more generations go on from what is there; another range is refused."""
	first = search(tmp_path, generations=2)
	kept = json.loads((first / "generations.json").read_text(encoding="utf-8"))["generations"]
	posterior = (first / "posterior.json").read_bytes()
	assert search(tmp_path, generations=2) == first and (first / "posterior.json").read_bytes() == posterior
	search(tmp_path, generations=3)
	again = json.loads((first / "generations.json").read_text(encoding="utf-8"))["generations"]
	assert again[:2] == kept and len(again) == 3
	with pytest.raises(ConfigError, match="other parameters"):
		search(tmp_path, samples=20)


def test_grainLearning(tmp_path, madeUp):
	"""Its table of samples can be the start of another calibration."""
	out = search(tmp_path, generations=1, samples=8, title="sand one")
	table = out / "grainlearning" / "sand-one_Iter0_Samples.txt"
	assert table.read_text(encoding="utf-8").split()[:5] == ["!OMP_NUM_THREADS", "description", "key", *RANGES]
	assert len(list(table.parent.glob("*_sim.txt"))) == len(list(table.parent.glob("*_param.txt"))) == 8
	data = numpy.genfromtxt(next(table.parent.glob("*_Sample3_sim.txt")))
	assert data.shape == (likelihood.POINTS, 3)
	other = tmp_path / "other"
	other.mkdir()
	calibration = calibrationfile.load(write(other, start=str(table)))
	points = sampling.Prior(2).draw(8, 1)
	assert calibration.start == pytest.approx(points, abs=1e-9)


@pytest.mark.parametrize(
	("changes", "message"),
	[
		({"colour": 1}, "calibration.colour"),
		({"parameters": {"specimen.frition": {"low": 0, "high": 1}}}, "parameters.specimen.frition"),
		({"parameters": {"specimen.friction": [0.2, 0.8]}}, "is no range"),
		({"parameters": {"specimen.friction": {"low": 0.8, "high": 0.2}}}, "low below high"),
		({"parameters": {"specimen.emod": {"low": 0, "high": 1e8, "scale": "log"}}}, "parameters.specimen.emod.scale"),
		({"parameters": {"specimen.friction": {"low": -0.5, "high": 0.8}}}, "specimen.friction"),
		({"parameters": {"wall.damping": {"low": 0.1, "high": 0.8}}}, "wall.damping"),
		({"seeds": 1}, "scatter of packings cannot be measured"),
		({"samples": 2}, "calibration.samples"),
		({"method": "guess"}, "calibration.method"),
		({"model": 3}, "calibration.model"),
		({"model": "none"}, "calibration.model"),
		({"curves": None}, "calibration.curves"),
		({"curves": {"lab": {"file": "nowhere.csv", "strain": "e", "stress_ratio": "sr"}}}, "curves.lab.file"),
		({"start": "nowhere.txt"}, "calibration.start"),
	],
)
def test_refused(tmp_path, changes, message):
	with pytest.raises(ConfigError, match=message):
		calibrationfile.load(write(tmp_path, **changes))


def test_weightsOfAMixture():
	"""Points from prior and proposal together, weighted, have the moments of the target, a Gaussian in the cube."""
	centre, width = numpy.array([0.3, 0.7]), 0.08

	def logs(points):
		return -0.5 * (((points - centre) / width) ** 2).sum(axis=1)

	first = sampling.Prior(2)
	points = first.draw(256, 3)
	weight, power = sampling.temper(logs(points), points, [(first, 256)], 60)
	assert power < 1 and sampling.effective(weight) == pytest.approx(60, rel=1e-3)
	proposal = sampling.Mixture(points, weight, 4)
	grid = numpy.stack(numpy.meshgrid(*[(numpy.arange(200) + 0.5) / 200] * 2), -1).reshape(-1, 2)
	assert proposal.density(grid).mean() == pytest.approx(1, abs=0.01)
	more = proposal.draw(1024, 5)
	assert more.shape == (1024, 2) and (more >= 0).all() and (more <= 1).all()
	points = numpy.vstack([points, more])
	weight = sampling.weights(logs(points), points, [(first, 256), (proposal, 1024)])
	assert weight @ points == pytest.approx(centre, abs=0.01)
	assert numpy.sqrt(weight @ (points - centre) ** 2) == pytest.approx([width] * 2, rel=0.1)


def test_likelihood():
	"""Of a set that hits the curve: the normalisation alone; the scatter of packings is pooled over sets; a failed set has none."""
	curve = Curve("c", {"stress_ratio": Series(STRAIN, 1 + 20 * STRAIN)}, [])
	target = likelihood.targets({"c": curve}, {"c": 0.1})[0]
	assert target.strain[-1] == pytest.approx(0.1) and len(target.strain) == likelihood.POINTS
	found = likelihood.Evaluations([target], 0.0)

	def test(offset):
		return {"stress_ratio": Series(STRAIN, 1 + 20 * STRAIN + offset)}

	assert found.add({"c": [test(0.1), test(-0.1)]}) == []
	found.add({"c": [test(0.4), test(0.2)]})
	found.add({"c": []})
	short = found.add({"c": [{"stress_ratio": Series(STRAIN[:10], STRAIN[:10])}]})
	assert short == ["c: 1 of 1 tests end before 0.1, and do not count"]
	assert found.packing(target) == pytest.approx(numpy.full(likelihood.POINTS, numpy.sqrt(0.02)))
	logs = found.logLikelihood()
	variance = 0.02 * 1.5 + likelihood.READING["stress_ratio"] ** 2
	covariance = variance * numpy.exp(-abs(target.strain[:, None] - target.strain) / likelihood.LENGTH)
	assert logs[0] == pytest.approx(-0.5 * numpy.linalg.slogdet(covariance)[1], rel=1e-6)
	apart = numpy.full(likelihood.POINTS, 0.3)
	assert logs[0] - logs[1] == pytest.approx(0.5 * apart @ numpy.linalg.solve(covariance, apart), rel=1e-5)
	assert logs[2] == logs[3] == -numpy.inf
	assert found.modelError(numpy.array([0.5, 0.5, 0, 0])) == (0, 0, 0)


@pytest.mark.parametrize("share", (0.0, 0.1))
def test_modelErrorIsInferred(share):
	"""Curves that are wrong by a known share, as the likelihood takes it: the interval holds it, and the likelihood is the mean of those with each share."""
	covered, means = 0, []
	for trial in range(10):
		random = numpy.random.default_rng(trial)
		curve = Curve("c", {"stress_ratio": Series(STRAIN, 1 + 20 * STRAIN)}, [])
		target = likelihood.targets({"c": curve}, {"c": 0.15})[0]
		grid = numpy.linspace(0, 0.15, 1 + 6 * likelihood.POINTS)  # the target's strains are among these
		apart = (grid[:, None] - grid) / likelihood.LENGTH
		size = share * 20 * target.strain[-1]
		covariance = likelihood.READING["stress_ratio"] ** 2 * numpy.exp(-abs(apart)) + size**2 * numpy.exp(-0.5 * apart**2)
		wrong = random.multivariate_normal(numpy.zeros(len(grid)), covariance, method="eigh")
		series = {"stress_ratio": Series(grid, 1 + 20 * grid + wrong)}
		found = likelihood.Evaluations([target], None)
		found.add({"c": [series] * 2})
		mean, low, high = found.modelError(numpy.ones(1))
		covered += low <= max(share, likelihood.MODELS[0]) <= high
		means.append(mean)
		each = []
		for one in likelihood.MODELS:
			known = likelihood.Evaluations([target], one)
			known.add({"c": [series] * 2})
			each.append(numpy.exp(known.logLikelihood()[0]))
		assert numpy.exp(found.logLikelihood()[0]) == pytest.approx(numpy.mean(each))
	assert covered >= 9 and (numpy.mean(means) < 0.03 if share == 0 else 0.06 < numpy.mean(means) < 0.2)


def test_gapsAreNotCompared():
	"""A straight line over a gap of the readings is no measurement; evenly coarse readings have no gap."""
	dense = numpy.concatenate([[0.0], numpy.linspace(0.04, 0.1, 31)])
	for strain, least in ((dense, 0.04), (numpy.linspace(0, 0.1, 6), 0.004)):
		target = likelihood.targets({"c": Curve("c", {"stress_ratio": Series(strain, 1 + strain)}, [])}, {"c": 0.1})[0]
		assert target.strain[0] == pytest.approx(least, abs=0.004) and target.strain[-1] == pytest.approx(0.1)


def test_inside(tmp_path, monkeypatch):
	"""Tests in one process: none is run twice, one that was killed is begun anew, one that kills each time fails, a failed one is told."""
	calibration, ran = calibrationfile.load(write(tmp_path, seeds=2)), []

	def run(config, out, quiet):
		ran.append(config.specimen.seed)
		if config.specimen.seed == 2:
			raise RuntimeError("no rest")
		out.mkdir()
		columns = ["stage", "step", *STRAINED]
		rows = [["shear", 1, e, 1e5 * (r - 1), 1e5, v] for e, r, v in zip(STRAIN, *(one.value for one in soil(0.5, 0.2).values()))]
		(out / "records.csv").write_text("\n".join(",".join(map(str, row)) for row in (columns, *rows)) + "\n", encoding="utf-8")

	monkeypatch.setattr(inside, "run", run)
	said = []
	tests = evaluate.Inside(calibration, tmp_path, argparse.Namespace(again=False), said.append)
	sets = [("00.0000", numpy.array([0.5, 0.5]))]
	place = tests.folder / inside.RUNS / "00.0000-lab-1"
	place.mkdir(parents=True)
	(place / inside.BEGUN).write_text('{"attempts": 1}', encoding="utf-8")
	tests.run(sets)
	tests.run(sets)
	assert ran == [1, 2] and sorted(path.name for path in place.iterdir()) == sorted([inside.BEGUN, inside.RESULT, "records.csv"])
	found, failed = tests.series(sets)
	assert found["00.0000"]["lab"][0]["stress_ratio"].value == pytest.approx(soil(0.5, 0.2)["stress_ratio"].value)
	assert failed["00.0000"] == ["00.0000-lab-2: failed: no rest"] and "no rest" in said[1]
	tests._arguments.again = True
	tests.run(sets)  # begun a second time
	assert ran == [1, 2, 2]
	(place / inside.RESULT).unlink()
	(place / inside.BEGUN).write_text('{"attempts": 2}', encoding="utf-8")
	tests.run(sets)
	assert ran == [1, 2, 2] and "has ended in it 2 times" in said[-1]
