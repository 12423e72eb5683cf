# SPDX-License-Identifier: GPL-2.0-or-later
"""fields.h5: the fields of all grains at chosen strains of a test, as HDF5. Needs no YADE.

One group a state, named by its row in shear (``row-0040``), with attributes ``row``, ``step``, ``axial_strain``, ``increment`` (axial strain since the state
that increments count from), ``bottom``, ``top`` (heights of the platens' faces [m]), ``radius`` (mean radius of the lateral boundary [m]). Each array has
attributes ``unit`` and ``meaning``. ``ids`` and ``radii`` [m] of the grains are at the top, and attributes of the test: ``title``, ``boundary``, ``pressure`` [Pa].
"""

import os
import pathlib

import h5py
import numpy as np


class FieldsFile:
	"""fields.h5 being written. A kill at any moment leaves the file as it was before the last :meth:`add`.

	:param path: the file. :param test: attributes of the test. :param meanings: name of an array -> (unit, meaning).
	:param rows: states up to this row are kept of an existing file; None starts anew.
	:raises ValueError: the existing file cannot be read.
	"""

	def __init__(self, path, test, meanings, rows=None):
		self.path, self._test, self._meanings = pathlib.Path(path), test, meanings
		if rows is None:
			self.path.unlink(missing_ok=True)
		elif self.path.is_file():
			self._rewritten(lambda old, new: [_copy(old, new, name) for name in states(old) if old[name].attrs["row"] <= rows])

	def _rewritten(self, fill):
		part = self.path.with_name(self.path.name + ".part")
		with h5py.File(part, "w") as new:
			new.attrs.update(self._test)
			if self.path.is_file():
				with opened(self.path) as old:
					for name in ("ids", "radii"):
						if name in old:
							_copy(old, new, name)
					fill(old, new)
			else:
				fill(None, new)
			new.flush()
		with open(part, "rb") as file:
			os.fsync(file.fileno())
		part.replace(self.path)

	def add(self, attributes, ids, radii, fields):
		"""Add a state: ``attributes`` as the module says, ids and radii [m] of the grains, ``fields`` by name."""

		def fill(old, new):
			if old is None:
				new.create_dataset("ids", data=ids)
				new.create_dataset("radii", data=radii).attrs["unit"] = "m"
			for name in states(old) if old is not None else ():
				_copy(old, new, name)
			group = new.create_group(f"row-{attributes['row']:04d}")
			group.attrs.update(attributes)
			for name, values in fields.items():
				array = group.create_dataset(name, data=values, compression="gzip", compression_opts=1)
				array.attrs["unit"], array.attrs["meaning"] = self._meanings[name]

		self._rewritten(fill)


def _copy(old, new, name):
	old.copy(name, new)


def opened(path):
	"""The file as h5py has it.

	:raises ValueError: there is none, or it is no HDF5.
	"""
	try:
		return h5py.File(path, "r")
	except OSError:
		raise ValueError(f"fields = '{path}': is no HDF5 file that can be read; fix: give the fields.h5 of a test with measure.strains") from None


def states(file):
	"""Names of the states in an open file, in their order."""
	return sorted((name for name in file if name.startswith("row-")), key=lambda name: file[name].attrs["row"])


def read(path, strain=None):
	"""A state of a test: (attributes of test and state, arrays by name; ``ids`` and ``radii`` among them).

	:param strain: axial strain, that of a state to 1e-3; None: the last state.
	:raises ValueError: there is no such state, or no file.
	"""
	with opened(path) as file:
		names = states(file)
		strains = [float(file[name].attrs["axial_strain"]) for name in names]
		if not names:
			raise ValueError(f"fields = '{path}': holds no state yet; fix: let the test reach the first of measure.strains")
		nearest = len(names) - 1 if strain is None else int(np.argmin(np.abs(np.array(strains) - strain)))
		if strain is not None and abs(strains[nearest] - strain) > 1e-3:
			kept = ", ".join(f"{value:.4f}" for value in strains)
			raise ValueError(f"strain = {strain:g}: is not in '{path}', which has {kept}; fix: give one of these, or run the test with it in measure.strains")
		group = file[names[nearest]]
		arrays = {name: values[()] for name, values in group.items()}
		return {**file.attrs, **group.attrs}, {"ids": file["ids"][()], "radii": file["radii"][()], **arrays}
