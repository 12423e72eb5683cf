# SPDX-License-Identifier: GPL-2.0-or-later
"""What the study's choices change: means over packings, and differences from a reference by pairs of tests of the same packing.

	scripts/yade -x examples/paper/study/compare.py STUDY OUT

STUDY: the folder of scripts/sweep of study.yaml; tests that are not done are left out. OUT/compare.csv: a row a case and quantity: mean, its 95 % half width, the
mean difference from the reference and its 95 % half width, both of pairs by seed. OUT/compare.png: the differences as points with intervals. Printed: a table a
comparison, the mean and behind it the difference.

A difference is told ("differs", bold in the tables) where its interval leaves out zero. Of many at once, one in twenty is told by chance.
"""

import argparse
import collections
import csv
import json
import math
import pathlib
import sys

import numpy
from hexmembrane.configuration import Config, schema
from hexmembrane.output import records, tables
from hexmembrane.report.summary import halfWidth, quantities
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

#: A proportional limit is q where it has left the line through its first LINE of strain by LEFT of that line.
LINE, LEFT = 0.002, 0.1
#: Quantity -> (factor to the unit told, unit, whether its difference is relative). processor_seconds: consolidation, of its own or shared, and shear.
TOLD = {
	"peak_q": (1e-3, "kPa", True),
	"strain_at_peak": (100, "%", False),
	"proportional_limit": (1e-3, "kPa", True),
	"end_q": (1e-3, "kPa", True),
	"end_volumetric_strain": (100, "%", False),
	"end_porosity": (1, "-", False),
	"processor_seconds": (1, "s", True),
}
#: Unit of an absolute difference of what has a unit: percentage points are no relative difference.
POINTS = {"%": "points"}
#: What is drawn.
DRAWN = ("peak_q", "proportional_limit", "end_q", "end_volumetric_strain")
OWN = {"consolidation.pressure": "100000.0", "membrane.particleRadius": "0.00075"}
SETTINGS = ("centre", "cube", "open loop", "centre in an open loop", "equal springs", "damping", "fixed rings", "no bending", "axial by platen", "as the study")
#: Comparison -> (sets, what names a case, what a case and its reference share, values of the reference, its set).
COMPARISONS = {
	"boundary": (("boundary",), ("boundary",), ("consolidation.pressure",), {"boundary": "membrane"}, "boundary"),
	"size": (("size", "finest"), ("membrane.particleRadius",), ("consolidation.pressure",), {"membrane.particleRadius": "0.00025"}, "finest"),
	"porosity": (("porosity",), ("boundary",), ("specimen.porosity",), {"boundary": "membrane"}, "porosity"),
	"densest": (("densest",), ("boundary",), (), {"boundary": "membrane"}, "densest"),
	"settings": (SETTINGS, ("set",), (), OWN, "size"),
}


def proportionalLimit(strain, q):
	"""q [Pa] where it has left the line through its values at 0 and LINE of strain by LEFT; nan: it never does."""
	slope = (numpy.interp(LINE, strain, q) - q[0]) / LINE
	over = q - q[0] - (1 - LEFT) * slope * strain
	left = numpy.flatnonzero((strain > LINE) & (over < 0))
	if not len(left):
		return numpy.nan
	row = left[0]
	share = over[row - 1] / (over[row - 1] - over[row])
	return float(q[row - 1] + share * (q[row] - q[row - 1]))


def processorSeconds(study, stages):
	"""What the stages of a test took after its packing [s]."""
	results = (study / "stages" / name / "result.json" for stage, name in stages.items() if stage != "specimen")
	return sum(json.loads(path.read_text(encoding="utf-8"))["processor_seconds"] for path in results)


def told(path, seconds):
	"""The quantities TOLD of a test's records, in their units."""
	table = records.read(path)
	shear = records.sheared(table)
	table = {name: column[shear] for name, column in table.items() if name != "stage"}
	values = {**quantities(table), "proportional_limit": proportionalLimit(table["axial_strain"], table["q"]), "processor_seconds": seconds}
	return {name: factor * values[name] for name, (factor, _, _) in TOLD.items()}


def read(study):
	"""The done tests: rows of runs.csv with ``told``."""
	with open(study / "runs.csv", encoding="utf-8", newline="") as file:
		rows = [row for row in csv.DictReader(file) if row["status"] == "done"]
	stages = {run["name"]: run["stages"] for run in json.loads((study / "plan.json").read_text(encoding="utf-8"))["runs"]}
	for row in rows:
		row["told"] = told(study / row["folder"] / "records.csv", processorSeconds(study, stages[row["run"]]))
	return rows


def named(key, value):
	"""A value of a case, a text of runs.csv, as it is told, such as '100 kPa'."""
	try:
		return schema.told(Config, key, float(value))
	except ValueError:  # a set's name, a boundary
		return value


def compared(name, tests):
	"""The rows of a comparison, a case and a quantity each, in the order of the study."""
	sets, naming, shared, reference, its = COMPARISONS[name]
	bases = {(*(test[key] for key in shared), test["seed"]): test for test in tests if test["set"] == its and all(test[key] == value for key, value in reference.items())}
	cases = collections.defaultdict(list)
	for test in tests:
		if test["set"] in sets:
			cases[*(test[key] for key in shared), *(test[key] for key in naming)].append(test)
	for case, of in cases.items():
		pairs = [(test, bases[key]) for test in of if (key := (*(test[key] for key in shared), test["seed"])) in bases and bases[key] is not test]
		for quantity, (_, unit, relative) in TOLD.items():
			values = numpy.array([test["told"][quantity] for test in of])
			row = {"comparison": name, "case": ", ".join(map(named, (*shared, *naming), case)), "quantity": quantity, "unit": unit, "tests": len(of), "mean": values.mean(), "half_width": float(halfWidth(values))}
			change = numpy.array([a["told"][quantity] - b["told"][quantity] for a, b in pairs])
			if relative:
				change = 100 * change / numpy.array([b["told"][quantity] for _, b in pairs])
			some = len(change) > 1
			row.update(pairs=len(pairs), difference_unit="%" if relative else POINTS.get(unit, unit), difference=change.mean() if some else numpy.nan)
			row["difference_half_width"] = float(halfWidth(change)) if some else numpy.nan
			row["differs"] = ("yes" if abs(row["difference"]) > row["difference_half_width"] else "no") if some else "-"
			yield row


def draw(rows, path):
	"""A row of panels a comparison that has differences, a column a quantity of DRAWN: the difference with its interval."""
	names = [name for name in COMPARISONS if any(row["comparison"] == name and row["pairs"] > 1 for row in rows)]
	if not names:
		return
	cases = {name: list(dict.fromkeys(row["case"] for row in rows if row["comparison"] == name and row["pairs"] > 1)) for name in names}
	figure = Figure(figsize=(3.1 * len(DRAWN) + 1, 0.24 * sum(map(len, cases.values())) + 0.8 * len(names) + 0.6), layout="constrained")
	FigureCanvasAgg(figure)
	panels = figure.subplots(len(names), len(DRAWN), squeeze=False, height_ratios=[len(cases[name]) + 1 for name in names])
	for name, line in zip(names, panels):
		for quantity, axes in zip(DRAWN, line):
			of = [row for row in rows if (row["comparison"], row["quantity"]) == (name, quantity) and row["pairs"] > 1]
			place = [cases[name].index(row["case"]) for row in of]
			for row, at in zip(of, place):
				axes.errorbar(row["difference"], at, xerr=row["difference_half_width"], fmt="o", ms=4, capsize=2, color="#1f4e79", mfc="#1f4e79" if row["differs"] == "yes" else "white")
			axes.axvline(0, color="0.5", lw=0.8)
			axes.set_ylim(len(cases[name]) - 0.5, -0.5)
			axes.set_yticks(range(len(cases[name])), cases[name] if quantity == DRAWN[0] else [], fontsize="x-small")
			axes.tick_params(axis="x", labelsize="x-small")
			axes.grid(color="0.92", axis="x")
			axes.spines[["top", "right"]].set_visible(False)
			axes.set_title(f"{name}: {quantity.replace('_', ' ')} [{of[0]['difference_unit']}]", fontsize="x-small")
	figure.savefig(path, dpi=110, metadata={"Software": "hexmembrane"})


def written(mean, half, sign=""):
	"""'MEAN +- HALF' with two digits of the half width; without one, four of the mean."""
	if not math.isfinite(half) or half <= 0:
		return f"{mean:{sign}.4g}"
	decimals = max(0, 1 - math.floor(math.log10(half)))
	return f"{round(mean, decimals) + 0.0:{sign}.{decimals}f} +- {half:.{decimals}f}"  # + 0.0: no minus before 0


def cell(row):
	"""The mean, and the difference in brackets where there is one, bold where it is told."""
	text = written(row["mean"], row["half_width"])
	if row["pairs"] < 2:
		return text
	unit = row["difference_unit"] if row["difference_unit"] in ("%", *POINTS.values()) else ""
	change = f"({written(row['difference'], row['difference_half_width'], '+')} {unit}".rstrip() + ")"
	return f"{text} **{change}**" if row["differs"] == "yes" else f"{text} {change}"


def table(rows):
	"""Lines of a comparison's table in Markdown: a row a case, a column a quantity."""
	yield f"| {rows[0]['comparison']} | tests | " + " | ".join(f"{name.replace('_', ' ')} [{unit}]" for name, (_, unit, _) in TOLD.items()) + " |"
	yield "| --- " * (len(TOLD) + 2) + "|"
	for case in dict.fromkeys(row["case"] for row in rows):
		of = [row for row in rows if row["case"] == case]
		yield f"| {case} | {of[0]['tests']} | " + " | ".join(map(cell, of)) + " |"


def main(argv):
	parser = argparse.ArgumentParser(prog="compare.py", description="Means and differences of the study's tests.")
	parser.add_argument("study", metavar="STUDY", type=pathlib.Path, help="the folder of scripts/sweep")
	parser.add_argument("out", metavar="OUT", type=pathlib.Path)
	arguments = parser.parse_args(argv)
	tests = read(arguments.study) if (arguments.study / "runs.csv").is_file() else []
	rows = [row for name in COMPARISONS for row in compared(name, tests)]
	if not rows:
		parser.exit(1, f"compare.py: {arguments.study}: no test is done; fix: give the folder of a scripts/sweep of study.yaml that has ended\n")
	arguments.out.mkdir(parents=True, exist_ok=True)
	tables.writeRows(arguments.out / "compare.csv", rows)
	draw(rows, arguments.out / "compare.png")
	for name in dict.fromkeys(row["comparison"] for row in rows):
		print("\n".join(table([row for row in rows if row["comparison"] == name])), end="\n\n")


if __name__ == "__main__":
	main(sys.argv[1:])
