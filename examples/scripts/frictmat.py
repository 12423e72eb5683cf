# SPDX-License-Identifier: GPL-2.0-or-later
"""Stock YADE grains in the membrane: FrictMat and the law of Cundall and Strack. The membrane's engines ask for no law of ours."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

from math import atan

import yade
from specimen import EMOD, build, stresses
from yade import *

law = [yade.Ig2_Sphere_Sphere_ScGeom()], [yade.Ip2_FrictMat_FrictMat_FrictPhys()], [yade.Law2_ScGeom_FrictPhys_CundallStrack()]
s = build(material=lambda friction, density: yade.FrictMat(young=EMOD, poisson=0.3, frictionAngle=atan(friction), density=density), law=law)
O.run(200 if "SHORT" in os.environ else 8000, True)
print("axial %.4g Pa, radial %.4g Pa" % stresses(s.soil))
