# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE's own way to many tests: yade-batch runs this script once for each line of table.txt, into out/batch. Without a table it is one test."""

import os
import pathlib
import sys

from yade import utils

import hexmembrane  # noqa: F401  (makes its classes known)
from hexmembrane.configuration import derived, load
from hexmembrane.run import run

EXAMPLES = pathlib.Path(os.path.abspath(sys.argv[0])).parents[2]  # YADE runs scripts without their __file__
SMALL = {
	"specimen": {"height": 0.04, "grains": 200, "porosity": 0.45, "emod": 2e7},
	"membrane": {"sizeRatio": 1.0},
	"consolidation": {"unbalanced": 5e-3, "tolerance": 0.1},
	"shear": {"strain": 0.02, "velocity": 0.08},
	"output": {"vtkEvery": 0},
}

utils.readParamsFromTable(noTableOk=True, friction=0.5, pressure=1e5, seed=1)
from yade.params import table  # noqa: E402  (made by the line above)

changes = {"specimen": {"friction": table.friction, "seed": table.seed}, "consolidation": {"pressure": table.pressure}}
config = derived(derived(load(EXAMPLES / "quick.yaml"), SMALL), changes)
run(config, f"out/batch/friction-{table.friction:g}-pressure-{table.pressure:g}-seed-{table.seed}", quiet=True)
