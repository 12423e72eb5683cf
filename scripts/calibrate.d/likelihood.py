# SPDX-License-Identifier: GPL-2.0-or-later
"""How likely a laboratory's curves are with a set of parameters, the scatter of packings measured. Needs no YADE.

Errors along one curve hang together, so they count as a Gaussian process. Its covariance between strains e_i and e_j is
s_i s_j exp(-|e_i - e_j|/LENGTH) + model^2 exp(-(e_i - e_j)^2/(2 LENGTH^2)), s^2 = packing^2 (1 + 1/seeds) + reading^2: a packing's curve is rough, what a model gets
wrong is smooth. packing: scatter over seeds, pooled over all sets of parameters; the laboratory's specimen is one packing more. reading: of the laboratory's numbers. model: what the best model is wrong by, a share of the curve's largest value; where it is not known it is a
parameter of its own, with the same chance for each factor from the least to the largest of MODELS, that the likelihood is averaged over.
"""

import dataclasses
import math

import numpy
from scipy.linalg import cho_factor, cho_solve
from scipy.special import logsumexp

#: Strain over which errors hang together.
LENGTH = 0.02
#: Standard deviation of a reading: stress ratio, volumetric strain.
READING = {"stress_ratio": 0.05, "volumetric_strain": 0.0015}
#: Points of a curve that are compared, evenly over its strain.
POINTS = 25
#: Steps between readings that are so many medians wide, and wider than half LENGTH, are gaps: a straight line over one is no reading.
GAP = 3
#: Model errors, as shares of a curve's largest value, where they are inferred.
MODELS = tuple(float(share) for share in numpy.geomspace(0.01, 0.3, 9))


@dataclasses.dataclass
class Target:
	"""One quantity of one laboratory curve at the strains that are compared."""

	curve: str
	quantity: str
	strain: numpy.ndarray
	value: numpy.ndarray

	@property
	def key(self):
		return self.curve, self.quantity


def targets(curves, end):
	"""The :class:`Target` list of laboratory curves, {name: Curve}; ``end``: {name: strain that the tests reach}."""
	found = []
	for name, curve in curves.items():
		for quantity, series in curve.series.items():
			last = min(series.strain[-1], end[name])
			strain = numpy.linspace(max(series.strain[0], 0.0), last, POINTS + 1)[1:]
			strain = strain[~_inGap(series.strain, strain)]
			found.append(Target(name, quantity, strain, series.at(strain)))
	return found


def _inGap(read, strain):
	"""Which strains lie in gaps between the strains that were read."""
	steps = numpy.diff(read)
	wide = steps > max(GAP * float(numpy.median(steps)), LENGTH / 2)
	at = numpy.clip(numpy.searchsorted(read, strain), 1, len(steps)) - 1
	return wide[at] & ~numpy.isin(strain, read)


class Evaluations:
	"""What tests gave at the targets' strains. ``add`` one set of parameters after the other.

	:param model: what the best model is wrong by, as a share of a curve's largest value; None: inferred.
	"""

	def __init__(self, targets, model):
		self.targets, self._models = targets, MODELS if model is None else (model,)
		self._sets = []  # of each set {target's key: (seeds, points)}, None where no seed was done

	def add(self, series):
		"""``series``: {curve: [series of one seed, as :func:`hexmembrane.laboratory.misfit.ofTest` gives it]}; seeds that failed left out.

		:returns: a text for each curve that some of these tests do not reach the end of: they are left out.
		"""
		rows, short = {}, []
		for target in self.targets:
			values = [one[target.quantity].at(target.strain) for one in series.get(target.curve, [])]
			whole = [row for row in values if numpy.isfinite(row).all()]
			if len(whole) < len(values):
				short.append(f"{target.curve}: {len(values) - len(whole)} of {len(values)} tests end before {target.strain[-1]:.4g}, and do not count")
			rows[target.key] = numpy.array(whole)
		self._sets.append(rows if all(map(len, rows.values())) else None)
		return list(dict.fromkeys(short))

	def __len__(self):
		return len(self._sets)

	def mean(self, k, target):
		"""Mean over seeds of set k at the target's strains; None when it failed."""
		return None if self._sets[k] is None else self._sets[k][target.key].mean(axis=0)

	def packing(self, target):
		"""Standard deviation over seeds at the target's strains, pooled; zeros when no set has two seeds."""
		squares, freedom = numpy.zeros(len(target.strain)), 0
		for rows in self._sets:
			if rows is not None and len(rows[target.key]) > 1:
				squares += rows[target.key].var(axis=0, ddof=0) * len(rows[target.key])
				freedom += len(rows[target.key]) - 1
		return numpy.sqrt(squares / max(freedom, 1))

	def covariance(self, target, seeds, model):
		"""(points, points) covariance of laboratory less mean of ``seeds`` tests at the target's strains; ``model``: the share that the model is wrong by."""
		rough = numpy.sqrt(self.packing(target) ** 2 * (1 + 1 / seeds) + READING[target.quantity] ** 2)
		smooth = model * abs(target.value - target.value[0]).max()
		apart = (target.strain[:, None] - target.strain) / LENGTH
		return numpy.outer(rough, rough) * numpy.exp(-abs(apart)) + smooth**2 * numpy.exp(-0.5 * apart**2)

	def logLikelihood(self):
		"""(sets,) log likelihoods; -inf for a set whose tests failed."""
		return logsumexp([self._ofModel(model) for model in self._models], axis=0) - math.log(len(self._models))

	def modelError(self, weight):
		"""(mean, low, high) of the model error, a share: its root mean square and a 95 % interval; all the same where it is given. ``weight``: (sets,) of the sets."""
		chance = numpy.zeros(len(self._models))
		each = numpy.array([self._ofModel(model) for model in self._models])
		for k in numpy.flatnonzero(weight):
			chance += weight[k] * numpy.exp(each[:, k] - logsumexp(each[:, k]))
		models, risen = numpy.array(self._models), numpy.cumsum(chance) / chance.sum()
		low, high = (models[min(int(numpy.searchsorted(risen, share)), len(models) - 1)] for share in (0.025, 0.975))
		return float(numpy.sqrt(chance @ models**2 / chance.sum())), float(low), float(high)

	def _ofModel(self, model):
		"""(sets,) log likelihoods at a model error."""
		found = numpy.full(len(self._sets), -numpy.inf)
		factors = {}
		for k, rows in enumerate(self._sets):
			if rows is None:
				continue
			total = 0.0
			for target in self.targets:
				seeds = len(rows[target.key])
				if (target.key, seeds) not in factors:
					factors[target.key, seeds] = self._factor(target, seeds, model)
				factor, logDeterminant = factors[target.key, seeds]
				apart = rows[target.key].mean(axis=0) - target.value
				total -= 0.5 * (apart @ cho_solve(factor, apart) + logDeterminant)
			found[k] = total
		return found

	def _factor(self, target, seeds, model):
		covariance = self.covariance(target, seeds, model)
		covariance[numpy.diag_indices_from(covariance)] *= 1 + 1e-9
		factor = cho_factor(covariance, lower=True)
		return factor, 2 * float(numpy.log(numpy.diag(factor[0])).sum())
