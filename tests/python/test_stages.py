# SPDX-License-Identifier: GPL-2.0-or-later
"""A test of several stages: its plan, every kind of stage as a user runs it, killed in the middle of an unloading and resumed."""

import copy
import shutil
import signal
import subprocess
import time

import numpy
import pytest
from hexmembrane.configuration import Config, ConfigError, toDict
from hexmembrane.configuration.stages import plan, span
from hexmembrane.output import records
from hexmembrane.report import page, runs
from hexmembrane.run import estimate
from tinyTest import TINY, command, configure, environment, runOutside

LIST = [
	{"kind": "consolidation", "pressure": 5e4},
	{"kind": "shear", "strain": 0.005, "velocities": [0.1, 0.1]},
	{"kind": "unloading", "q": 5e3, "velocity": 0.2, "strainStep": 2e-4},
	{"kind": "cycles", "strain": 0.0015, "upperStrain": 0.006, "velocity": 0.2, "records": 3},
	{"kind": "hold", "time": 2e-4, "records": 2},
	{"kind": "pressure", "pressure": 7e4, "time": 1e-3, "records": 3},
	{"kind": "consolidation", "pressure": 6e4},
]
LOOSE = {
	"consolidation": {"friction": 0.2, "unbalanced": 0.05, "tolerance": 0.3},
	"output": {"records": 6, "vtkEvery": 3, "checkpointEvery": 2, "consolidationSteps": 400},
}


def config(folder, stages, **changes):
	configure(folder)
	return Config.of({**copy.deepcopy(TINY), **changes, "stages": stages}, folder)


# The plan


def test_shortForm(tmp_path):
	"""Without a list there are a consolidation and a shear, with the keys of their sections."""
	configure(tmp_path)
	first, second = plan(Config.of({**TINY, "shear": {"strain": 0.1, "velocity": 0.04, "moving": "both"}}, tmp_path))
	assert (first.label, first.pressure, first.before, first.state) == ("consolidation", 1e5, 0, "consolidated")
	assert (second.label, second.strain, second.velocities, second.records, second.chain, second.state) == ("shear", 0.1, (0.02, 0.02), 12, ("shear",), "sheared")


def test_expanded(tmp_path):
	stages = plan(config(tmp_path, [*LIST[:3], {**LIST[3], "count": 2}, *LIST[4:]]))
	assert [stage.label for stage in stages] == [
		"consolidation", "shear", "unloading", "unloading-2", "shear-2", "unloading-3", "shear-3", "hold", "pressure", "consolidation-2",
	]  # fmt: skip
	assert stages[3].velocities == (0, -0.2) and stages[4].velocities == (0, 0.2) and stages[1].velocities == (0.1, 0.1)
	assert stages[4].farthest == 0.005 and stages[6].farthest == 0.006 and stages[1].farthest == -1
	assert stages[6].chain == ("shear", "unloading", "unloading-2", "shear-2", "unloading-3", "shear-3") and stages[-1].chain == ()
	assert [stage.pressure for stage in stages[-4:]] == [5e4, 5e4, 7e4, 6e4] and stages[-1].before == 7e4
	assert [span(stages, k) for k in range(4)] == [0, 0.005, None, None] and span(stages, 4) == pytest.approx(0.0045)


def test_platensAndEstimateKnowTheLargestStrain(tmp_path):
	made = config(tmp_path, LIST)
	assert made.shear.strain == 0.02  # given, and more
	del (given := copy.deepcopy(TINY))["shear"]
	made = Config.of({**given, "stages": LIST}, tmp_path)
	assert made.shear.strain == 0.006 and toDict(Config.of(toDict(made))) == toDict(made)
	radii = numpy.full(200, 2.5e-3)
	whole, one = (estimate.Estimate.of(config(tmp_path, stages), radii) for stages in (LIST, LIST[:2]))
	assert whole.consolidation > 1.5 * one.consolidation and whole.shear > 2 * one.shear
	made.platens.thickness = 0.0001
	with pytest.raises(ConfigError, match="platens.thickness"):
		estimate.requireTravel(made)


@pytest.mark.parametrize(
	"stages, message",
	[
		([], "stages = .*: the first stage is no consolidation"),
		([{"kind": "shear"}], "stages = 'shear': the first stage is no consolidation"),
		([{"pressure": 1e5}], r"stages\[0\].kind = None: is missing"),
		([{"kind": "consolidate"}], r"stages\[0\].kind = 'consolidate': is not one of the choices; fix: did you mean 'consolidation'"),
		([LIST[0], {"kind": "shear", "presure": 1}], r"stages\[1\].presure = 1: unknown key; fix: did you mean 'pressure'"),
		([LIST[0], {"kind": "shear", "pressure": 1e5}], r"stages\[1\].pressure = 100000.0: means nothing in a stage of kind shear; fix: its keys are strain, q"),
		([LIST[0], {"kind": "shear", "count": 2}], r"stages\[1\].count = 2: means nothing"),
		([LIST[0], {"kind": "unloading"}], r"stages\[1\].strain = None: the stage needs one end"),
		([LIST[0], {"kind": "shear", "strain": 0.1, "q": 1e5}], r"stages\[1\].strain = 0.1: the stage needs one end"),
		([LIST[0], {"kind": "cycles", "q": 0}], r"stages\[1\].upperStrain = None: the cycles need one upper end"),
		([LIST[0], {"kind": "hold"}], r"stages\[1\].time = None: is missing"),
		([LIST[0], {"kind": "pressure"}], r"stages\[1\].pressure = None: is missing"),
		([LIST[0], {"kind": "shear", "velocities": [0.1]}], r"stages\[1\].velocities = \[0.1\]: is not a speed of each platen"),
		([LIST[0], {"kind": "shear", "velocities": [0.1, -0.2]}], r"stages\[1\].velocities = \[0.1, -0.2\]: is not a speed"),
		([LIST[0], {"kind": "shear", "strain": 0.01}, {"kind": "shear", "strain": 0.01}], r"stages\[2\].strain = 0.01: is not more than the strain 0.01 before it"),
		([LIST[0], {"kind": "shear", "strain": 0.01}, {"kind": "unloading", "strain": 0.02}], r"stages\[2\].strain = 0.02: is not less than the strain 0.01"),
		("shear", "stages = 'shear': is not a list"),
	],
)
def test_wrongLists(tmp_path, stages, message):
	with pytest.raises(ConfigError, match=f"^{message}.*"):
		config(tmp_path, stages)


def test_measureCountsFromOneConsolidation(tmp_path):
	again = [*LIST, {"kind": "shear", "strain": 0.01}]
	config(tmp_path, again)
	with pytest.raises(ConfigError, match="stages = 9: a consolidation follows a shear, and measure counts from one of them"):
		config(tmp_path, again, measure={"slices": 4})


# As it runs


def file(folder):
	return configure(folder, stages=LIST, measure={"spacing": 0.01, "radius": 0.008, "every": 2}, **LOOSE)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
	"""A test that ran through in one go: (folder, what it printed)."""
	folder = tmp_path_factory.mktemp("whole")
	said = runOutside(file(folder), "--out", folder / "out")
	assert said.returncode == 0, said.stdout + said.stderr
	return folder / "out", said.stdout + said.stderr


def test_everyStage(whole):
	"""Each stage ends where it is to end, has its rows and its state, and is told."""
	out, said = whole
	table = records.read(out / "records.csv")
	labels = list(dict.fromkeys(table["stage"]))
	assert labels == ["consolidation", "shear", "unloading", "unloading-2", "shear-2", "hold", "pressure", "consolidation-2"]
	rows = {label: [i for i, stage in enumerate(table["stage"]) if stage == label] for label in labels}
	strain, q, target = (table[name] for name in ("axial_strain", "q", "sigma3_target"))
	assert strain[rows["shear"]] == pytest.approx(numpy.linspace(0, 0.005, 7), abs=1e-4)
	last = rows["unloading"][-1]
	assert q[last] <= 5e3 < q[last - 1] and strain[last] < 0.005
	assert strain[rows["unloading-2"][-1]] == pytest.approx(0.0015, abs=2e-4) and len(rows["unloading-2"]) == 4
	assert strain[rows["shear-2"][-1]] == pytest.approx(0.006, abs=1e-4) and (numpy.diff(strain[rows["shear-2"]][1:]) > 0).all()
	assert numpy.ptp(strain[rows["hold"]]) == 0 and table["time"][rows["hold"][-1]] - table["time"][rows["hold"][0]] == pytest.approx(2e-4, rel=0.15)
	assert list(target[rows["pressure"]][[0, -1]]) == [5e4, 7e4] and numpy.ptp(strain[rows["pressure"]]) < 1e-12
	assert target[-1] == 6e4 and table["soil_axial_middle"][-1] == pytest.approx(6e4, rel=0.3)
	assert abs(table["energy_error"][rows["shear"][1] : rows["pressure"][-1]]).max() < 1e-3
	states = {"consolidated", "sheared", *labels[2:]}
	assert states == {path.name.removesuffix(".yade.gz") for path in out.glob("*.yade.gz")}
	for text in ("unloading at 0.2 m/s to q = 5 kPa", "unloaded to", "hold for 0.0002 s", "pressure from 50 to 70 kPa for 0.001 s", "shear at 0.2 m/s to 0.5 %"):
		assert text in said, text
	regions = (out / "regions.csv").read_text().splitlines()
	assert {line.split(",")[0] for line in regions[1:]} <= {str(int(step)) for step in table["step"]} and len(regions) > 10


def test_itsPage(whole, tmp_path):
	"""The page draws all stages over strain and over time, and its slider goes by time: a strain is passed several times."""
	(run,) = page.gather([whole[0]])["runs"]
	assert run["problems"] == [] and run["state"].startswith("through 8 stages, at ")
	table = records.read(whole[0] / "records.csv")
	rows = sum(not stage.startswith("consolidation") for stage in table["stage"])
	over = run["curves"]
	assert len(over["stages"]["q"]) == rows < len(over["time"]["q"]) == len(table["step"]) == len(run["stages"]["strain"])
	assert max(over["stages"]["x"]) == pytest.approx(0.6, abs=0.02) and min(numpy.diff(over["stages"]["x"])) < 0 < min(numpy.diff(over["time"]["x"]))
	assert run["scene"]["strains"] == sorted(run["scene"]["strains"]) and run["scene"]["strains"][-1] == pytest.approx(table["time"][rows + run["stages"]["stage"].index("shear") - 1], rel=1e-5)
	verdict = {check["name"]: check for check in run["verdict"]}
	assert verdict["at its end"]["state"] == "pass" and verdict["grains inside"]["number"] == f"all at {rows} rows"
	shutil.copytree(whole[0], tmp_path / "half", ignore=shutil.ignore_patterns("consolidation-2.yade.gz"))
	assert runs.read(tmp_path / "half").state().startswith("stage consolidation-2, 8 of 8, at ") and not runs.read(tmp_path / "half").ended


def test_killedInTheUnloadingAndResumed(whole, tmp_path):
	"""Killed in the middle of an unloading and resumed, a test on one thread has the very rows of one that was never stopped."""
	out = tmp_path / "out"
	with subprocess.Popen(command(file(tmp_path), "--out", out), env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as test:
		deadline = time.monotonic() + 200
		while time.monotonic() < deadline and test.poll() is None:
			if (out / "records.csv").is_file() and (out / "records.csv").read_text().count("\nunloading,") >= 5:
				break
			time.sleep(0.005)
		assert test.poll() is None, "it ended before it was killed"
		test.send_signal(signal.SIGKILL)
	assert records.read(out / "records.csv")["stage"][-1].startswith("unloading")
	said = runOutside(tmp_path / "tiny.yaml", "--out", out, "--resume")
	assert said.returncode == 0, said.stdout + said.stderr
	assert "resumed in unloading" in said.stdout
	expected, found = (records.read(folder / "records.csv") for folder in (whole[0], out))
	for name in set(expected) - {"elapsed"}:
		assert list(found[name]) == list(expected[name]), name
	assert (out / "regions.csv").read_bytes() == (whole[0] / "regions.csv").read_bytes()
	assert (out / "vtk" / "grains.pvd").read_text() == (whole[0] / "vtk" / "grains.pvd").read_text()


def test_untilAStageOfTheList(whole, tmp_path, runHere):
	code, _, errors = runHere(whole[0].parent / "tiny.yaml", "--out", tmp_path / "out", "--until", "unloading-3")
	assert code == 2 and "--until = 'unloading-3': is no stage; fix: use specimen, boundary, consolidation, shear, unloading, unloading-2, shear-2, hold" in errors
	before = (whole[0] / "records.csv").read_bytes()
	code, _, errors = runHere(whole[0].parent / "tiny.yaml", "--out", whole[0], "--resume", "--until", "shear")
	assert code == 0 and (whole[0] / "records.csv").read_bytes() == before, errors
