# SPDX-License-Identifier: GPL-2.0-or-later
"""Gradations: from a laboratory's grading curve to the radii of the grains of a specimen. Lengths in m, passing in percent by mass.

A gradation is a curve of (diameter, percent of the mass that passes a sieve of this diameter), linear in the logarithm of the diameter between
its points, 0 % at the smallest and 100 % at the largest. All grains have one density, so that shares of mass are shares of volume::

	sand = Gradation.fromCsv("examples/data/toyoura.csv").cutPercent(3, 97)
	volume = math.pi * 0.02**2 * 0.08
	sand = sand.scaled(sand.scaleForGrains(7045, porosity=0.389, volume=volume))
	radii = sand.sample(7045, seed=1)

Needs no YADE.
"""

import math
import os
import re

import numpy

from hexmembrane.configuration.schema import shown

_FACTORS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6}
#: Characters of a file at most.
_LONGEST = 1_000_000


def _reject(what, value, wrong, fix):
	raise ValueError(f"Gradation.{what} = {value}: {wrong}; fix: {fix}")


def _requirePositive(what, value, unit):
	if not (isinstance(value, (int, float, numpy.number)) and math.isfinite(value) and value > 0):
		_reject(what, value, "must be a finite number > 0", f"give it in {unit}" if unit else "give a number > 0")
	return float(value)


class Gradation:
	"""A grading curve.

	:param diameters: m, strictly ascending, two or more.
	:param passing: percent of the mass finer than each diameter, ascending from 0 to 100.
	:raises ValueError: naming the entry and what to do.
	"""

	def __init__(self, diameters, passing):
		self.diameters = numpy.array(diameters, dtype=float)
		self.passing = numpy.array(passing, dtype=float)
		if self.diameters.ndim != 1 or self.diameters.shape != self.passing.shape:
			_reject("passing", self.passing.shape, f"not one for each of {self.diameters.shape} diameters", "two lists of equal length")
		if len(self.diameters) < 2:
			_reject("diameters", list(self.diameters), "a curve has two points or more", "at least a smallest and a largest diameter")
		for i, (diameter, percent) in enumerate(zip(self.diameters, self.passing)):
			_requirePositive(f"diameters[{i}]", diameter, "m")
			if not 0 <= percent <= 100:
				_reject(f"passing[{i}]", percent, "outside 0 .. 100", "percent of the mass finer than the diameter")
			if i and diameter <= self.diameters[i - 1]:
				_reject(f"diameters[{i}]", diameter, f"not above the one before, {self.diameters[i - 1]:.6g}", "strictly ascending diameters")
			if i and percent < self.passing[i - 1]:
				_reject(f"passing[{i}]", percent, f"less than at a smaller diameter, {self.passing[i - 1]:.6g}", "check the two rows")
		if self.passing[0] > 0:
			_reject(
				"passing[0]",
				self.passing[0],
				f"nothing says how fine the grains below {self.diameters[0]:.6g} m are",
				"a row with 0 percent, or a cut at or above this diameter",
			)
		if self.passing[-1] < 100:
			_reject(
				f"passing[{len(self.passing) - 1}]",
				self.passing[-1],
				f"nothing says how coarse the grains above {self.diameters[-1]:.6g} m are",
				"a row with 100 percent, or a cut at or below this diameter",
			)
		# leading rows of 0 and trailing rows of 100 percent hold no grains
		first = int(numpy.flatnonzero(self.passing == 0)[-1])
		last = int(numpy.flatnonzero(self.passing == 100)[0])
		self.diameters, self.passing = self.diameters[first : last + 1], self.passing[first : last + 1]
		self.diameters.flags.writeable = self.passing.flags.writeable = False

	# ---- where curves come from

	@classmethod
	def fromCsv(cls, path, cutBelow=None, cutAbove=None):
		"""Reads a curve as a laboratory writes it.

		One header line whose first column carries the unit (``diameter (mm), percent passing``; m, mm and um are understood), then a row
		(diameter, percent passing) for each sieve, from fine to coarse or from coarse to fine. Separated by commas, semicolons or tabs; with
		the last two a decimal comma is understood. Empty lines and lines that begin with # are skipped.

		:param cutBelow: m; grains finer than this are left out and the rest is taken as the whole. A curve that does not come down to
			0 percent needs it: how fine the finest are is not in it.
		:param cutAbove: m; the same for coarser grains and a curve that does not come up to 100 percent.
		:raises ValueError: naming file, line and what to do.
		:raises OSError: when the file cannot be read.
		"""
		rows = _readRows(path)
		if rows[0][0] > rows[-1][0]:
			rows.reverse()
		for (fine, passingFine, _), (diameter, percent, line) in zip(rows, rows[1:]):
			if diameter <= fine:
				_rejectLine(path, line, f"diameter {diameter:.6g} m", "repeated or out of order", "one row for each sieve, ascending or descending")
			if percent < passingFine:
				_rejectLine(path, line, f"{percent:.6g} percent", "less passes than through a finer sieve", "check the row and its neighbours")
		diameters = [r[0] for r in rows]
		passing = [r[1] for r in rows]
		if cutBelow is not None or cutAbove is not None:
			return _cutCurve(diameters, passing, cutBelow, cutAbove)
		return cls(diameters, passing)

	@classmethod
	def fromBins(cls, edges, massFractions):
		"""From the mass in each bin of diameters.

		:param edges: m, strictly ascending, one more than the bins.
		:param massFractions: of each bin, >= 0, in any unit: their sum is the whole.
		"""
		edges, fractions = list(edges), [float(f) for f in massFractions]
		if len(edges) != len(fractions) + 1:
			_reject("edges", len(edges), f"{len(fractions)} bins have {len(fractions) + 1} edges", "one edge more than mass fractions")
		for i, fraction in enumerate(fractions):
			if not (math.isfinite(fraction) and fraction >= 0):
				_reject(f"massFractions[{i}]", fraction, "not a share of a mass", "finite numbers >= 0")
		total = sum(fractions)
		if not total > 0:
			_reject("massFractions", fractions, "no mass at all", "at least one bin with mass")
		passing = numpy.concatenate([[0.0], numpy.cumsum(fractions) / total * 100])
		passing[passing > 100] = 100
		passing[-1] = 100
		return cls(edges, passing)

	# ---- other curves from this one

	def scaled(self, factor):
		"""The curve with all diameters multiplied by ``factor`` > 0."""
		return Gradation(self.diameters * _requirePositive("factor", factor, ""), self.passing)

	def cut(self, cutBelow=None, cutAbove=None):
		"""The curve without the grains finer than ``cutBelow`` and coarser than ``cutAbove`` (m); what is left is the whole."""
		return _cutCurve(self.diameters, self.passing, cutBelow, cutAbove)

	def cutPercent(self, low, high):
		"""The curve without the finest ``low`` percent and without what is beyond ``high`` percent of the mass."""
		if not (0 <= low < high <= 100):
			_reject("cutPercent", (low, high), "not 0 <= low < high <= 100", "e.g. (3, 97)")
		return self.cut(self.diameterAt(low), self.diameterAt(high))

	# ---- what the curve says

	def percentPassing(self, diameter):
		"""Percent of the mass finer than ``diameter`` (m; a number or an array)."""
		return numpy.interp(numpy.log(diameter), numpy.log(self.diameters), self.passing)

	def diameterAt(self, percent):
		"""Diameter (m) that ``percent`` of the mass is finer than; of a gap in the grading the finer end."""
		if not 0 <= percent <= 100:
			_reject("percent", percent, "outside 0 .. 100", "e.g. 50 for d50")
		k = int(numpy.searchsorted(self.passing, percent))
		if self.passing[k] == percent:
			return float(self.diameters[k])
		share = (percent - self.passing[k - 1]) / (self.passing[k] - self.passing[k - 1])
		return float(self.diameters[k - 1] * (self.diameters[k] / self.diameters[k - 1]) ** share)

	@property
	def d10(self):
		"""m"""
		return self.diameterAt(10)

	@property
	def d30(self):
		"""m"""
		return self.diameterAt(30)

	@property
	def d50(self):
		"""m"""
		return self.diameterAt(50)

	@property
	def d60(self):
		"""m"""
		return self.diameterAt(60)

	@property
	def uniformity(self):
		"""Coefficient of uniformity, Cu = d60/d10."""
		return self.d60 / self.d10

	@property
	def curvature(self):
		"""Coefficient of curvature, Cc = d30^2/(d10 d60)."""
		return self.d30**2 / (self.d10 * self.d60)

	@property
	def smallest(self):
		"""Smallest diameter (m)."""
		return float(self.diameters[0])

	@property
	def largest(self):
		"""Largest diameter (m)."""
		return float(self.diameters[-1])

	# ---- grains

	@property
	def grainsPerVolume(self):
		"""Number of grains in 1 m3 of solid: the integral of dP/(pi d^3/6), closed form on every piece of the curve."""
		return float(self._numbers()[-1])

	def grainCount(self, porosity, volume):
		"""Number of grains that fill ``volume`` (m3) at ``porosity``, rounded."""
		return int(round(self._solid(porosity, volume) * self.grainsPerVolume))

	def scaleForGrains(self, count, porosity, volume):
		"""Factor on the diameters with which ``count`` grains fill ``volume`` (m3) at ``porosity``."""
		_requireCount(count)
		return float((self._solid(porosity, volume) * self.grainsPerVolume / count) ** (1 / 3))

	def sample(self, count, seed=1):
		"""Radii (m) of ``count`` grains that follow the curve by mass, in random order.

		The number of grains of each size is its mass over the volume of one grain. The distribution by number is cut into ``count`` equal
		parts and each gives one grain that has the part's mean volume: the curve of the sample meets the target at the boundary of every part,
		and the total volume is exactly that of the curve. Only the order is random (numpy's PCG64 with ``seed``): two seeds give the same grains in
		other places. The largest error of the curve is the mass of one of the largest grains (about 100 (dmax/d50)^3/count percent);
		across a gap in the grading at most one grain lies in the gap.
		"""
		_requireCount(count)
		numbers = self._numbers()
		bounds = numpy.concatenate([[0.0], numpy.arange(1, count) / count * numbers[-1], [numbers[-1]]])
		mass = self._massAtNumber(bounds, numbers)
		volumes = numpy.diff(mass) / (numbers[-1] / count)
		radii = numpy.cbrt(volumes * 3 / (4 * math.pi))
		return numpy.random.Generator(numpy.random.PCG64(seed)).permutation(radii)

	# ---- arithmetic on the pieces of the curve; masses as volumes of solid, 1 for the whole

	def _solid(self, porosity, volume):
		if not (isinstance(porosity, (int, float)) and 0 < porosity < 1):
			_reject("porosity", porosity, "outside 0 .. 1", "e.g. 0.40")
		return (1 - porosity) * _requirePositive("volume", volume, "m3")

	def _numbers(self):
		"""Number of grains finer than each diameter of the curve, per volume of solid (1/m3)."""
		share = numpy.diff(self.passing) / 100
		cubes = self.diameters**-3
		return numpy.concatenate([[0.0], numpy.cumsum(share / numpy.diff(numpy.log(self.diameters)) * -numpy.diff(cubes) / 3 * 6 / math.pi)])

	def _massAtNumber(self, wanted, numbers):
		"""Share of the solid that lies in the finest ``wanted`` grains (1/m3); inverse of the closed form of ``_numbers``."""
		pieces = numpy.flatnonzero(numpy.diff(numbers) > 0)
		k = pieces[numpy.minimum(numpy.searchsorted(numbers[pieces + 1], wanted, side="left"), len(pieces) - 1)]
		slope = numpy.diff(self.passing)[k] / 100 / numpy.diff(numpy.log(self.diameters))[k]
		cube = self.diameters[k] ** -3 - (wanted - numbers[k]) * 3 * math.pi / 6 / slope
		# at the coarse end of a piece, rounding may not carry the diameter beyond it
		diameter = numpy.clip(numpy.maximum(cube, self.diameters[k + 1] ** -3) ** (-1 / 3), self.diameters[k], self.diameters[k + 1])
		mass = self.passing[k] / 100 + slope * numpy.log(diameter / self.diameters[k])
		mass[0], mass[-1] = 0.0, 1.0
		return mass


def passingOf(radii, diameters):
	"""Percent of the mass of grains with ``radii`` (m) that is finer than each of ``diameters`` (m): the curve of a sample."""
	sizes = numpy.sort(2 * numpy.asarray(radii, dtype=float))
	if sizes.ndim != 1 or not len(sizes) or not (numpy.isfinite(sizes) & (sizes > 0)).all():
		_reject("radii", radii, "not a list of positive numbers", "radii in m, one or more")
	mass = numpy.concatenate([[0.0], numpy.cumsum(sizes**3)])
	return 100 * mass[numpy.searchsorted(sizes, numpy.asarray(diameters, dtype=float), side="right")] / mass[-1]


def _requireCount(count):
	if isinstance(count, bool) or not isinstance(count, (int, numpy.integer)) or count < 1:
		_reject("count", count, "not a number of grains", "a whole number, 1 or more")


def _cutCurve(diameters, passing, cutBelow, cutAbove):
	"""The part of a curve between two diameters, taken as the whole. Points need not reach 0 and 100 percent on a side that is cut."""
	diameters, passing = numpy.asarray(diameters, dtype=float), numpy.asarray(passing, dtype=float)
	low = diameters[0] if cutBelow is None else max(_requirePositive("cutBelow", cutBelow, "m"), 0.0)
	high = diameters[-1] if cutAbove is None else _requirePositive("cutAbove", cutAbove, "m")
	if not low < high:
		_reject("cutBelow", low, f"not below the other end, {high:.6g}", "a range of diameters that holds grains")
	if (cutBelow is None or low < diameters[0]) and passing[0] > 0 or (cutAbove is None or high > diameters[-1]) and passing[-1] < 100:
		return Gradation(diameters, passing)  # says which end is open
	low, high = max(low, diameters[0]), min(high, diameters[-1])
	if not low < high:
		_reject("cutBelow", cutBelow, f"no grains between the cuts, the curve has {diameters[0]:.6g} to {diameters[-1]:.6g} m", "other cuts")
	share = numpy.interp(numpy.log([low, high]), numpy.log(diameters), passing)
	if not share[1] > share[0]:
		_reject("cutBelow", low, f"no mass between it and {high:.6g}", "other cuts")
	inside = (diameters > low) & (diameters < high)
	kept = (numpy.concatenate([[share[0]], passing[inside], [share[1]]]) - share[0]) / (share[1] - share[0]) * 100
	kept[0], kept[-1] = 0, 100
	return Gradation(numpy.concatenate([[low], diameters[inside], [high]]), numpy.clip(kept, 0, 100))


# ---- the reader


def _rejectLine(path, line, what, wrong, fix):
	raise ValueError(f"{os.fspath(path)}, line {line}: {what}: {wrong}; fix: {fix}")


def _readRows(path):
	"""[(diameter in m, percent passing, line number)] in the file's order."""
	with open(path, encoding="utf-8-sig", errors="replace") as file:
		text = file.read(_LONGEST + 1)
	if len(text) > _LONGEST:
		_rejectLine(path, 1, "the file", f"longer than the {_LONGEST} characters that a gradation may have", "a row for each sieve, and nothing else")
	lines = [(i, text.strip()) for i, text in enumerate(text.split("\n"), 1)]
	lines = [(i, text) for i, text in lines if text and not text.startswith("#")]
	if not lines:
		_rejectLine(path, 1, "empty file", "no header and no rows", "'diameter (mm), percent passing' and a row for each sieve")
	number, header = lines[0]
	separator = next((s for s in ";\t" if s in header), ",")
	unit = re.findall(r"(?<![^\W_])(mm|m|um|µm|μm)(?![^\W_])", header.split(separator)[0])
	if len(unit) != 1:
		_rejectLine(path, number, shown(header), "the first column has no unit", "a header line such as 'diameter (mm), percent passing'")
	rows = []
	for number, text in lines[1:]:
		fields = [field.strip() for field in text.split(separator)]
		if len(fields) != 2:
			_rejectLine(path, number, shown(text), f"{len(fields)} columns, not two", f"'diameter{separator} percent'")
		if separator != ",":
			fields = [field.replace(",", ".") for field in fields]
		try:
			diameter, percent = (float(field) for field in fields)
		except ValueError:
			_rejectLine(path, number, shown(text), "not two numbers", f"'diameter{separator} percent', the unit in the header only")
		if not (math.isfinite(diameter) and diameter > 0):
			_rejectLine(path, number, shown(text), "the diameter is not a finite number > 0", f"the sieve's opening in {unit[0]}")
		if not 0 <= percent <= 100:
			_rejectLine(path, number, shown(text), "the percentage is outside 0 .. 100", "percent of the mass that passes")
		rows.append((diameter * _FACTORS[unit[0]], percent, number))
	if len(rows) < 2:
		_rejectLine(path, lines[-1][0], f"{len(rows)} rows", "a curve has two points or more", "a row for each sieve")
	return rows
