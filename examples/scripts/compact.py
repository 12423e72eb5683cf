# SPDX-License-Identifier: GPL-2.0-or-later
"""The same test in YADE's own loop and in the compact tier: the engines of membrane and platens are the same objects, one engine replaces the others."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

import time

from specimen import build, stresses
from yade import *
from yade.wrapper import PyRunner

steps = 200 if "SHORT" in os.environ else 10000
for tier in "reference", "compact":
	O.reset()
	s = build(tier)
	start, rows = time.time(), []
	# Python looks at the scene between iterations. In the compact tier one iteration is 'substeps' steps (50 here) and O.iter goes up by them,
	# so a period of 75 steps becomes one of 100.
	O.engines += [PyRunner(command="rows.append(O.iter)", iterPeriod=75)]
	O.run(steps, True)
	axial, radial = stresses(s.soil)  # reads the compact tier's own contacts
	print(f"{tier}: {1e3 * (time.time() - start) / steps:.3g} ms a step, axial {axial:.6g} Pa, radial {radial:.6g} Pa, PyRunner at {rows[:3]}")
	print(f"contacts in O.interactions: {O.interactions.countReal()}")
s.loop.exportContacts()  # for YADE's own tools
print(f"after exportContacts(): {O.interactions.countReal()}")
