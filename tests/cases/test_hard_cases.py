# SPDX-License-Identifier: GPL-2.0-or-later
"""Some of the hard cases of scripts/bench.d/hardcases.py in a short form: fewer grains, 3 % strain. All of them: `scripts/bench cases`."""

import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "bench.d"))

import caseruns  # noqa: E402
import casescenes  # noqa: E402
from hardcases import CASES, Case, named  # noqa: E402

SHORT = (
	"pressure at once", "twenty cycles", "extension", "torn membrane", "frictionless grains", "R over r 2", "1.1 of the critical step",
	"3 times the critical step", "similar tests", "tilted platen, reference", "tilted platen, compact", "collisions of pairs, reference",
	"collisions of pairs, compact", "frictionless gas", "10 MPa, emod as it is",
)  # fmt: skip
REST = Case("at rest", drive=casescenes.rest(20000), bounds={"drift of porosity": (0, 1e-6), "drift of pressure": (0, 1e-4), "energy": (0, 1e-6)})


def assertAsExpected(case, tmp_path):
	found = caseruns.runCase(case, tmp_path, short=True)
	assert not found["odd"], found


@pytest.mark.parametrize("name", SHORT)
def test_asExpected(O, tmp_path, name):
	assertAsExpected(named(name), tmp_path)


def test_atRestNothingDrifts(O, tmp_path):
	assertAsExpected(REST, tmp_path)


def test_killedInAHardPlaceAndResumed(O, tmp_path):
	"""Cycles stopped between two checkpoints: the resumed test has the rows of one that was not stopped."""
	case = named("twenty cycles")

	def interrupt(code):
		raise KeyboardInterrupt

	config = case.configuration(tmp_path, short=True)
	caseruns.whole(case, config, tmp_path / "whole")
	with pytest.raises(KeyboardInterrupt):
		caseruns.whole(case, config, tmp_path / "cut", killAfter=7, kill=interrupt)
	caseruns.whole(case, config, tmp_path / "cut", resume=True)
	assert caseruns.differingRows(tmp_path / "whole", tmp_path / "cut") == 0


def test_namesAreDifferent():
	assert len({case.name for case in CASES}) == len(CASES)
