# SPDX-License-Identifier: GPL-2.0-or-later
"""Looks inside the study's specimens: bands, clouds, curves inside and outside, from the set ``boundary`` of study.yaml.

	scripts/yade -x examples/paper/study/inside.py STUDY OUT

STUDY: the folder of scripts/sweep; tests that are not done are left out. OUT/tests.csv: a row a test, printed as a table; OUT/groups.csv: a row a boundary and
pressure. OUT/NAME/: clouds at the start, at 8 and at 15 %, flexible over rigid with one colour scale, on the section of each test's band, for NAME =
PRESSURE-sSEED where both are done. OUT/curves-NAME.png: stress and strain inside and outside the last band, where there is one. OUT/bulge.png: r(z) at the end.
OUT/index.png: the localisation index over strain.
"""

import argparse
import csv
import pathlib
import sys

import numpy
from hexmembrane.measure import bands
from hexmembrane.output import clouds, groups, tables
from hexmembrane.report.summary import halfWidth
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

SET = "boundary"
KINDS = {"membrane": "flexible", "wall": "rigid"}
COLOURS = {"membrane": "#1f4e79", "wall": "#b5561c"}
VERDICTS = ("none", "barrel", "band", "pair")


class Test:
	"""One done test of the study: ``kind``, ``pressure`` [kPa], ``seed``, ``folder`` and, by step, the best plane of bands.csv."""

	def __init__(self, row, study):
		self.kind, self.pressure, self.seed = row["boundary"], round(float(row["consolidation.pressure"]) / 1e3), int(row["seed"])
		self.folder = study / row["folder"]
		self.name = f"{KINDS[self.kind]}-{self.pressure}-s{self.seed}"
		table = tables.read(self.folder / "bands.csv", ("verdict",))
		first = table["plane"] == 0
		self.verdicts = [verdict for verdict, kept in zip(table.pop("verdict"), first) if kept]
		self.steps = {name: values[first] for name, values in table.items()}
		self.strain = self.steps["axial_strain"]
		self.found = numpy.array([verdict in ("band", "pair") for verdict in self.verdicts])

	def told(self):
		"""What the tables tell of the test, by name; nan: no band."""
		one = self.steps
		values = {f"steps_{name}": self.verdicts.count(name) for name in VERDICTS}
		values.update(index_largest=one["index"].max(), explained_largest=one["explained"].max())
		last = int(numpy.flatnonzero(self.found)[-1]) if self.found.any() else None
		for name in ("axial_strain", "dip", "dip_low", "dip_high", "thickness_d50", "dip_coulomb", "dip_roscoe", "dip_arthur"):
			values[f"band_{name}"] = one[name][last] if last is not None else numpy.nan
		values["onset"] = bands.onset(self.strain - one["increment"] / 2, one["index"], self.found)
		values["start_porosity_excess"] = (one["start_porosity_inside"] - one["start_porosity_outside"])[last] if last is not None else numpy.nan
		return values


def read(study):
	"""The done tests of the set, by (pressure, seed, boundary)."""
	with open(study / "runs.csv", encoding="utf-8", newline="") as file:
		rows = [row for row in csv.DictReader(file) if row["set"] == SET and row["status"] == "done"]
	return [Test(row, study) for row in rows]


def line(test, told):
	"""One line of the printed table."""
	cells = [test.name, ", ".join(f"{told[f'steps_{name}']} {name}" for name in VERDICTS), f"{told['index_largest']:.2f}"]
	if test.found.any():
		cells += [f"{100 * told['band_axial_strain']:.0f} %", f"{told['band_dip']:.0f} ({told['band_dip_low']:.0f} to {told['band_dip_high']:.0f})"]
		cells += [f"{told['band_thickness_d50']:.1f}", "/".join(f"{told[f'band_dip_{by}']:.0f}" for by in ("coulomb", "roscoe", "arthur"))]
		cells += ["not for good" if numpy.isnan(told["onset"]) else f"{100 * told['onset']:.1f} %", f"{told['start_porosity_excess']:+.4f}"]
	else:
		cells += ["-"] * 6
	return "| " + " | ".join(cells) + " |"


def grouped(tests):
	"""A row a boundary and pressure: means over packings with half widths of their 95 % intervals."""
	rows = []
	for kind, pressure in sorted({(test.kind, test.pressure) for test in tests}):
		of = [test for test in tests if (test.kind, test.pressure) == (kind, pressure)]
		told = [test.told() for test in of]
		row = {"boundary": kind, "pressure_kPa": pressure, "tests": len(of), "with_a_band": sum(bool(test.found.any()) for test in of)}
		row["band_that_stays"] = sum(not numpy.isnan(one["onset"]) for one in told)
		row.update({f"steps_{name}": sum(one[f"steps_{name}"] for one in told) for name in VERDICTS})
		largest = numpy.array([one["index_largest"] for one in told])
		row["index_largest"], row["index_largest_half_width"] = float(largest.mean()), float(halfWidth(largest)) if len(of) > 1 else numpy.nan
		rows.append(row)
	return rows


def panels(path, tests, draw, height, **labels):
	"""A figure with a panel a pressure, in which ``draw(axes, test)`` draws each test."""
	pressures = sorted({test.pressure for test in tests})
	figure = Figure(figsize=(3.6 * len(pressures) + 1, height), layout="constrained")
	FigureCanvasAgg(figure)
	for axes, pressure in zip(figure.subplots(1, len(pressures), sharex=True, sharey=True, squeeze=False)[0], pressures):
		for test in tests:
			if test.pressure == pressure:
				draw(axes, test)
		axes.set_title(f"{pressure} kPa", fontsize="medium")
		axes.set_xlabel(labels["x"])
		axes.grid(color="0.92")
		axes.spines[["top", "right"]].set_visible(False)
	figure.axes[0].set_ylabel(labels["y"])
	handles = {kind: figure.axes[0].plot([], [], color=COLOURS[kind], label=KINDS[kind])[0] for kind in COLOURS}
	figure.axes[0].legend(handles=list(handles.values()), frameon=False, fontsize="small")
	figure.savefig(path, dpi=110, metadata={"Software": "hexmembrane"})


def index(axes, test):
	"""The index of a test over strain; a ring where it is a band or a pair."""
	axes.plot(100 * test.strain, test.steps["index"], color=COLOURS[test.kind], lw=0.9, alpha=0.8)
	axes.plot(100 * test.strain[test.found], test.steps["index"][test.found], "o", mfc="none", color=COLOURS[test.kind])
	axes.axhline(bands.INDEX_LIMIT, color="0.5", lw=0.8, ls=":")


def bulge(axes, test):
	"""The radius along the height at the end, over that at the start."""
	table = tables.read(test.folder / "profile.csv")
	first, last = (table["step"] == step for step in (table["step"].min(), table["step"].max()))
	axes.plot(table["radius"][last] / table["radius"][first], table["height"][last] * 1e3, color=COLOURS[test.kind], lw=0.9, alpha=0.8)


def main(argv):
	parser = argparse.ArgumentParser(prog="inside.py", description="Bands, clouds and curves of the study's tests.")
	parser.add_argument("study", metavar="STUDY", type=pathlib.Path, help="the folder of scripts/sweep")
	parser.add_argument("out", metavar="OUT", type=pathlib.Path)
	arguments = parser.parse_args(argv)
	out, tests = arguments.out, read(arguments.study) if (arguments.study / "runs.csv").is_file() else []
	if not tests:
		parser.exit(1, f"inside.py: {arguments.study}: no test of the set '{SET}' is done; fix: give the folder of a scripts/sweep of study.yaml that has ended\n")
	out.mkdir(parents=True, exist_ok=True)
	told = [test.told() for test in tests]
	tables.writeRows(out / "tests.csv", [{"test": test.name, **one} for test, one in zip(tests, told)])
	tables.writeRows(out / "groups.csv", grouped(tests))
	print("| test | steps | largest index | last band at | dip | thickness/d50 | Coulomb/Roscoe/Arthur | onset | porosity at the start, inside less outside |")
	print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |", flush=True)
	for test, one in zip(tests, told):
		print(line(test, one), flush=True)
		if test.found.any():
			try:
				groups.plot(test.folder, out / f"curves-{test.name}.png", title=test.name)
			except ValueError as error:  # no region inside or outside the band
				print(f"{test.name}: {error}", file=sys.stderr)
	panels(out / "index.png", tests, index, 3.6, x="axial strain [%]", y="localisation index [-]")
	panels(out / "bulge.png", tests, bulge, 4.6, x="radius at the end / at the start [-]", y="height [mm]")
	for pressure, seed in sorted({(test.pressure, test.seed) for test in tests}):
		both = [test for kind in KINDS for test in tests if (test.kind, test.pressure, test.seed) == (kind, pressure, seed)]
		if len(both) == len(KINDS):
			strains = clouds.strainsOf(both[0].folder)
			clouds.draw([test.folder for test in both], out / f"{pressure}-s{seed}", strains, names=[test.name for test in both])


if __name__ == "__main__":
	main(sys.argv[1:])
