# SPDX-License-Identifier: GPL-2.0-or-later
"""Sequential Monte Carlo over parameters: a quasi-random design, weights of all evaluations together, proposals from a mixture. Needs no YADE.

Parameters are handled as points of the unit cube; the prior is uniform there (uniform in the logarithm where a parameter's scale is 'log').

Generations: the first is a Sobol design. Each later one is drawn from a Gaussian mixture fitted to the weighted points so far, a tenth of it from the
prior. A point x that was drawn in generation g of n_g points counts with w = L(x)^b / sum_g (n_g/N) p_g(x), the density of all generations as one mixture
(J.-M. Cornuet, J.-M. Marin, A. Mira, C. P. Robert, Adaptive multiple importance sampling, Scand. J. Stat. 39, 2012): no evaluation is wasted. The power
b, 1 at the end, is lowered while too few points carry the weight (H. Cheng and others, Granular Matter 21, 2019, do so by widening the error).
"""

import warnings

import numpy
from scipy.stats import multivariate_normal, qmc
from sklearn.mixture import BayesianGaussianMixture

#: Share of a generation that is drawn from the prior; most components of a proposal.
FROM_PRIOR, COMPONENTS = 0.1, 4
#: Share of effective points that tempering keeps while generations are to come.
KEPT = 0.3
#: Points that a proposal is fitted to, drawn by weight, and how wide it is made beyond them.
_FITTED, _WIDER = 400, 1.5


class Prior:
	"""Uniform in the unit cube."""

	def __init__(self, dimensions):
		self.dimensions = dimensions

	def draw(self, count, seed):
		"""(count, dimensions) points of a scrambled Sobol sequence."""
		with warnings.catch_warnings():
			warnings.simplefilter("ignore", UserWarning)  # a number of points that is no power of two only loses balance
			return qmc.Sobol(self.dimensions, seed=seed).random(count)

	def density(self, points):
		return numpy.ones(len(points))


class Mixture:
	"""A Gaussian mixture, cut off at the cube's faces, with a part of the prior.

	:param points: (N, dimensions).
	:param weights: (N,), adding up to 1.
	"""

	def __init__(self, points, weights, seed):
		self.prior = Prior(points.shape[1])
		random = numpy.random.default_rng(seed)
		drawn = points[random.choice(len(points), _FITTED, p=weights)]
		# few points carry the weight, and a mixture through them alone would be needles: each is spread by the rule of B. W. Silverman (1986)
		spread = numpy.maximum(drawn.std(axis=0), 1e-3) * effective(weights) ** (-1 / (points.shape[1] + 4))
		drawn = numpy.clip(drawn + random.normal(size=drawn.shape) * spread, 0, 1)
		components = min(COMPONENTS, max(1, len(points) // (4 * points.shape[1])))
		fit = BayesianGaussianMixture(n_components=components, reg_covar=1e-5, max_iter=500, n_init=2, random_state=seed)
		with warnings.catch_warnings():
			warnings.simplefilter("ignore")  # of convergence: any mixture is a sound proposal
			fit.fit(drawn)
		self._parts = [(weight, multivariate_normal(mean, _WIDER * spread)) for weight, mean, spread in zip(fit.weights_, fit.means_, fit.covariances_)]
		inside = ((trial := self._raw(20000, random)) >= 0) & (trial <= 1)
		self._inside = max(1e-3, float(inside.all(axis=1).mean()))

	def _raw(self, count, random):
		parts = random.choice(len(self._parts), count, p=[weight for weight, _ in self._parts])
		drawn = [numpy.atleast_2d(part.rvs(number, random_state=random)).reshape(number, -1) for (_, part), number in zip(self._parts, numpy.bincount(parts, minlength=len(self._parts))) if number]
		return random.permutation(numpy.vstack(drawn))

	def draw(self, count, seed):
		"""(count, dimensions) points inside the cube."""
		random = numpy.random.default_rng(seed)
		fromPrior = max(1, round(FROM_PRIOR * count))
		kept = numpy.empty((0, self.prior.dimensions))
		while len(kept) < count - fromPrior:
			drawn = self._raw(4 * count, random)
			kept = numpy.vstack([kept, drawn[((drawn >= 0) & (drawn <= 1)).all(axis=1)]])
		return numpy.vstack([kept[: count - fromPrior], self.prior.draw(fromPrior, seed)])

	def density(self, points):
		mixture = sum(weight * part.pdf(points) for weight, part in self._parts)
		return (1 - FROM_PRIOR) * mixture / self._inside + FROM_PRIOR


def effective(weights):
	"""How many equal points would tell as much: 1/sum w^2 of weights that add up to 1."""
	return 1 / float((weights**2).sum())


def weights(logLikelihood, points, generations, power=1.0):
	"""Weights of all points, adding up to 1; a failed evaluation has log likelihood -inf and weight 0.

	:param generations: list of (proposal, number of its points).
	"""
	total = sum(count for _, count in generations)
	density = sum(count / total * proposal.density(points) for proposal, count in generations)
	logs = power * logLikelihood - numpy.log(density)
	with numpy.errstate(invalid="ignore"):
		found = numpy.exp(logs - logs.max())
	return found / found.sum()


def temper(logLikelihood, points, generations, wanted):
	"""(weights, power): the largest power up to 1 with which ``wanted`` points are effective, by bisection."""
	found = weights(logLikelihood, points, generations)
	if effective(found) >= wanted:
		return found, 1.0
	low, high = 0.0, 1.0
	for _ in range(40):
		middle = 0.5 * (low + high)
		if effective(weights(logLikelihood, points, generations, middle)) >= wanted:
			low = middle
		else:
			high = middle
	return weights(logLikelihood, points, generations, low), low


def quantiles(values, weight, shares):
	"""Weighted quantiles of (N,) values."""
	order = numpy.argsort(values)
	risen = numpy.cumsum(weight[order]) - 0.5 * weight[order]
	return numpy.interp(shares, risen / weight.sum(), values[order])
