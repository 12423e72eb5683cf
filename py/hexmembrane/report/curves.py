# SPDX-License-Identifier: GPL-2.0-or-later
"""The curves of a report: of each test, of tests that differ in their seed alone, and of a laboratory. Uses nothing of YADE."""

import dataclasses
import json
import pathlib

import numpy as np

from hexmembrane.report.encode import numbers
from hexmembrane.report.summary import halfWidth


@dataclasses.dataclass(frozen=True)
class Panel:
	"""A figure of curves: what is drawn, in ``unit`` after ``factor``; ``log``: on a logarithmic scale; ``columns``: of the records that it needs."""

	name: str
	title: str
	unit: str
	factor: float = 1.0
	log: bool = False
	columns: tuple = ()

	def values(self, table):
		"""Of the rows of a table, in the panel's unit; None when a column is missing."""
		columns = self.columns or (self.name,)
		if not set(columns) <= set(table):
			return None
		with np.errstate(divide="ignore", invalid="ignore"):
			return self.factor * (table[columns[0]] / table[columns[1]] if len(columns) == 2 else table[columns[0]])


PANELS = (
	Panel("q", "deviatoric stress of the soil, q", "kPa", 1e-3),
	Panel("volumetric_strain_volume", "volumetric strain, dilation positive", "%", 100),
	Panel("stress_ratio", "stress ratio q/p", "", columns=("q", "p")),
	Panel("porosity", "porosity", ""),
	Panel("coordination", "coordination number", ""),
	Panel("sigma3_transmitted_group3", "pressure that arrives, main body (group 3)", "kPa", 1e-3),
	Panel("sigma3_transmitted_group2", "pressure that arrives beside the platens (group 2)", "kPa", 1e-3),
	Panel("sigma3_applied", "pressure on the lateral boundary", "kPa", 1e-3),
	Panel("work_boundary", "work done on the specimen in the stage", "J"),
	Panel("energy_friction", "dissipated by contacts in the stage", "J"),
	Panel("energy_damping", "dissipated by local damping in the stage", "J"),
	Panel("energy_elastic", "elastic energy of the contacts", "J"),
	Panel("energy_membrane", "elastic energy of the membrane", "J"),
	Panel("energy_error", "error of the energy balance", "%", 100),
	Panel("unbalanced", "unbalanced force ratio", "", log=True),
	Panel("inertial_number", "inertial number", "", log=True),
)
#: What is drawn: its name, and over which column (column, label, unit, factor). The last two are of tests with a list of stages.
_OVER = {
	"shear": ("shear", "axial_strain", "axial strain", "%", 100.0),
	"consolidation": ("consolidation", "time", "time since the stage began", "ms", 1e3),
	"stages": ("all stages over strain", "axial_strain", "axial strain", "%", 100.0),
	"time": ("all stages over time", "time", "time since the test began", "ms", 1e3),
}
#: Keys that tests with other seeds may have other values of: what they are called, where their files are, what they write.
_FREE_SECTIONS, _FREE = ("output",), {"title": None, "specimen": ("seed", "packing"), "numerics": ("threads",)}
#: What a mean is not told by.
SEED = ("specimen.seed",)
#: Strains at which a mean is taken.
_POINTS = 201


def axes():
	"""For the page: by stage its name, and label and unit of what rows are drawn over."""
	return {stage: {"name": name, "label": label, "unit": unit} for stage, (name, _, label, unit, _) in _OVER.items()}


def _rows(run, stage):
	if stage == "stages":
		return run.sheared() if run.staged else {}
	if stage == "time":
		return {name: column for name, column in run.table.items() if name != "stage"} if run.staged else {}
	return run.rows(stage)


def ofRun(run):
	"""{stage: {"x": [...], name of a panel: [...]}} for the page."""
	found = {}
	for stage, (_, column, _, _, factor) in _OVER.items():
		rows = _rows(run, stage)
		if rows:
			x = rows[column] - (rows["time"][0] if column == "time" else 0.0)
			values = {panel.name: panel.values(rows) for panel in PANELS}
			found[stage] = {"x": numbers(factor * x), **{name: numbers(one) for name, one in values.items() if one is not None}}
	return found


def _alike(run):
	"""What tests that differ in their seed alone have in common; None without a configuration."""
	if not run.config:
		return None
	kept = {}
	for section, values in run.config.items():
		if section in _FREE_SECTIONS or _FREE.get(section, ()) is None:
			continue
		free = _FREE.get(section, ())
		if isinstance(values, dict):
			values = {name: pathlib.Path(value).name if name == "gradation" and value else value for name, value in values.items() if name not in free}
		kept[section] = values
	return json.dumps(kept, sort_keys=True, default=str)


def groups(runs):
	"""Lists of tests with rows of shear that differ in their seed alone, two or more each; lists of stages have no mean, since they pass a strain several times."""
	found = {}
	for run in runs:
		if run.rows("shear") and not run.staged and (alike := _alike(run)) is not None:
			found.setdefault(alike, []).append(run)
	return [group for group in found.values() if len(group) > 1]


def ofGroup(group):
	"""The mean of a group's curves and half the width of its interval, on strains that all have, for the page."""
	tables_ = [run.rows("shear") for run in group]
	_, column, _, _, factor = _OVER["shear"]
	x = np.linspace(0, min(table[column][-1] for table in tables_), _POINTS)
	content = {"x": numbers(factor * x)}
	for panel in PANELS:
		values = [panel.values(table) for table in tables_]
		if all(one is not None for one in values):
			each = np.array([np.interp(x, table[column], one) for table, one in zip(tables_, values)])
			content[panel.name], content[f"{panel.name} half width"] = numbers(each.mean(axis=0)), numbers(halfWidth(each))
	return {"name": f"mean of {len(group)}: {group[0].label(SEED) or group[0].title}", "members": [run.name for run in group], "shear": content}


def laboratory(curve, pressure):
	"""A :class:`hexmembrane.laboratory.curve.Curve` at sigma3 [Pa] for the page: q, q/p and volumetric strain where it has them."""
	series = curve.series
	strain = np.unique(np.concatenate([one.strain for one in series.values()]))
	found = {"x": numbers(100 * strain)}
	if "stress_ratio" in series:
		ratio = series["stress_ratio"].at(strain)
		found["q"], found["stress_ratio"] = numbers(1e-3 * pressure * (ratio - 1)), numbers(3 * (ratio - 1) / (ratio + 2))
	if "volumetric_strain" in series:
		found["volumetric_strain_volume"] = numbers(100 * series["volumetric_strain"].at(strain))
	return {"name": f"{curve.name} at {1e-3 * pressure:g} kPa", "shear": found}
