# SPDX-License-Identifier: GPL-2.0-or-later
"""The best fit alone: sets proposed by optuna's tree-structured Parzen estimator, many at a time. Needs no YADE."""

import warnings

import numpy
import optuna
from optuna.distributions import FloatDistribution


class Sampler:
	"""Proposes points of the unit cube, and is told their log likelihoods."""

	def __init__(self, dimensions, seed):
		optuna.logging.set_verbosity(optuna.logging.WARNING)
		self._space = {f"x{k}": FloatDistribution(0, 1) for k in range(dimensions)}
		with warnings.catch_warnings():
			warnings.simplefilter("ignore")  # that options of the sampler are called experimental
			sampler = optuna.samplers.TPESampler(seed=seed, multivariate=True, constant_liar=True)
		self._study = optuna.create_study(direction="maximize", sampler=sampler)

	def ask(self, count):
		"""(count, dimensions) points, none the same as another that is being tried."""
		return numpy.array([list(self._study.ask(self._space).params.values()) for _ in range(count)])

	def tell(self, points, values):
		"""Log likelihoods of points; -inf for a set whose tests failed. Points that were not asked for count as well."""
		for point, value in zip(points, values):
			parameters = dict(zip(self._space, point.tolist()))
			ended = {"state": optuna.trial.TrialState.FAIL} if value == -numpy.inf else {"value": float(value)}
			self._study.add_trial(optuna.trial.create_trial(params=parameters, distributions=self._space, **ended))
