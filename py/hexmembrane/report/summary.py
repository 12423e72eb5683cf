# SPDX-License-Identifier: GPL-2.0-or-later
"""A test in a few numbers, and the mean of several tests with its interval. Uses nothing of YADE."""

import math

import numpy
from scipy.stats import t as student

#: Share of the intervals.
CONFIDENCE = 0.95
#: Rows of the records that a peak is smoothed over, so that the noise of one is no peak.
SMOOTHED = 5
#: What is told of a test: name -> unit.
QUANTITIES = {
	"peak_q": "Pa",
	"strain_at_peak": "-",
	"end_q": "Pa",
	"end_volumetric_strain": "-",
	"start_porosity": "-",
	"end_porosity": "-",
	"start_coordination": "-",
	"end_coordination": "-",
	"largest_energy_error": "-",
}


def quantities(table):
	"""QUANTITIES of the records of a shear: peak of q smoothed over SMOOTHED rows; volumetric strain of the enclosed volume, dilation positive."""
	width = min(SMOOTHED, len(table["q"]))
	smooth = numpy.convolve(table["q"], numpy.full(width, 1 / width), "valid")
	peak = int(smooth.argmax())
	errors = table["energy_error"][numpy.isfinite(table["energy_error"])]
	return {
		"peak_q": smooth[peak],
		"strain_at_peak": table["axial_strain"][peak : peak + width].mean(),
		"end_q": table["q"][-1],
		"end_volumetric_strain": table["volumetric_strain_volume"][-1],
		"start_porosity": table["porosity"][0],
		"end_porosity": table["porosity"][-1],
		"start_coordination": table["coordination"][0],
		"end_coordination": table["coordination"][-1],
		"largest_energy_error": abs(errors).max() if len(errors) else math.nan,
	}


def halfWidth(values):
	"""Half of the interval of CONFIDENCE of the mean, by Student's t; nan with fewer than two values. Of rows: of each column."""
	count = len(values)
	if count < 2:
		return numpy.full(numpy.shape(values)[1:], math.nan)
	return student.ppf(0.5 + CONFIDENCE / 2, count - 1) * numpy.std(values, axis=0, ddof=1) / math.sqrt(count)
