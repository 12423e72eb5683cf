# SPDX-License-Identifier: GPL-2.0-or-later
"""What the study of accuracy takes from a test, and from many tests: quantities, paired differences, orders of the error."""

import dataclasses
import math

import numpy
from knobs import BASE
from scipy.stats import t as student

#: Rows of the records that a peak is smoothed over, so that the noise of one is no peak.
SMOOTHED = 5
#: Axial strains of the quantities.
EARLY, LATE, END = 0.01, 0.10, 0.15
#: Name -> (unit, whether differences are relative to the reference's value).
QUANTITIES = {
	"q at 1 %": ("Pa", True),
	"peak q": ("Pa", True),
	"strain at peak": ("-", False),
	"q at 15 %": ("Pa", True),
	"mean q from 10 to 15 %": ("Pa", True),
	"volumetric strain at 15 %": ("-", False),
	"start: axial": ("-", False),
	"start: radial": ("-", False),
	"start: middle axial": ("-", False),
	"start: middle radial": ("-", False),
	"boundary against contacts": ("-", False),
}
HEADER = ("knob", "value", "x", "quantity", "mean", "scatter", "half_width", "packings", "steps", "time", "paired")


def quantities(table):
	"""What a test's records say, a dict by name; nan: it did not come that far.

	``start: ...`` is the soil's stress over its target, less 1, in shear's first row. ``boundary against contacts`` is the largest difference of the two
	measures of the soil's stress in shear, over its axial stress. Strains: compression positive axially, dilation positive in volume.

	:param table: as :func:`hexmembrane.output.records.read` gives it.
	"""
	found = dict.fromkeys(QUANTITIES, math.nan)
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	if not shear.any():
		return found
	columns = {name: column[shear] for name, column in table.items() if name != "stage"}
	strain, q, target = columns["axial_strain"], columns["q"], columns["sigma3_target"][0]
	for name in ("axial", "radial"):
		found[f"start: {name}"] = columns[f"soil_{name}"][0] / target - 1
		found[f"start: middle {name}"] = columns[f"soil_{name}_middle"][0] / target - 1
	apart = [abs(columns[f"boundary_{name}"] - columns[f"soil_{name}"]) / columns["soil_axial"] for name in ("axial", "radial")]
	found["boundary against contacts"] = numpy.max(apart)
	near = 0.5 * strain[-1] / max(1, len(strain) - 1)  # rows are a step's travel off their strains
	if strain[-1] >= EARLY - near:
		found["q at 1 %"] = numpy.interp(EARLY, strain, q)
	if strain[-1] >= END - near:
		smooth = numpy.convolve(q, numpy.full(SMOOTHED, 1 / SMOOTHED), "valid")
		peak = int(smooth.argmax())
		found["peak q"], found["strain at peak"] = smooth[peak], strain[peak : peak + SMOOTHED].mean()
		found["q at 15 %"] = numpy.interp(END, strain, q)
		found["mean q from 10 to 15 %"] = q[strain >= LATE - near].mean()
		found["volumetric strain at 15 %"] = numpy.interp(END, strain, columns["volumetric_strain_volume"])
	return {name: float(value) for name, value in found.items()}


@dataclasses.dataclass
class Run:
	"""A test that has ended.

	:param seed: of its packing.
	:param packing: digest of its packing.
	:param values: see :func:`quantities`.
	:param steps: steps of the whole test.
	:param time: wall clock of it [s].
	:param x: abscissa that its log gives, nan without.
	"""

	seed: int
	packing: str
	values: dict
	steps: float
	time: float
	x: float = math.nan


def _spread(values):
	"""Mean, standard deviation and half width of the mean's 95 % interval (Student's t), nan where there are too few values."""
	n = len(values)
	scatter = float(numpy.std(values, ddof=1)) if n > 1 else math.nan
	return float(numpy.mean(values)) if n else math.nan, scatter, float(student.ppf(0.975, n - 1)) * scatter / math.sqrt(n) if n > 1 else math.nan


def _paired(name, relative, runs, reference):
	"""Differences of runs from those of the same packing at the reference level.

	:raises ValueError: a seed has two packings.
	"""
	found = []
	for seed in sorted(set(runs) & set(reference)):
		one, other = runs[seed], reference[seed]
		if one.packing != other.packing:
			raise ValueError(f"curves.packing = '{one.packing}': seed {seed} has another packing at the reference level; fix: compare only what leaves the packing as it is")
		value, to = one.values[name], other.values[name]
		found.append(value / to - 1 if relative else value - to)
	return [value for value in found if not math.isnan(value)]


def _among(name, relative, runs, reference):
	"""Mean, scatter and half width of a quantity among packings that no reference shares: the mean as difference from the reference's mean."""
	values, others = ([run.values[name] for run in some.values() if not math.isnan(run.values[name])] for some in (runs, reference))
	if not values or not others:
		return 0, math.nan, math.nan, math.nan
	middle = numpy.mean(others)
	mean, scatter, half = _spread(values)
	scale = abs(middle) if relative else 1.0
	return len(values), (mean - middle) / scale, scatter / scale, half / scale


def _cost(runs, base, name):
	"""Mean of steps or time over that of the base run of the same packing, nan without."""
	ratios = [getattr(runs[seed], name) / getattr(base[seed], name) for seed in set(runs) & set(base)]
	return float(numpy.mean(ratios)) if ratios else math.nan


def curves(knobs, runs):
	"""Rows of curves.csv, in the order of ``HEADER``; the first knob, ``packings``, is the scatter of the base runs.

	:param knobs: see :func:`knobs.knobs`.
	:param runs: name of a level's runs -> seed -> :class:`Run`, of those that came to their end.
	"""
	rows, base = [], runs.get(BASE, {})
	for name, (_, relative) in QUANTITIES.items():
		count, *spread = _among(name, relative, base, base)
		if count:
			rows.append(("packings", BASE, math.nan, name, *spread, count, 1.0, 1.0, "no"))
	for knob in knobs:
		reference = runs.get(knob.levels[0].run, {})
		for level in knob.levels:
			these = runs.get(level.run, {})
			if not reference or not these:
				continue
			x = level.x if not math.isnan(level.x) else float(numpy.mean([run.x for run in these.values()]))
			cost = [_cost(these, base, what) for what in ("steps", "time")]
			for name, (_, relative) in QUANTITIES.items():
				if knob.paired:
					differences = _paired(name, relative, these, reference)
					count, spread = len(differences), _spread(differences)
				else:
					count, *spread = _among(name, relative, these, reference)
				if count:
					rows.append((knob.name, level.value, x, name, *spread, count, *cost, "yes" if knob.paired else "no"))
	return rows


def order(x, mean, error, reference):
	"""Least squares of mean = C (x^p - reference^p): (p, least p, largest p, C).

	The range is that of p whose weighted sum of squares is above the least one by 1, or by the least one per degree of freedom where that is more.

	:param x: abscissas, the reference's left out.
	:param mean: differences from the reference.
	:param error: their standard errors.
	:returns: None with fewer than three levels.
	"""
	x, mean, weight = numpy.asarray(x), numpy.asarray(mean), 1 / numpy.asarray(error)
	if len(x) < 3:
		return None
	powers = numpy.arange(0.1, 4.001, 0.02)
	shapes = x ** powers[:, None] - reference ** powers[:, None]
	factors = (shapes * mean * weight**2).sum(axis=1) / (shapes**2 * weight**2).sum(axis=1)
	squares = (((mean - factors[:, None] * shapes) * weight) ** 2).sum(axis=1)
	best = int(squares.argmin())
	within = powers[squares <= squares[best] + max(1.0, squares[best] / (len(x) - 2))]
	return float(powers[best]), float(within[0]), float(within[-1]), float(factors[best])


def orders(knobs, rows):
	"""Lines that tell the observed order of each knob's error, where an order is looked for and the differences are larger than their intervals."""
	lines = []
	for knob in knobs:
		if knob.theory is None:
			continue
		sign = -1 if knob.theory < 0 else 1
		for name, (_, relative) in QUANTITIES.items():
			of = [row for row in rows if row[0] == knob.name and row[3] == name and not math.isnan(row[6])]
			others = [row for row in of if row[1] != knob.levels[0].value and row[6] > 0 and not math.isnan(row[2])]
			if len(others) < 3 or name.startswith("start") or name == "strain at peak":
				continue
			said = f"{knob.name}, {name}: theory {abs(knob.theory) or 'none'}, "
			if not any(abs(row[4]) > row[6] for row in others):
				lines.append(f"{said}not resolved, all differences are within their 95 % intervals")
				continue
			x, mean, half, count = (numpy.array([row[k] for row in others], dtype=float) for k in (2, 4, 6, 7))
			p, low, high, factor = order(x**sign, mean, half / student.ppf(0.975, count - 1), knob.levels[0].x ** sign)
			to = "relative " if relative else ""
			lines.append(f"{said}observed {p:.1f} ({low:.1f} to {high:.1f}), {to}error {factor:.2g} ({'1/' if sign < 0 else ''}{knob.axis})^{p:.1f}")
	return lines
