# SPDX-License-Identifier: GPL-2.0-or-later
"""A study's tables from its results: one row a run, mean and interval over seeds, all records, where they come from."""

import collections
import csv
import datetime
import hashlib
import io
import json
import pathlib

import numpy
from hexmembrane.output import records
from hexmembrane.output.records import COLUMNS
from hexmembrane.report.summary import QUANTITIES, halfWidth, quantities
from plan import STAGES_FOLDER, result, writeText

RUNS, MEANS, RECORDS, PROVENANCE = "runs.csv", "means.csv", "records.h5", "provenance.json"


def headers():
	"""Names of the quantities with their units, as in the records."""
	return {name: f"{name} [{unit}]" for name, unit in QUANTITIES.items()}


def recordsOf(folder, run):
	"""Path of a run's records."""
	return pathlib.Path(folder) / STAGES_FOLDER / run["stages"]["shear"] / "test" / "records.csv"


def sheared(path):
	"""The records of a test's shear, a dict of arrays; the peak and all strains are told of these."""
	table = records.read(path)
	rows = numpy.array([stage == "shear" for stage in table["stage"]])
	return {name: column[rows] for name, column in table.items() if name != "stage"}


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
				table = sheared(recordsOf(folder, run))
				found = quantities(table)
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
	parts = [(f"{name} mean [{unit}]", f"{name} half width [{unit}]") for name, unit in QUANTITIES.items()]
	table = [[*plan["axes"], "tests", "done", *(header for pair in parts for header in pair)]]
	for values, found in groups.items():
		done = [quantity for quantity in found if quantity]
		cells = []
		for name in QUANTITIES:
			column = numpy.array([quantity[name] for quantity in done])
			cells += [repr(float(column.mean())) if done else "", repr(float(halfWidth(column))) if len(done) > 1 else ""]
		table.append([*values, len(found), len(done), *cells])
	return table


def _writeRecords(plan, rows, path):
	"""All records by run, as HDF5: a group a run with the axes as attributes, a dataset a column with its unit."""
	import h5py

	units = {column.name: column.unit for column in COLUMNS}
	part = path.with_name(path.name + ".part")
	with h5py.File(part, "w") as file:
		file.attrs["title"], file.attrs["plan"] = plan["title"], json.dumps(plan["study"], default=str)
		for run, said, found, table in rows:
			place = file.create_group(run["name"])
			place.attrs.update({"seed": run["seed"], "status": said, **{key: "none" if value is None else value for key, value in run["values"].items()}})
			place.attrs.update(found or {})
			for name, column in (table or {}).items():
				place.create_dataset(name, data=column, compression="gzip").attrs["unit"] = units.get(name, "")
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
	table = [["run", *plan["axes"], "seed", "status", "folder", *headers().values()]]
	for run, said, found, _ in rows:
		cells = [repr(float(found[name])) for name in QUANTITIES] if found else [""] * len(QUANTITIES)
		table.append([run["name"], *(run["values"][key] for key in plan["axes"]), run["seed"], said, recordsOf("", run).parent, *cells])
	writeText(folder / RUNS, _csv(table))
	writeText(folder / MEANS, _csv(_means(plan, rows)))
	_writeRecords(plan, rows, folder / RECORDS)
	figure.drawAll(plan, rows, folder)
	results = {name: result(folder, name) for name in plan["jobs"]}
	facts = {
		"date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
		"study": plan["study"],
		"processor_hours": round(sum(found["seconds"] for found in results.values() if found) / 3600, 4),
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
