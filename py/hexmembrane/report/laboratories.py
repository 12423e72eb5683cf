# SPDX-License-Identifier: GPL-2.0-or-later
"""The laboratory's curves that tests are laid over: of their configurations (``lab``) and of the command. Uses nothing of YADE."""

from hexmembrane.configuration import ConfigError
from hexmembrane.laboratory import curve, misfit
from hexmembrane.report import curves
from hexmembrane.report.runs import ReportError


def gather(found, paths):
	"""(curve, pressure [Pa], names of the tests that it is compared with) of each; one of the command is compared with all tests.

	:param found: the tests. :param paths: of CSV files, sigma3 of which is that of the first test.
	:raises ReportError: one of ``paths`` is no such curve, or no test tells sigma3. A test's own that cannot be read is one of its problems.
	"""
	made = {}
	for path in paths:
		pressure = next((run.key("consolidation", "pressure") for run in found if run.key("consolidation", "pressure")), None)
		if pressure is None:
			raise ReportError(f"--laboratory = '{path}': no test tells the pressure that it is compared at; fix: give a test with a config.yaml")
		try:
			made[str(path), pressure] = curve.ofKeys({"file": str(path)}, pressure, "--laboratory"), [run.name for run in found]
		except ConfigError as error:
			raise ReportError(str(error)) from None
	for run in found:
		keys, pressure = run.config.get("lab"), run.key("consolidation", "pressure")
		try:
			own = curve.ofKeys(keys, pressure) if isinstance(keys, dict) and pressure else None
		except ConfigError as error:
			run.problems.append(f"The laboratory's curve cannot be read: {error}")
			continue
		if own is not None:
			made.setdefault((keys["file"], pressure), (own, []))[1].append(run.name)
	return [(one, pressure, list(dict.fromkeys(names))) for (_, pressure), (one, names) in made.items()]


def drawn(laboratories):
	"""The curves for the page."""
	return [curves.laboratory(one, pressure) for one, pressure, _ in laboratories]


def apart(run, laboratories):
	"""How far a test is from each curve that it is compared with: {"name", "rows": [what, laboratory's, test's as texts]} for the page."""
	found = []
	for one, pressure, names in laboratories:
		if run.name in names and run.table:
			rows = [[number.name, *number.texts()] for number in misfit.ofRecords(one, run.table, pressure)]
			if rows:
				found.append({"name": one.name, "rows": rows})
	return found
