# SPDX-License-Identifier: GPL-2.0-or-later
"""Radius and stress along the height of a specimen by strain. Uses nothing of YADE."""

import numpy as np

from hexmembrane.report import encode
from hexmembrane.report.runs import table

#: Slices of the height of a profile that is made from frames.
_SLICES = 24


def measured(run):
	"""Radius [mm] and the soil's stress [kPa] along the height [mm] from profile.csv, None without rows."""
	found = table(run, "profile.csv")
	if found is None or not len(found["step"]):
		return None
	_, first = np.unique(found["step"], return_index=True)
	states = [found["step"] == found["step"][k] for k in first]
	columns = {"height": 1e3, "radius": 1e3, "axial": 1e-3, "radial": 1e-3}
	return {
		"strains": encode.numbers(run.at(found["axial_strain"][first], found["step"][first])),
		"from": "profile.csv: slices of the soil",
		**{name: [encode.numbers(factor * found[name][rows]) for rows in states] for name, factor in columns.items()},
	}


def ofFrames(boundaries, strains):
	"""Mean distance from the axis [mm] along the height [mm] of the lateral boundary's points, without the O-ring rows.

	:param boundaries: (points (n, 3), ..., arrays by name) of each frame. :param strains: of the frames, encoded.
	"""
	heights, radii = [], []
	for points, _, arrays in boundaries:
		if "group" in arrays:
			points = points[arrays["group"] > 1]
		z = points[:, 2] - points[:, 2].min()
		which = np.minimum((z / max(z.max(), 1e-12) * _SLICES).astype(int), _SLICES - 1)
		count = np.bincount(which, minlength=_SLICES)
		held = count > 0  # rows of a coarse sheet may be farther apart than slices
		for found, values in ((heights, z), (radii, np.hypot(points[:, 0], points[:, 1]))):
			found.append(encode.numbers(1e3 * np.bincount(which, values, _SLICES)[held] / count[held]))
	return {"strains": strains, "from": "the frames: centres of the boundary's points", "height": heights, "radius": radii}
