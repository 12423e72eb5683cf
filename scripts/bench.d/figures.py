# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of the study of accuracy, from curves.csv alone: error against cost, one picture a quantity and one panel a knob.

	accuracy.py figures FOLDER

The band is the scatter between packings of the base test: an error well inside it is no reason for a slower test of one packing.
"""

import argparse
import math
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plot  # noqa: E402
import table  # noqa: E402
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter  # noqa: E402

#: Quantity -> (file, what an error of 1 is called).
PICTURES = {
	"q at 1 %": ("q-early.png", "%"),
	"peak q": ("q-peak.png", "%"),
	"mean q from 10 to 15 %": ("q-late.png", "%"),
	"volumetric strain at 15 %": ("volume.png", "points"),
}
COLUMNS = 4


def read(path):
	"""Rows of curves.csv as dicts, numbers as numbers.

	:raises SystemExit: there is no such file.
	"""
	if not path.is_file():
		raise SystemExit(f"figures: '{path}': there is no such file; fix: run the study first")
	texts = ("knob", "value", "quantity", "paired")
	return [{name: cell if name in texts else float(cell) for name, cell in row.items()} for row in table.read(path)]


def picture(rows, quantity, unit, path):
	"""Draw the knobs that a quantity has two levels or more of; False when there are none."""
	of = [row for row in rows if row["quantity"] == quantity and not math.isnan(row["time"])]
	names = [row["knob"] for row in of]
	knobs = [name for name in dict.fromkeys(names) if names.count(name) > 1]
	if not knobs:
		return False
	band = 100 * next((row["scatter"] for row in of if row["knob"] == "packings"), math.nan)
	down = math.ceil(len(knobs) / COLUMNS)
	figure, panels = plot.subplots(down, COLUMNS, figsize=(4 * COLUMNS, 3 * down), squeeze=False, layout="constrained")
	for panel in panels.flat[len(knobs) :]:
		panel.set_axis_off()
	for panel, knob in zip(panels.flat, knobs):
		levels = [row for row in of if row["knob"] == knob]
		half = [0.0 if math.isnan(row["half_width"]) else 100 * row["half_width"] for row in levels]
		if not math.isnan(band):
			panel.axhspan(-band, band, color="0.9")
		panel.axhline(0, color="0.6", linewidth=0.8)
		panel.errorbar([row["time"] for row in levels], [100 * row["mean"] for row in levels], half, fmt="o", markersize=4, capsize=3, color="black")
		for row in levels:
			panel.annotate(row["value"], (row["time"], 100 * row["mean"]), xytext=(4, 4), textcoords="offset points", fontsize=8)
		panel.set(title=knob, xscale="log")
		panel.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
		panel.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
		panel.xaxis.set_minor_formatter(NullFormatter())
		panel.margins(x=0.15)
	figure.suptitle(f"{quantity}: mean difference from the reference and its 95 % interval; band: scatter between packings")
	figure.supxlabel("wall clock over that of the base test")
	figure.supylabel(f"difference [{unit}]")
	figure.savefig(path, dpi=110)
	plot.close(figure)
	return True


def main(argv):
	parser = argparse.ArgumentParser(prog="accuracy figures", description="Pictures of the study of accuracy.")
	parser.add_argument("folder", metavar="FOLDER", type=pathlib.Path)
	folder = parser.parse_args(argv).folder
	rows = read(folder / "curves.csv")
	for quantity, (file, unit) in PICTURES.items():
		if picture(rows, quantity, unit, folder / file):
			print(f"written: {folder / file}")
