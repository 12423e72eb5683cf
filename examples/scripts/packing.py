# SPDX-License-Identifier: GPL-2.0-or-later
"""A packing of one's own: a cloud of YADE's makeCloud is pressed together in a rigid wall, then the wall goes and a membrane takes its place."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

import specimen
from yade import *
from yade import pack, utils
from yade.wrapper import *

from hexmembrane.scene.platens import platen

short = "SHORT" in os.environ
radius, height, stress = 0.025, 0.05, 20e3  # m, m, Pa

cloud = pack.SpherePack()
cloud.makeCloud((-radius, -radius, 0), (radius, radius, height), rMean=2e-3, rRelFuzz=0.3, seed=1)
inside = [(c, r) for c, r in cloud if (c[0] ** 2 + c[1] ** 2) ** 0.5 + r < radius]
# of a file with lines 'x y z r': from yade import ymport; inside = [(b.state.pos, b.shape.radius) for b in ymport.text("balls.txt")]

O.materials.append(specimen.linear(0.2, specimen.DENSITY))
grains = O.bodies.append([utils.sphere(c, r) for c, r in inside])
bottom = O.bodies.append(platen((0, 0, 0), radius, 0.02, facing=1))
top = O.bodies.append(platen((0, 0, height), radius, 0.06, facing=-1))
tube = Body()
tube.shape, tube.material, tube.dynamic = CylinderWall(radius=radius, height=2 * height), O.materials[0], False
tube.state.pos = (0, 0, height / 2)
wall = O.bodies.append(tube)
servo = RadialWallServo(wall=wall, stress=stress, bottomPlaten=bottom, topPlaten=top, maxVelocity=0.1)
lower = PlatenDrive(platen=bottom, direction=(0, 0, 1), velocity=0)
upper = PlatenDrive(platen=top, direction=(0, 0, -1), mode="stress", stress=stress, maxVelocity=0.2)
loop = CompactLoop(engines=[servo, lower, upper], damping=0.2, substeps=50)
O.engines = [ForceResetter(), loop]
O.dt = 5e-6
for _ in range(2 if short else 400):
	O.run(100, True)
	if upper.settled and servo.settled:
		break

# the grains as they lie, in a membrane of the wall's present size
low, high = SoilMeasure(wall=wall, bottomPlaten=bottom, topPlaten=top).faces
narrow = O.bodies[wall].shape.radius
spheres = [(O.bodies[i].state.pos - Vector3(0, 0, low), O.bodies[i].shape.radius) for i in grains]
print(f"{len(grains)} grains, wall of {1e3 * radius:g} mm now {1e3 * narrow:.4g} mm, height {1e3 * (high - low):.4g} mm")
O.reset()
s = specimen.build("compact", spheres, narrow, high - low, stress)
O.run(100 if short else 20000, True)
print("axial %.4g Pa, radial %.4g Pa" % specimen.stresses(s.soil))
