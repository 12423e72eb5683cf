# SPDX-License-Identifier: GPL-2.0-or-later
"""Studies of tests with a list of stages: packings are shared, the list is one job, and the tables say q at the end of each of its stages."""

import argparse
import pathlib
import sys

import pytest
import yaml
from hexmembrane.configuration import Config, derived

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "scripts" / "sweep.d"))
import dependence  # noqa: E402
import job  # noqa: E402
import plan as plans  # noqa: E402
import results  # noqa: E402
import studyfile  # noqa: E402
import sweep  # noqa: E402

LOOP = [{"kind": "consolidation"}, {"kind": "shear", "strain": 0.01}, {"kind": "unloading", "q": 0.0}, {"kind": "shear"}]
BASE = {
	"boundary": "wall",
	"specimen": {"radius": 0.015, "height": 0.03, "gradation": "sand.csv", "grains": 60, "porosity": 0.5, "emod": 1e7},
	"consolidation": {"pressure": 1e5},
	"shear": {"strain": 0.02, "velocity": 0.05},
	"stages": LOOP,
}


@pytest.fixture
def plan(tmp_path):
	(tmp_path / "sand.csv").write_text("diameter (mm), percent passing\n4, 0\n5, 60\n6, 100\n")
	(tmp_path / "study.yaml").write_text(yaml.safe_dump({"base": BASE, "axes": {"consolidation.pressure": [1e5, 2e5]}, "seeds": 2}))
	return plans.make(studyfile.load(tmp_path / "study.yaml"))[0]


def test_packingAndOneJob(plan, tmp_path):
	assert sorted(found["stage"] for found in plan["jobs"].values()) == 4 * ["shear"] + 2 * ["specimen"]
	for run in plan["runs"]:
		made = job.Job(plan, run["stages"]["shear"])
		assert made.job["before"] == run["stages"]["specimen"] and results.stagesOf(plan, run) == ["shear", "unloading", "shear-2"]
		assert "--from" not in made.arguments(False) and "--until" not in made.arguments(False) and made.arguments(True)[-1] == "--resume"
	assert plan["jobs"][plan["runs"][0]["stages"]["shear"]]["seconds"] > 0


def test_whatTheListDependsOn(plan, tmp_path):
	"""Also on what a consolidation depends on; where the membrane comes in the wall's place on the keys of both."""
	base = Config.of(BASE, tmp_path)
	names = dependence.names(base)
	assert list(names) == ["specimen", "shear"]
	for changes in ({"consolidation": {"unbalanced": 1e-4}}, {"shear": {"velocity": 0.04}}, {"stages": LOOP[:2]}):
		assert dependence.names(derived(base, changes))["shear"] != names["shear"]
	soft = {"membrane": {"young": 2e6}}
	assert dependence.names(derived(base, soft)) == names
	both = derived(base, {"stages": [LOOP[0], {"kind": "membrane"}, *LOOP[1:]]})
	assert dependence.names(derived(both, soft))["shear"] != dependence.names(both)["shear"]


def test_tables(plan, tmp_path, monkeypatch):
	"""Rows of the consolidation are not told of; a stage's q is that of its last row."""
	table = {"stage": ["consolidation", "shear", "shear", "unloading", "shear-2"], "q": [9.0, 1.0, 2.0, 0.5, 3.0]}
	monkeypatch.setattr(results.records, "read", lambda path: {name: results.numpy.array(column) if name == "q" else column for name, column in table.items()})
	assert list(results.sheared("records.csv", results.stagesOf(plan, plan["runs"][0]))["q"]) == [1.0, 2.0, 0.5, 3.0]
	assert results._qAfter("records.csv", results.endsOf(plan)) == {"q_after_shear": 2.0, "q_after_unloading": 0.5, "q_after_shear-2": 3.0}
	assert list(results.quantitiesOf(plan))[-3:] == ["q_after_shear", "q_after_unloading", "q_after_shear-2"]


def test_fullDisk(plan, tmp_path, monkeypatch, capsys):
	"""Tables that cannot be written: all runs are told of, and what to do."""
	def gather(*_):
		raise OSError(28, "No space left on device", "records.h5")

	monkeypatch.setattr(sweep, "advance", lambda *_: None)
	monkeypatch.setattr(results, "gather", gather)
	code = sweep.execute(plan, {}, tmp_path / "out", argparse.Namespace(again=False), print)
	said = capsys.readouterr().out
	assert code == 1 and said.count("missing: specimen has not ended") == 4 and "No space left on device: 'records.h5'); fix: make room" in said


def test_times(plan, tmp_path, monkeypatch):
	"""A list starts once; bands, rows and the reference tier's steps cost more."""
	def seconds(**changes):
		config = derived(Config.of(BASE, tmp_path), changes)
		return plans._costs(config, results.numpy.full(60, 3e-3))

	base, apart = seconds(), seconds(stages=None)
	with monkeypatch.context() as longer:
		longer.setattr(plans, "_START", plans._START + 10)
		assert seconds()["shear"][0] == pytest.approx(base["shear"][0] + 10)
		assert [seconds(stages=None)[stage][0] for stage in apart] == pytest.approx([one[0] + 10 for one in apart.values()])
	assert seconds(measure={"bands": True})["shear"][0] > base["shear"][0] + 0.2
	assert seconds(output={"records": 1000})["shear"][0] > base["shear"][0] + 2
	assert seconds(tier="reference")["shear"][0] > base["shear"][0] + 2
