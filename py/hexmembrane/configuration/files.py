# SPDX-License-Identifier: GPL-2.0-or-later
"""Configurations from files and from other configurations, and the resolved one that is written back. Uses nothing of YADE itself.

``load('test.yaml')`` reads and checks; ``derived(config, changes)`` changes a checked one; ``save(config, path)`` writes every
key with date and versions, and the written file can be run again.
"""

import datetime
import os
import pathlib
import platform
import subprocess
import sys

import numpy
import yaml

import hexmembrane
from hexmembrane.configuration.config import Config
from hexmembrane.configuration.reader import read
from hexmembrane.configuration.schema import LONGEST_PATH, ConfigError, paths, plainText, toDict
from hexmembrane.configuration.specimen import PATHS


#: Files that a configuration may be made of, one the base of the next.
MOST_BASES = 20


class _Writer(yaml.SafeDumper):
	"""Writes values out where PyYAML would write an alias, which the reader refuses."""

	def ignore_aliases(self, data):
		return True


def merged(base, changes):
	"""Nested dictionaries with changes: those of a section change its keys, everything else is replaced; neither argument is changed."""
	result = dict(base)
	for name, value in changes.items():
		old = result.get(name)
		result[name] = merged(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
	return result


def derived(config, changes):
	"""A checked configuration like ``config`` but for ``changes``, such as ``{"boundary": "wall", "specimen": {"seed": 2}}``; given are its keys and those.

	:raises ConfigError: as ``Config.of``.
	"""
	made = Config.of(merged(toDict(config), changes))
	made.given = config.given | frozenset(paths(changes))
	return made


def load(path):
	"""The checked configuration in a YAML file. With a key ``base``, another file relative to this one, it is that with this one's changes.

	:raises ConfigError: a file is missing or no YAML, is its own base, or a key is wrong.
	"""
	return Config.of(*_layers(pathlib.Path(path), ()))


def _layers(path, above):
	"""(keys of the file and its bases, folder that relative paths count from); ``above``: the files that it is a base of."""
	keys = read(path)
	if not isinstance(keys, dict) or "base" not in keys:
		return keys, path.parent
	changes = {name: value for name, value in keys.items() if name != "base"}
	if not isinstance(keys["base"], str):
		raise ConfigError("base", keys["base"], "is not text", "give the YAML file that this one changes")
	plainText("base", keys["base"], LONGEST_PATH)
	if len(above) >= MOST_BASES:
		raise ConfigError("base", keys["base"], f"is the base of more than {MOST_BASES} files", "write fewer files that change one another")
	base = path.parent / keys["base"]
	if base.resolve() in (*above, path.resolve()):
		raise ConfigError("base", keys["base"], "is its own base", "correct the path")
	below, folder = _layers(base, (*above, path.resolve()))
	if not isinstance(below, dict):
		raise ConfigError("base", str(base), "is not a mapping of keys", "write 'key: value' lines in it")
	for section, names in (("specimen", PATHS), ("lab", ("file",))):
		if isinstance(keys := below.get(section), dict):
			paths = {name: os.path.join(folder, keys[name]) for name in names if isinstance(keys.get(name), str)}
			below = merged(below, {section: {name: os.path.abspath(os.path.expanduser(value)) for name, value in paths.items()}})
	return merged(below, changes), path.parent


def _commit():
	"""The git commit of the checkout that this package is in ('-dirty' when changed), None elsewhere."""
	here = os.path.dirname(os.path.abspath(__file__))
	try:
		said = subprocess.run(
			["git", "-C", here, "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"], capture_output=True, text=True, timeout=10
		)
	except (OSError, subprocess.TimeoutExpired):
		return None
	return said.stdout.strip() if said.returncode == 0 else None


def resolved(config, **more):
	"""The configuration with every default filled in and, under ``made``, date, versions, threads and ``more``; ready for YAML."""
	origin = {
		"date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
		"hexmembrane": hexmembrane.__version__,
		"commit": _commit(),
		"python": platform.python_version(),
		"numpy": numpy.__version__,
		"machine": platform.machine(),
	}
	if "yade" in sys.modules:
		import yade.config

		origin.update(yade=yade.config.version, threads=yade.wrapper.Omega().numThreads)
	return {**toDict(config), "made": {**origin, **more}}


def save(config, path, **more):
	"""Write ``resolved(config, **more)`` as YAML, by temporary name and rename."""
	path = pathlib.Path(path)
	part = path.with_name(path.name + ".part")
	part.write_text(yaml.dump(resolved(config, **more), Dumper=_Writer, sort_keys=False, allow_unicode=True, width=110), encoding="utf-8")
	part.replace(path)
