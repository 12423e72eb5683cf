# SPDX-License-Identifier: GPL-2.0-or-later
"""Force chains: the strongest contacts of the soil in the frames of a test, for the page. Uses nothing of YADE."""

import numpy as np

from hexmembrane.output import vtk
from hexmembrane.report import encode

#: Share of a frame's contacts that is in the page, the strongest: those above the mean are a good third of them.
SHARE = 0.5
#: Numbers of a contact in the page.
NUMBERS = 7


def countOf(path):
	"""How many contacts of a frame would be in the page; 0 when it cannot be read."""
	try:
		return int(SHARE * len(vtk.read(path)[1]))
	except (OSError, ValueError, AttributeError):
		return 0


def ofFrames(run, paths):
	"""Per frame ``{"all", "mean" [N], "ends" [m], "force"}``, the strongest first, ``force`` over the mean; None when a frame cannot be read."""
	found = []
	for path in paths:
		try:
			points, lines, arrays, _ = vtk.read(path)
			forces = arrays["normal_force"][lines[:, 0]].astype(float)
			if lines.shape[1] != 2 or not np.isfinite(points).all() or not np.isfinite(forces).all():
				raise ValueError("it holds no contacts")
		except (OSError, ValueError, KeyError, IndexError, AttributeError) as error:
			run.problems.append(f"vtk/{path.name} cannot be read: {error}; there are no force chains.")
			return None
		mean = forces.mean()
		order = np.argsort(-forces, kind="stable")[: int(SHARE * len(lines))]
		ends = points[lines[order]].reshape(1, -1, 6)
		found.append({"all": len(lines), "mean": float(mean), "ends": encode.array(ends), "force": encode.array(forces[order].reshape(1, -1, 1) / (mean or 1.0))})
	return found
