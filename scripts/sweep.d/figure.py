# SPDX-License-Identifier: GPL-2.0-or-later
"""A study's figure: q and volumetric strain against axial strain, the mean over seeds with the band of its interval; a column of panels for each value of the last axis.

Lists of stages pass through a strain several times: of a study that has one, the curve of each test is drawn.
"""

import collections

import numpy
from hexmembrane.configuration import Config, schema
from hexmembrane.report.summary import CONFIDENCE, halfWidth
from results import endsOf, group
from studyfile import SET

#: Strains at which curves are averaged; columns of panels at most, with more there is one; lines that a legend names at most.
_POINTS, _MOST_COLUMNS, _MOST_NAMED = 201, 6, 10
_LINES = (("q", 1e-3, "deviatoric stress of the soil q [kPa]"), ("volumetric_strain_volume", 100, "volumetric strain [%]\n(dilation positive)"))


def _short(key, value):
	"""A value of an axis as it is named in the figure, such as 'pressure 50 kPa'."""
	return f"{key.rpartition('.')[2]} {schema.told(Config, key, value)}"


def drawAll(plan, rows, folder):
	"""Draw study.png, or study-SET.png for each set of a study of sets."""
	if plan["axes"][:1] != [SET]:
		draw(plan, rows, folder / "study.png")
		return
	for name in dict.fromkeys(run["values"][SET] for run in plan["runs"]):
		own = [row for row in rows if row[0]["values"][SET] == name]
		axes = list(plan["study"]["sets"][name].get("axes") or {})
		draw({**plan, "axes": axes, "title": f"{plan['title']}: {name}"}, own, folder / f"study-{name.replace(' ', '-')}.png")


def draw(plan, rows, path):
	"""Draw the done runs among ``rows``, as :func:`results.gather` has them, into a PNG file (by temporary name and rename); nothing without any."""
	from matplotlib import colormaps
	from matplotlib.backends.backend_agg import FigureCanvasAgg
	from matplotlib.figure import Figure

	curves = collections.defaultdict(list)
	for run, _, _, table in rows:
		if table:
			curves[group(plan, run)].append(table)
	if not curves:
		return
	last = list(dict.fromkeys(values[-1] for values in curves)) if len(plan["axes"]) > 1 else []
	columns = last if 0 < len(last) <= _MOST_COLUMNS else [None]
	names = list(dict.fromkeys(values[:-1] if columns != [None] else values for values in curves))
	figure = Figure(figsize=(max(7.0, 3.6 * len(columns)), 7.2), layout="constrained")
	FigureCanvasAgg(figure)
	panels = figure.subplots(2, len(columns), sharex=True, sharey="row", squeeze=False)
	colours = colormaps["viridis"](numpy.linspace(0.0, 0.88, len(names)))
	staged = bool(endsOf(plan))
	for values, tables in curves.items():
		column, name = (columns.index(values[-1]), values[:-1]) if columns != [None] else (0, values)
		strain = numpy.linspace(0, min(table["axial_strain"][-1] for table in tables), _POINTS)
		label = ", ".join(_short(key, value) for key, value in zip(plan["axes"], name))
		for row, (what, factor, _) in enumerate(_LINES):
			colour, told = colours[names.index(name)], f"{label} ({len(tables)})" if label else f"{len(tables)} tests"
			if staged:
				for k, table in enumerate(tables):
					panels[row][column].plot(100 * table["axial_strain"], factor * table[what], color=colour, lw=1.0, label="" if k else told)
				continue
			each = numpy.array([numpy.interp(strain, table["axial_strain"], factor * table[what]) for table in tables])
			mean, half = each.mean(axis=0), halfWidth(each)
			panels[row][column].plot(100 * strain, mean, color=colour, lw=1.5, label=told)
			if len(tables) > 1:
				panels[row][column].fill_between(100 * strain, mean - half, mean + half, color=colour, alpha=0.22, lw=0)
	for column, value in enumerate(columns):
		if value is not None:
			panels[0][column].set_title(_short(plan["axes"][-1], value), fontsize="medium")
		panels[1][column].set_xlabel("axial strain [%]")
	for row, (_, _, label) in enumerate(_LINES):
		panels[row][0].set_ylabel(label)
		for axes in panels[row]:
			axes.grid(color="0.92")
			axes.set_axisbelow(True)
			axes.spines[["top", "right"]].set_visible(False)
	if len(names) <= _MOST_NAMED:
		panels[0][0].legend(frameon=False, fontsize="small")
	figure.suptitle(plan["title"] + ("" if staged else f": mean over seeds and its {100 * CONFIDENCE:g} % interval"))
	part = path.with_name(path.name + ".part")
	figure.savefig(part, dpi=150, format="png", metadata={"Software": "hexmembrane"})
	part.replace(path)
