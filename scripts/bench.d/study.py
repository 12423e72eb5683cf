# SPDX-License-Identifier: GPL-2.0-or-later
"""The study's packing for the benchmarks that need it."""

import os

from hexmembrane.scene import packing_file
from hexmembrane.configuration import load
from hexmembrane.scene.specimen import make

RADIUS, HEIGHT = 0.02, 0.08  # of the cylinder, m
STUDY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples", "paper", "flexible-100.yaml")


def packing(folder):
	"""The study's packing, made once for a folder."""
	path = os.path.join(folder, "packing.txt")
	if not os.path.isfile(path):
		packing_file.save(make(load(STUDY), print), path)
	return packing_file.load(path)
