# SPDX-License-Identifier: GPL-2.0-or-later
"""What a consolidation brings to its target, the sheet's default stiffness, platens that are smooth until shear, and the survey's configurations."""

import importlib.util
import pathlib

import pytest
from hexmembrane import configuration
from hexmembrane.configuration import Config
from hexmembrane.output import records
from hexmembrane.run import stages
from hexmembrane.scene.flexible_membrane import bendingStiffness
from hexmembrane.scene.handles import Scene
from tinyTest import configure

ROOT = pathlib.Path(__file__).resolve().parents[2]
SLOW = {"unbalanced": 5e-3, "tolerance": 0.01}
ENDS = {"vtkEvery": 0, "checkpointEvery": 0, "consolidationSteps": 100}


def consolidated(tmp_path, runHere, name="out", **sections):
	"""The last row of a consolidation, and its folder."""
	path = configure(tmp_path, **sections, output=ENDS)
	out = tmp_path / name
	code, _, errors = runHere(path, "--out", out, "--until", "consolidation")
	assert code == 0, errors
	table = records.read(out / "records.csv")
	return {name: column[-1] for name, column in table.items()}, out


@pytest.mark.parametrize("boundary", ("membrane", "wall"))
def test_endsWithTheSoilOnTarget(tmp_path, runHere, boundary):
	last, _ = consolidated(tmp_path, runHere, boundary=boundary, consolidation=SLOW)
	assert last["soil_axial_middle"] == pytest.approx(1e5, rel=0.01)
	assert last["soil_radial_middle"] == pytest.approx(1e5, rel=0.01 if boundary == "membrane" else 0.2)  # a wall has one radius
	assert last["sigma3_transmitted_group3"] == pytest.approx(Scene().lateralBoundary.pressure, rel=0.01)
	assert last["sigma3_target"] == 1e5
	assert last["boundary_axial"] == pytest.approx(last["soil_axial"], rel=0.01)


@pytest.mark.parametrize("changes, closed", (({}, True), ({"radial": "transmitted"}, False), ({"open": True}, False), ({"open": True, "radial": "soil"}, True)))
def test_whichRadialStressIsHeld(tmp_path, runHere, changes, closed):
	"""The soil's, by default where the membrane's loop is closed; in shear the membrane's pressure stays."""
	changes = dict(changes)
	membrane = {"pressureTime": float("inf")} if changes.pop("open", False) else {}
	last, _ = consolidated(tmp_path, runHere, consolidation={"unbalanced": 0.05, "tolerance": 0.3, **changes}, membrane=membrane)
	servo = Scene().radialServo
	assert (servo is not None) == closed
	if closed:
		assert servo.dead and Scene().lateralBoundary.pressure == servo.factor * 1e5
	else:
		assert Scene().lateralBoundary.pressure == 1e5


def test_platensForceAsInPfc(tmp_path, runHere):
	"""The platen's force is on target, and the soil's stress is what the membrane leaves of it."""
	last, _ = consolidated(tmp_path, runHere, consolidation={**SLOW, "axial": "platen"})
	assert Scene().axialServo is None
	assert last["platen_force_top"] == pytest.approx(1e5 * Scene().endArea(), rel=0.01)
	assert abs(last["soil_axial_middle"] / 1e5 - 1) > 0.02


@pytest.mark.parametrize("platens, during, after", (({}, 0.0, 0.3), ({"consolidationFriction": 0.1, "friction": 0.2}, 0.1, 0.2), ({"consolidationFriction": None}, 0.3, 0.3)))
def test_platensAreSmoothUntilShear(tmp_path, runHere, O, monkeypatch, platens, during, after):
	begin, seen = stages.TriaxialTest.begin, []

	def beginNext(test, k):
		seen.append(O.materials["platen"].friction)
		begin(test, k)

	monkeypatch.setattr(stages.TriaxialTest, "begin", beginNext)
	consolidated(tmp_path, runHere, platens=platens)
	assert seen[1:] == [during] and O.materials["platen"].friction == after


def test_rowsBesideThePlatensMayBeNone(tmp_path, runHere):
	last, _ = consolidated(tmp_path, runHere, membrane={"particleRadius": 2.5e-3, "platenRows": 0}, consolidation=SLOW)
	assert Scene().lateralBoundary.radialServo is None
	assert last["sigma3_transmitted_group2"] == last["sigma3_transmitted_group3"] == last["sigma3_transmitted_all"]


def test_defaultStiffnessIsThatOfAStatedSag():
	"""A clamped plate of the mean grain's radius sags by p r^4/(64 D): D = p r^3/(64 sag)."""
	import numpy

	radii = numpy.array([1e-3, 2e-3])

	def given(**membrane):
		return Config.of(
			{
				"specimen": {"radius": 0.02, "height": 0.04, "gradation": str(ROOT / "examples" / "data" / "toyoura.csv"), "grains": 100},
				"membrane": membrane,
				"consolidation": {"pressure": 2e5},
			}
		)

	cube = (1e-9 + 8e-9) / 2
	assert bendingStiffness(given(), radii) == pytest.approx(2e5 * cube / (64 * 0.015), rel=1e-12)
	assert bendingStiffness(given(sag=0.03), radii) == pytest.approx(2e5 * cube / (64 * 0.03), rel=1e-12)
	assert bendingStiffness(given(bendingStiffness=0), radii) == 0
	assert bendingStiffness(given(bendingStiffness=1e-3, sag=0.5), radii) == 1e-3


def test_surveyOfRobustness(tmp_path):
	"""Two hundred sound configurations of different names; one of them, made tiny, is run and told."""
	spec = importlib.util.spec_from_file_location("robustness", ROOT / "scripts" / "bench.d" / "robustness.py")
	robustness = importlib.util.module_from_spec(spec)
	spec.loader.exec_module(robustness)
	cases = list(robustness.cases())
	assert len(cases) == len({name for name, _ in cases}) == 200
	for _, change in cases[:20]:
		Config.of(robustness.configuration(change))
	out = tmp_path / "survey"
	out.mkdir()
	tiny = {
		"specimen": {"grains": 150, "porosity": 0.46},
		"consolidation": {"unbalanced": 0.08, "tolerance": 0.3, "rampTime": 0.004},
		"membrane": {"particleRadius": 3e-3},
		"shear": {"strain": 0.002, "velocity": 0.2},
	}
	done = robustness.run("tiny", tiny, out)
	assert done[1] == "done" and len(done) == len(robustness.HEADER)
	refused = robustness.run("too coarse", configuration.merged(tiny, {"membrane": {"particleRadius": 0.015}}), out)
	assert refused[1] == "refused" or "fix: " in refused[-1]
	assert robustness.run("tiny", tiny, out) == done, "a run that has a result is not run again"
