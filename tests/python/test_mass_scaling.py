# SPDX-License-Identifier: GPL-2.0-or-later
"""Mass scaling of the small grains: what it raises, what it must leave alone, and what it tells."""

import re

import numpy
import pytest
from hexmembrane.configuration.specimen import Specimen
from hexmembrane.measure.rows import Grains
from hexmembrane.output import records
from hexmembrane.scene import timestep
from hexmembrane.scene.handles import Scene
from tinyTest import configure, runOutside

WIDE = "diameter (mm), percent passing\n3, 0\n6, 60\n7, 100\n"
#: A membrane that does not set the step, heavier where it has to.
SCALED = {"specimen": {"massScaling": True}, "membrane": {"densityScaling": None}}
PLAIN = {"membrane": {"densityScaling": None}}


def wide(folder, **changes):
	"""The tiny test with a wide gradation."""
	file = configure(folder, **changes)
	(folder / "sand.csv").write_text(WIDE)
	return file


def test_everyGrainsOwnStepIsTheLargests():
	"""2/omega of a grain among its equals goes with sqrt(m/kn)."""
	radii = numpy.array([1e-3, 1.5e-3, 3e-3])
	raised = timestep.sphereMass(radii, 2650) * timestep.massFactors(radii)
	assert raised == pytest.approx(raised[-1] * radii / radii[-1], rel=1e-12)
	stiffness = [timestep.contactStiffness(4e7, r, r) for r in radii]
	assert numpy.sqrt(raised / stiffness) == pytest.approx(numpy.full(3, numpy.sqrt(raised[-1] / stiffness[-1])), rel=1e-12)


def test_estimateOfTheStep():
	radii = numpy.array([1e-3, 3e-3])
	plain, scaled = (Specimen(radius=1, height=1, gradation="x", massScaling=on) for on in (False, True))
	assert timestep.grainStep(plain, radii) == timestep.grainStep(plain, 1e-3)
	assert timestep.grainStep(scaled, radii) == timestep.grainStep(plain, 3e-3)


@pytest.mark.parametrize("name", ["compact", "reference"])
@pytest.mark.parametrize("boundary", ["membrane", "wall"])
def test_masses(O, tmp_path, runHere, name, boundary):
	"""Mass and inertia are raised; packing, volumes and the density that the inertial number takes are not."""
	found = {}
	for on in (False, True):
		(tmp_path / str(on)).mkdir()
		file = wide(tmp_path / str(on), tier=name, boundary=boundary, specimen={"massScaling": on})
		code, said, _ = runHere(file, "--out", tmp_path / str(on) / "out", "--until", "boundary")
		assert code == 0 and ("grains' mass times" in said) == on
		ids = Scene().grainIds()
		bodies = [O.bodies[i] for i in ids]
		kept = [(b.shape.radius, tuple(b.state.pos)) for b in bodies], vars(Grains.of(ids))
		found[on] = kept, numpy.array([(b.state.mass, *b.state.inertia) for b in bodies]), (tmp_path / str(on) / "out" / "packing.txt").read_bytes(), O.dt
	assert found[True][0] == found[False][0] and found[True][2] == found[False][2]
	radii = numpy.array([radius for radius, _ in found[True][0][0]])
	assert found[True][1] == pytest.approx(found[False][1] * timestep.massFactors(radii)[:, None], rel=1e-12)
	assert found[True][0][1]["density"] == 2650 and found[True][3] >= found[False][3]


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
	"""(records, log) of the tiny test as it is and with the grains' masses raised."""
	found = {}
	for name, changes in (("plain", PLAIN), ("scaled", SCALED)):
		folder = tmp_path_factory.mktemp(name)
		said = runOutside(wide(folder, shear={"strain": 0.01}, output={"vtkEvery": 0}, **changes), "--out", folder / "out")
		assert said.returncode == 0, said.stdout + said.stderr
		found[name] = records.read(folder / "out" / "records.csv"), said.stdout
	return found


def test_stepIsThatOfTheLargest(runs):
	"""The log says by how much, and the run takes fewer steps by nearly as much."""
	whole, smallest, now, before = map(float, re.search(r"mass times (\S+), (\S+) for the smallest: their critical step is (\S+) s instead of (\S+) s", runs["scaled"][1]).groups())
	assert 1.2 < whole < smallest < (7 / 3) ** 2 * 1.001 and now / before == pytest.approx(smallest**0.5, rel=5e-3)
	steps = {name: table["step"][-1] for name, (table, _) in runs.items()}
	assert steps["scaled"] < 0.75 * steps["plain"]


def test_specimenAnswersAsBefore(runs):
	q, porosity = {}, {}
	for name, (table, _) in runs.items():
		shear = numpy.array([stage == "shear" for stage in table["stage"]])
		porosity[name] = table["porosity"][shear][0]
		q[name] = table["q"][shear] - table["q"][shear][0]
		assert table["inertial_number"][shear][-1] == pytest.approx(runs["plain"][0]["inertial_number"][-1], rel=1e-2)
	assert porosity["scaled"] == pytest.approx(porosity["plain"], abs=1e-3)
	# two runs of 200 grains with different time steps: their contacts come and go at different times
	assert abs(q["plain"] - q["scaled"]).max() < 0.1 * q["plain"].max()
