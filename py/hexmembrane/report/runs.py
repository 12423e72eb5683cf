# SPDX-License-Identifier: GPL-2.0-or-later
"""What the folder of a test holds, whole or not: what cannot be read is left out and told of. Uses nothing of YADE."""

import dataclasses
import json
import pathlib
import re

import numpy as np

from hexmembrane.configuration import Config, ConfigError
from hexmembrane.configuration.config import Output
from hexmembrane.configuration.reader import read as readYaml
from hexmembrane.configuration.schema import build
from hexmembrane.configuration.stages import ISOTROPIC, MEMBRANE, plan
from hexmembrane.output import records, tables

#: Folder of a study's stages under it, and the one of a test in a stage, see scripts/sweep.
_STUDY, _STAGES, _TEST = "plan.json", "stages", "test"
#: How the state of a test ends that is not at its end.
_HALF = ": not at its end"
#: Strains below this are told as 0.
_SETTLING = 1e-6
#: Keys that differ without that they tell tests apart: where files are, what is written, what is compared with.
_QUIET = ("output.", "lab.", "specimen.packing", "specimen.gradation", "specimen.balls", "numerics.threads")
#: What is told of a key that a configuration does not have.
_ABSENT = "not given"
#: A test is told by so many keys at most; with more its title says it better.
_TELLING = 4


class ReportError(ValueError):
	"""There is nothing that a report could be made of."""


def _told(strain):
	"""A strain as it is told: the settling before the first row is 0."""
	return 0.0 if abs(strain) < _SETTLING else strain


def _short(value):
	"""A value of a key as a reader wants it."""
	return f"{value:g}" if isinstance(value, float) else str(value)


@dataclasses.dataclass
class Run:
	"""A test.

	:param folder: of the test. :param name: in the report. :param config: its keys, nested. :param text: of its config.yaml.
	:param made: what made it, by name. :param table: of its records, {} without. :param problems: what is missing or damaged, sentences.
	:param values: keys that tell it from the others of a report, {} where there are none or too many.
	"""

	folder: pathlib.Path
	name: str
	config: dict = dataclasses.field(default_factory=dict)
	text: str = ""
	made: dict = dataclasses.field(default_factory=dict)
	table: dict = dataclasses.field(default_factory=dict)
	problems: list = dataclasses.field(default_factory=list)
	values: dict = dataclasses.field(default_factory=dict)

	@property
	def title(self):
		return str(self.config.get("title") or self.name)

	def label(self, but=()):
		"""What tells it from the others, without the keys in ``but``: 'friction 0.3, seed 1'."""
		return ", ".join(f"{key.rsplit('.', 1)[-1]} {_short(value)}" for key, value in self.values.items() if key not in but)

	def key(self, section, name, default=None):
		"""A key of the configuration."""
		values = self.config.get(section)
		value = values.get(name) if isinstance(values, dict) else None
		return default if value is None else value

	def rows(self, stage):
		"""The rows of a stage: column -> array; {} without any."""
		chosen = np.array([name == stage for name in self.table.get("stage", [])], dtype=bool)
		return {name: column[chosen] for name, column in self.table.items() if name != "stage"} if chosen.any() else {}

	@property
	def staged(self):
		"""Whether its configuration has a list of stages."""
		return isinstance(self.config.get("stages"), list)

	@property
	def boundary(self):
		"""Keyword of the lateral boundary that its shear has."""
		listed = self.config["stages"] if self.staged else []
		changed = any(isinstance(stage, dict) and stage.get("kind") == MEMBRANE for stage in listed)
		return "wall" if self.config.get("boundary") == "wall" and not changed else "membrane"

	def kinds(self):
		"""The kind of the stage of each row: 'unloading' of 'unloading-2'."""
		return [re.sub(r"-\d+$", "", str(name)) for name in self.table.get("stage", [])]

	def sheared(self, but=()):
		"""The rows after a consolidation, of all stages but those of the kinds in ``but``; {} without any."""
		chosen = np.array([kind not in (*ISOTROPIC, *but) for kind in self.kinds()], dtype=bool)
		return {name: column[chosen] for name, column in self.table.items() if name != "stage"} if chosen.any() else {}

	def at(self, strains, steps):
		"""Where states are on the page's slider: at their strains; of a list of stages, which pass through a strain several times, at their times [s]."""
		return np.interp(steps, self.table["step"], self.table["time"]) if self.staged and self.table else np.asarray(strains, dtype=float)

	def state(self):
		"""'sheared to 12 %', or how far it is."""
		if self.staged:
			return self._stateOfStages()
		shear, wanted = self.rows("shear"), self.key("shear", "strain")
		if not shear:
			return "consolidation, no shear yet" if self.rows("consolidation") else "no rows yet"
		strain = _told(shear["axial_strain"][-1])
		ended = isinstance(wanted, (int, float)) and strain >= (1 - 0.5 / self.key("output", "records", Output.records)) * wanted
		return f"sheared to {100 * strain:.4g} %" + ("" if ended or wanted is None else f" of {100 * wanted:.4g} %{_HALF}")

	def _stateOfStages(self):
		if not self.table:
			return "no rows yet"
		now, strain = str(self.table["stage"][-1]), _told(self.table["axial_strain"][-1])
		try:
			planned = plan(build(Config, self.config))
			labels = [stage.label for stage in planned]
			begun = f"stage {now}, {labels.index(now) + 1} of {len(labels)}, at {100 * strain:.4g} %"
		except (ConfigError, ValueError):
			return f"stage {now} of a list that cannot be read{_HALF}"
		ended = now == labels[-1] and (self.folder / f"{planned[-1].state}.yade.gz").is_file()
		return f"through {len(labels)} stages, at {100 * strain:.4g} %" if ended else begun + _HALF

	@property
	def ended(self):
		"""Whether its shear, or its last stage, has come to its end."""
		return self.state().startswith(("sheared", "through")) and not self.state().endswith(_HALF)


def read(folder, name=None):
	"""The :class:`Run` in a folder."""
	folder = pathlib.Path(folder)
	run = Run(folder, name or folder.resolve().name)
	_readConfiguration(run)
	damage = []
	try:
		run.table = records.read(folder / "records.csv", damage)
	except FileNotFoundError:
		run.problems.append("There is no records.csv: no row has been written yet.")
	except (OSError, ValueError) as error:
		run.problems.append(f"records.csv cannot be read: {error}")
	run.problems += damage
	if run.table and not run.ended:
		run.problems.append(f"The test is not at its end: {run.state().removesuffix(_HALF)}.")
	return run


def _readConfiguration(run):
	path = run.folder / "config.yaml"
	try:
		run.text = path.read_text(encoding="utf-8")
		found = readYaml(path)
		if not isinstance(found, dict):
			raise ValueError("it is no mapping of keys")
		run.made = found.pop("made", None) or {}
		run.config = found
	except FileNotFoundError:
		run.problems.append("There is no config.yaml: limits are those of the defaults, or unknown.")
	except (OSError, ValueError) as error:
		run.problems.append(f"config.yaml cannot be read: {error}")
	if not isinstance(run.made, dict):
		run.made = {}


def digests(run):
	"""{file: SHA-256} of the manifest, {} without a readable one."""
	try:
		files = json.loads((run.folder / "manifest.json").read_text(encoding="utf-8"))["files"]
		return {str(name): str(entry["sha256"]) for name, entry in files.items()}
	except (OSError, ValueError, KeyError, TypeError, AttributeError):
		return {}


def table(run, name, text=()):
	"""A table such as bands.csv in the run's folder; None without, damage is told of."""
	damage = []
	try:
		return tables.read(run.folder / name, text, damage=damage)
	except FileNotFoundError:
		return None
	except (OSError, ValueError) as error:
		damage.append(f"{name} cannot be read: {error}")
		return None
	finally:
		run.problems += damage


def gather(folders):
	"""The runs of folders of tests and of studies.

	:raises ReportError: a folder is neither.
	"""
	found = []
	for folder in map(pathlib.Path, folders):
		if (folder / _STUDY).is_file():
			found += _study(folder)
		elif folder.is_dir():
			if not any((folder / name).exists() for name in ("records.csv", "config.yaml", "manifest.json")):
				raise ReportError(f"DIR = '{folder}': holds no test and no study; fix: give the output folder of scripts/run or scripts/sweep")
			found.append(read(folder))
		else:
			raise ReportError(f"DIR = '{folder}': there is no such folder; fix: give the output folder of scripts/run or scripts/sweep")
	found = _distinct(found)
	_label(found)
	return found


def _study(folder):
	try:
		plan = json.loads((folder / _STUDY).read_text(encoding="utf-8"))
		places = [(run["name"], folder / _STAGES / run["stages"]["shear"] / _TEST) for run in plan["runs"]]
		values = [{**run.get("values", {}), **({"specimen.seed": run["seed"]} if "seed" in run else {})} for run in plan["runs"]]
	except (OSError, ValueError, KeyError, TypeError) as error:
		raise ReportError(f"DIR = '{folder}': its plan.json cannot be read ({error!r}); fix: plan the study again with scripts/sweep --dry-run") from None
	found = [read(place, name) for name, place in places]
	for run, told in zip(found, values):
		run.values = told
	return found


def differences(found):
	"""Keys in which tests differ, their titles left out: {"key", "values"}, texts."""
	return [{"key": key, "values": list(map(str, values))} for key, values in _differing(found)]


def _differing(found):
	"""(key, its values) of each key in which the configurations differ."""
	flat = [{} for _ in found]

	def visit(values, path, into):
		for name, value in values.items():
			at = f"{path}.{name}" if path else str(name)
			if isinstance(value, dict):
				visit(value, at, into)
			else:
				into[at] = value

	for run, into in zip(found, flat):
		visit({name: value for name, value in run.config.items() if name != "title"}, "", into)
	keys = list(dict.fromkeys(key for one in flat for key in one))
	rows = [(key, [one.get(key, _ABSENT) for one in flat]) for key in keys]
	return [(key, values) for key, values in rows if len(set(map(str, values))) > 1]


def _label(found):
	"""Sets what tells each test from the others, unless a study has said so."""
	own = [run for run in found if not run.values]
	telling = [(key, values) for key, values in _differing(own) if not key.startswith(_QUIET)]
	if len(telling) <= _TELLING:
		for k, run in enumerate(own):
			run.values = {key: values[k] for key, values in telling if values[k] != _ABSENT}


def _distinct(found):
	"""The runs, each with a name of its own."""
	seen = {}
	for run in found:
		seen[run.name] = seen.get(run.name, 0) + 1
		if seen[run.name] > 1:
			run.name = f"{run.name} ({seen[run.name]})"
	return found
