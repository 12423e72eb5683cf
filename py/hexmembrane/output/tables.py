# SPDX-License-Identifier: GPL-2.0-or-later
"""CSV files that a test writes row by row: columns with units in the header, whole rows, cut at a checkpoint. Needs no YADE."""

import contextlib
import csv
import dataclasses
import errno
import hashlib
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


class Kept:
	"""The first bytes of a table, up to a checkpoint; ``sha256``: theirs.

	:param path: the file.
	:param columns: its :class:`Column` s.
	:param size: how many bytes (a checkpoint's :meth:`Table.position`).
	:param name: what messages call it, without: the file's.
	:raises ValueError: the file is shorter, cannot be read or has other columns.
	"""

	def __init__(self, path, columns, size, name=None):
		self.path, self.columns = pathlib.Path(path), columns
		self._name = name = name or self.path.stem
		try:
			found = self.path.stat().st_size if self.path.is_file() else 0
			if found < size:
				raise ValueError(f"{name} = '{path}': has {found} bytes, its checkpoint was taken at {size}; fix: put the file back or start anew")
			with open(self.path, "rb") as file:
				self._data = file.read(size)
		except OSError as error:
			raise ValueError(f"{name} = '{path}': cannot be read ({error.strerror}); fix: make it readable") from None
		if not self._data.startswith(_header(columns)):
			raise ValueError(f"{name} = '{path}': has other columns than this version writes; fix: start anew in another folder")
		self.digest = hashlib.sha256(self._data)
		self.sha256 = self.digest.hexdigest()

	def lines(self):
		"""The rows, as they stand there."""
		return self._data.decode(errors="replace").split("\n")[1:-1]

	def last(self):
		"""The last row, by column; None without rows. :raises ValueError: it is no row."""
		lines = self.lines()
		if not lines:
			return None

		def value(column, cell):
			return cell if column.text else int(cell) if cell.lstrip("-").isdecimal() else float(cell)

		try:
			return {column.name: value(column, cell) for column, cell in zip(self.columns, lines[-1].split(","), strict=True)}
		except ValueError:
			raise ValueError(f"{self._name} = '{self.path}': line {len(lines) + 1} is no row of this version; fix: restore the file") from None


def _header(columns):
	return (",".join(column.header for column in columns) + "\n").encode()


class Table:
	"""A CSV file being written. Every row is written whole at once, so that a killed run leaves a readable file.

	:param path: the file.
	:param columns: its :class:`Column` s.
	:param keep: bytes to keep of an existing file (a checkpoint's :meth:`position`); None starts anew.
	:param name: what messages call it, without: the file's.
	:raises ValueError: the existing file is shorter than ``keep`` or has other columns.
	:raises OSError: the file cannot be written, with its name; what is in it are whole rows.

	Attribute: ``size``, bytes written so far.
	"""

	def __init__(self, path, columns, keep=None, name=None):
		self.path, self.columns = pathlib.Path(path), columns
		self._name = name or self.path.stem
		self._digest, self.size = hashlib.sha256(), 0
		if keep is None:
			self._file = open(self.path, "wb", buffering=0)
			self._write(_header(columns))
			return
		self._digest, self.size = Kept(path, columns, keep, name).digest, keep
		self._file = open(self.path, "r+b", buffering=0)
		self._file.truncate(keep)
		self._file.seek(keep)

	def _write(self, line):
		left = memoryview(line)
		try:
			while left:
				left = left[self._file.write(left) :]
			if os.fstat(self._file.fileno()).st_nlink == 0:
				raise FileNotFoundError(errno.ENOENT, "it was removed while the test was running")
		except OSError as error:
			with contextlib.suppress(OSError):
				self._file.truncate(self.size)
			raise type(error)(error.errno, error.strerror, str(self.path)) from None
		self._digest.update(line)
		self.size += len(line)

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
		self._write((",".join(cells) + "\n").encode())

	def position(self):
		"""Bytes written so far; they are on the disk when this returns."""
		os.fsync(self._file.fileno())
		return self.size

	@property
	def sha256(self):
		"""Of the bytes written so far."""
		return self._digest.hexdigest()

	def close(self):
		self._file.close()

	def __enter__(self):
		return self

	def __exit__(self, *_):
		self.close()


def read(path, text=(), name=None, damage=None, needed=("step",)):
	"""A table as a dict of column name -> numpy array; columns of ``text``: list of text. A last row cut by a kill is left out.

	:param name: what messages call it, without: the file's.
	:param damage: a list: rows from the first damaged one on are left out, and the list gets what is wrong; None: that is an error.
	:param needed: columns that it must have, beside those of ``text``.
	:raises ValueError: one of these is not there, or a row has a wrong number of cells or one that is no number.
	"""
	name = name or pathlib.Path(path).stem
	lines = pathlib.Path(path).read_bytes().decode(errors="replace").split("\n")
	columns = [header.split(" [")[0] for header in lines[0].split(",")]
	if not {*text, *needed} <= set(columns):
		raise ValueError(f"{name} = '{path}': has no header of {name}.csv; fix: give the {name}.csv of a test")
	rows = []
	for number, line in enumerate(lines[1:-1], 2):
		try:
			rows.append(_cells(columns, text, line))
		except ValueError as error:
			wrong = f"{name} = '{path}', line {number}: {error}; fix: restore the file"
			if damage is None:
				raise ValueError(wrong) from None
			damage.append(wrong)
			break
	cells = list(zip(*rows)) or [()] * len(columns)
	return {column: list(values) if column in text else numpy.array(values, dtype=float) for column, values in zip(columns, cells)}


def _cells(columns, text, line):
	"""The cells of a row, numbers but for columns of ``text``."""
	row = line.split(",")
	if len(row) != len(columns):
		raise ValueError(f"has {len(row)} cells for {len(columns)} columns")
	try:
		return [cell if column in text else float(cell) for column, cell in zip(columns, row)]
	except ValueError:
		raise ValueError("has a cell that is no number") from None


def writeRows(path, rows):
	"""Write dictionaries of the same keys as CSV, a row each, numbers with six digits: results that are kept and read, not gone on from."""
	with open(path, "w", encoding="utf-8", newline="") as file:
		writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
		writer.writeheader()
		writer.writerows({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()} for row in rows)


def markdown(columns):
	"""The table of columns for the documentation."""
	lines = ["| column | unit | meaning and sign |", "| --- | --- | --- |"]
	return "\n".join(lines + [f"| `{column.name}` | {column.unit} | {column.doc} |" for column in columns])
