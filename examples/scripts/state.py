# SPDX-License-Identifier: GPL-2.0-or-later
"""O.save and O.load in the middle of a run, and scripting a state that scripts/run has left: state.py [out/quick/consolidated.yade.gz]

The loaded scene goes on as the one that was saved. hexmembrane is imported before O.load: without it YADE says only 'unregistered class'.
"""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

import tempfile

import yade
from specimen import build
from yade import *

from hexmembrane.scene.handles import Scene  # parts of a scene, found again after O.load

steps = 300 if "SHORT" in os.environ else 5000
if len(sys.argv) > 1:
	O.load(sys.argv[1])
else:
	with tempfile.TemporaryDirectory() as folder:
		file = os.path.join(folder, "half.yade.gz")
		s = build("compact")
		O.run(steps, True)
		O.save(file)
		O.run(steps, True)
		whole = s.soil.stress()["whole"]
		O.load(file)  # handles to the scene before are of no use from here on
	O.run(steps, True)
	print(f"after O.load the same stress to the last bit: {bool((Scene().measure.stress()['whole'] == whole).all())}")

scene = Scene()
scene.topDrive.mode, scene.topDrive.velocity = "velocity", 0.05  # m/s
scene.lateralBoundary.setPressure(30e3)  # Pa
O.run(steps, True)
low, high = scene.faces()
print(f"height {1e3 * (high - low):.4g} mm, axial stress {scene.measure.stress()['whole'][2, 2]:.4g} Pa, critical time step {scene.criticalTimeStep():.3g} s")
