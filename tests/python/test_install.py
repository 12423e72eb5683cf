# SPDX-License-Identifier: GPL-2.0-or-later
"""``cmake --install`` beside a system's YADE: plain YADE then knows the classes and the package."""

import os
import pathlib
import re
import shutil
import subprocess

import hexmembrane
import pytest

ROOT = pathlib.Path(__file__).parents[2]
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


def test_packageAsksForWhatTheBuildNeeds():
	"""The Debian package is built with the packages that the set-up builds with, beside the YADE that it takes."""
	control = (ROOT / "scripts" / "packaging" / "debian" / "control").read_text(encoding="utf-8")
	needs = re.search(r"^Build-Depends: (.*?)^\S", control, re.MULTILINE | re.DOTALL)[1]
	named = {part.split()[0] for part in needs.split(",")}
	listed = (ROOT / "scripts" / "setup.d" / "packages.list").read_text(encoding="utf-8")
	plugin = re.search(r"^# the plugin.*?\n(.*?)^#", listed, re.MULTILINE | re.DOTALL)[1].split()
	assert set(plugin) - named == {"g++"}  # which every build has
	version = re.search(r"^yadeVersion=(\S+)", (ROOT / "scripts" / "setup.d" / "common.sh").read_text(encoding="utf-8"), re.MULTILINE)[1]
	assert control.count(f"yade (>= {version}), yade (<< ") == 2
