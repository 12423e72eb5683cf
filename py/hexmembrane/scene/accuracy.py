# SPDX-License-Identifier: GPL-2.0-or-later
"""What the settings of a test cost in accuracy: its error budget, and the cheapest settings within an error. Uses nothing of YADE.

Each knob's curve was measured on packings that differ in nothing else (``scripts/bench accuracy``; the page with figures:
examples/accuracy/README.md): the mean difference m_k to a converged reference, the half width h_k of its 95 % interval, and the scatter s_k of the
difference from packing to packing. Runs that differ by rounding alone scatter by s_0: grains that start the least bit otherwise take other paths.
The budget of a run, the largest difference to a run with all knobs at their references that is to be expected in 95 of 100, is

	sum |m_k| + sqrt(sum h_k^2 + 4 s^2),   s^2 = s_0^2 + sum max(0, s_k^2 - s_0^2)

Errors of one sign are not set off against those of the other. Scatter was measured at 1,200 grains and goes with 1/sqrt(N).

Speed costs more on stiff grains, so its curve was measured at two stiffnesses; m, h and s between them are linear in the stiffness' logarithm.
Scaled masses raise the inertial number, so a test pays for them through its velocity too.
"""

import copy
import csv
import dataclasses
import math
import pathlib
from typing import Callable

import numpy

from hexmembrane.configuration import ConfigError
from hexmembrane.configuration.stages import boundaries
from hexmembrane.scene import timestep

#: What errors are told of, as the curves have it: relative, and absolute.
PEAK, VOLUME = QUANTITIES = "peak q", "volumetric strain at 15 %"
#: Grains of the packings on which the curves were measured.
GRAINS = 1200
#: The measurements by lateral boundary: ``scripts/bench accuracy publish``. A wall that follows a servo pays more for speed than a membrane under its pressure.
FILES = {"membrane": pathlib.Path(__file__).with_name("accuracy.csv"), "wall": pathlib.Path(__file__).with_name("accuracy-wall.csv")}
#: How far a level may lie beyond the last one measured: chosen values are rounded to four digits.
_ROUNDED = 1e-3
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
		return not self.key.startswith("membrane.") or "membrane" in boundaries(config)


def _heavier(config, radii):
	"""What ``specimen.massScaling`` makes of the inertial number: it goes with the root of the grains' mass."""
	return math.sqrt(timestep.meanMassFactor(radii, config.specimen.springs.direct)) if config.specimen.massScaling else 1.0


def _rate(config, radii):
	"""Strain rate at a platens' velocity of 1 m/s as an inertial number, of the masses that the grains have in the test."""
	return _heavier(config, radii) * timestep.inertialTime(radii, config.specimen.density, config.consolidation.pressure) / config.specimen.height


def _sizeRatio(config, radii):
	given = config.membrane.particleRadius
	return config.membrane.sizeRatio if given is None else given / float(numpy.min(radii))


KNOBS = (
	Knob("velocity", "shear.velocity", lambda c, r: c.shear.velocity * _rate(c, r), lambda x, c, r: x / _rate(c, r)),
	Knob(
		"stiffness",
		"specimen.emod",
		lambda c, r: timestep.levelOf(c.specimen.springs, r, c.consolidation.pressure),
		lambda x, c, r: 4 * c.consolidation.pressure * x / math.pi,
	),
	Knob("step", "numerics.safety", lambda c, r: c.numerics.safety, lambda x, c, r: x),
	Knob("damping", "numerics.damping", lambda c, r: c.numerics.damping, chosen=False),
	Knob("size ratio", "membrane.sizeRatio", _sizeRatio, lambda x, c, r: x),
	# the factor is not known before the scene is there: the largest that was measured
	Knob("density scaling", "membrane.densityScaling", lambda c, r: c.membrane.densityScaling or 64.0, chosen=False),
)
#: The velocity's curve at the stiffest grains; ``velocity`` itself was measured on the base test's.
VELOCITY_ON_STIFF = "velocity on stiff grains"
#: kn/(p d) of the base test and of the stiffest grains.
STIFFNESSES = 100 * math.pi, 3000.0
#: kn/(p d) below which softness was seen to cost more with rolling resistance than the curves say.
_SOFT = 1000
_ROLLING = "WARNING: stiffness was measured without rolling resistance; with it soft grains were up to 17 % too weak (examples/accuracy); fix: kn/(p d) of 1000 or more"
#: The knob of ``specimen.massScaling``, which has no level between on and off.
SWITCH = "mass scaling"


@dataclasses.dataclass
class Curve:
	"""A knob's error against its level, by quantity; ascending levels."""

	x: numpy.ndarray
	mean: dict
	halfWidth: dict
	scatter: dict
	time: numpy.ndarray

	def error(self, quantity, x):
		"""|m|, h and s at levels x, linear in log x between what was measured."""
		parts = numpy.abs(self.mean[quantity]), self.halfWidth[quantity], self.scatter[quantity]
		return tuple(numpy.interp(numpy.log(x), numpy.log(self.x), part) for part in parts)

	def cost(self, x):
		"""Time of a test, relative to the base's."""
		return numpy.exp(numpy.interp(numpy.log(x), numpy.log(self.x), numpy.log(self.time)))

	def covers(self, x):
		return self.x[0] * (1 - _ROUNDED) <= x <= self.x[-1] * (1 + _ROUNDED)


@dataclasses.dataclass
class Measured:
	"""What the study found at GRAINS grains: curves by knob, (|m|, h, s) by quantity and time of SWITCH's levels, s_0 and the scatter of packings by quantity."""

	curves: dict
	switch: dict
	switchTime: dict
	scatter: dict
	packings: dict

	@classmethod
	def of(cls, path=FILES["membrane"]):
		"""The measurements in ``curves.csv`` of ``scripts/bench accuracy``. Runs that differ in the lists' skin alone differ by rounding: they tell the scatter."""
		with open(path, encoding="utf-8") as file:
			rows = [row for row in csv.DictReader(file) if row["quantity"] in QUANTITIES]

		def column(name, knob, quantity):
			return numpy.array([float(row[name]) for row in rows if (row["knob"], row["quantity"]) == (knob, quantity)])

		scatter, packings = ({name: float(column("scatter", knob, name).max()) for name in QUANTITIES} for knob in ("skin", "packings"))
		curves = {}
		for knob in {row["knob"] for row in rows} & {*(knob.name for knob in KNOBS), VELOCITY_ON_STIFF}:
			x = column("x", knob, PEAK)
			rising = x.argsort()
			mean, half = ({name: column(what, knob, name)[rising] for name in QUANTITIES} for what in ("fit", "fit_half_width"))
			spread = {name: _outwards(column("scatter", knob, name)[rising]) for name in QUANTITIES}
			curves[knob] = Curve(x[rising], mean, half, spread, column("time", knob, PEAK)[rising])
		switch, times = {}, {}
		for row in rows:
			if row["knob"] == SWITCH:
				times[row["value"]] = float(row["time"])
				switch.setdefault(row["value"], {})[row["quantity"]] = (abs(float(row["mean"])), float(row["half_width"]), float(row["scatter"]))
		return cls(curves, switch, times, scatter, packings)

	@classmethod
	def forTest(cls, config):
		"""The measurements in a configuration's lateral boundary; in the membrane's where it has both."""
		return cls.of(FILES["membrane" if "membrane" in boundaries(config) else "wall"])

	def error(self, knob, quantity, levels):
		"""|m|, h and s of a knob; ``levels``: the level of each knob by name, numbers or arrays."""
		x = levels[knob]
		found = self.curves[knob].error(quantity, x)
		if knob != "velocity" or VELOCITY_ON_STIFF not in self.curves:
			return found
		low, high = numpy.log(STIFFNESSES)
		share = numpy.clip((numpy.log(levels["stiffness"]) - low) / (high - low), 0, 1)
		return tuple((1 - share) * soft + share * stiff for soft, stiff in zip(found, self.curves[VELOCITY_ON_STIFF].error(quantity, x)))


def _outwards(scatter):
	"""Scatter that does not fall from the reference, whose own is 0, outwards: eight packings tell no dip from chance."""
	reference = int(scatter.argmin())
	low, high = scatter[: reference + 1][::-1], scatter[reference:]
	return numpy.concatenate([numpy.maximum.accumulate(low)[::-1], numpy.maximum.accumulate(high)[1:]])


def _total(errors, floor):
	"""The budget from (|m|, h, s) of all knobs and s_0, scatters as they are with the test's number of grains; numbers or arrays."""
	scatter = floor**2 + sum(numpy.maximum(0, s**2 - floor**2) for _, _, s in errors)
	return sum(mean for mean, _, _ in errors) + numpy.sqrt(sum(half**2 for _, half, _ in errors) + 4 * scatter)


@dataclasses.dataclass
class Budget:
	"""The error budget of a test.

	:param parts: (key, value, level, (|m|, h, s) by quantity) of each knob; None instead where the level is outside what was measured.
	:param scatter: s_0 by quantity.
	:param packings: of packings that differ in their seed alone, by quantity.
	:param elsewhere: what was measured on grains of another kind than the test's, in a sentence; empty: nothing.
	"""

	parts: list
	scatter: dict
	packings: dict
	elsewhere: str = ""

	def total(self, quantity):
		"""The budget of a run, of the knobs that were measured there."""
		return float(_total([errors[quantity] for *_, errors in self.parts if errors], self.scatter[quantity]))

	def unmeasured(self):
		"""Keys whose level is outside what was measured."""
		return [key for key, *_, bounds in self.parts if bounds is None]

	def lines(self):
		"""The budget in words, a line each: mean error +- its half width, scatter."""
		said = [f"error budget              {'peak of q':<22}{VOLUME}"]

		def line(name, peak, volume, more=""):
			said.append(f"  {name:<24}{peak:<22}{volume:<22}{more}".rstrip())

		for key, value, x, errors in self.parts:
			costs = [f"{100 * mean:.2f} +- {100 * half:.2f}, {100 * spread:.2f} %" for mean, half, spread in (errors[name] for name in QUANTITIES)] if errors else ["not measured there", ""]
			line(key, *costs, valueSaid(value) if value is True else f"{valueSaid(value)}, level {x:.3g}")
		for name, part in (("rounding alone", self.scatter), ("scatter of packings", self.packings), ("budget of a run", {name: self.total(name) for name in QUANTITIES})):
			line(name, *(f"{100 * part[name]:.2f} %" for name in QUANTITIES))
		return [*said, f"  {self.elsewhere}"] if self.elsewhere else said

	def asDict(self):
		"""For the resolved configuration: sizes of mean errors, half widths and scatters by key, then the sums; plain numbers."""
		parts = {key: {name: [_short(float(part)) for part in errors[name]] for name in QUANTITIES} if errors else "not measured there" for key, _, _, errors in self.parts}
		sums = {"rounding alone": self.scatter, "scatter of packings": self.packings, "budget of a run": {name: self.total(name) for name in QUANTITIES}}
		return {**parts, **{title: {name: _short(part[name]) for name in QUANTITIES} for title, part in sums.items()}}


def valueSaid(value):
	"""A key's value as a test tells it."""
	return "on" if value is True else "as needed" if value is None else f"{value:.4g}"


def _short(number):
	return float(f"{number:.3g}")


def _scattered(scatter, count):
	return {name: value * math.sqrt(GRAINS / count) for name, value in scatter.items()}


def _withGrains(error, count):
	return tuple(part * share for part, share in zip(error, (1, 1, math.sqrt(GRAINS / count))))


def budget(config, radii, measured=None):
	"""The :class:`Budget` of a configuration.

	:param config: checked configuration.
	:param radii: of its grains [m].
	"""
	measured = measured or Measured.forTest(config)
	parts = []
	knobs = [knob for knob in KNOBS if knob.applies(config) and knob.name in measured.curves]
	levels = {knob.name: knob.level(config, radii) for knob in knobs}
	for knob in knobs:
		x, covered = levels[knob.name], measured.curves[knob.name].covers(levels[knob.name])
		errors = {name: _withGrains(measured.error(knob.name, name, levels), len(radii)) for name in QUANTITIES} if covered else None
		parts.append((_keyOf(knob, config), _get(config, _keyOf(knob, config)), x, errors))
	if config.specimen.massScaling:
		parts.append(("specimen.massScaling", True, math.nan, {name: _withGrains(errors, len(radii)) for name, errors in measured.switch[_switchLevel(config)].items()}))
	soft = config.specimen.rollingFriction > 0 and levels.get("stiffness", math.inf) < _SOFT
	return Budget(parts, _scattered(measured.scatter, len(radii)), _scattered(measured.packings, len(radii)), _ROLLING if soft else "")


def _switchLevel(config):
	if not config.specimen.massScaling:
		return "off"
	return "on with the membrane" if "membrane" in boundaries(config) and config.membrane.densityScaling is None else "on"


def _keyOf(knob, config):
	"""The key that says the knob's value in this configuration."""
	return config.specimen.stiffnessKey if knob.key == "specimen.emod" else knob.key


def _get(config, key):
	section, name = key.split(".")
	return getattr(getattr(config, section), name)


def openKeys(config):
	"""Keys that ``accuracy`` chooses, since the configuration leaves them out."""
	given = config.given | ({"membrane.sizeRatio"} if config.membrane.particleRadius is not None else set())
	given |= {"specimen.emod"} if config.specimen.springs.direct else set()
	return [knob.key for knob in KNOBS if knob.chosen and knob.applies(config) and knob.key not in given]


def choose(config, radii, measured=None):
	"""Give the keys that the configuration leaves open the cheapest values whose budget of the peak of q stays within ``config.accuracy``.

	:param config: checked configuration with ``accuracy``; changed. Keys that were given stay.
	:param radii: of its grains [m].
	:returns: {key: value} of what was chosen; switches of the masses only where they are on.
	:raises ConfigError: no settings do; a given key is outside what was measured.
	"""
	measured = measured or Measured.forTest(config)
	tried = [_cheapest(_with(config, switches), radii, measured) | {"switches": switches} for switches in _switches(config)]
	within = [found for found in tried if found["values"] is not None]
	if not within:
		least, floor = min(found["least"] for found in tried), _scattered(measured.scatter, len(radii))[PEAK]
		raise ConfigError(
			"accuracy",
			config.accuracy,
			f"is out of reach: {100 * least:.2g} % is the least with the keys that are given, {200 * floor:.2g} % of it for rounding alone",
			f"accuracy: {math.ceil(1000 * least) / 1000:g} or more, or more grains, or leave keys out",
		)
	best = min(within, key=lambda found: found["cost"])
	chosen = {**best["values"], **best["switches"]}
	_set(config, chosen)
	return chosen


def _switches(config):
	"""What ``accuracy`` may switch on where the configuration leaves it out: nothing, the grains' scaled masses, and the membrane's density with them."""
	found = [{}]
	if "specimen.massScaling" in config.given:
		return found
	found.append({"specimen.massScaling": True})
	if "membrane" in boundaries(config) and "membrane.densityScaling" not in config.given:
		found.append({"specimen.massScaling": True, "membrane.densityScaling": None})
	return found


def _with(config, values):
	changed = copy.deepcopy(config)
	_set(changed, values)
	return changed


def _set(config, values):
	for key, value in values.items():
		section, name = key.split(".")
		setattr(getattr(config, section), name, value)


def _cheapest(config, radii, measured):
	"""{"values": {key: value} of the open keys at the least cost within the error, None where nothing is; "cost": that; "least": the least error}."""
	knobs = [knob for knob in KNOBS if knob.applies(config) and knob.name in measured.curves]
	levels = [_levels(measured.curves[knob.name].x) if knob.key in openKeys(config) else _level(knob, measured, config, radii) for knob in knobs]
	grid = numpy.meshgrid(*levels, indexing="ij")
	at = {knob.name: x for knob, x in zip(knobs, grid)}
	switch = _switchLevel(config)
	errors = [*(measured.error(knob.name, PEAK, at) for knob in knobs), measured.switch[switch][PEAK]]
	floor = _scattered(measured.scatter, len(radii))[PEAK]
	totals = _total([_withGrains(error, len(radii)) for error in errors], floor)
	slower = _heavier(config, radii)  # times were measured at a velocity, of grains with their own masses
	costs = measured.switchTime[switch] * math.prod(measured.curves[knob.name].cost(x / slower if knob.name == "velocity" else x) for knob, x in zip(knobs, grid))
	best = numpy.unravel_index(numpy.where(totals <= config.accuracy, costs, numpy.inf).argmin(), costs.shape)
	values = {knob.key: float(f"{knob.value(x[best], config, radii):.4g}") for knob, x in zip(knobs, grid) if knob.key in openKeys(config)}
	return {"values": values if totals[best] <= config.accuracy else None, "cost": costs[best], "least": float(totals.min())}


def _level(knob, measured, config, radii):
	"""The one level of a knob that is given."""
	curve, x = measured.curves[knob.name], knob.level(config, radii)
	if not curve.covers(x):
		raise ConfigError(
			_keyOf(knob, config), _get(config, _keyOf(knob, config)), f"is at level {x:.3g}, and errors were measured from {curve.x[0]:.3g} to {curve.x[-1]:.3g} only",
			"leave the key out, or leave accuracy out",
		)  # fmt: skip
	return numpy.array([x])


def _levels(x):
	"""Measured levels and some between."""
	return numpy.exp(numpy.interp(numpy.arange(_BETWEEN * (len(x) - 1) + 1) / _BETWEEN, numpy.arange(len(x)), numpy.log(x)))
