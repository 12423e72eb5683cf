# SPDX-License-Identifier: GPL-2.0-or-later
"""A test's scene in YADE: specimen, lateral boundary, end platens, engines, time step, and the handles to all that."""
