# SPDX-License-Identifier: GPL-2.0-or-later
"""scripts/sweep: what depends on which key, what a study's file may say, what becomes of stages that end badly, tables; last a whole study, killed and called again."""

import csv
import json
import math
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import numpy
import pytest
import yaml
from hexmembrane.configuration import Config, ConfigError, derived, toDict
from hexmembrane.configuration.schema import table as tableOfKeys

ROOT = pathlib.Path(__file__).parents[2]
FOLDER = ROOT / "scripts" / "sweep.d"
sys.path.insert(0, str(FOLDER))
import archive  # noqa: E402
import dependence  # noqa: E402
import figure  # noqa: E402
import job  # noqa: E402
import plan as plans  # noqa: E402
import results  # noqa: E402
import studyfile  # noqa: E402
import sweep as command  # noqa: E402
from dependence import CONSOLIDATION, SHEAR, SPECIMEN, STAGES  # noqa: E402

GRADATION = "diameter (mm), percent passing\n4, 0\n5, 60\n6, 100\n"
BASE = {
	"boundary": "wall",
	"specimen": {"radius": 0.015, "height": 0.03, "gradation": "sand.csv", "grains": 60, "porosity": 0.5, "emod": 1e7},
	"platens": {"thickness": 0.01},
	"consolidation": {"pressure": 1e5, "friction": 0.1, "unbalanced": 1e-2, "tolerance": 0.1},
	"shear": {"strain": 0.02, "velocity": 0.05},
	"output": {"records": 8, "checkpointEvery": 2, "consolidationSteps": 200},
}


@pytest.fixture
def base(tmp_path):
	(tmp_path / "sand.csv").write_text(GRADATION)
	return Config.of(BASE, tmp_path)


def write(folder, **study):
	"""study.yaml in the folder, with base.yaml beside it."""
	(folder / "sand.csv").write_text(GRADATION)
	(folder / "base.yaml").write_text(yaml.safe_dump(BASE))
	(folder / "study.yaml").write_text(yaml.safe_dump({"base": "base.yaml", **study}, sort_keys=False))
	return folder / "study.yaml"


@pytest.mark.parametrize(
	"key, value, told",
	[
		("consolidation.pressure", 5e4, "pressure 50 kPa"),
		("specimen.emod", 6e7, "emod 60 MPa"),
		("membrane.particleRadius", 0.25e-3, "particleRadius 0.25 mm"),
		("shear.velocity", 0.02, "velocity 0.02 m/s"),
		("specimen.friction", 0.5, "friction 0.5"),
		("consolidation.pressure", "-", "pressure -"),
		("boundary", "wall", "boundary wall"),
		("measure.bands", True, "bands True"),
	],
)
def test_namesInTheFigure(key, value, told):
	assert figure._short(key, value) == told


# What depends on which key


def test_everyKeyIsInTheTable(base):
	"""A new key is met by its section's row; one that is in none, or a row for a key that there is not, is an error."""
	keys = [row[0] for row in tableOfKeys(Config)]
	for key in keys:
		dependence.stageOf(key, base)
	assert {key for key in dependence.TABLE if not key.endswith("*")} <= set(keys)
	assert {key[:-2] for key in dependence.TABLE if key.endswith("*")} <= {key.split(".")[0] for key in keys if "." in key}


@pytest.mark.parametrize(
	"changes, first",
	[
		({"specimen": {"seed": 2}}, SPECIMEN),
		({"specimen": {"porosity": 0.48}}, SPECIMEN),
		({"specimen": {"emod": 2e7}}, CONSOLIDATION),
		({"specimen": {"friction": 0.4}}, SHEAR),
		({"specimen": {"friction": 0.4}, "consolidation": {"friction": None}}, CONSOLIDATION),
		({"specimen": {"stress": 1e3, "friction": 0.4}}, SPECIMEN),
		({"consolidation": {"pressure": 2e5}}, CONSOLIDATION),
		({"consolidation": {"unbalanced": 1e-3}}, CONSOLIDATION),
		({"boundary": "membrane"}, CONSOLIDATION),
		({"shear": {"strain": 0.01}}, SHEAR),
		({"shear": {"velocity": 0.01}}, SHEAR),
		({"platens": {"friction": 0.1}}, SHEAR),
		({"cement": {"emod": 1e7, "kratio": 2, "tensileStrength": 1e5, "cohesion": 1e5}}, CONSOLIDATION),
		({"tier": "reference"}, CONSOLIDATION),
		({"measure": {"slices": 5}}, SHEAR),
		({"membrane": {"young": 2e6}}, None),
		({"numerics": {"threads": 2}}, CONSOLIDATION),
		({"numerics": {"threads": 1, "verlet": 0.3}}, None),
		({"title": "another", "output": {"vtkEvery": 3, "checkpointEvery": 5}}, None),
	],
)
def test_aChangeMakesAnewWhatDependsOnIt(base, changes, first):
	before, after = dependence.names(base), dependence.names(derived(base, changes))
	same = STAGES.index(first) if first else len(STAGES)
	assert [before[stage] == after[stage] for stage in STAGES] == [place < same for place in range(len(STAGES))]


def test_filesAreKnownByTheirContent(base, tmp_path):
	other = tmp_path / "other.csv"
	other.write_text(GRADATION)
	assert dependence.names(derived(base, {"specimen": {"gradation": str(other)}})) == dependence.names(base)
	other.write_text(GRADATION.replace("60", "70"))
	assert dependence.names(derived(base, {"specimen": {"gradation": str(other)}}))[SPECIMEN] != dependence.names(base)[SPECIMEN]


# A study's file


def test_runsAndWhatTheyShare(tmp_path):
	study = studyfile.load(write(tmp_path, axes={"specimen.friction": [0.3, 0.5], "consolidation.pressure": ["5e4", 1e5]}, seeds=3))
	plan, inputs = plans.make(study)
	assert len(plan["runs"]) == 12 and list(plan["runs"][2]["values"].values()) == [0.3, 5e4] and plan["runs"][2]["seed"] == 3
	assert [sum(found["stage"] == stage for found in plan["jobs"].values()) for stage in STAGES] == [3, 6, 12]
	assert [pathlib.PurePath(place).name for place in inputs] == ["sand.csv"]
	assert all(plan["jobs"][name]["config"]["output"]["vtkEvery"] == 0 for name in plan["jobs"])
	assert json.loads(json.dumps(plan)) == plan


def test_list(tmp_path):
	study = studyfile.load(write(tmp_path, axes={"specimen.friction": [0.3, 0.5], "shear.velocity": [0.1, 0.2]}, combine="list", seeds=[4]))
	assert [tuple(run.values.values()) for run in study.runs] == [(0.3, 0.1), (0.5, 0.2)]


def test_setsShareWhatTheyHaveInCommon(tmp_path):
	sets = {"grains": {"axes": {"specimen.friction": [0.3, 0.5]}, "seeds": 2}, "plain one": {"changes": {"specimen": {"friction": 0.5}}}}
	study = studyfile.load(write(tmp_path, sets=sets))
	assert [run.name for run in study.runs] == ["0001", "0002", "0003", "0004", "0005"] and study.axes == ["set", "specimen.friction"]
	assert [list(run.values.values()) for run in study.runs[3:]] == [["grains", 0.5], ["plain one", "-"]] and study.runs[4].config.specimen.friction == 0.5
	plan, _ = plans.make(study)
	assert plan["runs"][2]["stages"] == plan["runs"][4]["stages"] and len(plan["jobs"]) == 2 + 2 + 4


def test_aTestWithoutCheckpointsHasItsTimeToo(tmp_path):
	plan, _ = plans.make(studyfile.load(write(tmp_path, changes={"output": {"checkpointEvery": 0}})))
	assert all(found["seconds"] > 0 for found in plan["jobs"].values())


def test_accuracyIsSettledBeforeAnythingIsNamed(tmp_path):
	changes = {"accuracy": 0.5, "specimen": {"grains": 2000, "emod": 4e7}}
	(tmp_path / "sand.csv").write_text(GRADATION)
	keys = {**BASE, "shear": {"strain": 0.02}}
	(tmp_path / "b.yaml").write_text(yaml.safe_dump(keys))
	(tmp_path / "s.yaml").write_text(yaml.safe_dump({"base": "b.yaml", "changes": changes}))
	plan, _ = plans.make(studyfile.load(tmp_path / "s.yaml"))
	config = next(iter(plan["jobs"].values()))["config"]
	assert config["accuracy"] is None and config["shear"]["velocity"] != Config.of(BASE, tmp_path).shear.velocity


@pytest.mark.parametrize(
	"study, message",
	[
		({"axis": {}}, "study.axis.*did you mean 'axes'"),
		({"axes": {"specimen.frition": [1]}}, "axes.specimen.frition.*did you mean 'specimen.friction'"),
		({"axes": {"specimen.friction": 0.3}}, "is not a list of values"),
		({"axes": {"specimen.friction": [0.3, -1]}}, r"run 0002: specimen.friction = -1, specimen.seed = 1.*out of range"),
		({"axes": {"specimen.seed": [1, 2]}}, "give it as seeds"),
		({"axes": {"membrane.young": [1e6, 2e6]}}, "changes no result of these tests"),
		({"axes": {"title": ["a", "b"]}}, "changes no result of these tests"),
		({"axes": {"specimen.friction": [0.3], "shear.velocity": [0.1, 0.2]}, "combine": "list"}, "give each axis as many"),
		({"combine": "all"}, "use 'product' or 'list'"),
		({"seeds": 0}, "neither a number of seeds"),
		({"seeds": [1, 1]}, "neither a number of seeds"),
		({"attempts": 0}, "whole number from 1"),
		({"report": 1}, "study.report = 1: is neither true nor false"),
		({"base": 3}, "is no configuration"),
		({"sets": {}}, "study.sets.*are no sets"),
		({"sets": {"a": 1}}, "sets.a = 1: is not a mapping"),
		({"sets": {"a/b": {}}}, "is no name of a set"),
		({"sets": {"a": {"axis": {}}}}, "sets.a.axis.*did you mean 'axes'"),
		({"sets": {"a": {}}, "seeds": 3}, "study.seeds = 3: stands beside sets"),
		({"sets": {"a": {"axes": {"title": ["a", "b"]}}}}, "changes no result"),
	],
)
def test_badStudies(tmp_path, study, message):
	with pytest.raises(ConfigError, match=message):
		studyfile.load(write(tmp_path, **study))


# One stage, with a program in YADE's place

FAKE = """
import os, pathlib, sys, time
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
out.mkdir(parents=True, exist_ok=True)
with open(out.parent / "calls", "a") as calls:
	calls.write("resume\\n" if "--resume" in sys.argv else "begin\\n")
(out / "config.yaml").write_text("made: {hexmembrane: 1.2.3}\\n")
count = len((out.parent / "calls").read_text().split())
%s
"""
CHECKPOINT = '(out / "checkpoint.json").write_text("{}")'
DONE = '(out / "consolidated.yade.gz").write_text("state")'


def runJob(folder, monkeypatch, program, attempts=3, before="done"):
	"""(job, its result) of a consolidation whose YADE is ``program``."""
	(folder / "fake.py").write_text(FAKE % program)
	monkeypatch.setattr(job, "LAUNCH", folder / "fake.py")
	monkeypatch.chdir(folder)
	plan = {"attempts": attempts, "jobs": {"a": {"stage": SPECIMEN, "before": None, "config": {}}}}
	plan["jobs"]["b"] = {"stage": CONSOLIDATION, "before": "a", "threads": 1, "config": {"specimen": {"packing": "stages/a/test/packing.txt", "gradation": None}}}
	(folder / "stages" / "a").mkdir(parents=True)
	(folder / "stages" / "a" / "result.json").write_text(json.dumps({"status": before, "error": "no room", "failed_in": SPECIMEN}))
	made = job.Job(plan, "b")
	return made, made.run()


@pytest.mark.parametrize(
	"program, calls, status, error",
	[
		(DONE, ["begin"], "done", ""),
		(f'{CHECKPOINT}\nif count < 3: os.kill(os.getpid(), 9)\n{DONE}', ["begin", "resume", "resume"], "done", ""),
		(f'if count < 2: os.kill(os.getpid(), 9)\n{DONE}', ["begin", "begin"], "done", ""),
		('os.kill(os.getpid(), 9)', ["begin"] * 3, "failed", "YADE was ended by SIGKILL"),
		('print("error: consolidation.maxSteps = 3: not at rest"); sys.exit(1)', ["begin"] * 3, "failed", "consolidation.maxSteps = 3: not at rest"),
		('print("error: shear.strain = 3: is out of range"); sys.exit(2)', ["begin"], "failed", "shear.strain = 3: is out of range"),
		(f'{CHECKPOINT}\nif count == 1: sys.exit(1)\nif count == 2: sys.exit(2)\n{DONE}', ["begin", "resume", "begin"], "done", ""),
		('sys.exit(0)', ["begin"] * 3, "failed", "YADE ended with the code 0"),
	],
)
def test_attempts(tmp_path, monkeypatch, program, calls, status, error):
	made, result = runJob(tmp_path, monkeypatch, program)
	assert (result["status"], result["error"], result["attempts"]) == (status, error, len(calls))
	assert (made.folder / "calls").read_text().split() == calls
	assert result["failed_in"] == ("" if status == "done" else CONSOLIDATION)


def test_afterAFailedStageNothingRuns(tmp_path, monkeypatch):
	made, result = runJob(tmp_path, monkeypatch, DONE, before="failed")
	assert (result["status"], result["failed_in"], result["error"]) == ("failed", SPECIMEN, "no room")
	assert not (made.folder / "calls").exists()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGUSR1, signal.SIGKILL])
def test_aStoppedStageHasNoResultAndLeavesNoProcess(tmp_path, monkeypatch, number):
	(tmp_path / "fake.py").write_text(FAKE % '(out / "pid").write_text(str(os.getpid())); time.sleep(60)')
	plan = {"attempts": 3, "jobs": {"a": {"stage": SPECIMEN, "before": None, "threads": 1, "config": {"specimen": {"packing": None, "gradation": None}}}}}
	(tmp_path / "plan.json").write_text(json.dumps(plan))
	code = f"import sys; sys.path.insert(0, {str(FOLDER)!r}); import job, pathlib; job.LAUNCH = pathlib.Path('fake.py').absolute(); sys.exit(job.main('a'))"
	child = subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path)
	pid = wait(lambda: (tmp_path / "stages/a/test/pid").is_file() and (tmp_path / "stages/a/test/pid").read_text())
	child.send_signal(number)
	assert child.wait(20) == (-9 if number == signal.SIGKILL else job.STOPPED)
	wait(lambda: not alive(pid))
	assert plans.result(tmp_path, "a") is None


def alive(pid):
	try:
		return pathlib.Path("/proc", pid, "stat").read_text().rpartition(")")[2].split()[0] != "Z"
	except OSError:
		return False


def wait(what, seconds=300):
	"""Until ``what()`` is true; what it gives."""
	end = time.monotonic() + seconds
	while not (found := what()):
		assert time.monotonic() < end, "waited too long"
		time.sleep(0.05)
	return found


# Tables


def test_quantities():
	strain = numpy.linspace(0, 0.1, 101)
	table = {"axial_strain": strain, "q": 1e5 * (1 - ((strain - 0.06) / 0.06) ** 2), "volumetric_strain_volume": strain / 2}
	table.update(porosity=0.4 + strain, coordination=5 - strain, energy_error=numpy.where(strain == 0, numpy.nan, -1e-3))
	found = results.quantities(table)
	assert found["peak_q"] == pytest.approx(1e5, rel=1e-3) and found["strain_at_peak"] == pytest.approx(0.06)
	assert found["end_volumetric_strain"] == 0.05 and found["largest_energy_error"] == 1e-3 and set(found) == set(results.QUANTITIES)


def test_halfWidth():
	"""Of 1, 2, 3: 4.303 times 1/sqrt(3)."""
	assert results.halfWidth([1.0, 2.0, 3.0]) == pytest.approx(4.302653 / math.sqrt(3), rel=1e-6)
	assert math.isnan(results.halfWidth([1.0]))


# A whole study


def sweep(*arguments):
	environment = {**os.environ, "PYTHONPATH": str(ROOT / "py")}
	launch = [sys.executable, str(ROOT / "scripts" / "setup.d" / "launch.py"), "1", str(FOLDER / "sweep.py")]
	return subprocess.Popen([*launch, *map(str, arguments)], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def call(*arguments):
	"""(exit code, output) of a whole call."""
	child = sweep(*arguments)
	said = child.communicate(timeout=600)[0]
	return child.returncode, said


def pidsOf(folder):
	"""Tests of YADE that run in the study's folder."""
	found = []
	for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
		try:
			words = path.read_bytes().split(b"\0")
		except OSError:
			continue
		if b"--out" in words and any(word.startswith(os.fsencode(folder)) for word in words):
			found.append(int(path.parent.name))
	return found


def test_testsOfSeveralThreads(tmp_path):
	"""They share the packing, take as many of the cores, are refused where there are fewer, and are the same when they are run again."""
	path = write(tmp_path, axes={"numerics.threads": [1, 2]}, report=False)
	code, said = call(path, "--out", tmp_path / "out", "--cores", 1)
	assert code == 2 and "--cores = 1: is less than numerics.threads = 2 of a test; fix: --cores 2 or more" in said
	code, said = call(path, "--out", tmp_path / "out", "--cores", 2)
	assert code == 0 and len(list((tmp_path / "out/stages").glob("specimen-*"))) == 1, said
	made = [yaml.safe_load(file.read_text())["made"]["threads"] for file in (tmp_path / "out/stages").glob("shear-*/test/config.yaml")]
	assert sorted(made) == [1, 2]
	jobs = plans.read(tmp_path / "out")["jobs"]
	assert sorted((found["stage"], found["threads"]) for found in jobs.values()) == [("consolidation", 1), ("consolidation", 2), ("shear", 1), ("shear", 2), ("specimen", 1)]
	code, said = call("--verify", tmp_path / "out" / archive.ARCHIVE, "--runs", 2, "--out", tmp_path / "again", "--cores", 2)
	assert code == 0 and said.count("equal bit for bit") == 5, said


def test_study(tmp_path, monkeypatch, capsys):
	"""A pressure that cannot be reached is a row. A test is killed in its shear, then scripts/sweep: the table is that of an unbroken study, and so is all that --verify compares."""
	path = write(tmp_path, axes={"consolidation.maxSteps": [200, 200000]}, changes={"shear": {"strain": 0.03}})
	whole, broken = tmp_path / "whole", tmp_path / "broken"
	code, said = call(path, "--out", whole, "--cores", 2)
	with open(whole / results.RUNS, encoding="utf-8") as file:
		rows = list(csv.DictReader(file))
	assert code == 1, said
	assert [row["status"].partition(":")[0] for row in rows] == ["failed", "done"]
	assert rows[0]["status"].startswith("failed: consolidation: consolidation.maxSteps = 200") and float(rows[1]["peak_q [Pa]"]) > 1e4
	assert {path.name for path in whole.iterdir()} >= {results.MEANS, results.RECORDS, "study.png", archive.ARCHIVE, command.PAGE}
	stamp = (whole / results.PROVENANCE).stat().st_mtime_ns
	monkeypatch.setattr(command.signal, "signal", lambda *_: None)
	assert command.main([str(path), "--out", str(whole)]) == 1
	assert "nothing to do" in capsys.readouterr().out and (whole / results.PROVENANCE).stat().st_mtime_ns == stamp

	child = sweep(path, "--out", broken, "--cores", 1)
	shears = lambda: [found for found in (broken / "stages").glob("shear-*/test") if job.hasCheckpoint(found)]  # noqa: E731
	wait(lambda: shears() and pidsOf(broken))
	os.kill(pidsOf(broken)[0], signal.SIGKILL)
	wait(lambda: pidsOf(broken))
	child.kill()
	child.wait()
	wait(lambda: not pidsOf(broken))
	code, said = call(path, "--out", broken, "--cores", 2)
	assert code == 1 and (broken / results.RUNS).read_bytes() == (whole / results.RUNS).read_bytes(), said

	# the stages that were made again are those of the broken study: --verify runs the same engine
	monkeypatch.setattr(command, "execute", lambda plan, inputs, folder, *_: shutil.copytree(broken / "stages", folder / "stages"))
	verify = ["--verify", str(whole / archive.ARCHIVE), "--out"]
	assert command.main([*verify, str(tmp_path / "same")]) == 0
	assert capsys.readouterr().out.count("equal bit for bit") == 3
	rows = next((broken / "stages").glob("shear-*/test/records.csv"))
	text = rows.read_text()
	rows.write_text(text.replace("\nshear,", "\nshear,9", 1))
	assert command.main([*verify, str(tmp_path / "other")]) == 1
	assert "(step in row 1)" in capsys.readouterr().out
