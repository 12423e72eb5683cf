# SPDX-License-Identifier: GPL-2.0-or-later
"""Draws examples/paper/results.png from the six tests of that folder and prints the table of its README.

	scripts/yade scripts/paper_figure.py OUT PICTURE

OUT holds flexible-50 .. rigid-150 as ``scripts/run examples/paper/NAME.yaml --out OUT/NAME`` leaves them.
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as pyplot  # noqa: E402
import numpy  # noqa: E402

import hexmembrane  # noqa: F401, E402
from hexmembrane import records  # noqa: E402

STYLES = {"flexible": "-", "rigid": "--"}
COLOURS = {50: "#1f4e79", 100: "#b5561c", 150: "#3a7d44"}


def line(name, table, start, shear):
	"""One line of the table."""
	peak = int(numpy.argmax(shear["q"]))
	target = shear["sigma3_target"][0]
	arrives = 100 * shear["sigma3_transmitted_group3"] / target
	own = 100 * shear["sigma3_membrane"] / target
	return (
		f"| {name} | {table['porosity'][start - 1]:.4f} | {1e-3 * shear['q'][peak]:.0f} kPa at {100 * shear['axial_strain'][peak]:.1f} % | {1e-3 * shear['q'][-1]:.0f} | "
		f"{1e-3 * shear['q_corrected'].max():.0f}, {1e-3 * shear['q_corrected'][-1]:.0f} | "
		f"{100 * shear['volumetric_strain_radius'][-1]:+.1f} %, {100 * shear['volumetric_strain_volume'][-1]:+.1f} % | {arrives.min():.2f} to {arrives.max():.2f} % | "
		f"{(arrives - own).min():.2f} to {(arrives - own).max():.2f} % | {numpy.abs(shear['energy_error']).max():.0e} | {shear['elapsed'][-1] / 60:.1f} min |"
	)


def main(out, picture):
	figure, (top, bottom) = pyplot.subplots(2, 1, figsize=(7, 8), sharex=True, layout="constrained")
	for pressure, colour in COLOURS.items():
		for kind, style in STYLES.items():
			name = f"{kind}-{pressure}"
			table = records.read(pathlib.Path(out) / name / "records.csv")
			start = table["stage"].index("shear")
			shear = {key: column[start:] for key, column in table.items()}
			strain = 100 * shear["axial_strain"]
			top.plot(strain, 1e-3 * shear["q"], style, color=colour, label=f"{kind}, {pressure} kPa")
			bottom.plot(strain, 100 * shear["volumetric_strain_volume"], style, color=colour)
			print(line(name, table, start, shear))
	top.set_ylabel("deviatoric stress q [kPa]")
	top.legend(ncols=3, frameon=False, loc="upper center", fontsize="small")
	top.set_ylim(0, 1.25 * top.get_ylim()[1])
	bottom.set_ylabel("volumetric strain, enclosed volume [%]\n(dilation positive)")
	bottom.set_xlabel("axial strain [%]")
	for axes in (top, bottom):
		axes.grid(color="0.92")
	figure.savefig(picture, dpi=110)


if __name__ == "__main__":
	main(*sys.argv[1:3])
