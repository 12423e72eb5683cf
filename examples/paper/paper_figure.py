# SPDX-License-Identifier: GPL-2.0-or-later
"""Draws results.png from the six tests of this folder and prints the table of README.md.

	scripts/yade -x examples/paper/paper_figure.py OUT PICTURE [--short]

OUT: folder with flexible-50 .. rigid-150 as ``scripts/run examples/paper/NAME.yaml --out OUT/NAME`` leaves them. A test that is
not there is run first, 3 to 5 minutes of one core each. With --short the tests are two of 300 coarse grains at 150 kPa, to 1 % of
strain: seconds, to see that all of it works.
"""

import argparse
import pathlib
import sys

import hexmembrane
import numpy
from hexmembrane import configuration
from hexmembrane.output import records
from hexmembrane.run import run
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from yade import O

HERE = pathlib.Path(hexmembrane.__file__).resolve().parents[2] / "examples" / "paper"
STYLES = {"flexible": "-", "rigid": "--"}
COLOURS = {50: "#1f4e79", 100: "#b5561c", 150: "#3a7d44"}
SHORT = {
	"specimen": {"grains": 300, "porosity": 0.44},
	"membrane": {"particleRadius": 2.5e-3, "thickness": 1.0e-3},  # as much thicker as the grains are larger
	"shear": {"strain": 0.01, "velocity": 0.08},
	"consolidation": {"unbalanced": 5e-3, "tolerance": 0.1},
	"output": {"records": 10, "vtkEvery": 0, "checkpointEvery": 0},
}


def provide(name, folder, short):
	"""The records of a test, which is run when its folder does not have them all."""
	if not (folder / "sheared.yade.gz").is_file():
		config = configuration.load(HERE / f"{name}.yaml")
		O.reset()
		run(configuration.derived(config, SHORT) if short else config, folder, quiet=True)
	return records.read(folder / "records.csv")


def line(name, table, start, shear):
	"""One line of the table."""
	peak = int(numpy.argmax(shear["q"]))
	target = shear["sigma3_target"][0]
	arrives = 100 * shear["sigma3_transmitted_group3"] / target
	without = arrives - 100 * shear["sigma3_membrane"] / target
	q, cell = 1e-3 * shear["q"], 1e-3 * shear["q_cell"]
	volumetric = [100 * shear[f"volumetric_strain_{source}"][-1] for source in ("radius", "volume")]
	cells = (
		name,
		f"{table['porosity'][start - 1]:.4f}",
		f"{q[peak]:.0f} kPa at {100 * shear['axial_strain'][peak]:.1f} %",
		f"{q[-1]:.0f}",
		f"{cell.max():.0f}, {cell[-1]:.0f}",
		f"{volumetric[0]:+.1f} %, {volumetric[1]:+.1f} %",
		f"{arrives.min():.2f} to {arrives.max():.2f} %",
		f"{without.min():.2f} to {without.max():.2f} %",
		f"{numpy.abs(shear['energy_error']).max():.0e}",
		f"{shear['elapsed'][-1] / 60:.1f} min",
	)
	return "| " + " | ".join(cells) + " |"


def main(argv):
	parser = argparse.ArgumentParser(prog="paper_figure.py", description="Draws the study's six tests and prints their table.")
	parser.add_argument("out", metavar="OUT", type=pathlib.Path)
	parser.add_argument("picture", metavar="PICTURE", type=pathlib.Path)
	parser.add_argument("--short", action="store_true", help="two tests of 300 grains to 1 %% of strain")
	arguments = parser.parse_args(argv)
	figure = Figure(figsize=(7, 8), layout="constrained")
	FigureCanvasAgg(figure)
	upper, lower = figure.subplots(2, 1, sharex=True)
	for pressure in (150,) if arguments.short else COLOURS:
		for kind, style in STYLES.items():
			name = f"{kind}-{pressure}"
			table = provide(name, arguments.out / name, arguments.short)
			start = table["stage"].index("shear")
			shear = {key: column[start:] for key, column in table.items()}
			strain = 100 * shear["axial_strain"]
			upper.plot(strain, 1e-3 * shear["q"], style, color=COLOURS[pressure], label=f"{kind}, {pressure} kPa")
			lower.plot(strain, 100 * shear["volumetric_strain_volume"], style, color=COLOURS[pressure])
			print(line(name, table, start, shear), flush=True)
	upper.set_ylabel("deviatoric stress q [kPa]")
	upper.legend(ncols=3, frameon=False, loc="upper center", fontsize="small")
	upper.set_ylim(0, 1.25 * upper.get_ylim()[1])
	lower.set_ylabel("volumetric strain, enclosed volume [%]\n(dilation positive)")
	lower.set_xlabel("axial strain [%]")
	for axes in (upper, lower):
		axes.grid(color="0.92")
	figure.savefig(arguments.picture, dpi=110)


if __name__ == "__main__":
	main(sys.argv[1:])
