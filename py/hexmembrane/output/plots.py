# SPDX-License-Identifier: GPL-2.0-or-later
"""The picture of a test, made from its records alone."""

import math
import pathlib

from hexmembrane.output.records import read, sheared

#: A laboratory's curve: points on a broad line, told by its shape where there is no colour.
_LABORATORY = dict(color="0.55", lw=3.0, marker="o", ms=3.5, mfc="0.25", mec="none", solid_capstyle="round")
_MISSING = "no shear rows in {}: nothing to plot; fix: shear the specimen first"


def _name(laboratory):
	return f"laboratory: {laboratory.name}".replace("$", r"\$")


def plot(recordsPath, pngPath, title="", laboratory=None, pressure=math.nan, misfit=()):
	"""Draw the soil's q, both volumetric strains, and transmitted pressures beside the soil's radial stress, against axial strain.

	:param recordsPath: records.csv of a test.
	:param pngPath: picture to write (by temporary name and rename).
	:param laboratory: a :class:`hexmembrane.laboratory.curve.Curve` to lay under ours, with the load cell's q beside the soil's, since a laboratory's is a load cell's.
	:param pressure: sigma3 of it [Pa]. :param misfit: lines that tell how far the test is from it.
	:returns: the figure, for those who want to change it.
	:raises ValueError: the records hold no shear.
	"""
	from matplotlib.backends.backend_agg import FigureCanvasAgg
	from matplotlib.figure import Figure

	table = read(recordsPath)
	rows = sheared(table)
	if not rows:
		raise ValueError(_MISSING.format(recordsPath))

	def column(name, factor=1.0):
		return [factor * table[name][i] for i in rows]

	strain = column("axial_strain", 100)
	figure = Figure(figsize=(7.0, 8.4), layout="constrained")
	FigureCanvasAgg(figure)
	upper, middle, lower = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 2))
	if title:
		figure.suptitle(title, parse_math=False)

	upper.plot(strain, column("q", 1e-3), color="#1f4e79", lw=1.8)
	upper.set_ylabel("deviatoric stress of the soil q [kPa]")

	if laboratory is not None and "stress_ratio" in laboratory.series:
		series = laboratory.series["stress_ratio"]
		upper.lines[0].set_label("soil")
		upper.plot(strain, column("q_cell", 1e-3), color="#b5541c", lw=1.2, ls="--", label="load cell's, membrane's pull included")
		upper.plot(100 * series.strain, 1e-3 * pressure * (series.value - 1), zorder=1, label=_name(laboratory), **_LABORATORY)
	if laboratory is not None and "volumetric_strain" in laboratory.series:
		series = laboratory.series["volumetric_strain"]
		middle.plot(100 * series.strain, 100 * series.value, zorder=1, label=_name(laboratory), **_LABORATORY)
	if misfit:
		upper.text(0.98, 0.04, "\n".join(map(str, misfit)), transform=upper.transAxes, ha="right", va="bottom", fontsize="x-small", color="0.3", parse_math=False)
	if upper.get_legend_handles_labels()[0]:
		upper.legend(frameon=False, fontsize="small")

	middle.plot(strain, column("volumetric_strain_radius", 100), color="#b5541c", lw=1.8, label="from the mean radius (Eq. 6)")
	middle.plot(strain, column("volumetric_strain_volume", 100), color="#1f4e79", lw=1.4, ls="--", label="from the enclosed volume")
	middle.axhline(0, color="0.6", lw=0.8, zorder=0)
	middle.set_ylabel("volumetric strain [%]\n(dilation positive)")
	middle.legend(frameon=False, fontsize="small")

	target = column("sigma3_target", 1e-3)
	lower.plot(strain, column("sigma3_transmitted_group3", 1e-3), color="#1f4e79", lw=1.4, label="transmitted, group 3")
	lower.plot(strain, column("sigma3_transmitted_all", 1e-3), color="#b5541c", lw=1.2, ls="--", label="transmitted, all")
	lower.plot(strain, column("soil_radial", 1e-3), color="#7a5195", lw=1.2, label="radial stress of the soil")
	lower.plot(strain, column("sigma3_applied", 1e-3), color="#3a7d44", lw=1.0, label="applied")
	lower.plot(strain, target, color="0.25", lw=1.0, label="target")
	low, high = [0.95 * p for p in target], [1.05 * p for p in target]
	lower.fill_between(strain, low, high, color="0.94", zorder=0, label="target \N{PLUS-MINUS SIGN} 5 %")
	lower.margins(y=0.45)
	lower.set_ylabel("confining pressure [kPa]")
	lower.set_xlabel("axial strain [%]")
	lower.legend(frameon=False, fontsize="small", ncols=3, loc="upper center", columnspacing=1.2)
	for axes in (upper, middle, lower):
		axes.grid(color="0.92")
		axes.set_axisbelow(True)
		axes.spines[["top", "right"]].set_visible(False)
	upper.set_xlim(0, max(strain) or None)
	upper.set_ylim(bottom=min(0, min(column("q", 1e-3))))

	pngPath = pathlib.Path(pngPath)
	part = pngPath.with_name(pngPath.name + ".part")
	figure.savefig(part, dpi=150, format="png", metadata={"Software": "hexmembrane"})
	part.replace(pngPath)
	return figure
