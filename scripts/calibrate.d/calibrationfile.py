# SPDX-License-Identifier: GPL-2.0-or-later
"""A calibration's file: laboratory curves, free parameters, a base configuration. Everything is checked before a test runs."""

import dataclasses
import itertools
import math
import pathlib
from typing import Optional

import numpy
import plan as plans
import studyfile
from dependence import flat, stageOf
from hexmembrane.configuration import ConfigError, derived, toDict
from hexmembrane.configuration.reader import read
from hexmembrane.laboratory import curve as laboratory

#: Key of a calibration's file -> what it is.
KEYS = {
	"title": "a name for tables and figures; none: the file's",
	"base": "a configuration: the name of its file, relative to this one, or its keys",
	"changes": "keys of all tests that differ from the base",
	"curves": "name -> a laboratory test: the keys of its declaration, and 'changes', the keys of its own test such as pressure and porosity",
	"parameters": "key path -> {low, high, scale}: what is free, scale 'linear' (default) or 'log'",
	"seeds": "list of specimen.seed, or how many, from 1: the scatter of packings is measured over them (2)",
	"method": "'bayes' (default): posterior by sequential Monte Carlo; 'best': the best fit alone, by optuna",
	"samples": "sets of parameters a generation (32)",
	"generations": "how many generations (4)",
	"model": "what the best model is wrong by, as share of a curve's largest value (0.03), or `infer`: from the curves themselves",
	"randomSeed": "of the design and the proposals (1)",
	"start": "a table of GrainLearning whose sets are the first generation",
	"attempts": "how often a stage is tried before it counts as failed (2)",
}
_SCALES = ("linear", "log")


@dataclasses.dataclass
class Parameter:
	"""A free key and its range."""

	key: str
	low: float
	high: float
	log: bool

	def value(self, unit):
		"""From [0, 1] to the key's value."""
		if self.log:
			return math.exp(math.log(self.low) + unit * math.log(self.high / self.low))
		return self.low + unit * (self.high - self.low)

	def unit(self, value):
		"""From the key's value to [0, 1]."""
		return math.log(value / self.low) / math.log(self.high / self.low) if self.log else (value - self.low) / (self.high - self.low)


@dataclasses.dataclass
class Laboratory:
	"""One laboratory test: its ``curve`` and the ``config`` of ours."""

	curve: laboratory.Curve
	config: object

	@property
	def end(self):
		"""Strain that all rows of a test cover: the last comes within a step of ``shear.strain``, before or after, so that is less a row."""
		return self.config.shear.strain * (1 - 1 / self.config.output.records)


@dataclasses.dataclass
class Calibration:
	"""A checked calibration; ``tests``: {name: :class:`Laboratory`}."""

	title: str
	tests: dict
	parameters: list
	seeds: list
	method: str
	samples: int
	generations: int
	model: Optional[float]  # None: inferred
	randomSeed: int
	attempts: int
	start: numpy.ndarray | None
	source: dict

	def values(self, point):
		"""{key: value} of a point of the unit cube."""
		return {parameter.key: float(parameter.value(unit)) for parameter, unit in zip(self.parameters, point)}

	def study(self, sets):
		"""The tests of the sets [(name, point)], over all curves and seeds, as a :class:`studyfile.Study`; a set that is no sound test is a ConfigError."""
		runs = []
		for (name, point), (test, found), seed in itertools.product(sets, self.tests.items(), self.seeds):
			values = self.values(point)
			try:
				config = derived(found.config, studyfile.nested({**values, studyfile.SEED: seed}))
			except ConfigError as error:
				raise studyfile.wrongRun(f"{name}-{test}", values, error) from None
			runs.append(studyfile.Run(f"{name}-{test}-{seed}", {"set": name, "curve": test, **values}, seed, config))
		axes = ["set", "curve", *(parameter.key for parameter in self.parameters)]
		return studyfile.Study(self.title, axes, runs, self.attempts, self.source)


def load(path):
	"""The :class:`Calibration` in a YAML file.

	:raises ConfigError: the file, a curve, or a test at a corner of the parameters' ranges is wrong; the message says which.
	"""
	path = pathlib.Path(path)
	given = read(path)
	if not isinstance(given, dict):
		raise ConfigError("calibration", str(path), "is not a mapping of keys", "write 'key: value' lines")
	for name in given:
		if name not in KEYS:
			raise ConfigError(f"calibration.{name}", given[name], "unknown key", f"known keys are {', '.join(KEYS)}")
	base = studyfile.baseOf(given, path.parent)
	tests = _tests(given.get("curves"), base, path.parent)
	parameters = _parameters(given.get("parameters"), base)
	found = Calibration(
		studyfile.titleOf(given, path),
		tests,
		parameters,
		studyfile.seedsOf(given.get("seeds", 2), base),
		_choice(given, "method", ("bayes", "best")),
		_whole(given, "samples", 32, 4, 10000),
		_whole(given, "generations", 4, 1, 100),
		_share(given),
		_whole(given, "randomSeed", 1, 0, 2**31 - 1),
		studyfile.attemptsOf(given.get("attempts", 2)),
		None,
		given,
	)
	found.start = _start(given.get("start"), path.parent, found)
	if found.method == "bayes" and len(found.seeds) < 2:
		raise ConfigError("calibration.seeds", given.get("seeds"), "is one packing, so the scatter of packings cannot be measured", "give seeds: 2 or more")
	_checkCorners(found)
	return found


def _tests(curves, base, folder):
	if not isinstance(curves, dict) or not curves:
		raise ConfigError("calibration.curves", curves, "is not a mapping of curves", "write 'NAME:' and below it file, strain, stress_ratio, ...")
	tests = {}
	for name, declared in curves.items():
		where = f"curves.{name}"
		if not isinstance(declared, dict):
			raise ConfigError(where, declared, "is not a mapping of keys", "give file, strain, stress_ratio, ...")
		changes = declared.get("changes", {})
		if not isinstance(changes, dict):
			raise ConfigError(f"{where}.changes", changes, "is not a mapping of keys", "write 'key: value' lines")
		config = derived(base, studyfile.resolved(changes, folder))
		curve = laboratory.read({key: value for key, value in declared.items() if key != "changes"}, folder, config.consolidation.pressure, where)
		tests[str(name)] = Laboratory(curve, config)
	return tests


def _parameters(parameters, base):
	if not isinstance(parameters, dict) or not parameters:
		raise ConfigError("calibration.parameters", parameters, "is not a mapping of parameters", "write 'specimen.friction: {low: 0.2, high: 0.8}'")
	known, found = flat(toDict(base)), []
	for key, given in parameters.items():
		where = f"parameters.{key}"
		if key not in known or key == studyfile.SEED:
			raise ConfigError(where, given, "is no key of a configuration that can be calibrated", "give a path such as specimen.friction")
		if not isinstance(given, dict) or set(given) - {"low", "high", "scale"} or not {"low", "high"} <= set(given):
			raise ConfigError(where, given, "is no range", "give {low: A, high: B}, and scale: log where it spans decades")
		low, high, scale = given["low"], given["high"], given.get("scale", "linear")
		numbers = all(isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value) for value in (low, high))
		if not numbers or not low < high:
			raise ConfigError(where, f"{low} to {high}", "is no range", "give two numbers, low below high")
		if scale not in _SCALES or scale == "log" and low <= 0:
			raise ConfigError(f"{where}.scale", scale, "is not possible here", "give linear, or log with low above 0")
		found.append(Parameter(key, float(low), float(high), scale == "log"))
	return found


def _choice(given, key, choices):
	value = given.get(key, choices[0])
	if value not in choices:
		raise ConfigError(f"calibration.{key}", value, "is not one of the choices", f"use {' or '.join(choices)}")
	return value


def _whole(given, key, default, low, high):
	value = given.get(key, default)
	if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
		raise ConfigError(f"calibration.{key}", value, f"is not a whole number from {low} to {high}", "give one")
	return value


def _share(given):
	value = given.get("model", 0.03)
	if value == "infer":
		return None
	if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= 1:
		raise ConfigError("calibration.model", value, "is no share from 0 to 1", "give 0.03, say, or infer")
	return float(value)


def _start(name, folder, calibration):
	"""The sets of a table of GrainLearning as points; columns beside the parameters' are passed over."""
	if name is None:
		return None
	path = pathlib.Path(folder) / str(name)
	try:
		lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
		header, rows = lines[0], lines[1:]
		points = [[parameter.unit(float(row[header.index(parameter.key)])) for parameter in calibration.parameters] for row in rows]
	except (OSError, ValueError, IndexError) as error:
		raise ConfigError("calibration.start", str(path), f"cannot be read ({error})", "give a table with a header line that has the parameters' names") from None
	if not points or not all(0 <= unit <= 1 for point in points for unit in point):
		raise ConfigError("calibration.start", str(path), "has a set outside the parameters' ranges, or none", "widen the ranges, or take it out")
	return numpy.array(points)


def _checkCorners(calibration):
	"""All corners of the ranges are sound tests, and each parameter changes a result."""
	corners = list(itertools.product((0.0, 1.0), repeat=len(calibration.parameters))) if len(calibration.parameters) <= 6 else [(0.0,) * len(calibration.parameters), (1.0,) * len(calibration.parameters)]
	study = calibration.study([(f"corner{k}", point) for k, point in enumerate(corners)])
	for parameter in calibration.parameters:
		if all(stageOf(parameter.key, run.config) is None for run in study.runs):
			raise ConfigError(f"parameters.{parameter.key}", f"{parameter.low:g} to {parameter.high:g}", "changes no result of these tests", "take it out")
	plans.make(study)
