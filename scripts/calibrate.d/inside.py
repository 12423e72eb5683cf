# SPDX-License-Identifier: GPL-2.0-or-later
"""Tests one after the other in this one YADE: the start of a YADE takes longer than a test of a few hundred grains does.

A test's folder RUNS/NAME has ``result.json`` when it has ended. A test that was begun and has no result, since the process was killed, is begun anew,
as often as the study's ``attempts`` say: what kills the process each time must not stop the rest.
"""

import json
import pathlib
import shutil
import time

from hexmembrane.configuration import ConfigError
from hexmembrane.run import run
from plan import writeText
from results import sheared

RUNS, RESULT, BEGUN = "runs", "result.json", "begun.json"


def _folder(folder, one):
	return pathlib.Path(folder) / RUNS / one.name


def _read(path):
	try:
		return json.loads(path.read_text(encoding="utf-8"))
	except (OSError, ValueError):
		return None


def status(folder, one):
	"""'done', 'failed: error' or 'missing'."""
	found = _read(_folder(folder, one) / RESULT)
	if found is None:
		return "missing"
	return "done" if found["status"] == "done" else f"failed: {found['error']}"


def table(folder, one):
	"""The records of a done test's shear, a dict of arrays."""
	return sheared(_folder(folder, one) / "records.csv")


def forget(study, folder):
	"""Take away the results of failed tests."""
	for one in study.runs:
		if status(folder, one).startswith("failed"):
			shutil.rmtree(_folder(folder, one))


def perform(study, folder, say):
	"""Run what has not been run of a study; each test leaves its records and result, no states."""
	left = [one for one in study.runs if status(folder, one) == "missing"]
	for number, one in enumerate(left, 1):
		place, begun = _folder(folder, one), time.process_time()
		place.mkdir(parents=True, exist_ok=True)
		attempts = ((_read(place / BEGUN) or {"attempts": 0})["attempts"]) + 1
		if attempts > study.attempts:
			error = f"the process has ended in it {study.attempts} times"
		else:
			writeText(place / BEGUN, json.dumps({"attempts": attempts}))
			error = _one(one.config, place)
		seconds = time.process_time() - begun
		writeText(place / RESULT, json.dumps({"status": "failed" if error else "done", "error": error, "processor_seconds": round(seconds, 2)}) + "\n")
		say(f"test {number} of {len(left)}: {one.name}: {error or 'done'}, {seconds:.1f} s of the processor")


def _one(config, place):
	"""Run a test; the error, empty when it is done."""
	test = place / "test"
	shutil.rmtree(test, ignore_errors=True)
	try:
		run(config, test, quiet=True)
		(test / "records.csv").replace(place / "records.csv")
	except (ConfigError, RuntimeError, ValueError, OSError) as error:
		return str(error)
	finally:
		shutil.rmtree(test, ignore_errors=True)
	return ""
