# SPDX-License-Identifier: GPL-2.0-or-later
"""CSV files that a test writes row by row: columns with units in the header, whole rows, cut at a checkpoint. Needs no YADE."""

import dataclasses
import math
import os
import pathlib

import numpy


@dataclasses.dataclass(frozen=True)
class Column:
	"""One column; ``doc`` says sign, formula and source; ``optional``: may be nan; ``text``: is no number."""

	name: str
	unit: str
	doc: str
	optional: bool = False
	text: bool = False

	@property
	def header(self):
		return f"{self.name} [{self.unit}]" if self.unit else self.name


class Table:
	"""A CSV file being written. Every row is written whole and flushed, so that a killed run leaves a readable file.

	:param path: the file.
	:param columns: its :class:`Column` s.
	:param keep: bytes to keep of an existing file (a checkpoint's :meth:`position`); None starts anew.
	:param name: what messages call it, without: the file's.
	:raises ValueError: the existing file is shorter than ``keep`` or has other columns.
	"""

	def __init__(self, path, columns, keep=None, name=None):
		self.path, self.columns = pathlib.Path(path), columns
		self._name = name or self.path.stem
		header = ",".join(column.header for column in columns) + "\n"
		if keep is None:
			self._file = open(self.path, "wb")
			self._write(header)
			return
		size = self.path.stat().st_size if self.path.is_file() else 0
		if size < keep:
			raise ValueError(
				f"{self._name} = '{self.path}': has {size} bytes, its checkpoint was taken at {keep}; fix: put the file back or start anew"
			)
		self._file = open(self.path, "r+b")
		if self._file.readline().decode(errors="replace") != header:
			self._file.close()
			raise ValueError(f"{self._name} = '{self.path}': has other columns than this version writes; fix: start anew in another folder")
		self._file.truncate(keep)
		self._file.seek(keep)

	def _write(self, line):
		self._file.write(line.encode())
		self._file.flush()

	def append(self, row):
		"""Write one row, a mapping with exactly the columns' names; values are written so that they read back exactly.

		:raises ValueError: a column is missing or unknown, or a number is not finite (nan is allowed in the optional columns).
		"""
		names = [column.name for column in self.columns]
		if set(row) != set(names):
			odd = sorted(set(row) ^ set(names))
			raise ValueError(f"{self._name}.row = {odd}: missing or unknown columns; fix: give each of COLUMNS once")
		cells = []
		for column in self.columns:
			name, value = column.name, row[column.name]
			if column.text:
				cells.append(value)
				continue
			if column.optional and math.isnan(value):
				cells.append("nan")
				continue
			if not math.isfinite(value):
				raise ValueError(f"{self._name}.{name} = {value} in step {row['step']}: is not finite; fix: see the state at the last checkpoint")
			cells.append(repr(int(value)) if float(value).is_integer() and abs(value) < 2**53 else repr(float(value)))
		self._write(",".join(cells) + "\n")

	def position(self):
		"""Bytes written so far; they are on the disk when this returns."""
		os.fsync(self._file.fileno())
		return self._file.tell()

	def close(self):
		self._file.close()

	def __enter__(self):
		return self

	def __exit__(self, *_):
		self.close()


def read(path, text=(), name=None):
	"""A table as a dict of column name -> numpy array; columns of ``text``: list of text. A last row cut by a kill is left out.

	:param name: what messages call it, without: the file's.
	:raises ValueError: it has no ``step`` or no column of ``text``, or a row has a wrong number of cells.
	"""
	name = name or pathlib.Path(path).stem
	lines = pathlib.Path(path).read_text(encoding="utf-8").split("\n")
	columns = [header.split(" [")[0] for header in lines[0].split(",")]
	if not {*text, "step"} <= set(columns):
		raise ValueError(f"{name} = '{path}': has no header of {name}.csv; fix: give the {name}.csv of a test")
	rows = [line.split(",") for line in lines[1:-1]]
	for number, row in enumerate(rows, 2):
		if len(row) != len(columns):
			raise ValueError(f"{name} = '{path}', line {number}: has {len(row)} cells for {len(columns)} columns; fix: restore the file")
	table = {}
	for k, column in enumerate(columns):
		cells = [row[k] for row in rows]
		table[column] = cells if column in text else numpy.array([float(cell) for cell in cells])
	return table


def markdown(columns):
	"""The table of columns for the documentation."""
	lines = ["| column | unit | meaning and sign |", "| --- | --- | --- |"]
	return "\n".join(lines + [f"| `{column.name}` | {column.unit} | {column.doc} |" for column in columns])
