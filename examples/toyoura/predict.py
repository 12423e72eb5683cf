# SPDX-License-Identifier: GPL-2.0-or-later
"""Laboratory tests that grains were not calibrated on, predicted: scripts/yade -x examples/toyoura/predict.py CALIBRATION_FOLDER --out FOLDER [--calibration FILE] [--hertz] [--tables].

Each draw from the posterior in ``sets.csv`` is one set of parameters and one packing of its own, so an interval has both scatters in it. The draws are the
same at all conditions. A void ratio of the laboratory goes to the packing's by its relative density: from the calibrated density on, with the slope between
the void ratios that are the least and the largest of both sands. The velocity goes with the root of the pressure, so the inertial number is one.
--hertz: the grains' stiffness goes with the cube root of the pressure, as that of Hertzian contacts does; else it is one for all tests.

A second call goes on. --tables runs nothing: it writes tables and figure of the tests that are done, of a run that goes on too.
"""

import argparse
import csv
import math
import pathlib
import sys

import hexmembrane
import numpy
from scipy.stats import t as student

ROOT = pathlib.Path(hexmembrane.__file__).resolve().parents[2]  # YADE runs a script without its __file__
HERE = ROOT / "examples" / "toyoura"
sys.path[:0] = [str(ROOT / "scripts" / name) for name in ("calibrate.d", "sweep.d")]

import calibrationfile  # noqa: E402
import inside
import studyfile
import sweep
from hexmembrane.configuration import derived
from hexmembrane.laboratory.misfit import ofTest

#: Numbers of the laboratory's tests in table1.csv that are predicted, those with a curve first: other pressures, the calibrated one, other void ratios.
TESTS = (45, 66, 53, 61, 50, 70, 64, 51, 72, 55, 47, 68)
CURVES = {45: "curve-49kPa-e0.658", 53: "curve-98kPa-e0.671", 66: "curve-196kPa-e0.677"}
#: Void ratio and pressure [Pa] of the calibrated test; least and largest void ratio of Toyoura sand; the same of the packer's grains.
CALIBRATED, PRESSURE, LIMITS, OURS = 0.671, 9.8e4, (0.605, 0.977), (0.710, 1.062)
#: Void ratio of the laboratory's table of volumetric strains, and membrane of all these tests [m].
VOID, LATEX = 0.70, 3e-4
#: Strain over which a peak is a mean: a maximum of a curve of few grains is its noise.
SMOOTH = 0.01
STRAINS = 0.05, 0.10
#: Power of the pressure that the stiffness of Hertzian contacts goes with.
HERTZ = 1 / 3
FIRST_SEED = 101


def laboratory():
	"""{number: row} of table1.csv, plain numbers: pressure [Pa], void ratio, thickness of the membrane [m], peak friction angle [deg]."""
	with open(HERE / "lab" / "table1.csv", encoding="utf-8") as file:
		rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
	return {int(number): {"pressure": 1e3 * pressure, "void ratio": void, "thickness": 1e-3 * thickness, "angle": angle} for number, pressure, void, thickness, angle in rows}


def conditions():
	"""{name: what :func:`laboratory` has of a test} of all that is predicted: TESTS, and a condition "e0.70-KPA" for each pair of volumetric strains of that table."""
	found = {number: laboratory()[number] for number in TESTS}
	with open(HERE / "lab" / "volumetric-strain-e0.70.csv", encoding="utf-8") as file:
		rows = numpy.array([[float(cell) for cell in row] for row in list(csv.reader(file))[1:]])
	at = [rows[rows[:, 0] == 100 * strain][:, 1:] for strain in STRAINS]
	for pair in zip(*at):
		pressure = 1e3 * math.sqrt(pair[0][0] * pair[1][0])
		strains = [-float(numpy.interp(math.log(1e-3 * pressure), numpy.log(table[:, 0]), table[:, 1])) for table in at]
		found[f"e0.70-{1e-3 * pressure:.3g}"] = {"pressure": pressure, "void ratio": VOID, "thickness": LATEX, "angle": math.nan, "strains": strains}
	return found


def curve(number):
	"""{quantity: (strain, value)} of a test with a curve; dilation positive, plain ratios."""
	with open(HERE / "lab" / f"{CURVES[number]}.csv", encoding="utf-8") as file:
		rows = list(csv.reader(file))[1:]
	columns = {"stress_ratio": (1, 1.0), "volumetric_strain": (2, -0.01)}
	return {name: numpy.array([(0.01 * float(row[0]), factor * float(row[column])) for row in rows if row[column]]).T for name, (column, factor) in columns.items()}


def draws(folder, count):
	"""``count`` sets of parameters from the posterior, {key: value} each, by systematic resampling; shuffled, so the first ones are a sample too."""
	with open(pathlib.Path(folder) / "sets.csv", encoding="utf-8") as file:
		rows = list(csv.DictReader(file))
	weight = numpy.array([float(row["weight"]) for row in rows])
	chosen = numpy.searchsorted(numpy.cumsum(weight), (numpy.arange(count) + 0.5) / count * weight.sum())
	keys = [key for key in rows[0] if key not in ("set", "log_likelihood", "weight", "failed")]
	return [{key: float(rows[k][key]) for key in keys} for k in numpy.random.default_rng(1).permutation(chosen)]


def packed(porosity, void):
	"""Porosity of the packing at a void ratio of the laboratory, from that of the calibrated one."""
	slope = (OURS[1] - OURS[0]) / (LIMITS[1] - LIMITS[0])
	ratio = porosity / (1 - porosity) + slope * (void - CALIBRATED)
	return ratio / (1 + ratio)


def study(base, folder, count, exponent=0.0):
	"""The tests: all conditions of a draw, then the next draw, so that what is cut off has as many of each.

	:param exponent: emod goes with this power of the pressure, from that of the calibration on.
	"""
	runs = []
	for k, values in enumerate(draws(folder, count)):
		for number, test in conditions().items():
			own = {**values, "specimen.porosity": packed(values["specimen.porosity"], test["void ratio"]), studyfile.SEED: FIRST_SEED + k}
			own |= {"consolidation.pressure": test["pressure"], "membrane.thickness": test["thickness"]}
			own |= {"shear.velocity": base.shear.velocity * math.sqrt(test["pressure"] / PRESSURE)}
			own |= {"specimen.emod": base.specimen.emod * (test["pressure"] / PRESSURE) ** exponent}
			runs.append(studyfile.Run(f"{number}-{k}", {"test": number}, FIRST_SEED + k, derived(base, studyfile.nested(own))))
	return studyfile.Study("predictions", ["test"], runs, 2, {})


def numbers(series):
	"""Peak friction angle [deg], volumetric strain [%] at STRAINS; nan where a test does not reach."""
	ratio = series["stress_ratio"]
	even = numpy.arange(ratio.strain[0], ratio.strain[-1], SMOOTH / 10)
	peak = numpy.convolve(ratio.at(even), numpy.full(10, 0.1), "valid").max()
	return [math.degrees(math.asin((peak - 1) / (peak + 1))), *(100 * float(series["volumetric_strain"].at(strain)) for strain in STRAINS)]


def interval(values):
	"""(mean, half width of the interval that has 95 % of single tests) of what several tests gave."""
	values = numpy.array(values)
	if len(values) < 2:
		return float(values.mean()), math.nan
	return float(values.mean()), float(student.ppf(0.975, len(values) - 1) * values.std(ddof=1) * math.sqrt(1 + 1 / len(values)))


def ofLaboratory(number):
	"""The same numbers of the laboratory's test; nan where it has none."""
	test = conditions()[number]
	angle = test["angle"]
	if number not in CURVES:
		return [angle, *test.get("strains", [math.nan for _ in STRAINS])]
	return [angle, *(100 * float(numpy.interp(strain, *curve(number)["volumetric_strain"])) for strain in STRAINS)]


def tables(found, folder, say):
	"""``predictions.csv``: a row a condition with the laboratory's numbers, ours with intervals; the picture. ``found``: {number of test: list of series}."""
	header = ["test", "sigma3 [kPa]", "void ratio [-]", "membrane [mm]", "tests"]
	for name in ("peak friction angle [deg]", *(f"volumetric strain at {100 * strain:g} % [%]" for strain in STRAINS)):
		header += [f"{name} laboratory", f"{name} ours", f"{name} half width", f"{name} difference"]
	rows = [header]
	for number, series in found.items():
		test = conditions()[number]
		row = [number, f"{1e-3 * test['pressure']:g}", test["void ratio"], f"{1e3 * test['thickness']:g}", len(series)]
		for there, ours in zip(ofLaboratory(number), zip(*map(numbers, series))):
			mean, half = interval(ours)
			row += ["" if math.isnan(value) else f"{value:.2f}" for value in (there, mean, half, mean - there)]
		rows.append(row)
		say(", ".join(map(str, row)))
	with open(pathlib.Path(folder) / "predictions.csv", "w", encoding="utf-8", newline="") as file:
		csv.writer(file, lineterminator="\n").writerows(rows)
	figure(found, pathlib.Path(folder) / "predictions.png")


def figure(found, path):
	"""Curves over the laboratory's where it has them; peak friction angle over the void ratio."""
	from matplotlib.backends.backend_agg import FigureCanvasAgg
	from matplotlib.figure import Figure

	drawn = Figure(figsize=(12, 6.2), layout="constrained")
	FigureCanvasAgg(drawn)
	panels = drawn.subplots(2, 3, squeeze=False)
	angles = panels[1][2]
	for column, (color, pressure) in enumerate((("#1f4e79", 4.9e4), ("#b5561c", 9.8e4), ("#3a7d44", 1.96e5))):
		number = next(number for number in CURVES if laboratory()[number]["pressure"] == pressure)
		label = f"{1e-3 * pressure:g} kPa, e = {laboratory()[number]['void ratio']:g}"
		for axes, quantity, factor in ((panels[0][column], "stress_ratio", 1), (panels[1][0], "volumetric_strain", 100)):
			for series in found.get(number, []):
				axes.plot(100 * series[quantity].strain, factor * series[quantity].value, color=color, lw=0.7, alpha=0.6)
			axes.plot(100 * curve(number)[quantity][0], factor * curve(number)[quantity][1], "o", color=color, ms=3, mec="k", mew=0.3, label=label)
			axes.legend(frameon=False, fontsize="small")
			axes.set_xlabel("axial strain [%]")
			axes.set_ylabel("sigma1/sigma3 [-]" if factor == 1 else "volumetric strain [%]")
		there = [row for row in laboratory().values() if row["pressure"] == pressure]
		angles.plot([row["void ratio"] for row in there], [row["angle"] for row in there], "o", color=color, ms=3, label=f"laboratory, {1e-3 * pressure:g} kPa")
		ours = [(laboratory()[n]["void ratio"], *interval([numbers(one)[0] for one in series])) for n, series in found.items() if n in TESTS and laboratory()[n]["pressure"] == pressure]
		if ours:
			angles.errorbar(*numpy.array(sorted(ours)).T, fmt="s-", color=color, lw=0.7, ms=4, capsize=2)
	angles.set_xlabel("void ratio [-]")
	angles.set_ylabel("peak friction angle [deg]")
	angles.legend(frameon=False, fontsize="small")
	fig19(panels[1][1], found)
	drawn.suptitle("Toyoura sand: lines and squares are tests with grains from the curve at 98 kPa alone")
	drawn.savefig(path, dpi=110)


def fig19(axes, found):
	"""Volumetric strain at STRAINS over the pressure at the void ratio VOID."""
	for k, (strain, color) in enumerate(zip(STRAINS, ("#1f4e79", "#b5561c"))):
		points = [(1e-3 * conditions()[n]["pressure"], ofLaboratory(n)[1 + k], *interval([numbers(one)[1 + k] for one in series])) for n, series in found.items() if n not in TESTS]
		if points:
			pressure, there, mean, half = numpy.array(sorted(points)).T
			axes.plot(pressure, there, "o", color=color, ms=3, mec="k", mew=0.3, label=f"laboratory, at {100 * strain:g} %")
			axes.errorbar(pressure, mean, half, fmt="s-", color=color, lw=0.7, ms=4, capsize=2)
			axes.legend(frameon=False, fontsize="small")
	axes.set_xscale("log")
	axes.set_xlabel("sigma3 [kPa]")
	axes.set_ylabel(f"volumetric strain at e = {VOID:g} [%]")


def main(argv):
	parser = argparse.ArgumentParser(prog="predict.py")
	parser.add_argument("calibration", metavar="CALIBRATION_FOLDER", help="what scripts/calibrate has left")
	parser.add_argument("--out", required=True, metavar="FOLDER")
	parser.add_argument("--calibration", dest="file", metavar="FILE", default=HERE / "calibration.yaml", help="the calibration of that folder (default: calibration.yaml)")
	parser.add_argument("--draws", type=int, default=6, metavar="N", help="tests a condition (6)")
	parser.add_argument("--hertz", action="store_true", help="stiffness of the grains goes with the cube root of the pressure")
	parser.add_argument("--tables", action="store_true", help="run nothing")
	given = parser.parse_args(argv)

	def whole(say):
		base = calibrationfile.load(given.file).tests["98 kPa"].config
		wanted, folder = study(base, given.calibration, given.draws, HERTZ if given.hertz else 0.0), pathlib.Path(given.out)
		folder.mkdir(parents=True, exist_ok=True)
		if not given.tables:
			with sweep.lock(folder):
				inside.perform(wanted, folder, say)
		found = {}
		for one in wanted.runs:
			if inside.status(folder, one) == "done":
				found.setdefault(one.values["test"], []).append(ofTest(inside.table(folder, one)))
			else:
				say(f"{one.name}: {inside.status(folder, one)}")
		tables(found, folder, say)
		return 0

	return sweep.guarded(whole)


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
