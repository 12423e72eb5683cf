# SPDX-License-Identifier: GPL-2.0-or-later
"""Looks inside the study's specimen: bands, clouds, curves inside and outside, of tests over several packings; prints the table of bands.

	scripts/yade -x examples/paper/inside_figure.py OUT [--pressures 50 100 150] [--seeds 1 2 3 4 5] [--short]

OUT/NAME-sSEED: each test, flexible-100-s1 say; one that is not there is run first, 4 to 8 minutes of one core. A test that was stopped goes on from its checkpoint.
OUT/clouds-PRESSURE-sSEED: clouds at the start, at 8 and at 15 %, flexible over rigid with one colour scale, on the section of each test's band.
OUT/curves-NAME-sSEED.png: stress and strain of the regions inside and outside the band, where there is one. OUT/bulge-NAME-sSEED.png: r(z).
With --short the tests are two of 300 coarse grains at 150 kPa, to 2 % of strain: seconds, to see that all of it works.
"""

import argparse
import pathlib
import sys

import hexmembrane
import numpy
from hexmembrane import configuration
from hexmembrane.measure import bands
from hexmembrane.output import clouds, groups, tables
from hexmembrane.run import checkpoints, run
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from yade import O

HERE = pathlib.Path(hexmembrane.__file__).resolve().parents[2] / "examples" / "paper"
KINDS = ("flexible", "rigid")
MEASURE = {"bands": True, "replicates": 50, "strains": [0, 0.08, 0.15], "spacing": 0.006, "radius": 0.006, "slices": 24}
SHORT = {
	"specimen": {"grains": 300, "porosity": 0.44},
	"membrane": {"particleRadius": 2.5e-3, "thickness": 1.0e-3},  # as much thicker as the grains are larger
	"shear": {"strain": 0.02, "velocity": 0.08},
	"consolidation": {"unbalanced": 5e-3, "tolerance": 0.1},
	"output": {"records": 10, "vtkEvery": 0, "checkpointEvery": 0},
	"measure": {"replicates": 3, "strains": [0, 0.01, 0.02], "spacing": 0.012, "radius": 0.01, "slices": 6},
}


def provide(kind, pressure, seed, out, short):
	"""The folder of a test, which is run or resumed when it has not come to its end."""
	folder = out / f"{kind}-{pressure}-s{seed}"
	if not (folder / "sheared.yade.gz").is_file():
		config = configuration.load(HERE / f"{kind}-{pressure}.yaml")
		config = configuration.derived(config, {"specimen": {"seed": seed}, "measure": MEASURE})
		O.reset()
		run(configuration.derived(config, SHORT) if short else config, folder, resume=checkpoints.exist(folder), quiet=True)
	return folder


def line(folder):
	"""One line of the table: the last step that was a band, else the last step."""
	table = tables.read(folder / "bands.csv", ("verdict",))
	first = table["plane"] == 0
	verdicts = [verdict for verdict, kept in zip(table["verdict"], first) if kept]
	found = numpy.array([verdict in ("band", "pair") for verdict in verdicts])
	one = {name: values[first] for name, values in table.items() if name != "verdict"}
	k = int(numpy.flatnonzero(found)[-1]) if found.any() else len(found) - 1
	begins = bands.onset(one["axial_strain"] - one["increment"] / 2, one["index"], found)

	def interval(name, digits):
		return f"{one[name][k]:.{digits}f} ({one[f'{name}_low'][k]:.{digits}f} to {one[f'{name}_high'][k]:.{digits}f})"

	cells = [folder.name, ", ".join(f"{verdicts.count(name)} {name}" for name in ("none", "barrel", "band", "pair")), f"{100 * one['axial_strain'][k]:.0f} %", interval("index", 2)]
	if found.any():
		cells += [interval("dip", 0), interval("azimuth", 0), f"{one['thickness_d50'][k]:.1f}", "/".join(f"{one[f'dip_{by}'][k]:.0f}" for by in ("coulomb", "roscoe", "arthur"))]
		cells += ["never for good" if numpy.isnan(begins) else f"{100 * begins:.1f} %", f"{one['start_porosity_inside'][k]:.4f}, {one['start_porosity_outside'][k]:.4f}"]
	else:
		cells += ["-"] * 6
	return "| " + " | ".join(cells) + " |"


def bulge(folder, path):
	"""Draw the radius along the height at each kept strain."""
	table = tables.read(folder / "profile.csv")
	figure = Figure(figsize=(4.2, 5.2), layout="constrained")
	FigureCanvasAgg(figure)
	axes = figure.subplots()
	steps = numpy.unique(table["step"])
	for k, step in enumerate(steps[:: max(1, len(steps) // 6)]):
		row = table["step"] == step
		axes.plot(1e3 * table["radius"][row], 1e3 * table["height"][row], color=(0.1, 0.2 + 0.1 * k, 0.7 - 0.1 * k), label=f"{100 * table['axial_strain'][row][0]:.1f} %")
	axes.set_xlabel("radius [mm]")
	axes.set_ylabel("height [mm]")
	axes.set_title(folder.name)
	axes.legend(frameon=False, fontsize="small")
	axes.grid(color="0.92")
	figure.savefig(path, dpi=110)


def main(argv):
	parser = argparse.ArgumentParser(prog="inside_figure.py", description="Bands, clouds and curves of the study's tests.")
	parser.add_argument("out", metavar="OUT", type=pathlib.Path)
	parser.add_argument("--pressures", type=int, nargs="+", default=[50, 100, 150])
	parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
	parser.add_argument("--short", action="store_true", help="two tests of 300 grains to 2 %% of strain")
	arguments = parser.parse_args(argv)
	out, strains = arguments.out, (SHORT if arguments.short else {"measure": MEASURE})["measure"]["strains"]
	print("| test | steps | at | index | dip | azimuth | thickness/d50 | Coulomb/Roscoe/Arthur | onset | porosity at the start inside, outside |")
	print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |", flush=True)
	for pressure in (150,) if arguments.short else arguments.pressures:
		for seed in (1,) if arguments.short else arguments.seeds:
			folders = [provide(kind, pressure, seed, out, arguments.short) for kind in KINDS]
			for folder in folders:
				print(line(folder), flush=True)
				bulge(folder, out / f"bulge-{folder.name}.png")
				try:
					groups.plot(folder, out / f"curves-{folder.name}.png", title=folder.name)
				except ValueError as error:  # no band, or no region inside or outside it
					print(f"{folder.name}: {error}", file=sys.stderr)
			clouds.draw(folders, out / f"clouds-{pressure}-s{seed}", strains)


if __name__ == "__main__":
	main(sys.argv[1:])
