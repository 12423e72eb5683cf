# SPDX-License-Identifier: GPL-2.0-or-later
"""VTKRecorder and YADE's other tools: what they see of a membrane test, and which of them count the contacts of membrane and platens."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

import tempfile
from math import pi

from specimen import HEIGHT, RADIUS, build, stresses
from yade import *
from yade import utils
from yade.wrapper import VTKRecorder

folder = sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()
s = build("compact")
O.run(200 if "SHORT" in os.environ else 10000, True)
s.loop.exportContacts()  # the compact tier's contacts into O.interactions, for one look
grains = set(s.grains)
own = [i for i in O.interactions if i.id1 in grains and i.id2 in grains]
axial, radial = stresses(s.soil)
theirs = utils.getStress(pi * RADIUS**2 * HEIGHT)  # compression negative; all contacts over a volume that one gives
print(f"contacts: {O.interactions.countReal()}, of two grains {len(own)}")
print(f"radial stress: SoilMeasure {radial:.4g} Pa, utils.getStress {-(theirs[0, 0] + theirs[1, 1]) / 2:.4g} Pa")
print(f"contacts a grain: SoilMeasure {s.soil.stress()['coordination']:.3g}, utils.avgNumInteractions {utils.avgNumInteractions():.3g}")
print(f"fabric, vertical: grains alone {sum(i.geom.normal[2] ** 2 for i in own) / len(own):.3f}, utils.fabricTensor {utils.fabricTensor()[0][2, 2]:.3f}")

# spheres with radius, velocity and so on; the membrane's are those of mask 3. Not "intr": it ends in a crash or MemoryError at times, in VTK's writer of
# parallel pieces. A test's own frames hold the contacts (output.contacts), as SoilMeasure.contacts() does
view = VTKRecorder(fileName=folder + "/", recorders=["spheres", "velocity", "mask"], iterPeriod=1, dead=True)
O.engines += [view]
view()
print(sorted(os.listdir(folder)))
