# SPDX-License-Identifier: GPL-2.0-or-later
"""Density scaling of the membrane alone: what it changes, what it must not, and what it tells."""

import math
import re

import numpy
import pytest
from hexmembrane.output import records
from hexmembrane.scene import timestep
from tinyTest import configure, runOutside


def test_factor():
	assert timestep.densityScaling(3.0, 1e-6, 5e-6) == 3.0
	assert timestep.densityScaling(None, 4e-6, 2e-6) == 4.0
	assert timestep.densityScaling(None, 2e-6, 4e-6) == 1.0


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
	"""The tiny test in a fine membrane of light spheres, which sets the time step: as it is, and with its density scaled up to the grains' step."""
	found = {}
	for name, scaling in (("plain", 1.0), ("scaled", None)):
		folder = tmp_path_factory.mktemp(name)
		membrane = {"sizeRatio": 0.35, "density": 500, "densityScaling": scaling}
		said = runOutside(configure(folder, membrane=membrane, shear={"strain": 0.01}, output={"vtkEvery": 0}), "--out", folder / "out")
		assert said.returncode == 0, said.stdout + said.stderr
		found[name] = records.read(folder / "out" / "records.csv"), said.stdout + said.stderr
	return found


def steps(text):
	"""Time step, critical step of grains and of membrane as a run's log has them (s)."""
	return [float(x) for x in re.search(r"time step (\S+) s; critical: grains (\S+) s, membrane (\S+) s", text).groups()]


def test_grainsSetTheStep(runs):
	plain, scaled = (steps(runs[name][1]) for name in ("plain", "scaled"))
	assert plain[2] < 0.7 * plain[1]
	assert scaled[1] == plain[1] and scaled[2] == pytest.approx(plain[1], rel=1e-2)  # the radius is fitted to the circumference
	assert scaled[0] == pytest.approx(plain[0] * scaled[2] / plain[2], rel=1e-2)
	said = re.search(r"membrane's density times (\S+): its critical step is (\S+) s instead of (\S+) s", runs["scaled"][1])
	factor, now, before = map(float, said.groups())
	assert factor == pytest.approx((plain[1] / plain[2]) ** 2, rel=1e-2) and now == scaled[2] and before == pytest.approx(plain[2], rel=1e-3)
	assert "density times" not in runs["plain"][1]


def test_effectIsRecordedAndSmall(runs):
	"""The membrane's inertia stays a small share of the pressure's force, and the specimen answers as before."""
	q = {}
	for name, (table, _) in runs.items():
		shear = numpy.array([stage == "shear" for stage in table["stage"]])
		unbalanced = table["membrane_unbalanced"][shear]
		assert (unbalanced > 0).all() and unbalanced.max() < 0.1
		q[name] = table["q"][shear] - table["q"][shear][0]  # the tiny test ends its consolidation within 10 % of the pressure
	assert len(q["plain"]) == len(q["scaled"])
	# two runs of 200 grains with different time steps: their contacts come and go at different times
	assert abs(q["plain"] - q["scaled"]).max() < 0.06 * q["plain"].max()
	assert math.isfinite(q["scaled"][-1])
