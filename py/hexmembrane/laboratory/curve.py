# SPDX-License-Identifier: GPL-2.0-or-later
"""A laboratory's curve of a drained triaxial compression test, read from CSV and checked. Needs no YADE.

Inside, strains are ratios, axial compression positive, dilation positive, and stress is the ratio sigma1/sigma3: the conventions of records.csv.
"""

import csv
import dataclasses
import pathlib
import re

import numpy
from hexmembrane.configuration import ConfigError

#: Key of a declaration -> what it is.
KEYS = {
	"file": "CSV with a header line; lines that begin with # are passed over, empty cells are no values",
	"strain": "header of the axial strain's column, compression positive",
	"stress_ratio": "header of sigma1/sigma3's column",
	"q": "header of the deviatoric stress' column, sigma1 - sigma3; instead of stress_ratio",
	"volumetric_strain": "header of the volumetric strain's column",
	"volumetric": "what is positive there: 'dilation' or 'compression'",
	"units": "header -> '%', '-', 'Pa', 'kPa' or 'MPa', where the header does not end in [unit]",
}
#: Quantities that a curve may have.
QUANTITIES = ("stress_ratio", "volumetric_strain")
#: Key of a declaration -> headers, without their units, that are taken where a configuration's ``lab`` names none; signs are those of records.csv.
NAMES = {
	"strain": ("axial_strain",),
	"stress_ratio": ("stress_ratio",),
	"q": ("q", "q_cell"),
	"volumetric_strain": ("volumetric_strain", "volumetric_strain_volume"),
}
_UNITS = {"%": 0.01, "-": 1.0, "Pa": 1.0, "kPa": 1e3, "MPa": 1e6}
_STRAIN, _STRESS = ("%", "-"), ("Pa", "kPa", "MPa")
#: Fewest values of a quantity; widest gap between two of them as share of its range of strain.
FEWEST, WIDEST = 5, 1 / 3
#: Largest strain that a test reaches; smallest that a curve to calibrate on ends at; largest stress ratio of sand.
_LARGEST, _SMALLEST, _STRONGEST = 0.5, 0.005, 50.0
_HEADER_UNIT = re.compile(r"\[([^\]]*)\]\s*$")


@dataclasses.dataclass
class Series:
	"""One quantity over axial strain: arrays of equal length, strain rising."""

	strain: numpy.ndarray
	value: numpy.ndarray

	def at(self, strain):
		"""The value at strains within its range, by straight lines between its points; nan outside."""
		return numpy.interp(strain, self.strain, self.value, left=numpy.nan, right=numpy.nan)


@dataclasses.dataclass
class Curve:
	"""A laboratory's test. ``series``: quantity -> :class:`Series`; ``warnings``: texts, gaps for one."""

	name: str
	series: dict
	warnings: list


def read(declared, folder, pressure, name="lab"):
	"""The :class:`Curve` that a declaration (:data:`KEYS`) names.

	:param folder: what relative paths start from.
	:param pressure: sigma3 [Pa], which makes a stress ratio of ``q``.
	:param name: its key in messages.
	:raises ConfigError: key, value, what is wrong and how to mend it; a curve is told as what it is: unsorted, percent for ratio, wrong sign, too short.
	"""
	_requireKeys(declared, name)
	path = pathlib.Path(folder) / pathlib.Path(declared["file"]).expanduser()
	columns = _table(path, name)
	used = {key: declared[key] for key in ("strain", "stress_ratio", "q", "volumetric_strain") if key in declared}
	for key, header in used.items():
		if header not in columns:
			raise ConfigError(f"{name}.{key}", header, f"is no column of '{path}'", f"its columns are {', '.join(columns)}")
	units = {key: _unit(declared, key, header, name) for key, header in used.items()}
	strain = columns[declared["strain"]] * _UNITS[units["strain"]]
	curve = Curve(path.stem, {}, [])
	for key in used:
		if key == "strain":
			continue
		kept = numpy.isfinite(columns[declared[key]])
		series = Series(strain[kept], columns[declared[key]][kept] * _UNITS[units[key]])
		where = f"{name}.{key}"
		_checkStrain(series.strain, units["strain"], where, path)
		if key == "volumetric_strain":
			_checkVolumetric(series, units[key], where)
			if declared["volumetric"] == "compression":
				series.value = -series.value
			curve.series[key] = series
		else:
			curve.series["stress_ratio"] = _stressRatio(series, key, pressure, where)
		curve.warnings += _gaps(series, where)
	return curve


def ofKeys(keys, pressure, name="lab"):
	"""The :class:`Curve` of a configuration's section ``lab``, a dict in which a key may be None; None without a file. Columns that are not named are those of NAMES.

	:raises ConfigError: as :func:`read`.
	"""
	declared = {key: value for key, value in keys.items() if value is not None}
	if "file" not in declared:
		return None
	headers = {_HEADER_UNIT.sub("", header).strip(): header for header in _table(pathlib.Path(declared["file"]).expanduser(), name)}
	known = {key: next((headers[one] for one in names if one in headers), None) for key, names in NAMES.items()}
	if not {"stress_ratio", "q", "volumetric_strain"} & set(declared):
		found = ["stress_ratio" if known["stress_ratio"] else "q", "volumetric_strain"]
		declared.update({key: known[key] for key in found if known[key]})
		if known["volumetric_strain"]:
			declared.setdefault("volumetric", "dilation")
	if known["strain"]:
		declared.setdefault("strain", known["strain"])
	return read(declared, "", pressure, name)


def _requireKeys(declared, name):
	if not isinstance(declared, dict):
		raise ConfigError(name, declared, "is not a mapping of keys", f"give {', '.join(KEYS)}")
	for key, value in declared.items():
		if key not in KEYS:
			raise ConfigError(f"{name}.{key}", value, "unknown key", f"known keys are {', '.join(KEYS)}")
		if not isinstance(value, dict if key == "units" else str):
			raise ConfigError(f"{name}.{key}", value, "is of the wrong kind", f"give {KEYS[key]}")
	for key in ("file", "strain"):
		if key not in declared:
			raise ConfigError(f"{name}.{key}", None, "is not given", f"give {KEYS[key]}")
	if ("stress_ratio" in declared) + ("q" in declared) + ("volumetric_strain" in declared) == 0:
		raise ConfigError(name, declared["file"], "has nothing to compare", "give stress_ratio or q, volumetric_strain, or both")
	if "stress_ratio" in declared and "q" in declared:
		raise ConfigError(f"{name}.q", declared["q"], "is given together with stress_ratio", "give one of the two")
	if "volumetric_strain" in declared and declared.get("volumetric") not in ("dilation", "compression"):
		raise ConfigError(f"{name}.volumetric", declared.get("volumetric"), "does not say what is positive", "give 'dilation' or 'compression'")


def _table(path, name):
	"""Header -> array of a CSV, nan where a cell is empty."""
	try:
		with open(path, encoding="utf-8-sig", newline="") as file:
			rows = [row for row in csv.reader(line for line in file if line.strip() and not line.startswith("#"))]
	except (OSError, ValueError) as error:
		raise ConfigError(f"{name}.file", str(path), f"cannot be read ({getattr(error, 'strerror', None) or error})", "give a CSV file in UTF-8") from None
	if len(rows) < 2:
		raise ConfigError(f"{name}.file", str(path), "has no rows", "give a header line and rows of numbers")
	header = [cell.strip() for cell in rows[0]]
	if len(set(header)) < len(header):
		raise ConfigError(f"{name}.file", str(path), "has two columns of one name", "give each column its own name")
	values = numpy.full((len(rows) - 1, len(header)), numpy.nan)
	for k, row in enumerate(rows[1:]):
		if len(row) > len(header):
			raise ConfigError(f"{name}.file", str(path), f"row {k + 2} has {len(row)} cells for {len(header)} columns", "write numbers with a point, and commas between cells only")
		for column, cell in enumerate(row):
			if cell.strip():
				values[k, column] = _number(cell, path, k + 2, name)
	return dict(zip(header, values.T))


def _number(cell, path, row, name):
	try:
		value = float(cell)
	except ValueError:
		value = numpy.nan
	if not numpy.isfinite(value):
		raise ConfigError(f"{name}.file", str(path), f"row {row} has '{cell.strip()}', which is no number", "leave a cell without a value empty")
	return value


def _unit(declared, key, header, name):
	found = declared.get("units", {}).get(header)
	if found is None:
		inHeader = _HEADER_UNIT.search(header)
		found = inHeader.group(1).strip() if inHeader else "-" if key == "stress_ratio" else None
	allowed = _STRESS if key == "q" else ("-",) if key == "stress_ratio" else _STRAIN
	if found not in allowed:
		wrong = "has no unit" if found is None else f"has the unit '{found}'"
		raise ConfigError(f"{name}.{key}", header, wrong, f"end the header with a unit in brackets, or give units: {{'{header}': UNIT}}, one of {', '.join(allowed)}")
	return found


def _checkStrain(strain, unit, where, path):
	if len(strain) < FEWEST:
		raise ConfigError(where, str(path), f"is too short: it has {len(strain)} values", f"give {FEWEST} at least")
	back = numpy.flatnonzero(numpy.diff(strain) <= 0)
	if len(back) and (numpy.diff(strain) < 0).all() and strain[-1] < 0:
		raise ConfigError(where, f"{strain[-1]:.4g}", "is the axial strain at the end: its sign is wrong", "give compression as positive")
	if len(back):
		k = int(back[0])
		raise ConfigError(where, f"{strain[k + 1]:.6g}", f"is an axial strain that comes after {strain[k]:.6g}: the rows are unsorted", "sort by strain, and take cycles out")
	if strain[0] < -1e-4:
		raise ConfigError(where, f"{strain[0]:.4g}", "is an axial strain below zero", "give compression as positive, counted from the start of shear")
	if strain[-1] > _LARGEST:
		other = "percent given for a ratio?" if unit == "-" else "what is its unit?"
		raise ConfigError(where, f"{strain[-1]:.4g}", f"is the axial strain at the end, more than a test reaches; {other}", "correct the unit")
	if strain[-1] < _SMALLEST:
		other = "a ratio given for percent?" if unit == "%" else "too short to compare"
		raise ConfigError(where, f"{strain[-1]:.4g}", f"is the axial strain at the end, less than {_SMALLEST:g}; {other}", "correct the unit, or give more of the test")


def _checkVolumetric(series, unit, where):
	if abs(series.value).max() > _LARGEST:
		other = "percent given for a ratio?" if unit == "-" else "what is its unit?"
		raise ConfigError(where, f"{abs(series.value).max():.4g}", f"is the largest volumetric strain, more than sand has; {other}", "correct the unit")
	if unit == "%" and 0 < abs(series.value).max() < 1e-4 and series.strain[-1] > 0.02:
		raise ConfigError(where, f"{abs(series.value).max():.4g}", "is the largest volumetric strain, less than sand has; a ratio given for percent?", "correct the unit")


def _stressRatio(series, key, pressure, where):
	if key == "q":
		if series.value.max() <= 0:
			raise ConfigError(where, f"{series.value.max():.4g}", "is the largest deviatoric stress: its sign is wrong", "give compression as positive")
		series = Series(series.strain, 1 + series.value / pressure)
		if not 1.05 < series.value.max() < _STRONGEST:
			wrong = f"is the largest sigma1/sigma3 at sigma3 = {pressure:g} Pa, which no sand has; what is the unit of q?"
			raise ConfigError(where, f"{series.value.max():.4g}", wrong, "correct the unit, or the test's pressure")
		return series
	if series.value.max() > _STRONGEST or series.value.max() < 1.05:
		wrong = "is the largest sigma1/sigma3, which no sand has"
		raise ConfigError(where, f"{series.value.max():.4g}", wrong, "give sigma1/sigma3, or name the column as q with its unit")
	if series.value.min() < 0.9:
		raise ConfigError(where, f"{series.value.min():.4g}", "is a sigma1/sigma3 below 1; q/sigma3 given for sigma1/sigma3?", "add 1, or give q with its unit")
	return series


def _gaps(series, where):
	steps = numpy.diff(series.strain)
	k = int(steps.argmax())
	if steps[k] <= WIDEST * (series.strain[-1] - series.strain[0]):
		return []
	return [f"WARNING: {where}: has a gap from {100 * series.strain[k]:.3g} to {100 * series.strain[k + 1]:.3g} % of strain; between two points a straight line is taken"]
