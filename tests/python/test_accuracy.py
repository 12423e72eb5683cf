# SPDX-License-Identifier: GPL-2.0-or-later
"""The study of speed against error: its jobs, its statistics against closed forms, and its short form from the runs to the pictures."""

import importlib
import math
import pathlib
import sys

import numpy
import pytest
from hexmembrane.configuration import Config
from PIL import Image
from scipy.stats import t as student

FOLDER = pathlib.Path(__file__).parents[2] / "scripts" / "bench.d"


@pytest.fixture(scope="module")
def part():
	"""The study's modules by name, which stand beside each other."""
	before = list(sys.path)
	sys.path.insert(0, str(FOLDER))
	yield importlib.import_module
	sys.path[:] = before


@pytest.fixture
def study(part, tmp_path):
	return part("accuracy").Study(tmp_path, 8)


def test_jobs(study):
	"""Sound configurations, the base runs first, each knob's reference first among its levels and none run twice."""
	names = list(study.jobs)
	assert [name.split(",")[0] for name in names[:9]] == ["base"] * 8 + ["velocity 0.0075"]
	configurations = {name: study.configuration(name) for name in names if name.endswith("seed 7")}
	for keys in configurations.values():
		Config.of(keys)
	assert len({repr(keys) for keys in configurations.values()}) == len(configurations)
	for knob in study.knobs:
		assert any(name.startswith(f"{knob.levels[0].run}, ") for name in names), f"{knob.name} has no reference run"
		assert knob.theory is None or not math.isnan(knob.levels[0].x)
		costs = [level.cost for name, (level, seed, _) in study.jobs.items() if seed == 7 and level in knob.levels and level.run != "base"]
		assert costs == sorted(costs, reverse=True), "the longest of a knob begin first"


def test_jobsInTheWall(part, tmp_path):
	"""Each knob that a budget in the wall is made from, with its reference and no level of a membrane."""
	study = part("accuracy").Study(tmp_path, 1, boundary="wall")
	assert {knob.name for knob in study.knobs} == set(part("knobs").OF_WALL)
	for name in study.jobs:
		keys = study.configuration(name)
		assert keys["boundary"] == "wall" and keys["membrane"] == study.configuration("base, seed 7")["membrane"]
		Config.of(keys)
	assert all(len(knob.levels) > 1 for knob in study.knobs)


def test_slowLevelsAreAsked(part, tmp_path):
	names = [set(part("accuracy").Study(tmp_path, 2, slow=slow).jobs) for slow in (False, True)]
	assert names[1] - names[0] == {f"{what}, seed {seed}" for what in ("size ratio 0.2", "size ratio of a scaled membrane 0.2", "grains 7000", "grains 30000") for seed in (7, 8)}


def records(rows, last, q):
	"""A table of records with one row of consolidation before the shear."""
	strain = numpy.linspace(0, last, rows)
	columns = {"axial_strain": strain, "q": q(strain), "volumetric_strain_volume": 0.2 * strain}
	columns.update(sigma3_target=numpy.full(rows, 1e5), soil_radial=numpy.full(rows, 1.01e5), soil_radial_middle=numpy.full(rows, 1e5))
	columns.update(soil_axial=numpy.full(rows, 2e5), soil_axial_middle=numpy.full(rows, 0.99e5), boundary_axial=numpy.full(rows, 2e5))
	columns["boundary_radial"] = 1.01e5 + 1e4 * (numpy.arange(rows) == 3)
	table = {name: numpy.concatenate([[0.0], column]) for name, column in columns.items()}
	return {"stage": ["consolidation"] + ["shear"] * rows, **table}


def test_quantities(part):
	"""Of a q that rises linearly, has one high row, and falls."""
	curves = part("curves")

	def q(strain):
		return 1e5 * numpy.minimum(strain / 0.05, 1 - (strain - 0.05)) + 5e4 * (numpy.arange(len(strain)) == 50)

	found = curves.quantities(records(61, 0.15, q))
	assert found["q at 1 %"] == pytest.approx(2e4) and found["q at 15 %"] == pytest.approx(9e4)
	assert found["peak q"] == pytest.approx(1e4 + 1e5 * (1 - 0.07)) and found["strain at peak"] == pytest.approx(0.12)  # of the five rows with the high one last
	assert found["volumetric strain at 15 %"] == pytest.approx(0.03)
	assert found["mean q from 10 to 15 %"] == pytest.approx(1e5 * (1 - 0.075) + 5e4 / 21)
	assert [found[f"start: {name}"] for name in ("axial", "radial", "middle axial", "middle radial")] == pytest.approx([1, 0.01, -0.01, 0])
	assert found["boundary against contacts"] == pytest.approx(0.05)
	short = curves.quantities(records(5, 0.01, q))
	assert short["q at 1 %"] == pytest.approx(2e4) and math.isnan(short["peak q"]) and math.isnan(short["q at 15 %"])


def runs(part, seeds, q, steps=100.0, packing="p{}"):
	"""Seed -> run with the value q(seed) as every quantity."""
	curves = part("curves")
	return {seed: curves.Run(seed, packing.format(seed), dict.fromkeys(curves.QUANTITIES, q(seed)), steps, steps) for seed in seeds}


def test_pairedDifferences(part):
	"""The packings' own scatter is not in them; relative ones are relative to the same packing's value."""
	curves, knobs = part("curves"), part("knobs")
	knob = knobs.Knob("velocity", "v", [knobs.Level("slow", 1.0), knobs.Level("fast", 2.0, {"a": 1})])
	known = {"base": runs(part, (7, 8, 9), lambda s: 10.0 * s), "velocity fast": runs(part, (7, 8, 9, 10), lambda s: 10.0 * s + s - 8, steps=50)}
	rows = {(row[0], row[1], row[3]): row for row in curves.curves([knob], known)}
	relative, absolute = (rows["velocity", "fast", name] for name in ("peak q", "strain at peak"))
	differences = [-1 / 70, 0, 1 / 90]
	assert relative[4] == pytest.approx(numpy.mean(differences)) and relative[5] == pytest.approx(numpy.std(differences, ddof=1))
	assert absolute[4:7] == pytest.approx((0, 1, student.ppf(0.975, 2) / math.sqrt(3))) and absolute[7:] == (3, 0.5, 0.5, "yes")
	assert rows["velocity", "slow", "peak q"][4:7] == (0, 0, 0)
	assert rows["packings", "base", "peak q"][5] == pytest.approx(10 / 80)
	known["velocity fast"] = runs(part, (7, 8), lambda s: 1.0, packing="other{}")
	with pytest.raises(ValueError, match="seed 7 has another packing at the reference level; fix: "):
		curves.curves([knob], known)


def test_numbersOfGrainsHaveNoPackingInCommon(part):
	curves, knobs = part("curves"), part("knobs")
	knob = knobs.Knob("grains", "n", [knobs.Level("3000", 3000.0, {"a": 3}), knobs.Level("500", 500.0, {"a": 1})], paired=False)
	known = {"grains 3000": runs(part, (7, 8, 9), lambda s: 2.0 * s), "grains 500": runs(part, (7, 8, 9), lambda s: 4.0 * (s - 8) + 20, packing="other")}
	row = next(row for row in curves.curves([knob], known) if row[:4] == ("grains", "500", 500.0, "peak q"))
	assert row[4:6] == pytest.approx((20 / 16 - 1, 4 / 16)) and row[-1] == "no" and math.isnan(row[-3])


@pytest.mark.parametrize("power", [1.0, 2.0])
def test_order(part, power):
	x = numpy.array([0.2, 0.4, 0.5, 0.8])
	found = part("curves").order(x, 3 * (x**power - 0.1**power), numpy.full(4, 0.05), 0.1)
	assert found[0] == pytest.approx(power, abs=0.011) and found[1] < power < found[2] and found[3] == pytest.approx(3, rel=0.02)
	assert part("curves").order(x[:2], x[:2], x[:2], 0.1) is None


def test_shortForm(part, tmp_path, capsys, monkeypatch):
	"""Runs, tables and pictures; a second call runs nothing; a run that was ended from outside is no result."""
	accuracy, survey = part("accuracy"), part("survey")
	accuracy.main([str(tmp_path), "--short", "--packings", "2", "--processes", "2"])
	rows = part("table").read(tmp_path / "runs.csv")
	assert len(rows) == 6 and all(row["outcome"] == "done" and float(row["q at 1 % [Pa]"]) > 0 for row in rows)
	assert len({row["packing"] for row in rows}) == 2 and not list(tmp_path.glob("*/*.yade.gz"))
	found = [row for row in part("figures").read(tmp_path / "curves.csv") if row["quantity"] == "q at 1 %"]
	assert [row["value"] for row in found] == ["base", "0.4", "0.8", "1.6"] and [row["packings"] for row in found] == [2] * 4
	assert [row["x"] for row in found[1:]] == [0.4, 0.8, 1.6] and 1 > found[2]["steps"] > found[3]["steps"] > 0.3
	accuracy.main(["figures", str(tmp_path)])
	assert min(Image.open(tmp_path / "q-early.png").size) > 250
	monkeypatch.setattr(survey.subprocess, "run", None)
	accuracy.main([str(tmp_path), "--short", "--packings", "2"])
	ended = type("Ended", (), {"returncode": 130, "stderr": ""})
	monkeypatch.setattr(survey.subprocess, "run", lambda *_, **__: ended)
	assert survey.run("other", {}, tmp_path)[0] == 130 and not survey.log("other", tmp_path).is_file()
	capsys.readouterr()
	accuracy.main([str(tmp_path), "--short", "--packings", "2", "--list"])
	assert "6 runs, " in capsys.readouterr().out


def test_fitTellsMoreThanALevel(part, monkeypatch):
	"""Under noise that a packing's levels share with their reference, intervals of fits hold the truth nine times in ten, and are narrower than a level's."""
	fits, x = part("fits"), numpy.array([2.0, 4, 8, 16, 32]) * 1e-4
	monkeypatch.setattr(fits, "RESAMPLES", 80)
	truth = 20 * (x - 1e-4)
	held, narrower = [], []
	for seed in range(30):
		random = numpy.random.default_rng(seed)
		table = truth + random.normal(0, 0.01, (8, 5)) + random.normal(0, 0.01, (8, 1))
		mean, half = fits.fit(x, table, 1e-4)
		held.append(abs(mean - truth) < half)
		narrower.append(half / (student.ppf(0.975, 7) * table.std(axis=0, ddof=1) / 8**0.5))
	assert numpy.mean(held) > 0.85 and (numpy.mean(narrower, axis=0)[:3] < 0.8).all()
	falling = fits.fit(1 / x, table, 1e4, sign=-1)
	assert falling[0] == pytest.approx(mean) and falling[1] == pytest.approx(half)
	assert fits.fit(x[:2], table[:, :2], 1e-4) is None and fits.fit(x, table[:2], 1e-4) is None


def test_fitsStandBesideTheirLevels(part):
	"""0 at the reference, the fit at the others, nan for other knobs; a packing without all levels is left out."""
	curves, knobs, fits = (part(name) for name in ("curves", "knobs", "fits"))
	levels = [knobs.Level(f"{x:g}", x, {"x": x}) for x in (1.0, 2.0, 4.0, 8.0)]
	knob, base = knobs.Knob("knob", "x", levels), dict.fromkeys(curves.QUANTITIES, 1.0)
	random = numpy.random.default_rng(2)

	def runs(x):
		values = {seed: {**base, "peak q": 1 + 0.1 * (x - 1) + random.normal(0, 1e-3)} for seed in range(8 if x < 8 else 7)}
		return {seed: curves.Run(seed, "packing", value, 1, 1) for seed, value in values.items()}

	found = {level.run: runs(level.x) for level in levels}
	rows = curves.curves([knob], found)
	columns = {row[1]: column for row, column in zip(rows, fits.columns([knob], found, rows)) if row[3] == "peak q"}
	assert columns["1"] == (0, 0) and columns["8"][0] == pytest.approx(0.7, rel=0.01) and 0 < columns["8"][1] < 0.01
	assert all(math.isnan(column[0]) for row, column in zip(rows, fits.columns([knob], found, rows)) if row[3] == "q at 1 %")
	assert fits.differences("peak q", True, [found[level.run] for level in levels[1:]], found[levels[0].run]).shape == (7, 3)


def test_publish(part, tmp_path, monkeypatch):
	"""The package gets the rows that budgets are made of, and no others; they read back."""
	from hexmembrane.scene import accuracy

	header = [*part("curves").HEADER, *part("fits").HEADER]
	names = [knob.name for knob in accuracy.KNOBS] + ["skin", "packings", accuracy.SWITCH, "tier"]
	rows = [[name, x, x, quantity, 0, 0.01, 0, 8, 1, x, "yes", 0.1 * x, 0.01] for name in names for x in (1, 2) for quantity in (*accuracy.QUANTITIES, "q at 1 %")]
	part("table").write(str(tmp_path / "curves.csv"), header, rows)
	monkeypatch.setitem(accuracy.FILES, "wall", tmp_path / "package.csv")
	part("accuracy").main(["publish", str(tmp_path), "--boundary", "wall"])
	assert len((tmp_path / "package.csv").read_text().splitlines()) == 1 + (len(names) - 1) * 2 * 2
	measured = accuracy.Measured.of(tmp_path / "package.csv")
	assert set(measured.curves) == {knob.name for knob in accuracy.KNOBS} and measured.curves["step"].error(accuracy.PEAK, 2) == pytest.approx((0.2, 0.01, 0.01))


def test_proof(part, tmp_path, monkeypatch):
	"""Its tests leave open what ``accuracy`` chooses and are on packings of their own; an error is held against the run's own budget."""
	proof, survey = part("proof"), part("survey")
	jobs = proof.jobs()
	assert len(jobs) == 40 and not {keys["specimen"]["seed"] for keys in jobs.values()} & set(range(7, 15))
	for keys in (*jobs.values(), *proof.jobs("wall").values()):
		Config.of(keys)
	peaks = {survey.place(f"{name}, seed 101", tmp_path): peak for name, peak in zip(("slow", *proof.ACCURACIES), (1.0e5, 1.04e5, 1.1e5, 0.9e5))}
	monkeypatch.setattr(proof.records, "read", lambda path: records(61, 0.15, lambda strain: numpy.full(len(strain), peaks[path.parent])))
	for out in peaks:
		out.mkdir()
		out.with_name(out.name + ".log").write_text("0 \n")
		(out / "config.yaml").write_text("made: {budget: {budget of a run: {peak q: 0.05, volumetric strain at 15 %: 0.01}}}\n")
	found = [row for row in proof.rows(tmp_path) if row[2] == "peak q"]
	assert [(row[0], row[1], row[-1]) for row in found] == [(101, str(share), held) for share, held in zip(proof.ACCURACIES, ("yes", "no", "no"))]
	assert [row[5] for row in found] == pytest.approx([0.04, 0.1, -0.1])
