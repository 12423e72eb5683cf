# SPDX-License-Identifier: GPL-2.0-or-later
"""The rows of records.csv from a scene of one's own: rows.py [FILE.csv]. Scene() says what it needs to find in the scene."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

import tempfile

from specimen import build
from yade import *

from hexmembrane.measure.rows import Grains, Reference, row
from hexmembrane.output.records import Records, read
from hexmembrane.scene.handles import Scene

file = sys.argv[1] if len(sys.argv) > 1 else os.path.join(tempfile.mkdtemp(), "records.csv")
s = build("compact")
O.trackEnergy = True
O.run(200 if "SHORT" in os.environ else 10000, True)

scene = Scene()
grains, reference = Grains.of(s.grains), Reference.of(scene)  # strains and works count from here
s.upper.mode, s.upper.velocity = "velocity", 0.05  # m/s
with Records(file) as records:
	for _ in range(3):
		O.run(100, True)
		records.append(row(scene, grains, reference, "shear", elapsed=0))
table = read(file)
print(f"{file}: {len(table)} columns, q {table['q'][-1]:.4g} Pa, axial strain {table['axial_strain'][-1]:.2e}, porosity {table['porosity'][-1]:.3f}")
