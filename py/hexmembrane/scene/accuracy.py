# SPDX-License-Identifier: GPL-2.0-or-later
"""What the settings of a test cost in accuracy: its error budget, and the cheapest settings within an error. Uses nothing of YADE.

Each knob's curve was measured on packings that differ in nothing else (``scripts/bench accuracy``; the page with figures:
examples/accuracy/README.md): the mean difference to a converged reference, and the half width of its 95 % interval. With b_k the sum of
both for the knob k, the settings' systematic error is at most sum b_k. One run differs from the mean of many by its *scatter* too: grains
that start the least bit otherwise take other paths. The budget of a run is sum b_k + 2 scatter. The scatter was measured at 1,200 grains
and goes with 1/sqrt(N).
"""

import csv
import dataclasses
import itertools
import math
import pathlib
from typing import Callable

import numpy

from hexmembrane.configuration import ConfigError
from hexmembrane.scene import timestep

#: What errors are told of: columns' names in the curves, and in words.
QUANTITIES = {"peak q": "peak of q, relative", "volumetric strain": "volumetric strain at 15 %, absolute"}
#: Grains of the packings on which the curves were measured.
GRAINS = 1200
_FILE = pathlib.Path(__file__).with_name("accuracy.csv")
#: Parts that the way between two measured levels is divided into when settings are chosen.
_BETWEEN = 2


@dataclasses.dataclass(frozen=True)
class Knob:
	"""A setting with a curve.

	:param name: in the curves.
	:param key: the configuration's key.
	:param level: the dimensionless level x of a configuration; ``level(config, radii)``.
	:param value: the key's value at a level; None: the level itself.
	:param chosen: whether ``accuracy`` may choose it.
	"""

	name: str
	key: str
	level: Callable
	value: Callable = None
	chosen: bool = True

	def applies(self, config):
		"""Whether the setting means something in this test."""
		return not self.key.startswith("membrane.") or config.boundary == "membrane"


def _rate(config, radii):
	"""Strain rate at a platens' velocity of 1 m/s as an inertial number."""
	return timestep.inertialTime(radii, config.specimen.density, config.consolidation.pressure) / config.specimen.height


def _sizeRatio(config, radii):
	given = config.membrane.particleRadius
	return config.membrane.sizeRatio if given is None else given / float(numpy.min(radii))


KNOBS = (
	Knob("velocity", "shear.velocity", lambda c, r: c.shear.velocity * _rate(c, r), lambda x, c, r: x / _rate(c, r)),
	Knob(
		"stiffness",
		"specimen.emod",
		lambda c, r: timestep.stiffnessLevel(c.specimen.emod, c.consolidation.pressure),
		lambda x, c, r: 4 * c.consolidation.pressure * x / math.pi,
	),
	Knob("time step", "numerics.safety", lambda c, r: c.numerics.safety, lambda x, c, r: x),
	Knob("damping", "numerics.damping", lambda c, r: c.numerics.damping, chosen=False),
	Knob("membrane size", "membrane.sizeRatio", _sizeRatio, lambda x, c, r: x),
)


@dataclasses.dataclass
class Curve:
	"""A knob's error against its level, by quantity; ascending levels."""

	x: numpy.ndarray
	mean: dict
	halfWidth: dict
	time: numpy.ndarray

	def bound(self, quantity, x):
		"""Largest systematic error at levels x: |mean| and half width, linear in log x between what was measured, its end beyond the reference."""
		bound = numpy.abs(self.mean[quantity]) + self.halfWidth[quantity]
		return numpy.interp(numpy.log(x), numpy.log(self.x), bound)

	def cost(self, x):
		"""Time of a test, relative to the base's."""
		return numpy.exp(numpy.interp(numpy.log(x), numpy.log(self.x), numpy.log(self.time)))

	def covers(self, x):
		return self.x[0] * (1 - 1e-9) <= x <= self.x[-1] * (1 + 1e-9)


@dataclasses.dataclass
class Measured:
	"""What the study found: curves by knob, and the scatter of one run by quantity, at GRAINS grains."""

	curves: dict
	scatter: dict
	packings: dict

	@classmethod
	def of(cls, path=_FILE):
		"""The measurements in a file of ``scripts/bench accuracy``."""
		with open(path, encoding="utf-8") as file:
			rows = [row for row in csv.DictReader(file) if row["quantity"] in QUANTITIES]
		scatter, packings = ({row["quantity"]: float(row["scatter"]) for row in rows if row["knob"] == name} for name in ("run to run", "packings"))
		curves = {}
		for knob in {row["knob"] for row in rows} & {knob.name for knob in KNOBS}:
			parts = {name: sorted((row for row in rows if (row["knob"], row["quantity"]) == (knob, name)), key=lambda row: float(row["x"])) for name in QUANTITIES}
			any_ = parts["peak q"]
			columns = {column: {name: numpy.array([float(row[column]) for row in part]) for name, part in parts.items()} for column in ("mean", "half_width")}
			x, time = (numpy.array([float(row[column]) for row in any_]) for column in ("x", "time"))
			curves[knob] = Curve(x, columns["mean"], columns["half_width"], time)
		return cls(curves, scatter, packings)


@dataclasses.dataclass
class Budget:
	"""The error budget of a test.

	:param parts: (key, value, level, bounds by quantity) of each knob; bounds are None where the level is outside what was measured.
	:param scatter: of one run, by quantity.
	:param packings: of packings that differ in their seed alone, by quantity.
	"""

	parts: list
	scatter: dict
	packings: dict

	def systematic(self, quantity):
		"""Sum of the bounds of all knobs that were measured there."""
		return sum(bounds[quantity] for *_, bounds in self.parts if bounds)

	def total(self, quantity):
		"""Largest error of one run that is to be expected: systematic and two scatters."""
		return self.systematic(quantity) + 2 * self.scatter[quantity]

	def unmeasured(self):
		"""Keys whose level is outside what was measured."""
		return [key for key, *_, bounds in self.parts if bounds is None]

	def lines(self):
		"""The budget in words, a line each."""
		said = ["error budget        peak of q   volumetric strain"]
		for key, value, x, bounds in self.parts:
			costs = f"{100 * bounds['peak q']:6.2f} %      {100 * bounds['volumetric strain']:.3f} %" if bounds else "  outside what was measured"
			said.append(f"  {key:<18}{costs}   ({value:.4g}, level {x:.3g})")
		for name, part in (("scatter of a run", self.scatter), ("scatter, packings", self.packings)):
			said.append(f"  {name:<18}{100 * part['peak q']:6.2f} %      {100 * part['volumetric strain']:.3f} %")
		said.append(f"  {'budget of a run':<18}{100 * self.total('peak q'):6.2f} %      {100 * self.total('volumetric strain'):.3f} %")
		return said

	def asDict(self):
		"""For the resolved configuration."""
		parts = {key: {"level": float(f"{x:.4g}"), **({name: float(f"{cost:.3g}") for name, cost in bounds.items()} if bounds else {"measured": False})} for key, _, x, bounds in self.parts}
		sums = {"scatter of a run": self.scatter, "scatter of packings": self.packings, "budget of a run": {name: self.total(name) for name in QUANTITIES}}
		return {**parts, **{title: {name: float(f"{cost:.3g}") for name, cost in part.items()} for title, part in sums.items()}}


def _scattered(scatter, count):
	return {name: value * math.sqrt(GRAINS / count) for name, value in scatter.items()}


def budget(config, radii, measured=None):
	"""The :class:`Budget` of a configuration.

	:param config: checked configuration.
	:param radii: of its grains [m].
	"""
	measured = measured or Measured.of()
	parts = []
	for knob in KNOBS:
		if knob.applies(config) and knob.name in measured.curves:
			curve, x = measured.curves[knob.name], knob.level(config, radii)
			bounds = {name: float(curve.bound(name, x)) for name in QUANTITIES} if curve.covers(x) else None
			parts.append((knob.key, _get(config, knob.key), x, bounds))
	return Budget(parts, _scattered(measured.scatter, len(radii)), _scattered(measured.packings, len(radii)))


def _get(config, key):
	section, name = key.split(".")
	return getattr(getattr(config, section), name)


def openKeys(config):
	"""Keys that ``accuracy`` chooses, since the configuration leaves them out."""
	given = config.given | ({"membrane.sizeRatio"} if config.membrane.particleRadius is not None else set())
	return [knob.key for knob in KNOBS if knob.chosen and knob.applies(config) and knob.key not in given]


def choose(config, radii, measured=None):
	"""Give the keys that the configuration leaves open the cheapest values whose budget of the peak of q stays within ``config.accuracy``.

	:param config: checked configuration with ``accuracy``; changed. Keys that were given stay.
	:param radii: of its grains [m].
	:returns: {key: value} of what was chosen.
	:raises ConfigError: no settings do; a given key is outside what was measured.
	"""
	measured = measured or Measured.of()
	knobs = [knob for knob in KNOBS if knob.applies(config) and knob.name in measured.curves]
	free = [knob for knob in knobs if knob.key in openKeys(config)]
	kept = sum(_bound(knob, measured, config, radii) for knob in knobs if knob not in free)
	left = config.accuracy - kept - 2 * _scattered(measured.scatter, len(radii))["peak q"]
	levels = [_levels(measured.curves[knob.name].x) for knob in free]
	bounds, costs = (
		[getattr(measured.curves[knob.name], what)(*arguments, x) for knob, x in zip(free, levels)]
		for what, arguments in (("bound", ("peak q",)), ("cost", ()))
	)
	least = sum(float(bound.min()) for bound in bounds)
	if least > left:
		raise ConfigError(
			"accuracy",
			config.accuracy,
			f"is out of reach: {100 * kept:.2g} % are lost by keys that are given, {100 * least:.2g} % at least by the others, and two scatters of a run are "
			f"{200 * _scattered(measured.scatter, len(radii))['peak q']:.2g} %",
			f"accuracy: {math.ceil(1000 * (config.accuracy - left + least)) / 1000:g} or more, or more grains, or leave keys out",
		)
	best = min(
		(pick for pick in itertools.product(*(range(len(x)) for x in levels)) if sum(bound[i] for bound, i in zip(bounds, pick)) <= left),
		key=lambda pick: math.prod(cost[i] for cost, i in zip(costs, pick)),
	)
	chosen = {knob.key: float(f"{knob.value(x[i], config, radii):.4g}") for knob, x, i in zip(free, levels, best)}
	for key, value in chosen.items():
		section, name = key.split(".")
		setattr(getattr(config, section), name, value)
	return chosen


def _bound(knob, measured, config, radii):
	curve, x = measured.curves[knob.name], knob.level(config, radii)
	if not curve.covers(x):
		raise ConfigError(
			knob.key, _get(config, knob.key), f"is at level {x:.3g}, and errors were measured from {curve.x[0]:.3g} to {curve.x[-1]:.3g} only",
			"leave the key out, or leave accuracy out",
		)  # fmt: skip
	return float(curve.bound("peak q", x))


def _levels(x):
	"""Measured levels and some between."""
	return numpy.exp(numpy.interp(numpy.arange(_BETWEEN * (len(x) - 1) + 1) / _BETWEEN, numpy.arange(len(x)), numpy.log(x)))
