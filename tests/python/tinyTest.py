# SPDX-License-Identifier: GPL-2.0-or-later
"""A test of 200 grains as a user runs it: its configuration, and the command line in a YADE of its own."""

import copy
import os
import pathlib
import subprocess
import sys

import yaml

ROOT = pathlib.Path(__file__).parents[2]
LAUNCHER = ROOT / "scripts" / "setup.d" / "launch.py"
MAIN = ROOT / "py" / "hexmembrane" / "__main__.py"
TINY = {
	"title": "tiny",
	"specimen": {"radius": 0.02, "height": 0.05, "gradation": "sand.csv", "grains": 200, "porosity": 0.45, "emod": 2e7, "seed": 3},
	"membrane": {"sizeRatio": 1.0, "young": 3e6, "thickness": 5e-4},
	"consolidation": {"pressure": 1e5, "friction": 0.2, "unbalanced": 5e-3, "tolerance": 0.1},
	"shear": {"strain": 0.02, "velocity": 0.08},
	"output": {"records": 12, "vtkEvery": 6, "checkpointEvery": 4, "consolidationSteps": 400, "report": False},
}
GRADATION = "diameter (mm), percent passing\n4, 0\n5, 60\n6, 100\n"


def command(*arguments):
	return [sys.executable, str(LAUNCHER), "1", str(MAIN), *map(str, arguments)]


def environment():
	return {**os.environ, "PYTHONPATH": str(ROOT / "py"), "OMP_NUM_THREADS": "1"}


def runOutside(*arguments):
	"""A test in a YADE of its own, on one thread."""
	return subprocess.run(command(*arguments), env=environment(), capture_output=True, text=True, timeout=300)


def configure(folder, **changes):
	"""tiny.yaml in ``folder``, with changes such as ``boundary='wall', shear={'strain': 1}``."""
	(folder / "sand.csv").write_text(GRADATION)
	given = copy.deepcopy(TINY)
	for name, part in changes.items():
		if isinstance(part, dict):
			given.setdefault(name, {}).update(part)
		else:
			given[name] = part
	(folder / "tiny.yaml").write_text(yaml.safe_dump(given))
	return folder / "tiny.yaml"
