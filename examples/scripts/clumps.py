# SPDX-License-Identifier: GPL-2.0-or-later
"""Clumps of two spheres in a membrane; in the reference tier, since the compact one refuses clumps."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

from specimen import build
from yade import *
from yade import utils

s = build()
# every third grain becomes a clump of two spheres that lie within it
clumps = []
for grain in s.grains[::3]:
	ball = O.bodies[grain]
	centre, radius, material = ball.state.pos, ball.shape.radius, ball.material
	O.bodies.erase(grain)
	pair = [utils.sphere(centre + shift * Vector3(0.25 * radius, 0, 0), 0.75 * radius, material=material) for shift in (-1, 1)]
	clumps.append(O.bodies.appendClumped(pair, discretization=10)[0])
O.run(200 if "SHORT" in os.environ else 8000, True)
# The soil's stress from branches that end at the spheres' centres, and from the boundary alone. Contacts of a clump's spheres have branches that do not
# reach its centre: the two differ, and the boundary's is right at rest.
stress = s.soil.stress()
print(f"{len(clumps)} clumps, pressure that arrives {s.membrane.transmittedPressure(3):.4g} Pa, axial {stress['boundary'][2, 2]:.4g} Pa by the boundary")
