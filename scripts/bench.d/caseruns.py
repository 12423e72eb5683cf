# SPDX-License-Identifier: GPL-2.0-or-later
"""One hard case in this YADE: it is run while it is watched, and what it left is measured.

A measurement is a number by its name; the table of :mod:`hardcases` says between which bounds each must lie.
"""

import contextlib
import io
import json
import math
import os
import pathlib
import unittest.mock

import numpy
from hexmembrane.configuration import Config, ConfigError
from hexmembrane.output import records, vtk
from hexmembrane.run import checkpoints, stages, states
from hexmembrane.run.pipeline import run as runTest
from yade import BodyArrays, O

#: Files of text in which a number that is not finite would be seen.
TEXTS = ("*.txt", "*.yaml", "manifest.json")


class Watched(stages.TriaxialTest):
	"""A test that notes the membrane's largest velocity at each row, lets a case drive the shear, and kills its process after a row of the shear."""

	case, killAfter, kill, watched = None, None, os._exit, None

	def row(self):
		row = super().row()
		fastest = float(numpy.linalg.norm(BodyArrays.velocities(self.scene.lateralBoundary.movingIds()), axis=1).max(initial=0.0))
		# what the pressure could give the sheet on a way of its own thickness
		scale = math.sqrt(self.config.consolidation.pressure / self.config.membrane.density)
		self.watched["membrane speed"] = max(self.watched.get("membrane speed", 0.0), fastest / scale)
		if self.stage == "shear" and self.rowCount == self.killAfter:
			self.kill(9)
		return row

	def runStage(self, k):
		if self.case.drive is None or not self.plan[k].straining:
			return super().runStage(k)
		if self.rowCount == 0:
			self.advance(1)
			self.row()
		self.case.drive(self)
		return None


def whole(case, config, out, resume=False, killAfter=None, kill=os._exit):
	"""A whole test in the folder ``out``: (outcome, message, what it printed, measurements).

	:param killAfter: the row of the shear after which ``kill(9)`` is called.
	"""
	seen, printed = {}, io.StringIO()
	attributes = {"case": case, "killAfter": killAfter, "kill": staticmethod(kill), "watched": seen}
	outcome, message = "done", ""
	with unittest.mock.patch.object(stages, "TriaxialTest", type("WatchedCase", (Watched,), attributes)), contextlib.redirect_stdout(printed):
		O.reset()
		try:
			runTest(Config.of(config), out, resume=resume)
		except ConfigError as error:
			outcome, message = "refused", str(error)
		except ValueError as error:
			outcome, message = ("stopped" if checkpoints.exist(out) else "refused"), str(error)
		except RuntimeError as error:
			outcome, message = ("stopped" if checkpoints.exist(out) else "refused"), str(error)
	seen["not finite"] = notFinite(pathlib.Path(out))
	if outcome == "done":
		seen.update(measured(pathlib.Path(out), seen))
	return outcome, message, printed.getvalue(), seen


def measured(out, seen):
	"""What the records of a test that is done say."""
	table = records.read(out / "records.csv")
	shear = numpy.array([i for i, stage in enumerate(table["stage"]) if stage == "shear"])
	first, target = shear[0], table["sigma3_target"][shear[0]]

	def most(values):
		return float(numpy.abs(values[shear]).max())

	late = shear[len(shear) // 2 :]
	transmitted = table["sigma3_transmitted_group3"]
	boundary = max(most((table[f"boundary_{a}"] - table[f"soil_{a}"]) / table["soil_axial"]) for a in ("axial", "radial"))
	return {
		"start axial": abs(table["soil_axial_middle"][first] / target - 1),
		"start radial": abs(table["soil_radial_middle"][first] / target - 1),
		"boundary": boundary,
		"held": most(transmitted / transmitted[first] - 1),
		"energy": most(table["energy_error"]),
		"energy, consolidation": float(abs(table["energy_error"][first - 1])),
		"largest q/sigma3": float(table["q"][shear].max() / target),
		"smallest q/sigma3": float(table["q"][shear].min() / target),
		"largest soil stress/sigma3": float(max(table[f"soil_{a}"][shear].max() for a in ("axial", "radial")) / target),
		"smallest soil stress/sigma3": float(min(table[f"soil_{a}"][shear].min() for a in ("axial", "radial")) / target),
		"broken bonds": float(table["bonds_broken"][-1]),
		"strain": float(table["axial_strain"][-1]),
		"porosity at the start": float(table["porosity"][first]),
		"drift of porosity": float(numpy.ptp(table["porosity"][late])),
		"drift of pressure": float(numpy.ptp(transmitted[late]) / target),
		"steps": float(table["step"][-1]),
	}


def notFinite(out):
	"""How many files of a test hold a number that is not finite: tables, packings, frames, checkpoints."""
	found = 0
	for pattern in TEXTS:
		for file in out.glob(pattern):
			words = file.read_text().lower().replace(",", " ").replace("[", " ").replace("]", " ").split()
			found += any(word.strip("-+") in ("nan", "inf", "infinity") for word in words)
	if (out / "records.csv").is_file():
		table = records.read(out / "records.csv")
		found += not all(numpy.isfinite(values).all() for name, values in table.items() if name != "stage")
	for file in out.glob("vtk/*.vtp"):
		points, _, ofPoints, ofCells = vtk.read(file)
		found += not all(numpy.isfinite(values).all() for values in (points, *ofPoints.values(), *ofCells.values()))
	for file in [*out.glob("*.yade"), *out.glob("*.yade.gz")]:
		O.reset()
		states.load(file)
		ids = [body.id for body in O.bodies]
		found += not all(numpy.isfinite(values).all() for values in (BodyArrays.positions(ids), BodyArrays.velocities(ids)))
	return float(found)


def differingRows(one, other):
	"""How many rows of two records are not the same text, the wall clock left out."""
	rows = []
	for out in (one, other):
		lines = (out / "records.csv").read_text().splitlines()
		clock = lines[0].split(",").index("elapsed [s]")
		rows.append([[cell for k, cell in enumerate(line.split(",")) if k != clock] for line in lines])
	return float(sum(a != b for a, b in zip(*rows)) + abs(len(rows[0]) - len(rows[1])))


def judge(case, outcome, message, printed, seen):
	"""What is not as the case expects, in words; nothing when all is."""
	odd = []
	if outcome not in case.expect.split(" or "):
		odd.append(f"is {outcome}, expected {case.expect}")
	if outcome != "done" and case.says not in message:
		odd.append(f"the message does not say '{case.says}'")
	if outcome != "done" and "fix: " not in message:
		odd.append("the message names no cause and no fix")
	if "see its messages above" in message:
		odd.append("the message does not pass on what YADE said")
	if case.warns and case.warns not in printed:
		odd.append(f"does not warn of '{case.warns}'")
	for name, (low, high) in case.allBounds().items():
		if name in seen and (outcome == "done" or name == "not finite") and not low <= seen[name] <= high:
			odd.append(f"{name} {seen[name]:.3g} is not in {low:g} ... {high:g}")
	odd += [f"{name} was not measured" for name in case.bounds if outcome == "done" and name not in seen]
	return odd


def runCase(case, out, short=False):
	"""A case in this YADE, as a dict of outcome, message, seen and odd. A folder ``out`` is made."""
	out.mkdir(parents=True, exist_ok=True)
	if case.scene is not None:
		outcome, message, printed, seen = "done", "", "", {}
		O.reset()
		try:
			seen = case.scene(out, short)
		except (ValueError, RuntimeError) as error:
			outcome, message = "stopped", str(error)
	else:
		outcome, message, printed, seen = whole(case, case.configuration(out, short), out)
	warnings = [line for line in printed.splitlines() if "WARNING" in line]
	found = {"outcome": outcome, "message": message, "warnings": warnings, "seen": seen, "odd": judge(case, outcome, message, printed, seen)}
	(out / "case.json").write_text(json.dumps(found, indent=1))
	return found
