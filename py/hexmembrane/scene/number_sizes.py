# SPDX-License-Identifier: GPL-2.0-or-later
"""Sizes of grains by number, as PFC's ``ball distribute`` has them, beside the gradation by mass. Lengths in m. Needs no YADE.

A distribution is its quantile function: the radius that a share of all grains is smaller than. It answers what
:class:`hexmembrane.scene.gradation.Gradation` answers: how many grains fill a volume, and their radii.
"""

import math

import numpy
from scipy.special import ndtr, ndtri

#: Places of a part of the distribution at which its mean volume is taken, and their weights: Gauss-Legendre of order 5.
_AT = (0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15))
_WEIGHTS = (5 / 18, 8 / 18, 5 / 18)
#: Parts for the mean volume of all.
_PARTS = 20000


class NumberSizes:
	"""A distribution of radii by number.

	:param quantile: radius [m] that a share (an array, 0 to 1) of the grains is smaller than.
	:param factor: on the radii.
	"""

	def __init__(self, quantile, factor=1.0):
		self.quantile, self.factor = quantile, factor

	@classmethod
	def uniform(cls, low, high):
		"""All radii between two are as frequent (PFC: ``radius low high``)."""
		return cls(lambda share: low + share * (high - low))

	@classmethod
	def gaussian(cls, mean, deviation, low, high):
		"""A normal distribution, cut off at two radii (PFC: ``gauss``)."""
		first, last = ndtr((low - mean) / deviation), ndtr((high - mean) / deviation)
		return cls(lambda share: numpy.clip(mean + deviation * ndtri(first + share * (last - first)), low, high))

	@classmethod
	def bins(cls, bins):
		"""Bins (low, high, share of the volume); in each all radii are as frequent (PFC: ``bin``, ``volume-fraction``)."""
		low, high, share = numpy.array(bins, dtype=float).T
		cube = (low**2 + high**2) * (low + high) / 4  # mean of r^3 between low and high
		numbers = numpy.concatenate([[0.0], numpy.cumsum(share / cube)])
		numbers /= numbers[-1]

		def quantile(wanted):
			k = numpy.clip(numpy.searchsorted(numbers, wanted, side="right") - 1, 0, len(low) - 1)
			return low[k] + numpy.clip((wanted - numbers[k]) / (numbers[k + 1] - numbers[k]), 0, 1) * (high[k] - low[k])

		return cls(quantile)

	def _cubes(self, count):
		"""Mean r^3 of each of ``count`` equal parts of the grains."""
		part = numpy.arange(count)
		return self.factor**3 * sum(weight * self.quantile((part + at) / count) ** 3 for at, weight in zip(_AT, _WEIGHTS))

	def scaled(self, factor):
		"""The distribution with all radii multiplied by ``factor``."""
		return NumberSizes(self.quantile, self.factor * factor)

	def grainCount(self, porosity, volume):
		"""Number of grains that fill ``volume`` (m3) at ``porosity``, rounded."""
		return int(round((1 - porosity) * volume / (4 / 3 * math.pi * self._cubes(_PARTS).mean())))

	def scaleForGrains(self, count, porosity, volume):
		"""Factor on the radii with which ``count`` grains fill ``volume`` (m3) at ``porosity``."""
		return float(((1 - porosity) * volume / (4 / 3 * math.pi * self._cubes(count).sum())) ** (1 / 3))

	def sample(self, count, seed=1):
		"""Radii (m) of ``count`` grains in random order: the grain of each equal part of the distribution has the part's mean volume."""
		return numpy.random.default_rng(seed).permutation(numpy.cbrt(self._cubes(count)))
