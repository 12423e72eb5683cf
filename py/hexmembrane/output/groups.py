# SPDX-License-Identifier: GPL-2.0-or-later
"""Stress and strain inside and outside a band: means over two groups of measurement regions, as curves. Needs regions.csv. Uses nothing of YADE."""

import math
import pathlib

import numpy as np

from hexmembrane.output import tables

#: Columns of regions.csv that curves are made of.
COLUMNS = ("q", "p", "porosity", "coordination", "sliding", "axial_strain_region", "volumetric_strain", "deviatoric_strain")


def _planes(folder):
	"""(normal (3,), height on the axis [m], thickness [m], step) of the planes of the last band in bands.csv."""
	path = pathlib.Path(folder) / "bands.csv"
	table = tables.read(path, ("verdict",)) if path.is_file() else {"verdict": [], "step": np.zeros(0)}
	found = [k for k, verdict in enumerate(table["verdict"]) if verdict in ("band", "pair")]
	if not found:
		raise ValueError(f"bands = '{path}': tells of no band; fix: give the regions inside and outside, or a test with measure.bands that has one")
	last = table["step"][found[-1]]
	planes = []
	for k in found:
		if table["step"][k] == last:
			dip, azimuth = (math.radians(table[name][k]) for name in ("dip", "azimuth"))
			n = np.array([math.sin(dip) * math.cos(azimuth), math.sin(dip) * math.sin(azimuth), math.cos(dip)])
			planes.append((n, table["height"][k], table["thickness"][k]))
	return planes, last


def fromBand(folder):
	"""(inside, outside): numbers of the regions of a test whose centres are in the slabs of its last band, and of those a whole radius beyond them.

	:raises ValueError: no band, no regions, or none in one of the groups.
	"""
	planes, step = _planes(folder)
	table = tables.read(pathlib.Path(folder) / "regions.csv")
	at = table["step"] == table["step"][np.argmin(np.abs(table["step"] - step))]
	centres, numbers, radii = np.column_stack([table[name][at] for name in "xyz"]), table["region"][at].astype(int), table["radius"][at]
	beyond = np.min([np.abs((centres - [0, 0, height]) @ n) - thickness / 2 for n, height, thickness in planes], axis=0)
	inside, outside = numbers[beyond <= 0], numbers[beyond >= radii]
	for name, group in (("inside", inside), ("outside", outside)):
		if not len(group):
			raise ValueError(f"regions {name} = none: of {len(numbers)} regions none is {name} the band; fix: a smaller measure.spacing or measure.radius")
	return inside.tolist(), outside.tolist()


def curves(folder, groups):
	"""Means over groups of regions against the specimen's axial strain: (axial strains (n,), by group a dict of column -> (n,)).

	:param groups: numbers of regions by name, such as {"inside": [1, 2, 3], "outside": [4, 5, 6]}. nan of single regions are left out.
	:raises ValueError: a region that there is not, an empty group.
	"""
	table = tables.read(pathlib.Path(folder) / "regions.csv")
	steps, first = np.unique(table["step"], return_index=True)
	known = set(table["region"].astype(int))
	found = {}
	for name, group in groups.items():
		if not len(group) or not set(group) <= known:
			raise ValueError(f"regions {name} = {list(group)}: not all are regions of '{folder}', which has 0 to {max(known)}; fix: give some of these")
		of = np.isin(table["region"], list(group))
		rows = [of & (table["step"] == step) for step in steps]
		found[name] = {column: np.array([_mean(table[column][row]) for row in rows]) for column in COLUMNS}
	return table["axial_strain"][first], found


def _mean(values):
	values = values[np.isfinite(values)]
	return values.mean() if len(values) else math.nan


def plot(folder, path, groups=None, title=""):
	"""Draw stress, strain and porosity of groups of regions against axial strain; ``groups`` as :func:`curves`, None: :func:`fromBand`."""
	from matplotlib.backends.backend_agg import FigureCanvasAgg
	from matplotlib.figure import Figure

	groups = groups or dict(zip(("inside", "outside"), fromBand(folder)))
	strain, found = curves(folder, groups)
	figure = Figure(figsize=(9.5, 6.4), layout="constrained")
	FigureCanvasAgg(figure)
	figure.suptitle(title)
	panels = (("q", 1e-3, "q [kPa]"), ("deviatoric_strain", 100, "deviatoric strain [%]"), ("porosity", 1, "porosity [-]"), ("coordination", 1, "coordination number [-]"))
	for axes, (name, factor, label) in zip(figure.subplots(2, 2, sharex=True).ravel(), panels):
		for (group, values), colour in zip(found.items(), ("#b5561c", "#1f4e79", "#3a7d44", "#7a5195")):
			axes.plot(100 * strain, factor * values[name], color=colour, lw=1.6, label=f"{group} ({len(groups[group])} regions)")
		axes.set_ylabel(label)
		axes.grid(color="0.92")
		axes.spines[["top", "right"]].set_visible(False)
	for axes in figure.axes[2:]:
		axes.set_xlabel("axial strain [%]")
	figure.axes[0].legend(frameon=False, fontsize="small")
	path = pathlib.Path(path)
	part = path.with_name(path.name + ".part")
	figure.savefig(part, dpi=150, format="png", metadata={"Software": "hexmembrane"})
	part.replace(path)
