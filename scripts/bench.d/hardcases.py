# SPDX-License-Identifier: GPL-2.0-or-later
"""The table of hard cases: a change of examples/quick.yaml or a scene of its own, and what is expected of each.

Outcomes: 'done' within bounds; 'refused' before the first step; 'stopped' on the way. A message must name the cause, ``says``.
"""

import dataclasses
import math
import tempfile
from typing import Callable, Optional

import caseruns
import casescenes
import survey
from hexmembrane.configuration import Config, merged
from hexmembrane.output import records
from hexmembrane.report.verdict import ENERGY
from hexmembrane.run.pipeline import run as runTest
from yade import O

#: examples/quick.yaml with grains that are few.
FEW = {
	"specimen": {"grains": 250, "height": 0.05, "porosity": 0.44},
	"shear": {"strain": 0.1, "velocity": 0.1},
	"output": {"records": 40, "vtkEvery": 20, "checkpointEvery": 10, "report": False},
}
#: What a short form has instead.
FEWER = {
	"specimen": {"grains": 150, "height": 0.04, "porosity": 0.46},
	"shear": {"strain": 0.03, "rampStrain": 0.002},
	"output": {"records": 12, "vtkEvery": 6, "checkpointEvery": 4, "report": False},
}
#: Bounds of every test that is done; measurements are defined in caseruns.py.
USUAL = {
	"start axial": (0, 0.01),
	"start radial": (0, 0.01),
	"boundary": (0, 0.1),
	"held": (0, 0.03),
	"energy": (0, ENERGY),
	"energy, consolidation": (0, 2e-3),
	"membrane speed": (0, 0.3),
	"largest soil stress/sigma3": (0.9, 6),
	"smallest soil stress/sigma3": (0.7, 1.1),
	"porosity at the start": (0.2, 0.6),
	"broken bonds": (0, 0),
	"not finite": (0, 0),
	"rows that differ after a kill": (0, 0),
}


@dataclasses.dataclass
class Case:
	"""A hard case.

	:param change: of the configuration, or a function of the folder that gives it.
	:param expect: outcomes, with ' or ' between.
	:param says: part of the message of one that is not done.
	:param warns: part of what is printed.
	:param bounds: beside USUAL, which they replace by name.
	:param again: one that is done is killed and resumed too.
	:param drive: what takes the place of the shear, a function of the test.
	:param scene: a function of (folder, short) that gives measurements, instead of a test.
	"""

	name: str
	change: object = dataclasses.field(default_factory=dict)
	expect: str = "done"
	says: str = ""
	warns: str = ""
	bounds: dict = dataclasses.field(default_factory=dict)
	again: bool = True
	drive: Optional[Callable] = None
	scene: Optional[Callable] = None

	def configuration(self, out, short=False):
		"""The configuration of the case; a change that is a function is asked, with the folder."""
		common = merged(FEW, FEWER) if short else FEW
		return survey.configuration(common, self.change(out) if callable(self.change) else self.change)

	def allBounds(self):
		return self.bounds if self.scene else {**USUAL, **self.bounds}


def atPressure(pressure, velocity=0.1):
	"""The test at another pressure p with the same p/E and inertial number: moduli go with p, velocities with its root."""
	share = pressure / 1e5
	return {
		"specimen": {"emod": 4e7 * share},
		"membrane": {"young": 1.2e6 * share},
		"consolidation": {"pressure": pressure},
		"shear": {"velocity": velocity * math.sqrt(share)},
	}


def sheet(stretch):
	"""E t [N/m]; that of quick.yaml is 600."""
	return {"membrane": {"young": stretch / 5e-4}}


def stepOf(share):
	"""An explicit time step, as a share of the critical one that the specimen has before there are contacts."""


	def change(out):
		O.reset()
		with tempfile.TemporaryDirectory() as folder:
			runTest(Config.of(Case("step").configuration(out)), folder, until="boundary", quiet=True)
		return {"numerics": {"dt": share * O.dt / 0.5}}  # numerics.safety is 0.5

	return change


def similar(out, short):
	"""A test and one at 64 times the pressure: all powers of two, so the rows must be the same to the last bit but for their units."""
	tables = []
	for share in (1, 64):
		case = Case("similar", atPressure(1e5 * share))
		outcome, message, _, _ = caseruns.whole(case, merged(case.configuration(out, short), {"shear": {"strain": 0.02}}), out / f"{share}")
		if outcome != "done":
			raise RuntimeError(message)
		tables.append(records.read(out / f"{share}" / "records.csv"))
	one, other = tables
	same = {"axial_strain": 1, "porosity": 1, "unbalanced": 1, "q": 64, "soil_radial": 64, "sigma3_transmitted_group3": 64, "time": 1 / 8, "energy_elastic": 64}
	count = min(len(one["step"]), len(other["step"]))
	differ = {i for name, factor in same.items() for i in range(count) if one[name][i] * factor != other[name][i]}
	return {"rows": float(count), "rows that differ": float(len(differ) + abs(len(one["step"]) - len(other["step"])))}


def wide(out):
	"""A gradation of sizes 1:10."""
	file = out.resolve() / "wide.csv"
	file.write_text("diameter (mm), percent passing\n1, 0\n10, 100\n")
	return {"specimen": {"gradation": str(file), "cutBelow": None, "cutAbove": None, "grains": 800, "porosity": 0.4}, "shear": {"strain": 0.02}}


def anySoil(**more):
	"""Bounds without those of soil that carries the whole pressure all the time."""
	return {"largest soil stress/sigma3": (0.5, 8), "smallest soil stress/sigma3": (0.0, 1.2), **more}


CASES = [
	Case("as it is", bounds={"largest q/sigma3": (0.8, 2.5)}),
	*(Case(f"{p} kPa", atPressure(1e3 * p), bounds={"largest q/sigma3": (0.8, 2.5)}) for p in (1, 10, 1000, 10000)),
	Case("similar tests", scene=similar, bounds={"rows that differ": (0, 0), "rows": (10, 1000)}),
	Case("10 MPa, emod as it is", {"consolidation": {"pressure": 1e7}, "membrane": {"young": 1.2e8}, "shear": {"velocity": 1.0}},
		expect="refused", says="specimen.emod = 40000000.0: gives kn/(p d) = 3.14"),
	Case("pressure at once", {"consolidation": {"rampTime": 1e-9}}, bounds={"energy, consolidation": (0, 0.01)}),
	# rows at the times of the case before it: the sheet is fast before the first of them
	Case("pressure at once, a quarter of the step", {"consolidation": {"rampTime": 1e-9}, "numerics": {"safety": 0.125}, "output": {"consolidationSteps": 2000}},
		bounds={"energy, consolidation": (0, 0.0025)}),
	Case("loose, collapses", {"specimen": {"porosity": 0.47, "friction": 0.05}, "consolidation": {"friction": 0.5}},
		bounds=anySoil(**{"start axial": (0, 0.1), "start radial": (0, 0.1), "largest q/sigma3": (0.0, 1.2)})),
	Case("packed under stress", {"specimen": {"porosity": 0.46, "stress": 1e3, "rollingFriction": 0.1, "packingRollingFriction": 0.1}}),
	Case("membrane ten times softer", sheet(60)),
	Case("membrane ten times softer, bends freely", {"membrane": {"young": 1.2e5, "bendingStiffness": 0.0}}, expect="done or stopped",
		warns="may fold between the grains", bounds=anySoil()),
	Case("membrane ten times stiffer", sheet(6000), bounds={"largest q/sigma3": (0.8, 3)}),
	Case("R over r 2", {"membrane": {"sizeRatio": 2.0}}),
	Case("R over r 7", {"membrane": {"sizeRatio": 7.0}}, expect="refused", says="membrane.sizeRatio"),
	Case("R over r 0.2", {"membrane": {"sizeRatio": 0.2}, "shear": {"strain": 0.02}}),
	Case("slender", {"specimen": {"radius": 0.01, "height": 0.08}}),
	Case("flat", {"specimen": {"radius": 0.03, "height": 0.03}}),
	Case("25 % strain", {"shear": {"strain": 0.25}}, bounds={"strain": (0.2499, 0.2501)}),
	Case("twenty cycles", drive=casescenes.cycles),
	Case("extension", drive=casescenes.extension, bounds=anySoil(**{"smallest q/sigma3": (-1.0, -0.3), "strain": (-0.06, -0.05)})),
	Case("torn membrane", {"membrane": {"tensileStrength": 0.3}}, expect="stopped", says="torn"),
	Case("frictionless grains", {"specimen": {"friction": 0.0}, "consolidation": {"friction": 0.0}}, bounds=anySoil(**{"largest q/sigma3": (0.0, 0.8)})),
	Case("sizes 1 to 10", wide),
	Case("0.9 of the critical step", stepOf(0.9), expect="done or stopped", says="numerics.dt"),
	Case("1.1 of the critical step", stepOf(1.1), expect="refused", says="numerics.dt"),
	Case("3 times the critical step", drive=casescenes.tooLong, expect="stopped", says="time step"),
	Case("1e6 steps at rest", again=False, drive=casescenes.rest(1000000),
		bounds={"drift of porosity": (0, 1e-9), "drift of pressure": (0, 1e-7), "energy": (0, 1e-6)}),
	Case("a script tilts the top platen", drive=casescenes.tilting, expect="stopped", says="was turned by"),
	*(Case(f"tilted platen, {tier}", scene=casescenes.tilted(tier), bounds=dict.fromkeys(("force", "turning force", "turned", "driven tilt"), (0, 1e-9)))
		for tier in ("reference", "compact")),
	*(Case(f"collisions of pairs, {tier}", scene=casescenes.pairs(tier), bounds={"against central differences": (0, 1e-9)})
		for tier in ("reference", "compact")),
	Case("frictionless gas", scene=casescenes.gas, bounds={"growth at 0.2": (0.98, 1.05), "growth at 0.8": (2, math.inf)}),
]  # fmt: skip


def named(name):
	"""The case of this name.

	:raises KeyError: there is none.
	"""
	return {case.name: case for case in CASES}[name]
