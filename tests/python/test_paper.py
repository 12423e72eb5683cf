# SPDX-License-Identifier: GPL-2.0-or-later
"""The study's tests in short: the files of examples/paper with fewer and larger grains, to 1 % of axial strain."""

import pathlib

import numpy
import pytest
from hexmembrane import configuration
from hexmembrane.output import records
from hexmembrane.run import run

PAPER = pathlib.Path(__file__).parents[2] / "examples" / "paper"
SHORT = {
	"specimen": {"grains": 300, "porosity": 0.44},
	"membrane": {"particleRadius": 2.5e-3, "thickness": 1.0e-3},  # as much thicker as the grains are larger
	"shear": {"strain": 0.01, "velocity": 0.08},
	"consolidation": {"unbalanced": 5e-3, "tolerance": 0.1},
	"output": {"records": 10, "vtkEvery": 0, "checkpointEvery": 0},
}


@pytest.mark.parametrize("name", ["flexible-150", "rigid-150"])
def test_short(O, tmp_path, name):
	"""From packing under stress to shear: the pressure arrives, q rises, the energies add up and the specimen contracts first."""
	config = configuration.derived(configuration.load(PAPER / f"{name}.yaml"), SHORT)
	run(config, tmp_path / "out", quiet=True)
	table = records.read(tmp_path / "out" / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	assert table["axial_strain"][-1] == pytest.approx(0.01, abs=1e-4)
	assert abs(table["sigma3_transmitted_group3"][shear] / 1.5e5 - 1).max() < 0.05
	assert abs(table["q"][shear][0]) < 2e4 and table["q"][-1] > 5e4 and (numpy.diff(table["q"][shear]) > 0).all()
	assert -0.01 < table["volumetric_strain_volume"][-1] < 0
	rolling = {round(c.phys.rollingArm / (c.geom.refR1 * c.geom.refR2 / (c.geom.refR1 + c.geom.refR2)), 9) for c in O.interactions}
	assert rolling == {0.0, 0.5}
	# The energy of the packing under stress is there before the first work, and none of it is lost.
	assert abs(table["energy_error"][shear]).max() < 1e-4
	assert abs(table["energy_error"][~shear][-1]) < (1e-4 if config.boundary == "wall" else 1e-2)
