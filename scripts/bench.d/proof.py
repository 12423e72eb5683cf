# SPDX-License-Identifier: GPL-2.0-or-later
"""Whether error budgets hold: tests on packings that the study of accuracy did not use, at settings chosen by ``accuracy``, against a slow test of each packing.

	accuracy.py prove FOLDER [--boundary wall] [--processes N]

The slow test of a packing has the references of the knobs that cost accuracy, and the base's of those that were found to cost none (step, R/r). FOLDER
keeps one folder a run and proof.csv; an interrupted proof goes on.
"""

import argparse
import math
import pathlib

import curves
import knobs
import survey
import table
import yaml
from hexmembrane.output import records
from hexmembrane.scene import accuracy

SEEDS = range(101, 111)
ACCURACIES = (0.08, 0.12, 0.2)
#: Keys that are left to ``accuracy``.
OPEN = (("shear", "velocity"), ("specimen", "emod"), ("membrane", "sizeRatio"))
SLOW = {"shear": {"velocity": 0.015}, "specimen": {"emod": 3000 * 4e5 / math.pi}, "numerics": {"damping": 0.1}}
HEADER = ("seed", "accuracy", "quantity", "slow test", "test", "error", "budget", "held")


def jobs(boundary="membrane", seeds=SEEDS):
	"""Names of runs in a lateral boundary -> their configurations; the slow ones first."""
	common = survey.configuration(knobs.COMMON, {"boundary": boundary})
	made = {f"slow, seed {seed}": survey.configuration(common, SLOW, {"specimen": {"seed": seed}}) for seed in seeds}
	for seed in seeds:
		for share in ACCURACIES:
			keys = survey.configuration(common, {"accuracy": share, "specimen": {"seed": seed}})
			for section, name in OPEN:
				del keys[section][name]
			made[f"{share}, seed {seed}"] = keys
	return made


def rows(folder, seeds=SEEDS):
	"""Rows of proof.csv, of the packings whose slow test has come to its end."""
	found = []
	for seed in seeds:
		runs = {name: survey.place(f"{name}, seed {seed}", folder) for name in ("slow", *map(str, ACCURACIES))}
		if not all(survey.log(f"{name}, seed {seed}", folder).is_file() for name in runs):
			continue
		values = {name: curves.quantities(records.read(out / "records.csv")) for name, out in runs.items()}
		for name in map(str, ACCURACIES):
			budgets = yaml.safe_load((runs[name] / "config.yaml").read_text())["made"]["budget"]["budget of a run"]
			for quantity in accuracy.QUANTITIES:
				slow, value = values["slow"][quantity], values[name][quantity]
				error = value / slow - 1 if curves.QUANTITIES[quantity][1] else value - slow
				found.append((seed, name, quantity, slow, value, error, budgets[quantity], "yes" if abs(error) <= budgets[quantity] else "no"))
	return found


def main(argv):
	parser = argparse.ArgumentParser(prog="accuracy prove", description="Whether error budgets hold.")
	survey.addOptions(parser)
	survey.addBoundary(parser)
	arguments = parser.parse_args(argv)
	wanted = {name: keys for name, keys in jobs(arguments.boundary).items() if arguments.only in name}
	survey.runAll(
		list(wanted), lambda name: (name, *survey.run(name, wanted[name], arguments.folder)[:2]), arguments.folder, arguments.processes, lambda done: None
	)
	found = rows(arguments.folder)
	table.write(str(arguments.folder / "proof.csv"), HEADER, [[f"{cell:.5g}" if isinstance(cell, float) else cell for cell in row] for row in found])
	for quantity in accuracy.QUANTITIES:
		held = [row[-1] for row in found if row[2] == quantity]
		print(f"{quantity}: {held.count('yes')} of {len(held)} within the budget")
