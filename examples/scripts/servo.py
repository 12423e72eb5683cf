# SPDX-License-Identifier: GPL-2.0-or-later
"""A servo of one's own, in Python: shear at a constant mean stress. Every so many steps the confining pressure follows the axial stress."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

from specimen import build, stresses
from yade import *
from yade.wrapper import PyRunner

short, mean = "SHORT" in os.environ, 50e3  # Pa
s = build("compact", pressure=mean)
O.run(200 if short else 10000, True)


def follow():
	"""p = (axial + 2 radial)/3 is to stay; a part of the correction at a time, since the specimen answers late."""
	axial, radial = stresses(s.soil)
	s.pressure.pressure += 0.1 * ((3 * mean - axial) / 2 - radial)
	s.beside.pressure = s.pressure.pressure


s.upper.mode, s.upper.velocity = "velocity", 0.05  # m/s
O.engines += [PyRunner(command="follow()", iterPeriod=s.loop.substeps)]
O.run(500 if short else 12000, True)
axial, radial = stresses(s.soil)
print(f"axial {axial:.4g} Pa, radial {radial:.4g} Pa, mean {(axial + 2 * radial) / 3:.4g} Pa of {mean:g} Pa")
