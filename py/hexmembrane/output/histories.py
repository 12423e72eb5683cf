# SPDX-License-Identifier: GPL-2.0-or-later
"""Records of a test under the names of PFC's FISH functions and of the functions of its triaxial examples, with PFC's signs; the command scripts/pfc-histories.

Stresses are negative in compression and axial strain in shortening, as PFC has them. Uses nothing of YADE.
"""

import argparse
import csv
import pathlib
import sys

import numpy

from hexmembrane.output import records

_FILE = "histories.csv"
#: Name -> (unit, what it is, its value from the columns of the records).
HISTORIES = {
	"global.cycle": ("", "cycle", lambda row: row["step"]),
	"mech.age": ("s", "mechanical time", lambda row: row["time"]),
	"wezz": ("", "axial strain of the walls, extension positive", lambda row: -row["axial_strain"]),
	"wevol": ("", "volumetric strain of the enclosed volume, dilation positive", lambda row: row["volumetric_strain_volume"]),
	"wszz": ("Pa", "axial stress on the walls: their mean force over the present mean section, tension positive", lambda row: -_force(row) * row["height"] / row["volume"]),
	"wsrr": ("Pa", "radial stress on the membrane or cylinder: transmitted pressure, tension positive", lambda row: -row["sigma3_transmitted_all"]),
	"measure.stress.zz": ("Pa", "axial stress in the soil, tension positive; of the whole soil, PFC's is of a sphere", lambda row: -row["soil_axial"]),
	"measure.stress.rr": ("Pa", "radial stress likewise, mean of xx and yy", lambda row: -row["soil_radial"]),
	"measure.porosity": ("", "porosity of the whole soil", lambda row: row["porosity"]),
	"measure.coordination": ("", "contacts with a normal force among grains, twice, over the number of grains", lambda row: row["coordination"]),
	"wall.force.contact.z.bottom": ("N", "z of the contacts' force on the bottom wall", lambda row: -row["platen_force_bottom"]),
	"wall.force.contact.z.top": ("N", "z of the contacts' force on the top wall", lambda row: row["platen_force_top"]),
}


def _force(row):
	return (row["platen_force_bottom"] + row["platen_force_top"]) / 2


def of(table):
	"""Histories of the records' columns (:func:`hexmembrane.output.records.read`): name -> array."""
	return {name: numpy.asarray(value(table), dtype=float) for name, (_, _, value) in HISTORIES.items()}


def write(folder, out=None):
	"""Write ``histories.csv`` of a test's folder, or another file; its path.

	:raises ValueError: there are no records, or they are damaged. :raises OSError: the file cannot be written.
	"""
	folder = pathlib.Path(folder)
	if not (folder / "records.csv").is_file():
		raise ValueError(f"DIR = '{folder}': has no records.csv; fix: give the output folder of a test")
	table = records.read(folder / "records.csv")
	out = pathlib.Path(out) if out else folder / _FILE
	found = of(table)
	with open(out, "w", encoding="utf-8", newline="\n") as file:
		writer = csv.writer(file, lineterminator="\n")
		writer.writerow(["stage", *found])
		for stage, *values in zip(table["stage"], *(values.tolist() for values in found.values())):
			writer.writerow([stage, *(repr(value) for value in values)])
	return out


def markdown():
	"""The table of names, for the documentation."""
	rows = [f"| `{name}` | {unit} | {meaning} |" for name, (unit, meaning, _) in HISTORIES.items()]
	return "\n".join(["| name | unit | what |", "| --- | --- | --- |", *rows])


def main(argv):
	"""The command; returns its exit code: 0, 1 for what cannot be written, 2 for a folder without records."""
	parser = argparse.ArgumentParser(prog="scripts/pfc-histories", description="Write a test's records under the names and with the signs of PFC.")
	parser.add_argument("folder", metavar="DIR", help="output folder of a test")
	parser.add_argument("--out", metavar="FILE", help=f"file to write (default: {_FILE} in the folder)")
	given = parser.parse_args(argv)
	try:
		print(write(given.folder, given.out))
	except ValueError as error:
		print(f"pfc-histories: {error}", file=sys.stderr)
		return 2
	except OSError as error:
		print(f"pfc-histories: '{error.filename}': cannot be written ({error.strerror}); fix: choose another file or free space", file=sys.stderr)
		return 1
	return 0


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
