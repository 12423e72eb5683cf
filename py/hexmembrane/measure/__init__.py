# SPDX-License-Identifier: GPL-2.0-or-later
"""What is read from a scene: rows of the records, energies, stress along the height."""
