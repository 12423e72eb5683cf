# SPDX-License-Identifier: GPL-2.0-or-later
"""Many tests from variations of examples/quick.yaml, each in a process of its own, with one result each that is kept.

A folder holds, for each run, NAME.yaml, the folder NAME of the test, NAME.log with exit code and last error, and said.txt in NAME with what the
test printed. A run with a NAME.log is not run again, so an interrupted survey goes on.
"""

import concurrent.futures
import os
import pathlib
import subprocess
import sys

import yaml

from hexmembrane.configuration import merged
from hexmembrane.run import checkpoints

ROOT = pathlib.Path(__file__).resolve().parents[2]
QUICK = ROOT / "examples" / "quick.yaml"


#: Exit codes of a process that was told to end (by an interrupt, a termination or a kill): that is no result.
ENDED = (130, 143, -2, -9, -15)


def configuration(*changes):
	"""The configuration of examples/quick.yaml with changes, as nested dictionaries; later ones win."""
	made = yaml.safe_load(QUICK.read_text())
	made["specimen"]["gradation"] = str(QUICK.parent / "data" / "toyoura.csv")
	for change in changes:
		made = merged(made, change)
	return made


def place(name, folder):
	"""The folder of a run's test."""
	return folder / name.replace(", ", "_").replace(" ", "-").replace("/", "-per-")


def log(name, folder):
	"""The file that holds a run's result, once it has one."""
	return folder / f"{place(name, folder).name}.log"


def run(name, keys, folder):
	"""One test in a process of its own, one thread, unless it has a result: (exit code, last error, its folder)."""
	out, result = place(name, folder), log(name, folder)
	if not result.is_file():
		out.mkdir(exist_ok=True)
		file = folder / f"{out.name}.yaml"
		file.write_text(yaml.safe_dump(keys))
		program = [sys.executable, str(ROOT / "scripts" / "setup.d" / "launch.py"), "1", str(ROOT / "py" / "hexmembrane" / "__main__.py")]
		arguments = [str(file), "--out", str(out), *(["--resume"] if checkpoints.exist(out) else [])]
		with open(out / "said.txt", "a") as said:
			ended = subprocess.run([*program, *arguments], stdout=said, stderr=subprocess.PIPE, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
		if ended.returncode in ENDED:
			return ended.returncode, "was ended from outside; call the survey again", out
		errors = [line for line in ended.stderr.splitlines() if line.startswith("error: ")]
		result.write_text(f"{ended.returncode} {errors[-1] if errors else ''}\n")
	code, _, message = result.read_text().strip().partition(" ")
	return int(code), message, out


def outcome(code):
	"""In a word, how a run with this exit code ended."""
	return {0: "done", 2: "refused"}.get(code, "stopped")


def runAll(names, one, folder, processes, keep):
	"""``one(name)`` for all names, so many at once and in this order; ``keep(rows)`` after each, with the rows so far in the names' order."""
	folder.mkdir(parents=True, exist_ok=True)
	rows = {}
	with concurrent.futures.ThreadPoolExecutor(processes) as pool:
		tasks = {pool.submit(one, name): name for name in names}
		for done in concurrent.futures.as_completed(tasks):
			rows[tasks[done]] = done.result()
			print(*done.result(), sep=" | ", flush=True)
			keep([rows[name] for name in names if name in rows])
	return rows


def addOptions(parser):
	"""The options that every survey has."""
	parser.add_argument("folder", metavar="FOLDER", type=pathlib.Path)
	parser.add_argument("--processes", type=int, default=len(os.sched_getaffinity(0)))
	parser.add_argument("--only", default="", help="runs whose name has this in it")


def addBoundary(parser):
	"""The option of surveys that are made in either lateral boundary."""
	parser.add_argument("--boundary", choices=("membrane", "wall"), default="membrane", help="lateral boundary of the tests; each has a folder of its own")
