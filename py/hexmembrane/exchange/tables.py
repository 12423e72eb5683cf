# SPDX-License-Identifier: GPL-2.0-or-later
"""Tables of a state: balls.csv, contacts.csv, bonds.csv, walls.csv and measures.csv in a folder, as an exporter inside PFC writes them. Uses nothing of YADE.

Each file is CSV (UTF-8). Its first line is ``# hexmembrane-tables=1 table=NAME cycle=N timestep=SECONDS time=SECONDS``, more lines with # may follow, then comes
the line of the columns. SI units. A field that the state does not have is empty. Columns that are not known are left out.
"""

import csv
import dataclasses
import math
import pathlib

import numpy

from hexmembrane.configuration import ConfigError
from hexmembrane.configuration.schema import shown

#: Version of the format. A reader takes its own only.
VERSION = 1
_MARK = "hexmembrane-tables"
_VECTOR = ("x", "y", "z")
#: Columns of each table: name -> (unit, meaning). Those of _NEEDED must be there and have a value in each line.
COLUMNS = {
	"balls": {
		"id": ("", "PFC's number of the ball"),
		**{name: ("m", f"{name} of the centre") for name in _VECTOR},
		"r": ("m", "radius"),
		**{f"v{name}": ("m/s", f"velocity along {name}, that of the last cycle") for name in _VECTOR},
		**{f"w{name}": ("rad/s", f"spin about {name}") for name in _VECTOR},
		"density": ("kg/m3", "density"),
		"group": ("", "PFC's group"),
	},
	"contacts": {
		"id": ("", "PFC's number of the contact"),
		"kind": ("", "ball-ball or ball-facet"),
		"end1": ("", "number of the ball at end 1"),
		"end2": ("", "number of the ball at end 2, or of the wall that the facet belongs to"),
		"model": ("", "PFC's contact model"),
		"gap": ("m", "distance of the surfaces, below 0 in contact"),
		**{f"p{name}": ("m", f"{name} of the contact's place") for name in _VECTOR},
		**{f"n{name}": ("", f"{name} of the unit normal, from end 1 to end 2") for name in _VECTOR},
		**{f"f{name}": ("N", f"{name} of the force on end 2, without that of a parallel bond") for name in _VECTOR},
		**{f"m{name}": ("N m", f"{name} of the moment of rolling resistance on end 2") for name in _VECTOR},
		"kn": ("N/m", "normal stiffness of the contact"),
		"ks": ("N/m", "shear stiffness"),
		"fric": ("", "coefficient of friction"),
		"rr_fric": ("", "coefficient of rolling friction"),
		"rr_kr": ("N m", "rolling stiffness"),
		"emod": ("Pa", "effective modulus of the contact, as PFC tells it"),
		"cb_state": ("", "3: bonded"),
		"cb_tenf": ("N", "tensile strength of the contact bond"),
		"cb_shearf": ("N", "shear strength of the contact bond"),
		"dp_nratio": ("", "normal damping ratio of the dashpot"),
		"dp_sratio": ("", "shear damping ratio of the dashpot"),
		"rgap": ("m", "reference gap"),
		"lin_mode": ("", "0: normal force from the gap, 1: by increments"),
	},
	"bonds": {
		"id": ("", "PFC's number of the contact that the parallel bond belongs to"),
		"end1": ("", "number of the ball at end 1"),
		"end2": ("", "number of the ball at end 2"),
		"pb_rmul": ("", "radius of the bond over the smaller ball's"),
		"pb_kn": ("N/m3", "normal stiffness of the bond by area"),
		"pb_ks": ("N/m3", "shear stiffness by area"),
		"pb_ten": ("Pa", "tensile strength"),
		"pb_coh": ("Pa", "cohesion"),
		"pb_fa": ("degrees", "friction angle"),
		"pb_mcf": ("", "share of the moments in the stresses"),
		**{f"pb_f{name}": ("N", f"{name} of the bond's force on end 2") for name in _VECTOR},
		**{f"pb_m{name}": ("N m", f"{name} of the bond's moment on end 2") for name in _VECTOR},
		"pb_sigma": ("Pa", "largest normal stress in the bond, tension positive"),
		"pb_tau": ("Pa", "largest shear stress in the bond"),
	},
	"walls": {
		"id": ("", "PFC's number of the wall"),
		"name": ("", "its name"),
		**{name: ("m", f"{name} of its place") for name in _VECTOR},
		**{f"v{name}": ("m/s", f"velocity along {name}") for name in _VECTOR},
		**{f"f{name}": ("N", f"{name} of the sum of its contacts' forces") for name in _VECTOR},
	},
	"measures": {
		"id": ("", "PFC's number of the measurement sphere"),
		**{name: ("m", f"{name} of the centre") for name in _VECTOR},
		"r": ("m", "radius"),
		"porosity": ("", "porosity"),
		"coordination": ("", "coordination number"),
		**{f"s{name}": ("Pa", f"stress {name}, tension positive") for name in ("xx", "yy", "zz", "xy", "xz", "yz")},
	},
}
_NEEDED = {
	"balls": ("id", "x", "y", "z", "r"),
	"contacts": ("id", "kind", "end1", "end2", "model", "gap", "nx", "ny", "nz", "fx", "fy", "fz", "kn", "ks", "fric"),
	"bonds": ("end1", "end2", "pb_rmul", "pb_kn", "pb_ks", "pb_ten", "pb_coh", "pb_fa", "pb_mcf", "pb_fx", "pb_fy", "pb_fz", "pb_mx", "pb_my", "pb_mz"),
	"walls": ("id", "x", "y", "z"),
	"measures": ("id", "x", "y", "z", "r"),
}
_TEXTS = ("kind", "model", "group", "name")
#: Strengths of bonds, which may be infinite.
_STRENGTHS = ("pb_ten", "pb_coh")
#: PFC's contact model that has parallel bonds.
PARALLEL = "linearpbond"
BALL_BALL, BALL_FACET = "ball-ball", "ball-facet"
#: cb_state of a contact that is bonded.
BONDED = 3


@dataclasses.dataclass
class Table:
	"""One table: ``head``, the words of its first line; ``columns``, an array of numbers (NaN: empty) or a list of texts by name; ``lines``, of the file."""

	head: dict
	columns: dict
	lines: list

	def __len__(self):
		return len(self.lines)

	def __getitem__(self, name):
		"""A column; NaN where the file has none."""
		return self.columns.get(name, [""] * len(self) if name in _TEXTS else numpy.full(len(self), math.nan))

	def vectors(self, letter=""):
		"""The columns x, y, z, with a letter before them, as (N, 3)."""
		return numpy.column_stack([self[letter + name] for name in _VECTOR])

	def number(self, name):
		"""A number of the first line, NaN where it is not there."""
		try:
			return float(self.head.get(name, math.nan))
		except ValueError:
			return math.nan


@dataclasses.dataclass
class State:
	"""The tables of a folder: ``balls`` and ``contacts``; ``bonds``, those that hold, ``walls`` and ``measures`` where they are there (else None)."""

	folder: pathlib.Path
	balls: Table
	contacts: Table
	bonds: Table = None
	walls: Table = None
	measures: Table = None


def read(folder):
	"""The :class:`State` in a folder.

	:raises ConfigError: a file is missing, of another version, or a line of it is wrong; with file, line, value and fix.
	"""
	folder = pathlib.Path(folder)
	found = {name: _read(folder / f"{name}.csv", name) for name in COLUMNS if name in ("balls", "contacts") or (folder / f"{name}.csv").exists()}
	cycles = {name: table.head.get("cycle") for name, table in found.items()}
	if len(set(cycles.values())) > 1:
		wrong = "the tables are of different cycles, " + ", ".join(f"{name} of {cycle}" for name, cycle in cycles.items())
		raise ConfigError("tables", str(folder), wrong, "export all of them at once, without cycling between them")
	state = State(folder, **found)
	_checkEnds(state)
	return state


def _read(path, name):
	try:
		text = path.read_text(encoding="utf-8-sig")
	except OSError as error:
		raise ConfigError(f"{name}.csv", str(path), f"cannot be read ({error.strerror})", "give the folder that scripts/pfc.d/export_pfc.py wrote") from None
	except UnicodeDecodeError:
		raise ConfigError(f"{name}.csv", str(path), "is no text", "a CSV file in UTF-8") from None
	lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
	head = _head(path, name, lines)
	lines = [(number, line) for number, line in lines if not line.startswith("#")]
	if not lines:
		raise ConfigError(f"{name}.csv", str(path), "has no line of columns", "export it anew")
	names = [word.strip() for word in next(csv.reader([lines[0][1]]))]
	missing = [column for column in _NEEDED[name] if column not in names]
	if missing:
		raise ConfigError(f"{name}.csv", str(path), f"line {lines[0][0]}: no column {', '.join(missing)}", "export it anew")
	rows = [row for row in csv.reader(line for _, line in lines[1:])]
	numbers = [number for number, _ in lines[1:]]
	for number, row in zip(numbers, rows):
		if len(row) != len(names):
			raise ConfigError(f"{name}.csv", str(path), f"line {number}: has {len(row)} columns, the header {len(names)}", "a value or nothing for each column")
	return Table(head, {column: _column(path, name, column, numbers, [row[k] for row in rows]) for k, column in enumerate(names) if column in COLUMNS[name]}, numbers)


def _head(path, name, lines):
	first = lines[0][1] if lines else ""
	words = dict(word.split("=", 1) for word in first.lstrip("# ").split() if "=" in word)
	if not first.startswith("#") or _MARK not in words:
		raise ConfigError(f"{name}.csv", str(path), f"its first line {shown(first)} names no format", f"a first line '# {_MARK}={VERSION} table={name} ...', as the exporters write it")
	if words[_MARK] != str(VERSION) or words.get("table") != name:
		raise ConfigError(f"{name}.csv", str(path), f"is {words.get('table')} of format {words[_MARK]}", f"{name} of format {VERSION}: export it anew by this version's exporter")
	return words


def _column(path, name, column, lines, texts):
	texts = [text.strip() for text in texts]
	if column in _TEXTS:
		return texts
	values = numpy.empty(len(texts))
	for k, text in enumerate(texts):
		try:
			values[k] = float(text) if text else math.nan
		except ValueError:
			raise ConfigError(f"{name}.csv", str(path), f"line {lines[k]}: {column} = {shown(text)} is no number", "numbers alone, in SI units") from None
		if column in _NEEDED[name] and not math.isfinite(values[k]) and not (column in _STRENGTHS and values[k] == math.inf):
			raise ConfigError(f"{name}.csv", str(path), f"line {lines[k]}: {column} = {shown(text)} is not finite", "a value in each line")
	return values


def _checkEnds(state):
	"""Each ball and contact is there once, and the contacts' ends are."""
	balls, contacts = state.balls, state.contacts
	ids = {number: line for number, line in zip(balls["id"].tolist(), balls.lines)}
	if len(ids) != len(balls):
		raise ConfigError("balls.csv", str(state.folder), "a ball's id is there twice", "each ball once")
	if len(balls) and not balls["r"].min() > 0:
		line = balls.lines[int(balls["r"].argmin())]
		raise ConfigError("balls.csv", str(state.folder), f"line {line}: r = {balls['r'].min():g} is not > 0", "a radius > 0")
	pairs = {}
	for line, kind, *ends in zip(contacts.lines, contacts["kind"], contacts["end1"].tolist(), contacts["end2"].tolist()):
		if kind not in (BALL_BALL, BALL_FACET):
			raise ConfigError("contacts.csv", str(state.folder), f"line {line}: kind = {shown(kind)}", f"{BALL_BALL} or {BALL_FACET}; clumps are not known here")
		for end in ends if kind == BALL_BALL else ends[:1]:
			if end not in ids:
				raise ConfigError("contacts.csv", str(state.folder), f"line {line}: there is no ball {end:g}", "balls.csv and contacts.csv of one export")
		if kind == BALL_BALL and (ends[0] == ends[1] or pairs.setdefault(frozenset(ends), line) != line):
			wrong = f"line {line}: balls {ends[0]:g} and {ends[1]:g} are " + ("one" if ends[0] == ends[1] else f"in line {pairs[frozenset(ends)]} already")
			raise ConfigError("contacts.csv", str(state.folder), wrong, "each pair of balls once")
	_checkContactBonds(state)
	_checkParallelBonds(state, ids)
	normals = numpy.linalg.norm(contacts.vectors("n"), axis=1)
	if len(contacts) and abs(normals - 1).max() > 1e-6:
		k = int(abs(normals - 1).argmax())
		raise ConfigError("contacts.csv", str(state.folder), f"line {contacts.lines[k]}: the normal has the length {normals[k]:g}", "unit normals")


def _checkContactBonds(state):
	contacts = state.contacts
	for line, model, bond, *strengths in zip(contacts.lines, contacts["model"], contacts["cb_state"], contacts["cb_tenf"], contacts["cb_shearf"]):
		if model == "linearcbond" and bond == BONDED and not min(strengths) > 0:
			raise ConfigError("contacts.csv", str(state.folder), f"line {line}: a bonded contact has strengths {strengths[0]:g} and {strengths[1]:g}", "cb_tenf and cb_shearf > 0")


def _checkParallelBonds(state, ids):
	"""The bonds are there where there may be some, each once, between balls that are, with numbers that a bond can have."""
	bonds = state.bonds
	if bonds is None:
		if PARALLEL in state.contacts["model"]:
			line = state.contacts.lines[state.contacts["model"].index(PARALLEL)]
			raise ConfigError("bonds.csv", str(state.folder), f"is missing, and contacts.csv has the model {PARALLEL} in line {line}", "export it anew by this version's exporter")
		return
	pairs = {}
	for line, *ends in zip(bonds.lines, bonds["end1"].tolist(), bonds["end2"].tolist()):
		for end in ends:
			if end not in ids:
				raise ConfigError("bonds.csv", str(state.folder), f"line {line}: there is no ball {end:g}", "balls.csv and bonds.csv of one export; bonds with walls are not known here")
		if ends[0] == ends[1] or pairs.setdefault(frozenset(ends), line) != line:
			wrong = f"line {line}: balls {ends[0]:g} and {ends[1]:g} are " + ("one" if ends[0] == ends[1] else f"in line {pairs[frozenset(ends)]} already")
			raise ConfigError("bonds.csv", str(state.folder), wrong, "each pair of balls once")
	for name, low, high in (("pb_rmul", 0, math.inf), ("pb_kn", 0, math.inf), ("pb_ks", -1e-300, math.inf), ("pb_ten", -1e-300, math.nan), ("pb_coh", -1e-300, math.nan),
			("pb_fa", -1e-300, 90), ("pb_mcf", -1e-300, 1 + 1e-12)):  # fmt: skip
		for line, value in zip(bonds.lines, bonds[name].tolist()):
			if not value > low or value >= high:
				raise ConfigError("bonds.csv", str(state.folder), f"line {line}: {name} = {value:g} is out of range", "what PFC has of a bond that holds")


def write(folder, name, rows, head):
	"""Write a table; ``rows``: dictionaries by column, ``head``: words of the first line.

	:raises OSError: it cannot be written.
	"""
	words = {_MARK: VERSION, "table": name, **head}
	with open(pathlib.Path(folder) / f"{name}.csv", "w", encoding="utf-8", newline="\n") as file:
		file.write("# " + " ".join(f"{key}={value}" for key, value in words.items()) + "\n")
		writer = csv.writer(file, lineterminator="\n")
		writer.writerow(COLUMNS[name])
		for row in rows:
			writer.writerow([_text(row.get(column, "")) for column in COLUMNS[name]])


def _text(value):
	return repr(value) if isinstance(value, float) else value


def markdown():
	"""The tables of columns, for the documentation."""
	parts = []
	for name, columns in COLUMNS.items():
		parts += [f"**{name}.csv**\n", "| column | unit | what |", "| --- | --- | --- |"]
		parts += [f"| `{column}`{' (needed)' if column in _NEEDED[name] else ''} | {unit} | {meaning} |" for column, (unit, meaning) in columns.items()]
		parts.append("")
	return "\n".join(parts)
