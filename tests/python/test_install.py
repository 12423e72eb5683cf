# SPDX-License-Identifier: GPL-2.0-or-later
"""``cmake --install`` beside a system's YADE: plain YADE then knows the classes and the package."""

import os
import shutil
import subprocess

import hexmembrane
import pytest

SCRIPT = """
import hexmembrane
from yade.wrapper import HexMembrane
from hexmembrane.configuration import Config
print("installed:", hexmembrane.__file__, hexmembrane.__version__, HexMembrane(specimenRadius=.02, specimenHeight=.04, particleRadius=.002).specimenRadius, Config.__name__)
"""


def _over(tree, *command):
	"""The command with a tree laid over /usr, without a network: YADE's own program opens ports."""
	return ["bwrap", "--bind", "/", "/", "--dev-bind", "/dev", "/dev", "--unshare-net", "--overlay-src", "/usr", "--overlay-src", str(tree), "--ro-overlay", "/usr", *command]


def test_plainYadeKnowsTheClasses(tmp_path):
	"""The installed plugin is loaded at YADE's start, the installed package is imported; neither this checkout nor its build is looked at."""
	installed = subprocess.run(["cmake", "--install", os.environ["HEXMEMBRANE_BUILD"]], env={**os.environ, "DESTDIR": str(tmp_path / "installed")}, capture_output=True, text=True)
	assert installed.returncode == 0, installed.stderr
	tree = tmp_path / "installed" / "usr"
	if shutil.which("bwrap") is None or subprocess.run(_over(tree, "true"), capture_output=True).returncode:
		pytest.skip("no bubblewrap that lays one folder over another")
	script = tmp_path / "script.py"
	script.write_text(SCRIPT)
	plain = {name: value for name, value in os.environ.items() if name not in ("HEXMEMBRANE_BUILD", "PYTHONPATH")}
	yade = plain.get("YADE_EXECUTABLE") or shutil.which("yade-double")
	found = subprocess.run(_over(tree, yade, "-n", "-x", str(script)), env=plain, cwd="/tmp", stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
	(line,) = [line for line in found.stdout.splitlines() if line.startswith("installed:")] or [found.stdout + found.stderr]
	assert line.split()[1].startswith("/usr/lib/") and line.split()[2:] == [hexmembrane.__version__, "0.02", "Config"]
