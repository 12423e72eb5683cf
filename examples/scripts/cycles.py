# SPDX-License-Identifier: GPL-2.0-or-later
"""Unloading, reloading and cycles: the platen's velocity changes its sign between two bounds of the strain."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

from specimen import HEIGHT, build, stresses
from yade import *
from yade import plot

short = "SHORT" in os.environ
s = build("compact")
O.run(200 if short else 10000, True)
s.upper.mode, s.upper.rampTime = "velocity", 1e-3  # s, so that no turn jerks the specimen
low, high = s.soil.faces
height = high - low


def shear(velocity, until):
	"""At this velocity [m/s], positive compresses, until the axial strain is there."""
	s.upper.velocity = velocity
	while True:
		O.run(100, True)
		low, high = s.soil.faces
		strain = 1 - (high - low) / height
		axial, radial = stresses(s.soil)
		plot.addData(strain=strain, q=axial - radial)
		if velocity * (strain - until) >= 0:
			return


step = 5e-4 if short else 0.01
shear(0.1, 2 * step)
for cycle in range(1 if short else 3):
	shear(-0.1, step)
	shear(0.1, 2 * step)
shear(0.1, 3 * step)
plot.plots = {"strain": "q"}
print(f"{len(plot.data['q'])} points, strain {plot.data['strain'][-1]:.4f}, q from {min(plot.data['q']):.4g} to {max(plot.data['q']):.4g} Pa")
if len(sys.argv) > 1:
	plot.plot(noShow=True).savefig(sys.argv[1])  # cycles.png, say
