# SPDX-License-Identifier: GPL-2.0-or-later
"""A script with a table: scripts/yade-batch -j 2 examples/scripts/table.txt examples/scripts/batch.py runs it once for each line of the table."""

import os
import sys

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE does not do it

from specimen import build, linear, stresses
from yade import *
from yade import utils

utils.readParamsFromTable(noTableOk=True, friction=0.5, pressure=50e3)
from yade.params import table  # noqa: E402  (made by the line above)

s = build("compact", pressure=table.pressure, material=lambda friction, density: linear(min(friction, table.friction), density))
O.run(200 if "SHORT" in os.environ else 10000, True)
print("friction %g: axial %.4g Pa, radial %.4g Pa" % (table.friction, *stresses(s.soil)))
utils.waitIfBatch()
