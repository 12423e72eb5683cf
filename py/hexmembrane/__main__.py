# SPDX-License-Identifier: GPL-2.0-or-later
"""``yade -n -x path/to/hexmembrane/__main__.py CONFIG [--out DIR] ...``, or ``python -m hexmembrane`` where YADE is imported."""

import sys

from hexmembrane.run.command import main

sys.exit(main(sys.argv[1:]))
