# SPDX-License-Identifier: GPL-2.0-or-later
"""What a membrane's thickness adds, and what scaled grains do: scripts/yade -x examples/toyoura/effects.py membrane|grains CALIBRATION_FOLDER --out FOLDER.

``membrane``: one packing in a thin and in a thick membrane at low pressures, as the laboratory's tests 12, 19, 22, 29. The applied pressure is constant, as a
laboratory's cell pressure is: the membrane's hoop tension then presses on the soil as well. Told are the stress ratio of load cell and cell pressure, which has the
membrane in it, and that of the soil alone. Differences are of pairs of the same packing.

``grains``: the best set's grains, more and smaller, at the same porosity inside and the same inertial number. A wall loosens its layer: the porosity of
the cylinder is that inside plus LAYER times the walls' area times d over the volume. Platens are wider than the specimen, as a laboratory's lubricated ones are: small
grains pass the edge of narrow ones.

A second call goes on. --tables runs nothing.
"""

import argparse
import csv
import math
import pathlib
import sys

import hexmembrane
import numpy

ROOT = pathlib.Path(hexmembrane.__file__).resolve().parents[2]  # YADE runs a script without its __file__
HERE = ROOT / "examples" / "toyoura"
sys.path[:0] = [str(HERE), *(str(ROOT / "scripts" / name) for name in ("calibrate.d", "sweep.d"))]

import calibrationfile  # noqa: E402
import inside
import predict
import studyfile
import sweep
from hexmembrane.configuration import derived
from hexmembrane.laboratory import misfit
from hexmembrane.output import tables
from hexmembrane.report.summary import halfWidth
from hexmembrane.scene import specimen

#: Pressures [Pa], membranes [m], void ratio of the laboratory's four tests (0.681 to 0.687); (test in the thin, in the thick one) at each pressure.
PRESSURES, THICKNESSES, VOID, PAIRS = (4.9e3, 9.8e3), (1e-4, 3e-4), 0.685, ((12, 19), (22, 29))
#: Of the open loop's pressure that arrives in the consolidation: grains packed at 10 kPa expand into the membrane.
TOLERANCE = 0.15
#: What a thin tube's axial and hoop tension of the extra 0.2 mm adds to the stress ratio at these pressures.
THIN_TUBE = (0.38, 0.24)
#: Numbers of grains, and packings of each.
GRAINS = {600: 8, 4000: 4, 14600: 3, 49000: 1}
#: R/r of the membrane where it is not the calibration's.
SIZE_RATIO = {14600: 0.8, 49000: 0.8}
#: The platens' radius over the specimen's.
PLATENS = 1.4
#: Measured: 7,045 grains in 40 x 80 mm, 15.4 d50 across, have 0.389 in all and 0.3591 inside (pkg/specimen/README.md).
LAYER = (0.389 - 0.3591) / (4 / 15.4 + 2 / 30.8)


def membranes(base, folder, count):
	"""The tests in membranes: all conditions of a draw from the posterior, then the next draw."""
	runs = []
	for k, values in enumerate(predict.draws(folder, count)):
		for pressure in PRESSURES:
			for thickness in THICKNESSES:
				own = {**values, "specimen.porosity": predict.packed(values["specimen.porosity"], VOID), studyfile.SEED: predict.FIRST_SEED + k}
				own |= {"consolidation.pressure": pressure, "membrane.thickness": thickness, "membrane.pressureTime": math.inf, "consolidation.tolerance": TOLERANCE}
				own |= {"shear.velocity": base.shear.velocity * math.sqrt(pressure / predict.PRESSURE)}
				case = {"pressure": pressure, "thickness": thickness, "draw": k}
				runs.append(studyfile.Run(f"{1e-3 * pressure:g}-{1e3 * thickness:g}-{k}", case, predict.FIRST_SEED + k, derived(base, studyfile.nested(own))))
	return studyfile.Study("membranes", ["pressure", "thickness"], runs, 2, {})


def meanDiameter(config):
	"""Of the grains [m], by volume."""
	sizes = specimen.radii(config.specimen, config.specimen.radius, config.specimen.height)
	return 2 * float((sizes**3).mean()) ** (1 / 3)


def layered(config, diameter):
	"""What the walls' layer adds to the porosity of grains of a diameter [m]."""
	return LAYER * diameter * (2 / config.specimen.radius + 2 / config.specimen.height)


def best(folder):
	"""The best set's parameters, {key: value}."""
	with open(pathlib.Path(folder) / "sets.csv", encoding="utf-8") as file:
		rows = list(csv.DictReader(file))
	row = max((row for row in rows if not row["failed"]), key=lambda row: float(row["log_likelihood"]))
	return {key: float(row[key]) for key in row if key not in ("set", "log_likelihood", "weight", "failed")}


def scaled(base, folder, wanted, slower=1.0):
	"""The tests of scaled grains; ``wanted``: number of grains -> packings; ``slower``: what all velocities are divided by."""
	values, runs = best(folder), []
	first = derived(base, studyfile.nested(values))
	diameter, inner = meanDiameter(first), values["specimen.porosity"] - layered(first, meanDiameter(first))
	for grains, packings in wanted.items():
		d = diameter * (first.specimen.grains / grains) ** (1 / 3)
		for k in range(packings):
			own = {**values, "specimen.grains": grains, "specimen.porosity": inner + layered(first, d), studyfile.SEED: predict.FIRST_SEED + k}
			own |= {"shear.velocity": base.shear.velocity * diameter / d / slower, "platens.radius": PLATENS * base.specimen.radius}
			if grains in SIZE_RATIO:
				own["membrane.sizeRatio"] = SIZE_RATIO[grains]
			case = {"grains": grains, "across": 2 * first.specimen.radius / d, "packing": k}
			runs.append(studyfile.Run(f"{grains}-{k}", case, predict.FIRST_SEED + k, derived(base, studyfile.nested(own))))
	return studyfile.Study("scaled grains", ["grains"], runs, 2, {})


def peak(strain, ratio):
	"""Largest mean of a ratio over predict.SMOOTH of strain."""
	even = numpy.arange(strain[0], strain[-1], predict.SMOOTH / 10)
	return float(numpy.convolve(numpy.interp(even, strain, ratio), numpy.full(10, 0.1), "valid").max())


def ratios(table):
	"""(peak of sigma1/sigma3 of load cell and cell pressure, of the soil's own stresses) of a test's shear."""
	cell, own = 1 + table["q_cell"] / table["sigma3_target"], table["soil_axial"] / table["soil_radial"]
	return peak(table["axial_strain"], cell), peak(table["axial_strain"], own)


def tellMembranes(found, say):
	"""Rows of membrane.csv: a row a pressure. ``found``: {(pressure, thickness): {draw: (cell's, soil's)}}."""
	rows = []
	for pressure, pair, theory in zip(PRESSURES, PAIRS, THIN_TUBE):
		thin, thick = (found.get((pressure, thickness), {}) for thickness in THICKNESSES)
		both = sorted(set(thin) & set(thick))
		if len(both) < 2:
			say(f"{1e-3 * pressure:g} kPa: {len(both)} pairs of tests are done")
			continue
		there = [(1 + s) / (1 - s) for s in (math.sin(math.radians(predict.laboratory()[number]["angle"])) for number in pair)]
		row = {"sigma3_kPa": 1e-3 * pressure, "pairs": len(both), "laboratory": there[1] - there[0], "thin_tube": theory}
		for at, name in enumerate(("cell", "soil")):
			values = numpy.array([(thin[k][at], thick[k][at]) for k in both])
			change = values[:, 1] - values[:, 0]
			row |= {f"{name}_thin": values[:, 0].mean(), f"{name}_thick": values[:, 1].mean(), f"{name}_difference": change.mean(), f"{name}_half_width": float(halfWidth(change))}
		rows.append({key: float(value) if isinstance(value, numpy.floating) else value for key, value in row.items()})
		say(f"{rows[-1]}")
	return rows


#: Name -> (unit, its value of a test's series) of what is told of scaled grains.
TOLD = {
	"peak": ("-", lambda test: peak(test["stress_ratio"].strain, test["stress_ratio"].value)),
	"strain_at_peak": ("%", lambda test: 100 * float(test["stress_ratio"].strain[test["stress_ratio"].value.argmax()])),
	"ratio_at_12.4": ("-", lambda test: float(test["stress_ratio"].at(0.124))),
	"dilation_angle": ("deg", lambda test: misfit.dilationAngle(test["volumetric_strain"])),
	"strain_at_5": ("%", lambda test: 100 * float(test["volumetric_strain"].at(0.05))),
	"strain_at_10": ("%", lambda test: 100 * float(test["volumetric_strain"].at(0.10))),
}


def tellGrains(found, say):
	"""Rows of grains.csv: a row a number of grains and quantity, mean and half width of its 95 % interval. ``found``: {(grains, across): [series]}."""
	rows = []
	for (grains, across), tests in sorted(found.items()):
		for name, (unit, of) in TOLD.items():
			values = numpy.array([of(test) for test in tests])
			row = {"grains": grains, "across": across, "quantity": name, "unit": unit, "packings": len(values), "mean": float(values.mean())}
			rows.append({**row, "half_width": float(halfWidth(values)) if len(values) > 1 else math.nan})
			say(f"{grains} grains, {across:.1f} across: {name} {rows[-1]['mean']:.4g} +- {rows[-1]['half_width']:.2g} {unit}")
	return rows


def main(argv):
	parser = argparse.ArgumentParser(prog="effects.py")
	parser.add_argument("what", choices=("membrane", "grains"))
	parser.add_argument("calibration", metavar="CALIBRATION_FOLDER", help="what scripts/calibrate has left")
	parser.add_argument("--out", required=True, metavar="FOLDER")
	parser.add_argument("--packings", type=int, metavar="N", help="membrane: tests a condition (8); grains: at most so many of each")
	parser.add_argument("--grains", type=int, nargs="+", choices=tuple(GRAINS), help="these numbers of grains alone")
	parser.add_argument("--slower", type=float, default=1.0, metavar="FACTOR", help="grains: velocities are divided by it")
	parser.add_argument("--tables", action="store_true", help="run nothing")
	given = parser.parse_args(argv)

	def whole(say):
		base, out = calibrationfile.load(HERE / "calibration.yaml").tests["98 kPa"].config, pathlib.Path(given.out)
		if given.what == "membrane":
			wanted = membranes(base, given.calibration, given.packings or 8)
		else:
			wanted = scaled(base, given.calibration, {n: min(GRAINS[n], given.packings or GRAINS[n]) for n in given.grains or GRAINS}, given.slower)
		out.mkdir(parents=True, exist_ok=True)
		if not given.tables:
			with sweep.lock(out):
				inside.perform(wanted, out, say)
		rows = tell(given.what, wanted, out, say)
		if rows:
			tables.writeRows(out / f"{given.what}.csv", rows)
		return 0

	return sweep.guarded(whole)


def tell(what, wanted, out, say):
	"""The rows of the table; tests that are not done are told."""
	found = {}
	for one in wanted.runs:
		if inside.status(out, one) != "done":
			say(f"{one.name}: {inside.status(out, one)}")
		elif what == "membrane":
			found.setdefault((one.values["pressure"], one.values["thickness"]), {})[one.values["draw"]] = ratios(inside.table(out, one))
		else:
			found.setdefault((one.values["grains"], one.values["across"]), []).append(misfit.ofTest(inside.table(out, one)))
	return (tellMembranes if what == "membrane" else tellGrains)(found, say)


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
