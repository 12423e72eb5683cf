# SPDX-License-Identifier: GPL-2.0-or-later
"""What a careful reviewer looks at in a test: each check with its number, its limit and whether it is within. Uses nothing of YADE."""

import dataclasses
import math

import numpy as np

from hexmembrane.configuration.config import Consolidation, Shear, restTolerance
from hexmembrane.report.summary import quantities
from hexmembrane.scene.timestep import QUASISTATIC

#: Largest error of the energy balance in shear, of the larger of work and stored energy; the bound of scripts/bench cases.
ENERGY = 2e-3
PASS, FAIL, OPEN = "pass", "fail", "open"


@dataclasses.dataclass
class Check:
	"""One line of the verdict.

	:param name: what is asked. :param number: what was found, with unit. :param limit: what it may be. :param state: PASS, FAIL or OPEN, not judged.
	:param why: where number and limit come from, or why it is not judged.
	"""

	name: str
	number: str
	limit: str
	state: str
	why: str


def _percent(value):
	return f"{100 * value:.3g} %"


def _within(name, value, limit, why, show=_percent):
	if not (isinstance(limit, (int, float)) and math.isfinite(value)):
		return Check(name, show(value) if math.isfinite(value) else "unknown", "unknown", OPEN, why)
	return Check(name, show(value), f"\N{LESS-THAN OR EQUAL TO} {show(limit)}", PASS if value <= limit else FAIL, why)


def _largest(values):
	values = np.abs(values[np.isfinite(values)])
	return float(values.max()) if len(values) else math.nan


def _number(value):
	return f"{value:.2e}"


def checks(run, scatter=None):
	"""The verdict on a test, a list of :class:`Check`; what its records do not tell is not judged.

	:param scatter: relative half width of the mean peak of q over packings and their number, None: one packing.
	"""
	shear, consolidation = run.rows("shear"), run.rows("consolidation")
	wanted = run.key("shear", "strain")
	limit = f"{100 * wanted:.4g} %" if isinstance(wanted, (int, float)) else "unknown"
	found = [Check("at its end", run.state(), limit, PASS if run.ended else FAIL, "last row of records.csv, shear.strain")]
	if consolidation:
		limit = run.key("consolidation", "unbalanced", Consolidation.__dataclass_fields__["unbalanced"].default)
		found.append(_within("at rest before shear", float(consolidation["unbalanced"][-1]), limit, "unbalanced force ratio, consolidation.unbalanced", _number))
	if shear:
		found += _sheared(run, shear)
	return found + [_budget(run), _packings(run, scatter)]


def _sheared(run, shear):
	first = {name: float(shear[name][0]) for name in ("soil_axial_middle", "soil_radial_middle", "sigma3_target")}
	off = max(abs(first[name] / first["sigma3_target"] - 1) for name in ("soil_axial_middle", "soil_radial_middle")) if first["sigma3_target"] else math.nan
	rest = restTolerance(run.key("consolidation", "tolerance"), run.config.get("boundary"), run.key("membrane", "pressureTime"))
	arrived = run.key("shear", "pressureTolerance", Shear.__dataclass_fields__["pressureTolerance"].default)
	found = [
		_within("isotropic start", off, rest, "soil's axial and radial stress in the middle half against sigma3, first row of shear; consolidation.tolerance"),
		_within("quasi-static", _largest(shear["inertial_number"]), QUASISTATIC, "largest inertial number in shear", _number),
		_within("pressure arrived", _largest(shear["sigma3_distance"]), arrived, "largest sigma3_distance in shear, shear.pressureTolerance"),
		_within("energy balance", _largest(shear["energy_error"]), ENERGY, "largest energy_error in shear; nan with output.energy: false"),
	]
	broken = int(_largest(shear["bonds_broken"]))
	found.append(Check("membrane whole", f"{broken} broken bonds", "0", FAIL if broken else PASS, "bonds_broken"))
	rows = len(shear["step"])
	inside = Check("grains inside", f"all at {rows} rows", "all", PASS, "a test stops with an error at the first row with a grain outside")
	if not run.ended:
		inside.state, inside.why = OPEN, "the test is not at its end, and its files do not say why"
	return [*found, inside]


def _budget(run):
	name = "error budget"
	try:
		value = float(run.made["budget"]["budget of a run"]["peak q"])
	except (KeyError, TypeError, ValueError):
		return Check(name, "unknown", "unknown", OPEN, "config.yaml has none")
	wanted = run.config.get("accuracy")
	if not isinstance(wanted, (int, float)):
		return Check(name, _percent(value), "none asked for", OPEN, "error of the peak of q by the settings; the key accuracy sets a limit")
	return _within(name, value, wanted, "error of the peak of q by the settings; the key accuracy")


def _packings(run, scatter):
	name = "packings"
	try:
		expected = float(run.made["budget"]["scatter of packings"]["peak q"])
	except (KeyError, TypeError, ValueError):
		expected = math.nan
	said = f"; {_percent(expected)} scatter between packings is expected" if math.isfinite(expected) else ""
	if scatter is None:
		return Check(name, "1 packing", "several", OPEN, "one packing tells nothing of the scatter between packings" + said)
	value, count = scatter
	why = f"half the 95 % interval of the mean peak of q over {count} packings" + said
	wanted = run.config.get("accuracy")
	if isinstance(wanted, (int, float)):
		return _within(name, value, wanted, why + "; the key accuracy")
	return Check(name, _percent(value), "none asked for", OPEN, why)


def summary(run):
	"""The test in numbers for the page, (label, text) pairs; [] without shear."""
	shear = run.rows("shear")
	if not shear:
		return []
	found = quantities(shear)
	return [
		("peak of q", f"{1e-3 * found['peak_q']:.4g} kPa at {100 * found['strain_at_peak']:.3g} %"),
		("q at the end", f"{1e-3 * found['end_q']:.4g} kPa"),
		("volumetric strain at the end", f"{100 * found['end_volumetric_strain']:.3g} %"),
		("porosity", f"{found['start_porosity']:.4f} to {found['end_porosity']:.4f}"),
		("coordination number", f"{found['start_coordination']:.3g} to {found['end_coordination']:.3g}"),
	]
