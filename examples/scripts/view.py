# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE's 3D view of a sheared specimen: the membrane coloured by its tension, a quarter of it left out so that the grains are seen; a picture of it.

Without a screen: xvfb-run -a scripts/yade -x examples/scripts/view.py out/view.jpg
"""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

import numpy
from specimen import HEIGHT, build
from yade import *

s = build("compact")
short = "SHORT" in os.environ
O.run(200 if short else 10000, True)  # consolidation
s.upper.mode, s.upper.velocity = "velocity", 0.2  # m/s, positive compresses
O.run(200 if short else int(0.15 * HEIGHT / s.upper.velocity / O.dt), True)

# tension of a particle [N]: the mean of its bonds
bonds, ids = numpy.array(s.membrane.bonds), list(s.membrane.ids)
total = numpy.bincount(bonds.ravel(), numpy.repeat(s.bonds.normalForces(), 2), len(ids))
tension = total / numpy.bincount(bonds.ravel(), minlength=len(ids))
low, high = numpy.quantile(tension, (0.02, 0.98))
for id, share in zip(ids, numpy.clip((tension - low) / max(high - low, 1e-12), 0, 1)):
	O.bodies[id].shape.color = (share, 0.25, 1 - share)  # blue: least, red: most
for id in s.grains:
	O.bodies[id].shape.color = (0.85, 0.75, 0.5)
print(f"tension of the membrane's bonds from {low:.3g} to {high:.3g} N")

if "DISPLAY" in os.environ:
	from PyQt5.QtWidgets import QApplication
	from yade import qt

	yade.Gl1_Sphere.quality, yade.Gl1_Sphere.stripes = 3, False
	view = qt.View()
	view.screenSize, view.axes, view.timeDisp = (500, 500), False, ""
	view.viewDir, view.upVector = (-0.5, 1, -0.4), (0, 0, 1)
	view.fitAABB((-0.025, -0.025, -0.02), (0.025, 0.025, HEIGHT + 0.015))
	for id in ids:
		x, y, _ = O.bodies[id].state.pos
		if x > 0 > y:
			qt.Renderer().hideBody(id)
	if len(sys.argv) > 1:
		view.saveSnapshot(sys.argv[1])  # a JPEG, written when the window is drawn next
		for _ in range(20):
			QApplication.processEvents()
