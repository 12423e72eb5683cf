# SPDX-License-Identifier: GPL-2.0-or-later
"""Laboratory curves: reading and checking them, and how far a test is from one."""
