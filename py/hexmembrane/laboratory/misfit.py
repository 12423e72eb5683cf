# SPDX-License-Identifier: GPL-2.0-or-later
"""How far a test is from a laboratory's curve: five numbers that engineers read off, and the distance along the whole curve. Needs no YADE."""

import dataclasses
import math

import numpy
from hexmembrane.laboratory.curve import Series

#: Strain of the secant modulus; strain over which a slope of dilation is taken.
MODULUS_STRAIN, SLOPE_STRAIN = 0.005, 0.02


@dataclasses.dataclass
class Number:
	"""One number of both curves; nan where a curve does not reach."""

	name: str
	unit: str
	laboratory: float
	test: float

	def texts(self):
		"""(laboratory's, test's) with the unit."""
		unit = "" if self.unit == "-" else f" {self.unit}"
		return [f"{value:.4g}{unit}" if math.isfinite(value) else "not reached" for value in (self.laboratory, self.test)]

	def __str__(self):
		there, here = self.texts()
		return f"{self.name} {here}" if self.laboratory == 0 else f"{self.name} {here}, laboratory's {there}"


def ofTest(table):
	"""A test's series as a laboratory would have them, from the records of its shear (dict of arrays).

	The stress ratio is the load cell's, 1 + q_cell/sigma3, membrane's pull included, since a laboratory's is; volumetric strain is that of the enclosed volume.
	"""
	strain = table["axial_strain"]
	rising = numpy.concatenate([[True], numpy.diff(numpy.maximum.accumulate(strain)) > 0])
	ratio = 1 + table["q_cell"] / table["sigma3_target"]
	return {"stress_ratio": Series(strain[rising], ratio[rising]), "volumetric_strain": Series(strain[rising], table["volumetric_strain_volume"][rising])}


def ofRecords(curve, table, pressure):
	"""The :class:`Number` list of a test: those of :func:`numbers`, then the distance along each quantity of the curve; [] without rows of shear.

	:param table: of records.csv, as :func:`hexmembrane.output.records.read` gives it.
	"""
	rows = numpy.array([stage == "shear" for stage in table["stage"]], dtype=bool)
	if not rows.any():
		return []
	test = ofTest({name: table[name][rows] for name in ("axial_strain", "q_cell", "sigma3_target", "volumetric_strain_volume")})
	apart = rootMeanSquare(curve, test)
	words = {"stress_ratio": ("distance along sigma1/sigma3", "-", 1), "volumetric_strain": ("distance along the volumetric strain", "%", 100)}
	along = [Number(name, unit, 0.0, factor * apart[quantity]) for quantity, (name, unit, factor) in words.items() if quantity in apart]
	return [*numbers(curve, test, pressure), *along]


def rootMeanSquare(curve, test):
	"""{quantity: root of the mean squared distance at the laboratory's strains that the test reaches}; nan where it reaches none."""
	found = {}
	for name, series in curve.series.items():
		apart = test[name].at(series.strain) - series.value
		apart = apart[numpy.isfinite(apart)]
		found[name] = float(numpy.sqrt((apart**2).mean())) if len(apart) else math.nan
	return found


def numbers(curve, test, pressure):
	"""The :class:`Number` list: peak, strain at peak, secant modulus, dilation angle, residual; up to the strain that both curves reach.

	Dilation angle: sin(psi) = D/(2 + D) with D the steepest d(eps_v)/d(eps_1) over 2 % of strain (P. A. Vermeer, R. de Borst,
	Non-associated plasticity for soils, concrete and rock, Heron 29(3), 1984).
	"""
	rows = []
	if "stress_ratio" in curve.series:
		both = _common(curve.series["stress_ratio"], test["stress_ratio"])
		for name, unit, measure in (
			("peak of sigma1/sigma3", "-", lambda s: s.value.max()),
			("strain at the peak", "%", lambda s: 100 * s.strain[s.value.argmax()]),
			("secant modulus at 0.5 %", "MPa", lambda s: 1e-6 * pressure * float(s.at(MODULUS_STRAIN) - 1) / MODULUS_STRAIN),
			("sigma1/sigma3 at the end", "-", lambda s: s.value[-1]),
		):
			rows.append(Number(name, unit, *(float(measure(series)) for series in both)))
	if "volumetric_strain" in curve.series:
		both = _common(curve.series["volumetric_strain"], test["volumetric_strain"])
		rows.append(Number("dilation angle", "deg", *(dilationAngle(series) for series in both)))
		rows.append(Number("volumetric strain at the end", "%", *(100 * float(series.value[-1]) for series in both)))
	return rows


def _common(laboratory, test):
	"""Both series up to the strain that both reach, with a value there."""
	end = min(laboratory.strain[-1], test.strain[-1])
	cut = []
	for series in (laboratory, test):
		inside = series.strain < end
		cut.append(Series(numpy.append(series.strain[inside], end), numpy.append(series.value[inside], series.at(end))))
	return cut


def dilationAngle(series):
	"""[deg], nan for a series shorter than the slope's strain."""
	starts = series.strain[series.strain + SLOPE_STRAIN <= series.strain[-1]]
	if not len(starts):
		return math.nan
	slope = float((series.at(starts + SLOPE_STRAIN) - series.at(starts)).max()) / SLOPE_STRAIN
	return math.degrees(math.asin(slope / (2 + slope)))
