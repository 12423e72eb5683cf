# SPDX-License-Identifier: GPL-2.0-or-later
"""What a careful reviewer looks at in a test: each check with its number, its limit and whether it is within. Uses nothing of YADE."""

import dataclasses
import math

import numpy as np

from hexmembrane.configuration.config import Consolidation, Shear, restTolerance
from hexmembrane.configuration.stages import ISOTROPIC, PRESSURE
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
	shear, turns = run.sheared(), _turns(run)
	wanted = run.key("shear", "strain")
	limit = "all stages" if run.staged else f"{100 * wanted:.4g} %" if isinstance(wanted, (int, float)) else "unknown"
	why = "last row of records.csv, " + ("stages" if run.staged else "shear.strain")
	found = [Check("at its end", run.state(), limit, PASS if run.ended else FAIL, why)]
	if turns:
		limit = run.key("consolidation", "unbalanced", Consolidation.__dataclass_fields__["unbalanced"].default)
		rest = float(max(run.table["unbalanced"][k - 1] for k in turns))
		found.append(_within("at rest before shear", rest, limit, "unbalanced force ratio, last row of consolidation, consolidation.unbalanced", _number))
	if shear:
		found += _sheared(run, shear, [k for k in turns if k < len(run.table["step"])] or [0])
	return found + [_budget(run), _packings(run, scatter)]


def _turns(run):
	"""Numbers of the rows that come after the last one of a consolidation, the number of all rows where it has not ended."""
	kinds = [*run.kinds(), None]
	return [k for k in range(1, len(kinds)) if kinds[k - 1] in ISOTROPIC and kinds[k] not in ISOTROPIC]


def _anisotropy(run, first):
	"""The larger distance of the middle half's stresses from sigma3 in the rows ``first``, the largest of all; nan without a pressure."""
	target = run.table["sigma3_target"][first]
	if not (target != 0).all():
		return math.nan
	return float(max(np.abs(run.table[name][first] / target - 1).max() for name in ("soil_axial_middle", "soil_radial_middle")))


def _sheared(run, shear, first):
	off = _anisotropy(run, first)
	rest = restTolerance(run.key("consolidation", "tolerance"), run.boundary, run.key("membrane", "pressureTime"))
	arrived = run.key("shear", "pressureTolerance", Shear.__dataclass_fields__["pressureTolerance"].default)
	found = [
		_within("isotropic start", off, rest, "soil's axial and radial stress in the middle half against sigma3, first row of shear; consolidation.tolerance"),
		_within("quasi-static", _largest(shear["inertial_number"]), QUASISTATIC, "largest inertial number in shear", _number),
		_within("pressure arrived", _largest(run.sheared(but=(PRESSURE,)).get("sigma3_distance", np.array([]))), arrived, "largest sigma3_distance in shear, shear.pressureTolerance"),
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
	shear = run.sheared()
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
