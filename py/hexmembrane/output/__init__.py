# SPDX-License-Identifier: GPL-2.0-or-later
"""What a test leaves on the disk: records, VTK frames, the picture."""
