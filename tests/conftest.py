# SPDX-License-Identifier: GPL-2.0-or-later
"""Makes YADE and hexmembrane importable in the tests.

YADE's program is a Python script that can be imported as well: it then starts YADE in this Python without a session. It parses
sys.argv while it is read, so pytest's own arguments are put aside meanwhile.
"""

import importlib.machinery
import importlib.util
import os
import shutil
import sys

import pytest

TESTS = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(os.path.dirname(TESTS), "py"), os.path.join(TESTS, "engines")]  # the package, and the scenes that tests share


def _startYade():
	program = os.environ.get("YADE_EXECUTABLE") or shutil.which("yade-double")
	if not program or not os.path.isfile(program):
		raise RuntimeError("YADE's program was not found (yade-double in PATH, or YADE_EXECUTABLE). Run the tests with scripts/test.")
	loader = importlib.machinery.SourceFileLoader("yadeProgram", program)
	spec = importlib.util.spec_from_file_location("yadeProgram", program, loader=loader)
	module = importlib.util.module_from_spec(spec)
	kept = sys.argv, sys.dont_write_bytecode
	sys.argv = [program, "-n"] + (["-j", os.environ["HEXMEMBRANE_THREADS"]] if "HEXMEMBRANE_THREADS" in os.environ else [])
	sys.dont_write_bytecode = True  # the program lies in a folder that is not ours
	try:
		loader.exec_module(module)
	finally:
		sys.argv, sys.dont_write_bytecode = kept


_startYade()
import hexmembrane  # noqa: E402  (needs YADE started)
from tiers import TIERS  # noqa: E402


@pytest.fixture
def O():
	"""YADE's Omega with an empty scene, emptied again after the test."""
	import yade

	yade.O.reset()
	yade.O.engines = []
	yield yade.O
	yade.O.reset()


@pytest.fixture(params=TIERS)
def tier(request):
	"""Each tier in turn, for a test whose body builds its list of engines with tiers.engines."""
	return request.param
