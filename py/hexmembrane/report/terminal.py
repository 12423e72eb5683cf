# SPDX-License-Identifier: GPL-2.0-or-later
"""Curves as text, for a terminal. Uses nothing of YADE."""

import math

#: Dots of a character of Braille, by row and column.
_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
_EMPTY = 0x2800
#: What is drawn: columns of the records with factor and label.
_LINES = (("q", 1e-3, "q [kPa] over axial strain [%]"), ("volumetric_strain_volume", 100, "volumetric strain [%], dilation positive"))
#: The same while there is no shear yet.
_BEFORE = (("p", 1e-3, "mean stress of the soil [kPa] over time [ms]"), ("porosity", 1, "porosity"))
#: A number is told as 0 below this share of the range that it bounds.
_NOTHING = 1e-4


def plot(x, y, width=64, height=10):
	"""Points joined by straight lines, as lines of text with the range of y beside and of x below. Points that are not finite are left out."""
	points = [(a, b) for a, b in zip(x, y) if math.isfinite(a) and math.isfinite(b)]
	if not points:
		return ["no values yet"]
	left, right = min(a for a, _ in points), max(a for a, _ in points)
	low, high = min(b for _, b in points), max(b for _, b in points)
	columns, rows = 2 * width, 4 * height
	cells = [[_EMPTY] * width for _ in range(height)]

	def place(value, least, most, count):
		return 0 if most == least else round((value - least) / (most - least) * (count - 1))

	before = None
	for a, b in points:
		at = place(a, left, right, columns), rows - 1 - place(b, low, high, rows)
		start = before or at
		steps = max(abs(at[0] - start[0]), abs(at[1] - start[1]), 1)
		for k in range(steps + 1):
			i, j = (round(p + (q - p) * k / steps) for p, q in zip(start, at))
			cells[j // 4][i // 2] |= _DOTS[j % 4][i % 2]
		before = at

	def told(value, other):
		return f"{0 if abs(value) < _NOTHING * abs(other - value) else value:.4g}"

	lines = []
	for k, row in enumerate(cells):
		label = told(high, low) if k == 0 else told(low, high) if k == height - 1 else ""
		lines.append(f"{label:>9} \N{BOX DRAWINGS LIGHT VERTICAL}" + "".join(map(chr, row)).rstrip(chr(_EMPTY)))
	return [*lines, " " * 11 + told(left, right).ljust(width - 8) + told(right, left).rjust(8)]


def lines(run, width=64):
	"""A test's curves against axial strain in percent, as lines of text; those of its consolidation against time, while it is there."""
	found = [f"{run.title}: {run.state()}".translate({code: "?" for code in (*range(32), *range(127, 160))})]
	shear, before = run.sheared(), run.rows("consolidation")
	if shear:
		rows, drawn, x = shear, _LINES, 100 * shear["axial_strain"]
	else:
		rows, drawn, x = before, _BEFORE if before else (), 1e3 * (before["time"] - before["time"][0]) if before else []
	for name, factor, label in drawn:
		found += [label, *plot(x, factor * rows[name], width)]
	return found
