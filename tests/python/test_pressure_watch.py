# SPDX-License-Identifier: GPL-2.0-or-later
"""A lateral boundary that loses its pressure in shear: told once when it begins and at the end, in a column, and the end of the test where that is asked for."""

import numpy
import pytest
from hexmembrane.configuration.config import Shear
from hexmembrane.output import records
from hexmembrane.run import checkpoints
from hexmembrane.run.pressure_watch import PressureWatch
from tinyTest import configure

#: A wall that cannot follow a specimen sheared at eight times the quick example's velocity.
FAST = {"boundary": "wall", "wall": {"maxVelocity": 1e-4}, "shear": {"strain": 0.015, "velocity": 0.5}}


def row(distance, strain=0.03):
	return {"sigma3_distance": distance, "axial_strain": strain, "sigma3_transmitted_group3": 1e5 * (1 + distance)}


def test_toldOnce():
	watch = PressureWatch(Shear(), "wall")
	assert watch.strayed(row(0.05)) == watch.strayed(row(-0.04)) == ""
	said = watch.strayed(row(-0.08))
	assert said.startswith("shear.pressureTolerance = 0.05: at 3.00 % the wall transmits 92 kPa, -8 % of sigma3 away from what it is to hold; fix: ")
	assert watch.strayed(row(0.5)) == ""


def test_eachTimeWhereItStops():
	watch = PressureWatch(Shear(stopOutsideTolerance=True, pressureTolerance=0.2), "membrane")
	assert watch.strayed(row(0.19)) == "" and watch.strayed(row(0.21)) and watch.strayed(row(0.21))


@pytest.mark.parametrize("stop", [False, True])
def test_wallThatIsTooSlow(tmp_path, runHere, stop):
	given = {**FAST, "shear": {**FAST["shear"], "stopOutsideTolerance": stop}}
	code, said, error = runHere(configure(tmp_path, **given), "--out", tmp_path / "out")
	table = records.read(tmp_path / "out" / "records.csv")
	shear = [i for i, stage in enumerate(table["stage"]) if stage == "shear"]
	distance = table["sigma3_distance"]
	held = table["sigma3_target"]
	assert numpy.allclose(distance, (table["sigma3_transmitted_group3"] - held) / held, atol=1e-12)
	assert max(abs(distance[i]) for i in shear) > 0.05
	if stop:
		assert code == 1 and "error: shear.pressureTolerance = 0.05: at " in error and "; the last checkpoint is in" in error
		assert abs(distance[-1]) > 0.05 and checkpoints.exist(tmp_path / "out")
	else:
		assert code == 0
		assert error.count("WARNING: wall.maxVelocity: the wall moves as fast as it may, 0.0001 m/s, in shear at ") == 1
		assert table["loops_saturated"][-1] == 1
		assert error.count("WARNING: shear.pressureTolerance") == 1 and "WARNING, the pressure was not held" in error
