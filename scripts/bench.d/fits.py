# SPDX-License-Identifier: GPL-2.0-or-later
"""A knob's error as a power of its abscissa, with an interval from resampled packings, for the error budget of a test (scene/accuracy.py).

A level's own mean difference has the noise of its own runs and of the reference's. The fit mean = C (x^p - reference^p) uses all levels at once.
Its interval comes from fits to packings drawn anew with replacement: levels of one packing stay together, so their common noise is in it. With
eight packings and made-up data it holds the truth 85 to 95 times in a hundred.
"""

import curves
import numpy
from scipy.stats import t as student

RESAMPLES = 400
HEADER = ("fit", "fit_half_width")
_SEED = 1


def differences(name, relative, levels, reference):
	"""(packings, levels) differences from the same packing at the reference level, of the packings that came to their end at all levels.

	:param levels: list of seed -> :class:`curves.Run`.
	:param reference: seed -> :class:`curves.Run`.
	"""
	seeds = sorted(set(reference).intersection(*levels))
	table = numpy.array([[runs[seed].values[name] for runs in levels] for seed in seeds], dtype=float).reshape(len(seeds), len(levels))
	to = numpy.array([[reference[seed].values[name]] for seed in seeds], dtype=float).reshape(len(seeds), 1)
	table = table / to - 1 if relative else table - to
	return table[~numpy.isnan(table).any(axis=1)]


def fit(x, table, reference, sign=1):
	"""Fitted mean differences at x and the half widths of their 95 % intervals; None where there are too few levels or packings, or no difference at all.

	:param x: abscissas of the levels, the reference's left out.
	:param table: see :func:`differences`.
	:param reference: abscissa of the reference.
	:param sign: -1 for an error in the reciprocal of the abscissa.
	"""
	count = len(table)
	if count < 3 or len(x) < 3 or numpy.isnan(x).any():
		return None
	error = table.std(axis=0, ddof=1) / count**0.5
	if not (error > 0).all():
		return None
	x, reference = numpy.asarray(x, dtype=float) ** sign, reference**sign

	def at(rows):
		power, _, _, factor = curves.order(x, rows.mean(axis=0), error, reference)
		return factor * (x**power - reference**power)

	random = numpy.random.default_rng(_SEED)
	spread = numpy.std([at(table[random.integers(count, size=count)]) for _ in range(RESAMPLES)], axis=0, ddof=1)
	return at(table), student.ppf(0.975, count - 1) * (count / (count - 1)) ** 0.5 * spread


def columns(knobs, runs, rows):
	"""The columns of ``HEADER`` for rows of :func:`curves.curves`: 0 at a knob's reference, nan where there is no fit."""
	found = {}
	for knob in (knob for knob in knobs if knob.paired and knob.levels[0].run in runs):
		reference, *others = (level for level in knob.levels if level.run in runs)
		x = [level.x for level in others]
		for name, (_, relative) in curves.QUANTITIES.items():
			fitted = fit(x, differences(name, relative, [runs[level.run] for level in others], runs[reference.run]), reference.x, -1 if (knob.theory or 0) < 0 else 1)
			if fitted:
				found[knob.name, reference.value, name] = (0.0, 0.0)
				found.update({(knob.name, level.value, name): (float(mean), float(half)) for level, mean, half in zip(others, *fitted)})
	return [found.get((row[0], row[1], row[3]), (float("nan"),) * 2) for row in rows]
