# SPDX-License-Identifier: GPL-2.0-or-later
"""A study's file: a base configuration, axes and seeds. All its tests are checked before one runs."""

import dataclasses
import difflib
import itertools
import os
import pathlib
import re

from dependence import flat, stageOf
from hexmembrane import configuration
from hexmembrane.configuration import Config, ConfigError, derived, toDict
from hexmembrane.configuration.specimen import PATHS
from hexmembrane.configuration.reader import read

#: Key of a study's file -> what it is.
KEYS = {
	"title": "a name for tables and figures; none: the file's",
	"base": "a configuration: the name of its file, relative to this one, or its keys",
	"changes": "keys of all tests that differ from the base",
	"axes": "key path -> list of its values",
	"combine": "'product': every value with every other; 'list': the first of each axis, the second of each, ...",
	"seeds": "list of specimen.seed, or how many, from 1; none: the base's",
	"sets": "several studies in one: name -> its own changes, axes, combine and seeds; what they share is run once",
	"attempts": "how often a stage is tried before it counts as failed (2)",
	"report": "whether the study's page is written at the end, report.html (true)",
}
#: Keys that a set of ``sets`` may have; a study has either them or ``sets``, beside the changes of all.
SET_KEYS = ("changes", "axes", "combine", "seeds")
#: The axis that names a run's set, and an axis' value in a run of a set that does not have it.
SET, NOT_VARIED = "set", "-"
_SET_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _-]*")
SEED = "specimen.seed"
MOST_ATTEMPTS = 20


@dataclasses.dataclass
class Run:
	"""One test: ``name``, its ``values`` by key path of the axes (and SET), ``seed``, checked ``config``."""

	name: str
	values: dict
	seed: int
	config: Config


@dataclasses.dataclass
class Study:
	"""A checked study."""

	title: str
	axes: list
	runs: list
	attempts: int
	source: dict


def load(path):
	"""The :class:`Study` in a YAML file.

	:raises ConfigError: the file or one of its tests is wrong; the message says which.
	"""
	path = pathlib.Path(path)
	given = read(path)
	if not isinstance(given, dict):
		raise ConfigError("study", str(path), "is not a mapping of keys", "write 'key: value' lines")
	for name in given:
		if name not in KEYS:
			raise ConfigError(f"study.{name}", given[name], "unknown key", f"{_guess(name, KEYS)}known keys are {', '.join(KEYS)}")
	wantsPage(given)
	base = baseOf(given, path.parent)
	if "sets" in given:
		axes, runs = _sets(given, base, path.parent)
	else:
		axes, runs = _designed(given, base, path.parent, 1)
	return Study(titleOf(given, path), axes, runs, attemptsOf(given.get("attempts", 2)), given)


def _sets(given, base, folder):
	"""(axes, runs) of a study of sets; a run has '-' for an axis that its set does not have."""
	sets = given["sets"]
	if not isinstance(sets, dict) or not sets:
		raise ConfigError("study.sets", sets, "are no sets", "write 'name:' lines, each with axes, changes or seeds below it")
	for name in ("axes", "combine", "seeds"):
		if name in given:
			raise ConfigError(f"study.{name}", given[name], "stands beside sets", "give it in each set")
	found = []
	for name, own in sets.items():
		if not _SET_NAME.fullmatch(str(name)):
			raise ConfigError("study.sets", name, "is no name of a set, which is that of a file too", "use letters, digits, spaces, _ and -, a letter or digit first")
		if not isinstance(own, dict):
			raise ConfigError(f"sets.{name}", own, "is not a mapping of keys", f"give {', '.join(SET_KEYS)}")
		for key in own:
			if key not in SET_KEYS:
				raise ConfigError(f"sets.{name}.{key}", own[key], "unknown key", f"{_guess(key, SET_KEYS)}known keys are {', '.join(SET_KEYS)}")
		changed = derived(base, _changes(own, folder))
		found.append((str(name), *_designed(own, changed, folder, 1 + sum(len(runs) for _, _, runs in found))))
	axes = list(dict.fromkeys(key for _, keys, _ in found for key in keys))
	runs = []
	for name, _, of in found:
		runs += [dataclasses.replace(run, values={SET: name, **{key: run.values.get(key, NOT_VARIED) for key in axes}}) for run in of]
	return [SET, *axes], runs


def _designed(given, base, folder, first):
	"""(axes, runs) of one design: axes, how they combine, seeds; runs are numbered from ``first``."""
	axes = _axes(given.get("axes"), base, folder)
	seeds = seedsOf(given.get("seeds"), base)
	runs = []
	for number, (values, seed) in enumerate(itertools.product(_combined(axes, given.get("combine", "product")), seeds), first):
		runs.append(_run(number, values, seed, base))
	for key in axes:
		if all(stageOf(key, run.config) is None for run in runs):
			raise ConfigError(f"axes.{key}", axes[key], "changes no result of these tests", "take it out")
	if len(seeds) > 1 and all(stageOf(SEED, run.config) is None for run in runs):
		raise ConfigError("seeds", seeds, "change nothing, the packing is a file", "take them out, or give specimen.gradation")
	return list(axes), runs


def wantsPage(given):
	"""Whether a study's file, as it was read, asks for a page."""
	wanted = given.get("report", True)
	if not isinstance(wanted, bool):
		raise ConfigError("study.report", wanted, "is neither true nor false", "write true or false")
	return wanted


def _guess(name, known):
	close = difflib.get_close_matches(str(name), known, 1, 0.6)
	return f"did you mean '{close[0]}'? " if close else ""


def titleOf(given, path):
	title = given.get("title", path.name.removesuffix(".yaml"))
	if not isinstance(title, str):
		raise ConfigError("study.title", title, "is not text", "give a name")
	return title


def baseOf(given, folder):
	base = given.get("base")
	if isinstance(base, str):
		config = configuration.load(folder / base)
	elif isinstance(base, dict):
		config = Config.of(base, folder)
	else:
		raise ConfigError("study.base", base, "is no configuration", f"give {KEYS['base']}")
	return derived(config, _changes(given, folder))


def _changes(given, folder):
	"""The key ``changes`` of a study or a set."""
	changes = given.get("changes", {})
	if not isinstance(changes, dict):
		raise ConfigError("study.changes", changes, "is not a mapping of keys", "write 'key: value' lines")
	return resolved(changes, folder)


def resolved(changes, folder):
	"""Changes whose files are named by whole paths."""
	specimen = changes.get("specimen")
	if not isinstance(specimen, dict):
		return changes
	files = {name: os.path.abspath(os.path.join(folder, os.path.expanduser(specimen[name]))) for name in PATHS if isinstance(specimen.get(name), str)}
	return {**changes, "specimen": {**specimen, **files}}


def nested(values):
	"""{key path: value} as nested dictionaries."""
	made = {}
	for key, value in values.items():
		*sections, name = key.split(".")
		place = made
		for section in sections:
			place = place.setdefault(section, {})
		place[name] = value
	return made


def _axes(axes, base, folder):
	axes = {} if axes is None else axes
	if not isinstance(axes, dict):
		raise ConfigError("study.axes", axes, "is not a mapping", "write lines such as 'specimen.friction: [0.3, 0.5]'")
	known = flat(toDict(base))
	for key, values in axes.items():
		if key not in known:
			raise ConfigError(f"axes.{key}", values, "is no key of a configuration", f"{_guess(key, known)}give a path such as specimen.friction")
		if key == SEED:
			raise ConfigError(f"axes.{key}", values, "is what means are taken over", "give it as seeds")
		if not isinstance(values, list) or not values or any(isinstance(value, (list, dict)) for value in values):
			raise ConfigError(f"axes.{key}", values, "is not a list of values", "write [first, second, ...]")
	return {key: [flat(resolved(nested({key: value}), folder))[key] for value in values] for key, values in axes.items()}


def _combined(axes, how):
	if how not in ("product", "list"):
		raise ConfigError("study.combine", how, "is not one of the choices", "use 'product' or 'list'")
	lengths = {key: len(values) for key, values in axes.items()}
	if how == "list" and len(set(lengths.values())) > 1:
		raise ConfigError("study.combine", how, f"axes have {lengths} values", "give each axis as many, or combine: product")
	rows = zip(*axes.values(), strict=True) if how == "list" and axes else itertools.product(*axes.values())
	return [dict(zip(axes, row)) for row in rows]


def seedsOf(seeds, base):
	if seeds is None:
		return [base.specimen.seed]
	whole = isinstance(seeds, int) and not isinstance(seeds, bool)
	if whole and 1 <= seeds <= 100000:
		return list(range(1, seeds + 1))
	if whole or not isinstance(seeds, list) or not seeds or len(set(map(str, seeds))) < len(seeds):
		raise ConfigError("study.seeds", seeds, "is neither a number of seeds nor a list of different ones", "give seeds: 5 or seeds: [1, 2, 7]")
	return seeds


def attemptsOf(attempts):
	if isinstance(attempts, bool) or not isinstance(attempts, int) or not 1 <= attempts <= MOST_ATTEMPTS:
		raise ConfigError("study.attempts", attempts, f"is not a whole number from 1 to {MOST_ATTEMPTS}", "give one")
	return attempts


def wrongRun(name, values, error):
	"""The error that says which run has another error."""
	wrong, _, fix = str(error).partition("; fix: ")
	return ConfigError("study", f"run {name}: " + ", ".join(f"{key} = {value}" for key, value in values.items()), wrong, fix)


def _run(number, values, seed, base):
	name = f"{number:04d}"
	try:
		config = derived(base, nested({**values, SEED: seed}))
	except ConfigError as error:
		raise wrongRun(name, {**values, SEED: seed}, error) from None
	checked = flat(toDict(config))
	return Run(name, {key: checked[key] for key in values}, config.specimen.seed, config)
