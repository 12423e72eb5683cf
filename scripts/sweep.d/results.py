# SPDX-License-Identifier: GPL-2.0-or-later
"""A study's tables from its results: one row a run, mean and interval over seeds, all records, where they come from."""

import collections
import csv
import datetime
import hashlib
import io
import json
import math
import pathlib

import numpy
from hexmembrane.output import records
from hexmembrane.output.records import COLUMNS
from hexmembrane.report.summary import QUANTITIES, halfWidth, quantities
from plan import STAGES_FOLDER, result, writeText

RUNS, MEANS, RECORDS, PROVENANCE = "runs.csv", "means.csv", "records.h5", "provenance.json"


def recordsOf(folder, run):
	"""Path of a run's records."""
	return pathlib.Path(folder) / STAGES_FOLDER / run["stages"]["shear"] / "test" / "records.csv"


def stagesOf(plan, run):
	"""Labels of the stages that a run's rows in the tables are of: of a list of stages those since its last consolidation, which strains count from."""
	return plan["jobs"][run["stages"]["shear"]].get("rows", ["shear"])


def sheared(path, stages=("shear",)):
	"""The records of some stages of a test, a dict of arrays; the peak and all strains are told of these."""
	table = records.read(path)
	rows = numpy.array([stage in stages for stage in table["stage"]])
	return {name: column[rows] for name, column in table.items() if name != "stage"}


def endsOf(plan):
	"""Labels of stages whose q at the end is in the tables: those of lists of stages, as they follow one another."""
	lists = [stagesOf(plan, run) for run in plan["runs"] if plan["jobs"][run["stages"]["shear"]]["config"].get("stages") is not None]
	return list(dict.fromkeys(label for labels in lists for label in labels))


def quantitiesOf(plan):
	"""Name -> unit of what the tables have of each run."""
	return {**QUANTITIES, **{f"q_after_{label}": "Pa" for label in endsOf(plan)}}


def _qAfter(path, labels):
	table = records.read(path)
	last = {stage: q for stage, q in zip(table["stage"], table["q"])}
	return {f"q_after_{label}": last.get(label, math.nan) for label in labels}


def status(folder, run):
	"""'done', 'failed: STAGE: error' or 'missing: STAGE has not ended'."""
	for stage, name in run["stages"].items():
		found = result(folder, name)
		if found is None:
			return f"missing: {stage} has not ended"
		if found["status"] == "failed":
			return f"failed: {found['failed_in']}: {found['error']}"
	return "done"


def _rows(plan, folder):
	"""(run, status, quantities or None, records or None) of each run."""
	for run in plan["runs"]:
		said, table = status(folder, run), None
		if said == "done":
			try:
				path = recordsOf(folder, run)
				table = sheared(path, stagesOf(plan, run))
				found = {**quantities(table), **_qAfter(path, endsOf(plan))}
			except (OSError, ValueError, KeyError, IndexError) as error:
				said, table = f"failed: records: {error}", None
		yield run, said, found if table else None, table


def _csv(rows):
	text = io.StringIO()
	csv.writer(text, lineterminator="\n").writerows(rows)
	return text.getvalue()


def group(plan, run):
	"""What runs that differ in their seed alone have in common."""
	return tuple(run["values"][key] for key in plan["axes"])


def _means(plan, rows):
	groups = collections.defaultdict(list)
	for run, _, found, _ in rows:
		groups[group(plan, run)].append(found)
	told = quantitiesOf(plan)
	parts = [(f"{name} mean [{unit}]", f"{name} half width [{unit}]") for name, unit in told.items()]
	table = [[*plan["axes"], "tests", "done", *(header for pair in parts for header in pair)]]
	for values, found in groups.items():
		done = [quantity for quantity in found if quantity]
		cells = []
		for name in told:
			column = numpy.array([quantity[name] for quantity in done])
			cells += [repr(float(column.mean())) if done else "", repr(float(halfWidth(column))) if len(done) > 1 else ""]
		table.append([*values, len(found), len(done), *cells])
	return table


def _writeRecords(plan, rows, path):
	"""All records by run, as HDF5: a group a run with the axes as attributes, a dataset a column with its unit.

	The file is made in memory: HDF5 does not get over a disk that is full, and ends the process by crashing.
	"""
	import h5py

	units = {column.name: column.unit for column in COLUMNS}
	with h5py.File(path, "w", driver="core", backing_store=False) as file:
		file.attrs["title"], file.attrs["plan"] = plan["title"], json.dumps(plan["study"], default=str)
		for run, said, found, table in rows:
			place = file.create_group(run["name"])
			place.attrs.update({"seed": run["seed"], "status": said, **{key: "none" if value is None else value for key, value in run["values"].items()}})
			place.attrs.update(found or {})
			for name, column in (table or {}).items():
				place.create_dataset(name, data=column, compression="gzip").attrs["unit"] = units.get(name, "")
		file.flush()
		image = file.id.get_file_image()
	part = path.with_name(path.name + ".part")
	part.write_bytes(image)
	part.replace(path)


def stamp(plan, folder):
	"""What the tables are made from, in one number: plan and results."""
	digest = hashlib.sha256(json.dumps(plan, sort_keys=True).encode())
	for name in sorted(plan["jobs"]):
		digest.update(json.dumps([name, result(folder, name)], sort_keys=True).encode())
	return digest.hexdigest()


def upToDate(plan, folder):
	"""Whether all results are there and the tables are theirs."""
	if any(result(folder, name) is None for name in plan["jobs"]):
		return False
	try:
		return json.loads((pathlib.Path(folder) / PROVENANCE).read_text(encoding="utf-8"))["stamp"] == stamp(plan, folder)
	except (OSError, ValueError, KeyError):
		return False


def gather(plan, folder):
	"""Write RUNS, MEANS, RECORDS, the figure and, last, PROVENANCE; the rows of the table of runs."""
	import figure

	folder = pathlib.Path(folder)
	rows = list(_rows(plan, folder))
	told = quantitiesOf(plan)
	table = [["run", *plan["axes"], "seed", "status", "folder", *(f"{name} [{unit}]" for name, unit in told.items())]]
	for run, said, found, _ in rows:
		cells = [repr(float(found[name])) for name in told] if found else [""] * len(told)
		table.append([run["name"], *(run["values"][key] for key in plan["axes"]), run["seed"], said, recordsOf("", run).parent, *cells])
	writeText(folder / RUNS, _csv(table))
	writeText(folder / MEANS, _csv(_means(plan, rows)))
	_writeRecords(plan, rows, folder / RECORDS)
	figure.drawAll(plan, rows, folder)
	results = {name: result(folder, name) for name in plan["jobs"]}
	facts = {
		"date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
		"study": plan["study"],
		"processor_hours": round(sum(found.get("processor_seconds", found["seconds"]) for found in results.values() if found) / 3600, 4),
		"made_by": _unlike({key: value for key, value in found["made"].items() if key != "date"} for found in results.values() if found),
		"machines": _unlike({"host": found["host"], "processor": found["processor"]} for found in results.values() if found),
		"stages": results,
		"stamp": stamp(plan, folder),
	}
	writeText(folder / PROVENANCE, json.dumps(facts, indent=1, default=str) + "\n")
	return table


def _unlike(facts):
	"""The different ones among dictionaries, in order."""
	kept = []
	for found in facts:
		if found and found not in kept:
			kept.append(found)
	return kept
