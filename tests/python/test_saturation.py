# SPDX-License-Identifier: GPL-2.0-or-later
"""Loops of pressure and stress that stand at a limit say so; sizes that no laboratory's test has are told before anything runs."""

import numpy
import pytest
from hexmembrane.configuration import Config
from hexmembrane.output import records
from hexmembrane.run.estimate import improbable
from tinyTest import TINY, configure


def test_loopsAtTheirLimit(tmp_path, runHere):
	"""Where a loop may not move, its limit is told once, with the key, and each row counts the loops that stand."""
	tight = {"friction": 0.2, "unbalanced": 0.1, "tolerance": 0.5}
	path = configure(
		tmp_path,
		consolidation=tight,
		membrane={"maxFactor": 1.0001, "servoMaxFactor": 1.0001, "young": 3e7},
		shear={"strain": 0.004, "velocity": 0.2},
		output={"records": 4, "vtkEvery": 0, "checkpointEvery": 0, "consolidationSteps": 400},
	)
	code, said, errors = runHere(path, "--out", tmp_path / "out")
	assert code == 0, errors
	told = [line for line in errors.splitlines() if "stands at its limit" in line]
	assert sum("WARNING: membrane.maxFactor = 1.0001: the pressure of the membrane's main body stands at its limit" in line for line in told) == 1
	assert all("kPa arrive; fix: a larger maxFactor" in line for line in told)
	assert records.read(tmp_path / "out" / "records.csv")["loops_saturated"][-1] >= 1


@pytest.mark.parametrize(
	"specimen, radius, message",
	[
		({"radius": 25, "height": 100}, 2.0, ["specimen.radius = 25 m is improbable, tests have 0.002 to 0.5; in mm it would be 0.025 m; fix: see the unit", "specimen.height", "the grains' mean radius = 2 m"]),
		({"density": 2.65}, 2e-3, ["specimen.density = 2.65 kg/m3 is improbable"]),
		({}, 2e-3, []),
	],
)
def test_improbableSizes(tmp_path, specimen, radius, message):
	configure(tmp_path)
	config = Config.of({**TINY, "specimen": {**TINY["specimen"], **specimen}}, tmp_path)
	found = improbable(config, numpy.full(10, radius))
	assert len(found) == len(message) and all(text in line for text, line in zip(message, found))


def test_improbableIsToldFirst(tmp_path, runHere):
	path = configure(tmp_path, specimen={"radius": 20, "height": 50}, membrane={"young": 3e9})
	(tmp_path / "sand.csv").write_text("diameter (m), percent passing\n4, 0\n5, 60\n6, 100\n")
	code, said, errors = runHere(path, "--out", tmp_path / "out", "--check")
	assert code == 0 and "WARNING: specimen.radius = 20 m is improbable" in said, errors
