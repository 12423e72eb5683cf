# SPDX-License-Identifier: GPL-2.0-or-later
"""Clouds on a vertical section at the strains at which a test kept its fields. Uses nothing of YADE."""

import numpy as np

from hexmembrane.output import clouds, fields
from hexmembrane.report import encode


def ofRun(run):
	"""The clouds of a test with fields.h5 for the page, None without: one section for all states, the band's where there is one."""
	path = run.folder / "fields.h5"
	if not path.is_file():
		return None
	try:
		section = clouds.bandSection(run.folder) or clouds.Section()
		with fields.opened(path) as file:
			strains, steps = ([float(file[name].attrs[what]) for name in fields.states(file)] for what in ("axial_strain", "step"))
		states = [clouds.cloud(path, strain, section) for strain in strains]
	except (OSError, ValueError, KeyError, RuntimeError) as error:
		run.problems.append(f"fields.h5 cannot be read: {error}")
		return None
	if not states:
		return None
	quantities = []
	for name, (label, colours, signed) in clouds.QUANTITIES.items():
		seen = np.concatenate([one.values[name][np.isfinite(one.values[name])] for one in states])
		low, high = np.percentile(seen, (0.5, 99.5)) if len(seen) else (0.0, 0.0)
		if signed:
			low, high = -max(abs(low), abs(high)), max(abs(low), abs(high))
		values = [encode.array(one.values[name][None]) for one in states]
		quantities.append({"name": name, "label": label, "colours": colours, "range": [float(low), float(high)], "states": values})
	grids = [{"along": encode.numbers(1e3 * one.along), "height": encode.numbers(1e3 * one.height)} for one in states]
	return {"strains": encode.numbers(run.at(strains, steps)), "azimuth": section.azimuth, "grids": grids, "quantities": quantities}
