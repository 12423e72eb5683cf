# SPDX-License-Identifier: GPL-2.0-or-later
"""Clumps of two spheres in a membrane; in the reference tier, since the compact one refuses clumps."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

from specimen import build
from yade import *
from yade.utils import clumpTemplate

s = build()
# every third grain becomes a pair of spheres that has its volume
pair = clumpTemplate(relRadii=[1, 1], relPositions=[[0, 0, 0], [0.6, 0, 0]])
made = O.bodies.replaceByClumps([pair], [1 / 3], discretization=10)
O.run(200 if "SHORT" in os.environ else 8000, True)
# The soil's stress from branches that end at the spheres' centres, and from the boundary alone. Contacts of a clump's spheres have branches that do not
# reach its centre: the two differ, and the boundary's is right at rest.
stress = s.soil.stress()
print(f"{len(made)} clumps, pressure that arrives {s.membrane.transmittedPressure(3):.4g} Pa, axial {stress['boundary'][2, 2]:.4g} Pa by the boundary")
