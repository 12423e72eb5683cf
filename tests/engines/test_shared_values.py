# SPDX-License-Identifier: GPL-2.0-or-later
"""Defaults and ranges of shared.csv are those of the classes and of the configuration's keys."""

import csv
import math

import pytest
import yade
from hexmembrane.configuration import Config
from hexmembrane.configuration.schema import SHARED, table
from membraneScene import makeMembrane

ROWS = {row["name"]: row for row in csv.DictReader(line for line in SHARED.read_text().splitlines() if not line.startswith("#"))}
#: Row -> the classes' attributes with its default, and the keys with its range; those whose default is their own are in brackets.
USED = {
	"local_damping": (["CompactLoop.damping"], ["numerics.damping"]),
	"substeps": (["CompactLoop.substeps"], ["numerics.substeps"]),
	"list_skin": ([], ["numerics.skin"]),
	"packing_seed": (["CylinderPacking.seed"], ["specimen.seed"]),
	"stiffness_ratio": (["CylinderPacking.stiffnessRatio"], ["specimen.kratio"]),
	"friction": ([], ["(specimen.friction)", "(wall.friction)", "(platens.friction)", "(platens.consolidationFriction)", "(consolidation.friction)"]),
	"rolling_friction": (["CylinderPacking.rollingFriction", "LinearMat.rollingFriction"], ["specimen.rollingFriction", "specimen.packingRollingFriction"]),
	"servo_tolerance": (["PlatenDrive.tolerance", "RadialWallServo.tolerance", "SoilStressServo.tolerance"], ["wall.tolerance"]),
	"servo_damping": (["PlatenDrive.damping", "RadialWallServo.damping"], ["(wall.damping)"]),
	"o_ring_rows": (["HexMembrane.oRingRows"], ["membrane.oRingRows"]),
	"platen_rows": (["HexMembrane.platenRows"], ["(membrane.platenRows)"]),
	"lattice_poisson": ([], ["(membrane.poisson)"]),
	"plate_stiffness": ([], ["(membrane.bendingStiffness)"]),
	"placement": (["HexMembrane.placement"], ["membrane.placement"]),
	"pressure_surface": (["MembranePressure.surface"], ["membrane.surface"]),
	"area_rule": (["MembraneRadialServo.areaRule"], ["membrane.areaRule"]),
	"o_ring_mode": (["MembraneORings.mode"], ["(membrane.oRings)"]),
}


def test_eachRowIsUsed():
	assert set(USED) == set(ROWS)


@pytest.mark.parametrize("name", USED)
def test_classesAndKeysHaveTheRow(O, name):
	row, keys = ROWS[name], {path: (default, allowed) for path, _, _, default, allowed, _ in table(Config)}
	attributes, paths = USED[name]
	for attribute in attributes:
		kind, member = attribute.split(".")
		found = getattr(getattr(yade, kind)(), member)
		assert found == (row["default"] if row["choices"] else float(row["default"])), attribute
	for path in paths:
		default, allowed = keys[path.strip("()")]
		if not path.startswith("("):
			assert default == row["default"] or float(default) == float(row["default"]), path
		if row["choices"]:
			assert allowed == " or ".join(f"'{choice}'" for choice in row["choices"].split("|"))
		elif path != "membrane.oRingRows":  # at least one there: something must hold the sheet
			assert allowed.startswith((">" if row["open"] == "low" else ">=") + f" {float(row['low']):g}"), path


BELOW = {
	"local_damping": lambda value: loop(damping=value),
	"substeps": lambda value: loop(substeps=int(value)),
	"o_ring_rows": lambda value: makeMembrane(oRingRows=int(value)),
	"platen_rows": lambda value: makeMembrane(platenRows=int(value)),
	"packing_seed": lambda value: packing(seed=int(value)),
	"stiffness_ratio": lambda value: packing(stiffnessRatio=value),
	"friction": lambda value: packing(friction=value),
	"rolling_friction": lambda value: packing(rollingFriction=value),
}


def loop(**settings):
	yade.O.engines = [yade.CompactLoop(**settings)]
	yade.O.dt = 1e-6
	yade.O.step()


def packing(**settings):
	given = {"radius": 0.02, "height": 0.04, "radii": [2e-3] * 60, "porosity": 0.45, "stress": 2e4, "emod": 1e7, "friction": 0.4, **settings}
	yade.CylinderPacking(**given).generate()


@pytest.mark.parametrize("name", BELOW)
def test_belowTheRangeIsRefused(O, name):
	low = float(ROWS[name]["low"])
	with pytest.raises(ValueError, match="is out of range; fix: give a number >= " + f"{low:g}"):
		BELOW[name](math.floor(low - 1))
