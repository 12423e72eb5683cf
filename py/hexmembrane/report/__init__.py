# SPDX-License-Identifier: GPL-2.0-or-later
"""Reports: one page of HTML from one test, several or a study, that opens from the disk without a network."""
