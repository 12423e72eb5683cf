# SPDX-License-Identifier: GPL-2.0-or-later
"""A study as one file, and whether a part of it comes out again: packings and records are compared byte by byte, without the wall clock."""

import gzip
import hashlib
import io
import os
import pathlib
import tarfile

import numpy
from hexmembrane.output import records
from plan import INPUTS, NAME, RESULT, STAGES_FOLDER
from results import MEANS, PROVENANCE, RECORDS, RUNS

ARCHIVE = "study.tar.gz"
#: What ``measure`` of a configuration leaves.
INSIDE = ("regions.csv", "profile.csv", "bands.csv", "fields.h5")
#: Of a stage: what says what it was and what came out. States can be made again and are left out.
_KEPT = (RESULT, "job.yaml", *(f"test/{name}" for name in ("config.yaml", "packing.txt", "records.csv", "manifest.json", *INSIDE)))
#: Column that no second run has again.
_CLOCK = "elapsed"
#: Largest relative difference of rows that another processor's rounding is let off with.
TOLERANCE = 0.1


def _members(plan, folder):
	tops = [NAME, RUNS, MEANS, RECORDS, PROVENANCE, *sorted(path.name for path in folder.glob("study*.png"))]
	inputs = sorted(str(path.relative_to(folder)) for path in (folder / INPUTS).rglob("*") if path.is_file() and path.suffix != ".part")
	stages = [f"{STAGES_FOLDER}/{name}/{file}" for name in sorted(plan["jobs"]) for file in _KEPT]
	# a test's packing is that of its specimen's stage
	copies = {f"{STAGES_FOLDER}/{name}/test/packing.txt" for name, job in plan["jobs"].items() if job["stage"] != "specimen"}
	return [name for name in (*tops, *inputs, *stages) if name not in copies and (folder / name).is_file()]


def write(plan, folder):
	"""Write ARCHIVE into the study's folder; its path. The same content gives the same bytes."""
	folder = pathlib.Path(folder)
	path = folder / ARCHIVE
	part = path.with_name(ARCHIVE + ".part")
	with open(part, "wb") as file, gzip.GzipFile("", "wb", mtime=0, fileobj=file) as packed, tarfile.open(fileobj=packed, mode="w") as archive:
		for name in _members(plan, folder):
			data = (folder / name).read_bytes()
			member = tarfile.TarInfo(name)
			member.size = len(data)
			archive.addfile(member, io.BytesIO(data))
	part.replace(path)
	return path


def unpack(path, folder):
	"""Unpack an archive; nothing is written outside the folder. :raises OSError, tarfile.TarError, ValueError: it is none."""
	with tarfile.open(path, "r:gz") as archive:
		archive.extractall(folder, filter="data")
	if not (pathlib.Path(folder) / NAME).is_file():
		raise ValueError(f"archive = '{path}': has no {NAME}; fix: give a {ARCHIVE} of scripts/sweep")


def chosen(plan, folder, count):
	"""Names of ``count`` done runs, spread over all of them."""
	from results import status

	done = [run["name"] for run in plan["runs"] if status(folder, run) == "done"]
	places = numpy.unique(numpy.linspace(0, len(done) - 1, min(count, len(done))).round().astype(int)) if done else []
	return [done[place] for place in places]


def linked(plan, old, new):
	"""Put an archive's inputs into another plan's folder."""
	for path in (pathlib.Path(old) / INPUTS).rglob("*"):
		if path.is_file():
			target = pathlib.Path(new) / path.relative_to(old)
			target.parent.mkdir(parents=True, exist_ok=True)
			target.write_bytes(path.read_bytes())


def _sha(path):
	return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None


def compare(job, old, new):
	"""(largest relative difference, text) of a stage in two folders of stages; 0.0: equal bit for bit, nan: it cannot be compared."""
	old, new = (pathlib.Path(folder) / "test" for folder in (old, new))
	if job["stage"] == "specimen":
		same = _sha(old / "packing.txt") == _sha(new / "packing.txt") is not None
		return (0.0, "equal bit for bit") if same else (numpy.nan, "another packing")
	try:
		before, after = (records.read(folder / "records.csv") for folder in (old, new))
	except (OSError, ValueError) as error:
		return numpy.nan, f"no records to compare ({os.fspath(getattr(error, 'filename', None) or error)})"
	if before.pop("stage") != after.pop("stage") or set(before) != set(after):
		return numpy.nan, f"other rows: {len(before['step'])} before, {len(after['step'])} now"
	worst, where = 0.0, ""
	for name in sorted(set(before) - {_CLOCK}):
		a, b = before[name], after[name]
		apart = numpy.where((a == b) | (numpy.isnan(a) & numpy.isnan(b)), 0, abs(a - b) / max(numpy.nanmax(abs(a), initial=0), 1e-300))
		if apart.size and not apart.max() <= worst:
			worst, where = float(apart.max()), f"{name} in row {int(apart.argmax()) + 1}"
	return (0.0, "equal bit for bit") if not where else (worst, f"differs by up to {worst:.2g} of the column's largest value ({where})")
