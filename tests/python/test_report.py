# SPDX-License-Identifier: GPL-2.0-or-later
"""The report: what is gathered of whole, half and damaged tests, what the page may hold, its size."""

import base64
import html.parser
import json
import math
import re
import time
import zlib

import numpy as np
import pytest
import yaml
from hexmembrane.output import vtk
from hexmembrane.report import command, encode, libraries, page, profiles, runs, spatial, terminal, verdict
from hexmembrane.report.runs import ReportError
from madeUpTest import HARM, makeTest
from tinyTest import configure


def decoded(encoded):
	"""As ``page/data.js`` does."""
	raw = np.frombuffer(zlib.decompress(base64.b64decode(encoded["data"])), np.uint8).reshape(2, -1)
	steps = (raw[0].astype(np.uint16) | (raw[1].astype(np.uint16) << 8)).reshape(encoded["shape"])
	codes = np.cumsum(steps, axis=0, dtype=np.uint16)
	return np.where(codes == 65535, np.nan, encoded["low"] + codes * (encoded["high"] - encoded["low"]) / 65534)


def test_numbersThroughThePage():
	values = np.random.default_rng(1).normal(size=(4, 50, 3))
	values[2, 7] = np.nan
	found = decoded(encode.array(values))
	assert np.array_equal(np.isnan(found), np.isnan(values))
	assert np.nanmax(abs(found - values)) <= 1.001 * (np.nanmax(values) - np.nanmin(values)) / 131068
	assert np.array_equal(decoded(encode.array(np.full((2, 3, 1), 5.0))), np.full((2, 3, 1), 5.0))
	assert np.isnan(decoded(encode.array(np.full((1, 2, 1), np.nan)))).all()


def test_whatIsGathered(tmp_path):
	found = page.gather([makeTest(tmp_path / "a")])
	(run,) = found["runs"]
	assert run["problems"] == [] and run["state"] == "sheared to 10 %" and run["made"]["commit"] == "0" * 40
	shear = run["curves"]["shear"]
	assert shear["x"][0] == 0 and shear["x"][-1] == pytest.approx(10) and shear["q"][-1] == pytest.approx(200 * (1 - math.exp(-5)), rel=1e-5)
	assert shear["stress_ratio"][-1] == pytest.approx(2e5 * (1 - math.exp(-5)) / 1.5e5, rel=1e-5)
	scene = run["scene"]
	assert scene["strains"] == [0, 0.05, 0.1] and scene["grains"]["position"]["shape"] == [3, 30, 3]
	assert {one["name"] for one in scene["grains"]["quantities"]} == {"displacement", "settlement", "coordination"}
	moved = decoded(next(one["values"] for one in scene["grains"]["quantities"] if one["name"] == "displacement"))
	assert np.allclose(moved[2], 2, atol=1e-4)
	tension = decoded(next(one["values"] for one in scene["boundary"]["quantities"] if one["name"] == "hoop_tension"))
	assert np.allclose(tension[0, :, 0], np.repeat(np.arange(4.0), 3), atol=1e-4)
	assert len(run["profile"]["radius"]) == 3 and run["clouds"] is None


def test_profileOfACoarseSheet():
	"""Slices of the height without a row of the sheet are left out: no hole in its line."""
	points = np.array([(0.02, 0, z) for z in (0.0, 0.05, 0.1)])
	found = profiles.ofFrames([(points, None, {})], [0.0])
	assert found["height"] == [[0, 50, 100]] and found["radius"] == [[20, 20, 20]]


def test_forceChainsAreTheStrongestContacts(tmp_path):
	folder = makeTest(tmp_path / "a")
	points, lines, arrays, _ = vtk.read(folder / "vtk" / "contacts-0001.vtp")
	forces = arrays["normal_force"][::2]
	strongest = np.argsort(-forces)[:45]
	one = page.gather([folder])["runs"][0]["scene"]["chains"][1]
	assert one["all"] == 90 and one["mean"] == pytest.approx(forces.mean(), rel=1e-5)
	assert np.allclose(decoded(one["force"])[0, :, 0], forces[strongest] / forces.mean(), atol=1e-4)
	assert np.allclose(decoded(one["ends"])[0], points.reshape(-1, 6)[strongest], atol=1e-6)
	without = makeTest(tmp_path / "b")
	(without / "vtk" / "contacts.pvd").unlink()
	(run,) = page.gather([without])["runs"]
	assert "chains" not in run["scene"] and run["problems"] == []
	assert spatial.bytesOf(runs.read(folder)) - spatial.bytesOf(runs.read(without)) == 2 * 3 * 7 * 45


def states(run, scatter=None):
	return {check.name: check.state for check in verdict.checks(run, scatter)}


@pytest.mark.parametrize(
	"name, columns",
	[
		("isotropic start", {"soil_axial_middle": 1.006e5}),
		("quasi-static", {"inertial_number": 1.1e-3}),
		("pressure arrived", {"sigma3_distance": -0.06}),
		("energy balance", {"energy_error": 3e-3}),
		("membrane whole", {"bonds_broken": 1}),
		("at its end", {}),
	],
)
def test_verdictFindsWhatIsWrong(tmp_path, name, columns):
	good = states(runs.read(makeTest(tmp_path / "good")))
	assert {check for check, state in good.items() if state == "open"} == {"error budget", "packings"} and "fail" not in good.values()
	bad = states(runs.read(makeTest(tmp_path / "bad", last=0.1 if columns else 0.05, **columns)))
	assert bad[name] == "fail" and list(bad.values()).count("fail") == 1
	if not columns:
		assert bad["grains inside"] == "open"


def test_budgetAndPackingsAreJudgedByTheKeyAccuracy(tmp_path):
	run = runs.read(makeTest(tmp_path / "a"))
	run.config["accuracy"] = 0.05
	found = states(run, (0.04, 3))
	assert found["error budget"] == "fail" and found["packings"] == "pass"
	run.made = {}
	assert states(run)["error budget"] == "open"


def test_seedsAreOneMean(tmp_path):
	folders = [makeTest(tmp_path / name, seed=seed, p=1e5 * seed) for name, seed in (("a", 1), ("b", 3))]
	other = makeTest(tmp_path / "c", seed=1, last=0.05)
	text = yaml.safe_load((other / "config.yaml").read_text())
	text["shear"]["strain"] = 0.05
	(other / "config.yaml").write_text(yaml.safe_dump(text))
	found = page.gather([*folders, other])
	(group,) = found["groups"]
	assert group["members"] == ["a", "b"]
	ratio, half = group["shear"]["stress_ratio"][-1], group["shear"]["stress_ratio half width"][-1]
	each = 2 * (1 - math.exp(-5)) * np.array([1, 1 / 3])
	assert ratio == pytest.approx(each.mean(), rel=1e-5) and half == pytest.approx(12.7062 * each.std(ddof=1) / math.sqrt(2), rel=1e-4)
	assert {one["key"] for one in found["differences"]} == {"specimen.seed", "shear.strain"}
	assert group["name"] == "mean of 2: strain 0.1" and [run["label"] for run in found["runs"]] == ["strain 0.1, seed 1", "strain 0.1, seed 3", "strain 0.05, seed 1"]


def test_laboratory(tmp_path):
	"""Of the command and of a test's own configuration: drawn once, compared with each test that it is for."""
	path, other = tmp_path / "lab.csv", makeTest(tmp_path / "b", seed=2)
	path.write_text("axial_strain [%],q [kPa],volumetric_strain [%]\n" + "".join(f"{strain},{50 * strain},\n" for strain in range(5)) + "5,,1\n6,,2\n7,,3\n8,,4\n9,,5\n")
	folder = makeTest(tmp_path / "a", q_cell=1e5)
	found = page.gather([folder, other], [path])
	(drawn,) = found["laboratories"]
	assert drawn["name"] == "lab at 100 kPa" and drawn["shear"]["x"] == list(range(10))
	assert drawn["shear"]["q"] == [0, 50, 100, 150, 200, *[None] * 5] and drawn["shear"]["stress_ratio"][2] == pytest.approx(100 / (100 + 100 / 3), rel=1e-5)
	assert drawn["shear"]["volumetric_strain_volume"] == [*[None] * 5, 1, 2, 3, 4, 5]
	rows = {name: texts for name, *texts in found["runs"][0]["apart"][0]["rows"]}
	assert rows["peak of sigma1/sigma3"] == ["3", "2"] and rows["distance along sigma1/sigma3"][1] == "0.7071" and len(found["runs"][1]["apart"]) == 1
	config = yaml.safe_load((folder / "config.yaml").read_text())
	for name, lab in (("own", {"file": str(path), "q": None}), ("lost", {"file": str(tmp_path / "none.csv")})):
		(folder / "config.yaml").write_text(yaml.safe_dump({**config, "lab": lab}))
		first, second = page.gather([folder, other])["runs"]
		assert second["apart"] == [] and len(first["apart"]) == (name == "own") and ("cannot be read" in "".join(first["problems"])) == (name == "lost")
	for text in ("strain,q [Pa]\n0,0\n", "axial_strain [-],other\n0,0\n", "axial_strain [-],q [Pa]\n0,much\n", "axial_strain [-],q [kPa]\n0,0\n0.01,5\n"):
		path.write_text(text)
		with pytest.raises(ReportError, match="--laboratory.* = .*fix: "):
			page.gather([folder], [path])


class Elements(html.parser.HTMLParser):
	"""The elements of a page, and the texts of its scripts."""

	def __init__(self, text):
		super().__init__()
		self.names, self.scripts, self._open = [], [], False
		self.feed(text)

	def handle_starttag(self, tag, attributes):
		self.names.append(tag)
		self._open = tag == "script"
		if self._open:
			self.scripts.append("")
		assert not any(name.startswith("on") or name == "src" for name, _ in attributes)

	def handle_endtag(self, tag):
		self._open = self._open and tag != "script"

	def handle_data(self, data):
		if self._open:
			self.scripts[-1] += data


def test_textsOfAUserAreNoMarkup(tmp_path):
	plain = Elements(page.text(page.gather([makeTest(tmp_path / "plain")])))
	folder = makeTest(tmp_path / "<b>&", title=HARM)
	(folder / "config.yaml").write_text((folder / "config.yaml").read_text() + f"# {HARM}\n")
	harmed = Elements(page.text(page.gather([folder])))
	assert harmed.names == plain.names and len(harmed.scripts) == len(plain.scripts)
	content = json.loads(harmed.scripts[0])
	assert content["title"] == HARM and content["runs"][0]["name"] == "<b>&" and HARM in content["runs"][0]["configuration"]
	assert "<" not in harmed.scripts[0]


def test_thePageLoadsNothing(tmp_path):
	text = page.text(page.gather([makeTest(tmp_path / "a")]))
	policy = re.search('Content-Security-Policy" content="([^"]*)"', text)[1]
	assert policy.startswith("default-src 'none'; script-src 'sha256-") and "unsafe-inline" not in policy.split("style-src")[0]
	assert not re.search(r"(src|href)=[\"']?(https?:)?//", Elements(text).scripts[-1])


def harm(folder, what):
	if what == "no row":
		(folder / "records.csv").write_bytes((folder / "records.csv").read_bytes().split(b"\n")[0] + b"\n")
	elif what == "cut row":
		lines = (folder / "records.csv").read_bytes().split(b"\n")
		(folder / "records.csv").write_bytes(b"\n".join([*lines[:6], lines[6][:20], *lines[7:]]))
	elif what == "records of bytes":
		(folder / "records.csv").write_bytes(bytes(range(256)) * 8)
	elif what == "no records":
		(folder / "records.csv").unlink()
	elif what == "no configuration":
		(folder / "config.yaml").unlink()
	elif what == "configuration of bytes":
		(folder / "config.yaml").write_bytes(b"\xff\x00: [")
	elif what == "frame of bytes":
		(folder / "vtk" / "grains-0001.vtp").write_bytes(b"no XML")
	elif what == "contacts of bytes":
		(folder / "vtk" / "contacts-0001.vtp").write_bytes(b"no XML")
	elif what == "no frame":
		(folder / "vtk" / "membrane-0001.vtp").unlink()
	elif what == "fields of bytes":
		(folder / "fields.h5").write_bytes(b"no HDF5")
	elif what == "profile of bytes":
		(folder / "profile.csv").write_bytes(b"\xff\xfe,,\n1")


@pytest.mark.parametrize(
	"what",
	[
		"no row",
		"cut row",
		"records of bytes",
		"no records",
		"no configuration",
		"configuration of bytes",
		"frame of bytes",
		"contacts of bytes",
		"no frame",
		"fields of bytes",
		"profile of bytes",
	],
)
def test_aDamagedTestHasAPageThatSaysSo(tmp_path, what):
	folder = makeTest(tmp_path / "a")
	harm(folder, what)
	found = page.gather([folder])
	(run,) = found["runs"]
	assert run["problems"] or what == "no row" and run["state"] == "no rows yet"
	assert page.text(found)
	if what == "cut row":
		assert len(run["curves"]["shear"]["x"]) == 4 and run["scene"] is not None
	if what == "frame of bytes":
		assert run["scene"]["strains"] == [0, 0.1]


def test_sizeAndTimeOfAStudysTest(tmp_path, monkeypatch):
	"""7,045 grains and 12,384 particles in 16 frames; they move at random, which compresses worse than what moves together."""
	folder = makeTest(tmp_path / "a", frames=16, grains=7045, rows=151, jitter=1e-4, sheet=12384)
	start = time.process_time()
	path = tmp_path / "report.html"
	page.write(path, page.gather([folder]))
	assert path.stat().st_size < 15e6 and time.process_time() - start < 10
	monkeypatch.setattr(spatial, "MOST_BYTES", spatial.bytesOf(runs.read(folder)) / 3)
	(run,) = page.gather([folder])["runs"]
	assert len(run["scene"]["strains"]) == 6 and run["problems"] == ["Of 16 frames 6 are in this page, lest it grow too large."]


def test_textForATerminal(tmp_path):
	lines = terminal.lines(runs.read(makeTest(tmp_path / "a", title="a\x1b[31m")))
	assert lines[0] == "a?[31m: sheared to 10 %" and len(lines) == 25 and max(map(len, lines)) < 80
	assert terminal.plot([0, 1], [math.nan, math.inf]) == ["no values yet"] and len(terminal.plot([1], [2])) == 11


def test_command(tmp_path, capsys, monkeypatch):
	folder = makeTest(tmp_path / "a")
	half = makeTest(tmp_path / "half", last=0.05)
	monkeypatch.setattr(command.time, "sleep", lambda seconds: (_ for _ in ()).throw(KeyboardInterrupt))
	assert command.main([str(half), "--watch", "7"]) == 130 and '"watch":7.0' in (half / "report.html").read_text()
	assert command.main([str(folder), "--watch", "7"]) == 0 and '"watch":null' in (folder / "report.html").read_text()
	assert capsys.readouterr().out.count("q [kPa]") == 2
	assert command.main([str(folder), "--text"]) == 0
	assert command.main([str(tmp_path / "none")]) == 1 and "there is no such folder; fix: " in capsys.readouterr().err
	assert command.main([str(tmp_path)]) == 1 and "holds no test and no study; fix: " in capsys.readouterr().err
	assert command.main([str(folder), "--out", str(tmp_path / "no" / "a.html")]) == 1 and "cannot be written" in capsys.readouterr().err
	assert command.main([str(tmp_path / "later"), "--watch", "7"]) == 130 and "waiting for a test in " in capsys.readouterr().out
	monkeypatch.setattr(libraries, "FOLDERS", (tmp_path,))
	assert command.main([str(folder)]) == 1 and "fix: apt-get install node-d3" in capsys.readouterr().err
	(tmp_path / "d3" / "dist").mkdir(parents=True)
	(tmp_path / "d3" / "dist" / "d3.min.js").write_text("harmed = 1")
	assert command.main([str(folder)]) == 1 and "d3.min.js': is not the file that pages are tried with (SHA-256 " in capsys.readouterr().err


def test_aStudyIsOpenedByItsPlan(tmp_path):
	makeTest(tmp_path / "stages" / "shear-1" / "test")
	values = {"set": "dense", "consolidation.pressure": 50000.0}
	plan = {"runs": [{"name": "001", "values": values, "seed": 2, "stages": {"shear": "shear-1"}}, {"name": "002", "stages": {"shear": "shear-2"}}]}
	(tmp_path / "plan.json").write_text(json.dumps(plan))
	first, second = page.gather([tmp_path])["runs"]
	assert first["name"] == "001" and first["label"] == "set dense, pressure 50000, seed 2" and not first["problems"] and second["state"] == "no rows yet" and second["problems"]
	(tmp_path / "plan.json").write_text("{")
	with pytest.raises(ReportError, match="plan.json cannot be read"):
		runs.gather([tmp_path])


def test_aTestEndsWithItsReport(tmp_path, runHere, monkeypatch):
	"""And goes well without the page's libraries; resumed at its end with them it writes the page."""
	config, out, lab = configure(tmp_path, shear={"strain": 0.002}, output={"records": 4, "report": True}), tmp_path / "out", tmp_path / "sand test.csv"
	lab.write_text("axial_strain [%],q [kPa]\n0,0\n0.1,50\n0.5,80\n1,100\n2,90\n")
	with monkeypatch.context() as without:
		without.setattr(libraries, "FOLDERS", (tmp_path,))
		code, said, _ = runHere(config, "--out", out, "--lab", lab)
	assert "laboratory sand test: peak of sigma1/sigma3 " in said
	assert code == 0 and not (out / "report.html").exists() and "no report.html: report.node-d3" in said
	code, said, _ = runHere(config, "--out", out, "--resume")
	assert code == 0 and (out / "report.html").is_file() and "report.html" in said and not (out / "report.html.part").exists()
	assert page.gather([out])["runs"][0]["problems"] == []
	lab.write_text("axial_strain [%],q [kPa]\n0,0\n")
	code, _, errors = runHere(config, "--out", tmp_path / "other", "--lab", lab)
	assert code == 2 and "error: lab.q = " in errors and "is too short: it has 1 values; fix: " in errors and not (tmp_path / "other").exists()
