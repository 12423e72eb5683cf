# SPDX-License-Identifier: GPL-2.0-or-later
"""``yade -n -x path/to/hexmembrane/__main__.py CONFIG [--out DIR] ...``, or ``python -m hexmembrane`` where YADE is imported."""

import sys

try:
	from hexmembrane.run.command import main
except ImportError as error:
	# the plugin is missing, of another version or beside an installed one; the message has the fix
	sys.exit(f"error: {error}")

sys.exit(main(sys.argv[1:]))
