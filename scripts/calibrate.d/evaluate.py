# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs the tests of sets of parameters by the machinery of ``scripts/sweep``, and reads them as a laboratory would."""

import pathlib

import inside
import plan as plans
import results
import sweep
from hexmembrane.laboratory import misfit

#: Folder of the tests, and what is drawn there: names of sets and points, a generation a list.
TESTS, GENERATIONS = "tests", "generations.json"


def setName(generation, number):
	return f"{generation:02d}.{number:04d}"


class Tests:
	"""All tests of a calibration in one folder, so that none is run twice and packings are shared."""

	def __init__(self, calibration, folder, arguments, say):
		self.calibration, self.folder = calibration, pathlib.Path(folder) / TESTS
		self._arguments, self._say = arguments, say
		self._planned = None, None

	def plan(self, sets):
		"""(plan, its input files) of the sets, [(name, point)]; made once for the same sets in a row."""
		names = [name for name, _ in sets]
		if self._planned[0] != names:
			self._planned = names, plans.make(self.calibration.study(sets))
		return self._planned[1]

	def run(self, sets):
		"""Run what has not been run of the sets."""
		plan, inputs = self.plan(sets)
		self.folder.mkdir(parents=True, exist_ok=True)
		with sweep.lock(self.folder):
			if self._arguments.again:
				sweep.forget(plan, self.folder)
				self._arguments.again = False  # once: what fails again stays failed
			sweep.advance(plan, inputs, self.folder, self._arguments, self._say)

	def series(self, sets):
		"""({set: {curve: [series of a seed]}}, {set: texts of what failed}) of sets that have run."""
		plan, _ = self.plan(sets)
		found, failed = {name: {} for name, _ in sets}, {name: [] for name, _ in sets}
		for run in plan["runs"]:
			name, curve = run["values"]["set"], run["values"]["curve"]
			said = results.status(self.folder, run)
			if said == "done":
				found[name].setdefault(curve, []).append(misfit.ofTest(results.sheared(results.recordsOf(self.folder, run))))
			else:
				failed[name].append(f"{run['name']}: {said}")
		return found, failed

	def gather(self, sets):
		"""The tables of all tests, as a study has them."""
		plan, inputs = self.plan(sets)
		plans.write(plan, inputs, self.folder)
		return results.gather(plan, self.folder)


class Inside(Tests):
	"""The same without a YADE a stage: the tests run one after the other in this process, for specimens of few grains."""

	def run(self, sets):
		study = self.calibration.study(sets)
		self.folder.mkdir(parents=True, exist_ok=True)
		with sweep.lock(self.folder):
			if self._arguments.again:
				inside.forget(study, self.folder)
				self._arguments.again = False
			inside.perform(study, self.folder, self._say)

	def series(self, sets):
		found, failed = {name: {} for name, _ in sets}, {name: [] for name, _ in sets}
		for run in self.calibration.study(sets).runs:
			name, curve, said = run.values["set"], run.values["curve"], inside.status(self.folder, run)
			if said == "done":
				found[name].setdefault(curve, []).append(misfit.ofTest(inside.table(self.folder, run)))
			else:
				failed[name].append(f"{run.name}: {said}")
		return found, failed

	def gather(self, sets):
		"""Nothing: the tables of a study are made from its stages."""
