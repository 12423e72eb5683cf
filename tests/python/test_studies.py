# SPDX-License-Identifier: GPL-2.0-or-later
"""The studies whose pictures and tables the pages show, in their short form: they run, and what they leave is sane."""

import contextlib
import importlib.util
import io
import json
import pathlib
import re

import numpy
import pytest
from hexmembrane import configuration
from hexmembrane.output import records
from hexmembrane.run import run, states
from hexmembrane.scene.handles import Scene
from PIL import Image

ROOT = pathlib.Path(__file__).parents[2]
TESTS = ("flexible-150", "rigid-150")


def loaded(script):
	"""A script as a module."""
	path = ROOT / script
	spec = importlib.util.spec_from_file_location(path.stem, path)
	module = importlib.util.module_from_spec(spec)
	spec.loader.exec_module(module)
	return module


def study(script, *arguments):
	"""Lines that a study prints in its short form, in this YADE."""
	import yade

	module = loaded(script)
	yade.O.reset()
	printed = io.StringIO()
	with contextlib.redirect_stdout(printed):
		module.main([*map(str, arguments), "--short"])
	yade.O.reset()
	return printed.getvalue().splitlines()


def isPicture(path):
	picture = Image.open(path).convert("L")
	return min(picture.size) > 500 and picture.getextrema()[0] < 60


@pytest.fixture(scope="module")
def paper(tmp_path_factory):
	"""The study's tests in short: (folder, lines printed)."""
	out = tmp_path_factory.mktemp("paper")
	return out, study("examples/paper/paper_figure.py", out, out / "results.png")


def test_paperFigure(paper):
	out, lines = paper
	assert [line.split(" | ")[0] for line in lines] == [f"| {name}" for name in TESTS]
	assert isPicture(out / "results.png")
	heads = [line for line in (ROOT / "examples/paper/README.md").read_text().splitlines() if line.startswith("| test |")]
	assert len(heads) == 1 and all(line.count("|") == heads[0].count("|") for line in lines)


@pytest.mark.parametrize("name", TESTS)
def test_studysTests(O, paper, name):
	"""From packing under stress to shear: the pressure arrives, q rises, the energies add up and the specimen contracts first."""
	folder = paper[0] / name
	table = records.read(folder / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	assert table["axial_strain"][-1] == pytest.approx(0.01, abs=1e-4)
	assert abs(table["sigma3_transmitted_group3"][shear] / 1.5e5 - 1).max() < 0.05
	assert abs(table["q"][shear][0]) < 2e4 and table["q"][-1] > 5e4 and (numpy.diff(table["q"][shear]) > 0).all()
	assert -0.01 < table["volumetric_strain_volume"][-1] < 0
	# The energy of the packing under stress is there before the first work, and none of it is lost.
	assert abs(table["energy_error"][shear]).max() < 1e-4
	assert abs(table["energy_error"][~shear][-1]) < (1e-4 if name.startswith("rigid") else 1e-2)
	states.load(folder / "sheared.yade.gz")
	O.step()
	Scene().exportContacts()
	rolling = {round(c.phys.rollingArm / (c.geom.refR1 * c.geom.refR2 / (c.geom.refR1 + c.geom.refR2)), 9) for c in O.interactions}
	assert rolling == {0.0, 0.5}


def test_pressureStudy(paper, tmp_path):
	"""Ours brings about what was asked for; the study's settings press too hard by R/(Rc - R) and by the cubes beside the platens."""
	lines = study("examples/paper/pressure_study.py", paper[0] / "flexible-150" / "packing.txt", tmp_path)
	written = (tmp_path / "table.md").read_text().splitlines()
	assert written[2:] == lines and written[0] in (ROOT / "examples/paper/pressure.md").read_text()
	ours, theirs = ([cell.strip() for cell in line.split("|")[1:-1]] for line in lines)
	assert (ours[3], theirs[3]) == ("ours", "study") and (ours[7] != "", theirs[7]) == (True, "")
	main, beside = ([float(row[k].split()[0]) for row in (ours, theirs)] for k in (4, 5))
	assert abs(main[0] - 100) < 6 and 110 < main[1] < 118 and abs(beside[0] - 100) < 6 and beside[1] > 120


def test_schemeFigure(tmp_path):
	"""The rows beside the platens get most with a force of their own, least with none; held ends press by being pushed against."""
	lines = study("examples/paper/scheme_figure.py", tmp_path)
	assert isPicture(tmp_path / "schemes.png")
	page = (ROOT / "examples/paper/schemes.md").read_text()
	table = [line for line in lines if line.startswith("| ")]
	assert table[0] in page and len(table) == 8
	beside, main = ([float(row.split("|")[k]) for row in table[2:]] for k in (3, 4))
	assert beside[0] > 60 > beside[4] > beside[2] + 5  # three-stage, held, main body only, each after consolidation
	assert all(90 < value < 110 for value in main)


def test_packingStudy():
	lines = study("pkg/specimen/packing_study.py")
	digests = [line for line in lines if line.startswith("digests")][0].split(": ")[1].split()
	assert len(digests) == 2 and digests[0] == digests[1]
	core = [float(re.search(r"porosity (\S+)", line)[1]) for line in lines if "core (2 d50" in line]
	assert len(core) == 3 and all(0.3 < n < 0.43 for n in core)
	reached = [line for line in lines if line.startswith("400 grains")]
	assert len(reached) == 3 and "fix: " in reached[1] and "coordination" in reached[2]


MEASURE = {"bands": True, "replicates": 3, "strains": [0, 0.01, 0.02], "spacing": 0.012, "radius": 0.01, "slices": 6}


def test_insideTheStudysTests(O, tmp_path, capsys):
	"""From a study's table of runs, of which one is not done, to the tables and pictures."""
	short = {**loaded("examples/paper/paper_figure.py").SHORT, "shear": {"strain": 0.02, "velocity": 0.08}, "measure": MEASURE}
	rows = ["run,set,boundary,consolidation.pressure,membrane.particleRadius,specimen.porosity,seed,status,folder", "0003,boundary,wall,150000.0,-,-,2,missing: shear has not ended,third"]
	for number, kind in enumerate(("membrane", "wall"), 1):
		O.reset()
		config = configuration.load(ROOT / "examples" / "paper" / "flexible-150.yaml")
		run(configuration.derived(config, {"boundary": kind, **short}), tmp_path / kind, quiet=True)
		rows.append(f"{number:04d},boundary,{kind},150000.0,-,-,1,done,{kind}")
		rows.append(f"{number + 4:04d},porosity,{kind},-,-,0.4,{number},done,{kind}")
		(tmp_path / "stages" / kind).mkdir(parents=True)
		(tmp_path / "stages" / kind / "result.json").write_text('{"processor_seconds": 7.5}')
	(tmp_path / "runs.csv").write_text("\n".join(rows) + "\n")
	stages = {row.split(",")[0]: {"specimen": "packing", "shear": row.split(",")[2]} for row in rows[1:]}
	(tmp_path / "plan.json").write_text(json.dumps({"runs": [{"name": name, "stages": one} for name, one in stages.items()]}))
	inside = loaded("examples/paper/study/inside.py")
	out = tmp_path / "out"
	inside.main([str(tmp_path), str(out)])
	printed = [[cell.strip() for cell in line.strip("|").split("|")] for line in capsys.readouterr().out.splitlines() if line.startswith("|")]
	assert [row[0] for row in printed[2:]] == ["flexible-150-s1", "rigid-150-s1"] and all(len(row) == len(printed[0]) for row in printed)
	for name in ("150-s1/shear", "150-s1/porosity", "bulge", "index"):
		assert min(Image.open(out / f"{name}.png").size) > 300, name
	assert len(list((out / "150-s1").glob("*.vtp"))) == 6
	assert [line.split(",")[:3] for line in (out / "groups.csv").read_text().splitlines()[1:]] == [["membrane", "150", "1"], ["wall", "150", "1"]]
	compare = loaded("examples/paper/study/compare.py")
	compare.main([str(tmp_path), str(out)])
	lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in capsys.readouterr().out.splitlines() if line.startswith("|")]
	names = ["150 kPa, membrane", "150 kPa, wall"], ["0.4, membrane", "0.4, wall"]
	assert [line[0] for line in lines] == ["boundary", "---", *names[0], "porosity", "---", *names[1]]
	assert all(len(line) == len(compare.TOLD) + 2 and (line[1], line[-1]) == ("1", "7.5") for line in lines if line[0] in sum(names, []))
	assert not (out / "compare.png").exists()  # of one pair there is no interval
	(tmp_path / "runs.csv").write_text(rows[0] + "\n")
	for script, told in ((inside, "no test of the set 'boundary' is done; fix: "), (compare, "no test is done; fix: ")):
		for study in (tmp_path, tmp_path / "stages"):  # nothing done; no study
			with pytest.raises(SystemExit):
				script.main([str(study), str(out)])
			assert told in capsys.readouterr().err


def test_comparisonsOfTheStudy(tmp_path):
	"""Differences by pairs of a seed, of tests whose numbers are known; a proportional limit at a knee."""
	compare = loaded("examples/paper/study/compare.py")
	strain = numpy.linspace(0, 0.01, 101)
	assert compare.proportionalLimit(strain, numpy.minimum(2e7 * strain, 1e5)) == pytest.approx(1e5)
	bent = numpy.where(strain < 0.004, 2e7 * strain, 8e4 + 1e7 * (strain - 0.004))  # leaves by a tenth where 8e4 + 1e7 (e - 0.004) = 1.8e7 e: e = 0.005
	assert compare.proportionalLimit(strain, bent) == pytest.approx(9e4, rel=1e-6)
	assert numpy.isnan(compare.proportionalLimit(strain, 2e7 * strain))
	tests = []
	for seed, base in (("1", 100.0), ("2", 120.0), ("3", 140.0)):
		for kind, factor in (("membrane", 1.0), ("wall", 1.1)):
			of = {"set": "boundary", "boundary": kind, "consolidation.pressure": "100000.0", "seed": seed}
			tests.append({**of, "told": dict.fromkeys(compare.TOLD, factor * base)})
	rows = {(row["case"], row["quantity"]): row for row in compare.compared("boundary", tests)}
	wall = rows["100 kPa, wall", "peak_q"]
	assert (wall["tests"], wall["pairs"], wall["differs"]) == (3, 3, "yes") and wall["difference"] == pytest.approx(10) and wall["difference_half_width"] == pytest.approx(0, abs=1e-9)
	assert wall["mean"] == pytest.approx(132) and rows["100 kPa, wall", "end_porosity"]["difference"] == pytest.approx(12)
	assert rows["100 kPa, membrane", "peak_q"]["pairs"] == 0
	assert rows["100 kPa, wall", "end_volumetric_strain"]["difference_unit"] == "points"
	assert (compare.written(372.34, 7.04), compare.written(0.40883, 0.00083), compare.written(4.0, float("nan"), "+")) == ("372.3 +- 7.0", "0.40883 +- 0.00083", "+4")
	assert compare.written(-0.001, 0.34, "+") == "+0.00 +- 0.34"
	told = {"mean": 132.0, "half_width": 5.0, "pairs": 3, "difference": -10.0, "difference_half_width": 2.0, "difference_unit": "%"}
	assert compare.cell({**told, "differs": "yes"}) == "132.0 +- 5.0 **(-10.0 +- 2.0 %)**"
	assert compare.cell({**told, "differs": "no", "difference_unit": "-"}) == "132.0 +- 5.0 (-10.0 +- 2.0)"
	assert compare.cell({**told, "pairs": 1}) == "132.0 +- 5.0"
	compare.draw(list(rows.values()), tmp_path / "compare.png")
	assert min(Image.open(tmp_path / "compare.png").size) > 100
