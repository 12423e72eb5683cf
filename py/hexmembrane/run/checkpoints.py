# SPDX-License-Identifier: GPL-2.0-or-later
"""Checkpoints of a run: YADE's own saved state plus a small JSON that says how far the run was.

The JSON is written last, by temporary name and rename, so a kill at any moment leaves the previous checkpoint whole.
"""

import json
import pathlib

VERSION = 1
_NAME = "checkpoint.json"


class CheckpointError(RuntimeError):
	"""A checkpoint that is missing, damaged or of another version or test."""


def write(folder, state, facts):
	"""Make ``state`` (a file name in ``folder``, complete on the disk) the checkpoint, with ``facts`` (JSON values)."""
	folder = pathlib.Path(folder)
	part = folder / (_NAME + ".part")
	part.write_text(json.dumps({"version": VERSION, "state": state, **facts}, indent=1), encoding="utf-8")
	part.replace(folder / _NAME)


def read(folder):
	"""The facts of the folder's checkpoint, ``state`` included.

	:raises CheckpointError: there is none, it cannot be read, its version is another one or its state file is missing.
	"""
	path = pathlib.Path(folder) / _NAME
	try:
		facts = json.loads(path.read_text(encoding="utf-8"))
	except OSError:
		raise CheckpointError(f"checkpoint = '{path}': there is none; fix: run without --resume") from None
	except ValueError as error:
		raise CheckpointError(f"checkpoint = '{path}': is damaged ({error}); fix: run without --resume") from None
	if not isinstance(facts, dict) or facts.get("version") != VERSION:
		raise CheckpointError(f"checkpoint = '{path}': is not of version {VERSION}; fix: run without --resume")
	state = path.with_name(facts["state"])
	if not state.is_file():
		raise CheckpointError(f"checkpoint = '{path}': its state '{state.name}' is missing; fix: run without --resume")
	return facts


def differences(old, new, path=""):
	"""Key paths whose values differ between two nested dictionaries."""
	paths = []
	for name in sorted(set(old) | set(new)):
		at = f"{path}.{name}" if path else name
		a, b = old.get(name), new.get(name)
		if isinstance(a, dict) and isinstance(b, dict):
			paths += differences(a, b, at)
		elif a != b:
			paths.append(at)
	return paths
