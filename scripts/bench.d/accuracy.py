# SPDX-License-Identifier: GPL-2.0-or-later
"""Speed against error: examples/quick.yaml with one knob changed at a time, over eight packings, each against the same packing at the knob's reference.

	accuracy.py FOLDER [--boundary wall] [--packings N] [--only TEXT] [--processes N] [--runs N] [--slow] [--list]
	accuracy.py figures FOLDER
	accuracy.py publish FOLDER [--boundary wall]
	accuracy.py prove FOLDER [--boundary wall] [--processes N]

FOLDER keeps one folder a run, runs.csv with one row a run, and curves.csv with one row a knob, level and quantity (curves.py). A run that has a
result is not run again, so an interrupted study goes on. Base runs come first, then knob by knob as in knobs.py, the longest runs of each first.

Columns of curves.csv: mean, signed, of the paired differences from the reference (relative to its value for stresses, absolute for strains and for
start stresses over their target); scatter, their standard deviation over the packings; half_width of the mean's 95 % interval; steps and time relative
to the base run; fit and fit_half_width, the same as mean and half_width from all levels at once (fits.py). Numbers of grains have no packing in common: there mean is the difference of the means, scatter and half_width are the level's own.
"""

import argparse
import csv
import hashlib
import math
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))

import curves  # noqa: E402
import fits  # noqa: E402
import knobs  # noqa: E402
import survey  # noqa: E402
import table  # noqa: E402
from hexmembrane.output import records  # noqa: E402

FIRST_SEED = 7
#: Processor minutes of a base run (AMD EPYC with 2 processors shared with other work, 27 November 2026, 0c92da1).
MINUTES = 0.15
HEADER = ("run", "seed", "outcome", "packing", *(f"{name} [{unit}]" for name, (unit, _) in curves.QUANTITIES.items()), "steps", "time [s]", "x of the log", "message")


class Study:
	"""The runs of a study.

	Attributes: ``knobs``, ``common`` (what all runs change), ``jobs`` (run's name -> (level, seed, knob's pattern for the log), in the order to run them).

	:param folder: of the runs and the tables.
	:param packings: how many.
	:param slow: slow levels too.
	:param short: the short form, for tests.
	:param boundary: lateral boundary of all runs.
	"""

	def __init__(self, folder, packings, slow=False, short=False, boundary="membrane"):
		self.folder = folder
		extra, self.knobs = knobs.short() if short else ({}, knobs.knobs() if boundary == "membrane" else knobs.ofWall())
		self.common = survey.merged(survey.merged(knobs.COMMON, extra), {"boundary": boundary})
		self.jobs = {}
		seeds = range(FIRST_SEED, FIRST_SEED + packings)
		self._add(knobs.Knob(knobs.BASE, "", [knobs.Level(knobs.BASE)]), seeds, slow)
		for knob in self.knobs:
			self._add(knob, seeds[: knob.packings], slow)

	def _add(self, knob, seeds, slow):
		for level in sorted(knob.levels, key=lambda level: -level.cost):
			for seed in seeds if slow or not level.slow else ():
				self.jobs.setdefault(f"{level.run}, seed {seed}", (level, seed, knob.log))

	def configuration(self, name):
		"""Of a run, as nested dictionaries."""
		level, seed, _ = self.jobs[name]
		return survey.configuration(self.common, level.change, {"specimen": {"seed": seed}})

	def run(self, name):
		"""Run it unless it has a result; its row of runs.csv."""
		code, message, out = survey.run(name, self.configuration(name), self.folder)
		for state in out.glob("*.yade.gz") if code == 0 else ():
			state.unlink()
		found = self.result(name)
		numbers = ([*found.values.values(), found.steps, found.time, found.x]) if found else [math.nan] * (len(HEADER) - 5)
		level, seed, _ = self.jobs[name]
		return level.run, seed, survey.outcome(code), found.packing if found else "", *("" if math.isnan(value) else f"{value:.6g}" for value in numbers), message

	def result(self, name):
		"""The :class:`curves.Run` of a run that came to its end, or as far as it came; None without records."""
		_, seed, pattern = self.jobs[name]
		out = survey.place(name, self.folder)
		if not (out / "records.csv").is_file():
			return None
		read = records.read(out / "records.csv")
		if not len(read["step"]):
			return None
		x = re.search(pattern, (out / "said.txt").read_text()) if pattern else None
		digest = hashlib.sha1((out / "packing.txt").read_bytes()).hexdigest()[:12]
		return curves.Run(seed, digest, curves.quantities(read), read["step"][-1], read["elapsed"][-1], float(x[1]) if x else math.nan)

	def hasEnded(self, name):
		"""Whether a run has a result, whatever it is."""
		return survey.log(name, self.folder).is_file()

	def whole(self):
		"""Name of a level's runs -> seed -> :class:`curves.Run`, of those that came to their end."""
		found = {}
		for name, (level, seed, _) in self.jobs.items():
			if self.hasEnded(name) and survey.log(name, self.folder).read_text().split()[0] == "0":
				found.setdefault(level.run, {})[seed] = self.result(name)
		return found

	def tell(self):
		"""Write curves.csv from all runs that there are, and print the orders; its rows."""
		runs = self.whole()
		rows = curves.curves(self.knobs, runs)
		print(*curves.orders(self.knobs, rows), sep="\n")
		rows = [(*row, *more) for row, more in zip(rows, fits.columns(self.knobs, runs, rows))]
		table.write(str(self.folder / "curves.csv"), (*curves.HEADER, *fits.HEADER), [[f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row] for row in rows])
		return rows


def publish(argv):
	"""Make the study in a folder the one that tests' error budgets are made from: the rows of curves.csv that they use, in the package."""
	from hexmembrane.scene import accuracy

	parser = argparse.ArgumentParser(prog="accuracy publish", description="Makes a study the one of the error budgets.")
	parser.add_argument("folder", metavar="FOLDER", type=pathlib.Path)
	survey.addBoundary(parser)
	arguments = parser.parse_args(argv)
	folder, path = arguments.folder, accuracy.FILES[arguments.boundary]
	used = {*(knob.name for knob in accuracy.KNOBS), accuracy.VELOCITY_ON_STIFF, accuracy.SWITCH, "skin", "packings"}
	rows = [row for row in table.read(folder / "curves.csv") if row["knob"] in used and row["quantity"] in accuracy.QUANTITIES]
	with open(path, "w", newline="", encoding="utf-8") as file:
		writer = csv.DictWriter(file, rows[0], lineterminator="\n")
		writer.writeheader()
		writer.writerows(rows)
	print(f"written: {path}")


def _arguments(argv):
	parser = argparse.ArgumentParser(prog="accuracy", description="Speed against error.")
	survey.addOptions(parser)
	survey.addBoundary(parser)
	parser.add_argument("--packings", type=int, default=8, help=f"how many, from seed {FIRST_SEED} on (default 8)")
	parser.add_argument("--runs", type=int, help="how many, from the first on (default: all)")
	parser.add_argument("--slow", action="store_true", help="slow levels too: a membrane of R/r = 0.2, 7,000 and 30,000 grains")
	parser.add_argument("--list", action="store_true", help="print the runs with what they cost, base runs counting 1, and run none")
	parser.add_argument("--short", action="store_true", help="three velocities on 150 grains to 1.2 % strain: a test of the study itself")
	return parser.parse_args(argv)


def main(argv):
	if argv[:1] == ["figures"]:
		import figures

		return figures.main(argv[1:])
	if argv[:1] == ["prove"]:
		import proof

		return proof.main(argv[1:])
	if argv[:1] == ["publish"]:
		return publish(argv[1:])
	arguments = _arguments(argv)
	study = Study(arguments.folder, arguments.packings, arguments.slow, arguments.short, arguments.boundary)
	wanted = [name for name in study.jobs if arguments.only in name][: arguments.runs]
	if arguments.list:
		costs = [study.jobs[name][0].cost for name in wanted]
		print(*(f"{name}: {cost:.2g}" for name, cost in zip(wanted, costs)), sep="\n")
		print(f"{len(wanted)} runs, {sum(costs):.0f} times a base run, about {MINUTES * sum(costs):.0f} processor minutes")
		return None
	path = str(arguments.folder / "runs.csv")
	told = [name for name in study.jobs if name in wanted or study.hasEnded(name)]
	survey.runAll(told, study.run, arguments.folder, arguments.processes, lambda rows: table.write(path, HEADER, rows))
	study.tell()
	return None


if __name__ == "__main__":
	main(sys.argv[1:])
