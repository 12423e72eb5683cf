# SPDX-License-Identifier: GPL-2.0-or-later
"""hexmembrane: a flexible membrane for triaxial tests in YADE.

Importing it makes the C++ classes (see :mod:`hexmembrane._load`) known to YADE: they are then in module ``yade`` like YADE's own.
"""

from hexmembrane import _load

__version__ = "0.2.0"

_load.load()
