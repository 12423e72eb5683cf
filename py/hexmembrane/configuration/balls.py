# SPDX-License-Identifier: GPL-2.0-or-later
"""A table of balls, as PFC's ``ball list`` or a script inside it writes one, and the upright cylinder round them. Uses nothing of YADE.

The file is CSV (UTF-8) with one header line; the columns ``x``, ``y``, ``z`` and ``r`` (or ``radius``) are needed, ``id`` is checked where it is there, in
any order; other columns are left out. Empty lines and lines that begin with # are skipped.
"""

import dataclasses
import functools
import math
import os
import pathlib

import numpy

from hexmembrane.configuration.schema import ConfigError, shown

#: Metres in a unit of the table.
UNITS = {"m": 1.0, "mm": 1e-3}
#: Bytes of a file at most: a million lines of five numbers with all digits.
_LONGEST = 160_000_000
_KEY = "specimen.balls"
#: Cuts of a golden section.
_CUTS = 40


@dataclasses.dataclass
class Balls:
	"""Centres (N, 3) and radii [m] in the file's order; ``left``: names of columns that are left out."""

	centres: numpy.ndarray
	radii: numpy.ndarray
	left: tuple


@dataclasses.dataclass
class Cylinder:
	"""An upright cylinder: axis at x, y; foot z, radius and height [m]."""

	x: float
	y: float
	z: float
	radius: float
	height: float


def read(path, unit):
	"""The table in a file, lengths in ``unit``, as :class:`Balls`.

	:raises ConfigError: the file cannot be read, a column is missing, a line is no ball, or a ball is there twice; with line, value and fix.
	"""
	try:
		status = os.stat(path)
		return _read(str(path), unit, status.st_mtime_ns, status.st_size)
	except OSError as error:
		raise ConfigError(_KEY, str(path), f"cannot be read ({error.strerror})", "correct the path") from None


@functools.lru_cache(maxsize=2)
def _read(path, unit, _changed, size):
	if size > _LONGEST:
		raise ConfigError(_KEY, path, f"has {size} bytes", f"at most {_LONGEST}, enough for a million balls")
	try:
		text = pathlib.Path(path).read_text(encoding="utf-8-sig")
	except UnicodeDecodeError:
		raise ConfigError(_KEY, path, "is no text", "a CSV file in UTF-8") from None
	lines = [(number, line.strip()) for number, line in enumerate(text.split("\n"), 1)]
	lines = [(number, line) for number, line in lines if line and not line.startswith("#")]
	if not lines:
		raise ConfigError(_KEY, path, "is empty", "a header line 'id,x,y,z,r' and a line for each ball")
	columns, left = _columns(path, *lines[0])
	width = len(lines[0][1].split(","))
	values, ids = numpy.empty((len(lines) - 1, 4)), {}
	for k, (number, line) in enumerate(lines[1:]):
		fields = [field.strip() for field in line.split(",")]
		if len(fields) != width:
			_wrong(path, number, f"has {len(fields)} columns, the header {width}", "a value for each column")
		for j, name in enumerate(("x", "y", "z", "r")):
			values[k, j] = _number(path, number, name, fields[columns[name]])
		if values[k, 3] <= 0:
			_wrong(path, number, f"r = {values[k, 3]:g} is not > 0", "a radius > 0")
		if "id" in columns and ids.setdefault(fields[columns["id"]], number) != number:
			name = fields[columns["id"]]
			_wrong(path, number, f"the ball with id {shown(name)} is in line {ids[name]} already", "each ball once")
	if not len(values):
		raise ConfigError(_KEY, path, "has a header and no ball", "a line for each ball")
	_, first, count = numpy.unique(values[:, :3], axis=0, return_index=True, return_counts=True)
	if (count > 1).any():
		same = numpy.flatnonzero((values[:, :3] == values[first[count > 1][0], :3]).all(axis=1))
		_wrong(path, lines[1 + same[1]][0], f"the ball is at the same place as that in line {lines[1 + same[0]][0]}", "each ball once")
	values *= UNITS[unit]
	return Balls(values[:, :3], values[:, 3], left)


def _wrong(path, number, what, fix):
	raise ConfigError(_KEY, path, f"line {number}: {what}", fix)


def _columns(path, number, header):
	"""({name: place} of the columns that are known, names of the others)."""
	names = [name.strip().strip('"').lower() for name in header.split(",")]
	names = ["r" if name == "radius" else name for name in names]
	for name in names:
		if names.count(name) > 1:
			_wrong(path, number, f"the column {shown(name)} is there twice", "each column once")
	missing = [name for name in ("x", "y", "z", "r") if name not in names]
	if missing:
		_wrong(path, number, f"the header {shown(header)} has no column {', '.join(missing)}", "a header such as 'id,x,y,z,r', separated by commas")
	known = {name: k for k, name in enumerate(names) if name in ("id", "x", "y", "z", "r")}
	return known, tuple(name for name in names if name not in known)


def _number(path, line, name, text):
	try:
		number = float(text)
	except ValueError:
		number = math.nan
	if not math.isfinite(number):
		_wrong(path, line, f"{name} = {shown(text)} is not a finite number", "numbers alone, their unit is specimen.ballsUnit")
	return number


def circumscribed(centres, radii):
	"""The least upright :class:`Cylinder` that holds all balls."""

	def reach(x, y):
		return float((numpy.hypot(centres[:, 0] - x, centres[:, 1] - y) + radii).max())

	low, high = (centres[:, :2] - radii[:, None]).min(axis=0), (centres[:, :2] + radii[:, None]).max(axis=0)
	# How far the farthest ball reaches is a convex function of the axis' place: least along y for each x, then along x.
	x = _least(lambda x: reach(x, _least(lambda y: reach(x, y), low[1], high[1])), low[0], high[0])
	y = _least(lambda y: reach(x, y), low[1], high[1])
	foot = float((centres[:, 2] - radii).min())
	return Cylinder(x, y, foot, reach(x, y), float((centres[:, 2] + radii).max()) - foot)


def _least(function, low, high):
	"""Where a convex function of one number is least, by golden section."""
	share = (math.sqrt(5) - 1) / 2
	inner = [high - share * (high - low), low + share * (high - low)]
	values = [function(at) for at in inner]
	for _ in range(_CUTS):
		if values[0] < values[1]:
			high, inner[1], values[1] = inner[1], inner[0], values[0]
			inner[0] = high - share * (high - low)
			values[0] = function(inner[0])
		else:
			low, inner[0], values[0] = inner[0], inner[1], values[1]
			inner[1] = low + share * (high - low)
			values[1] = function(inner[1])
	return float((low + high) / 2)
