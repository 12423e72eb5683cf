# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains and lateral boundary as VTK XML files (.vtp) with a .pvd time series, for ParaView; written by VTK's own writer.

Arrays of the grains' points: id, radius [m], velocity [m/s], displacement [m] since the first frame, coordination (contacts
with a normal force, all partners); with local strain measured (``measure``) also void_ratio, volumetric, deviatoric, rotation [rad], non_affine [m2] of the
last step, volumetric_sum, deviatoric_sum, rotation_sum since shear began (:data:`hexmembrane.measure.local.FIELDS`), mean_stress and shear_stress [Pa] of
the cell, sqrt(3/2 s:s) of the deviator s. Of the membrane's points (sphere centres): id, group, radius [m], velocity [m/s],
displacement [m], normal_displacement [m] since the first frame along the first frame's outward normal (outward positive),
pressure [Pa] on the particle (positive inwards, 0 on the O-ring rows); of its triangles: group (the least of the corners'), pressure [Pa] (mean of the corners'),
hoop_strain, axial_strain [-], hoop_tension, axial_tension [N/m], see :func:`hexmembrane.scene.sheet_state.sheetState`.
Of a rigid wall's points: pressure [Pa], normal_displacement [m], outward positive.
Of the contacts, a line each (``output.contacts``): normal_force [N], compression positive, at both ends, for ParaView's filter Tube; of the lines kind, what a grain
touches there (:data:`hexmembrane.output.frames.KINDS`), and shear_force [N].
"""

import contextlib
import errno
import os
import pathlib

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter

#: Bytes that are written in the place of a file that VTK could not write, to hear why.
_PROBE = 1 << 20


def _cells(connectivity):
	"""A vtkCellArray of cells that all have ``connectivity.shape[1]`` points."""
	count, size = connectivity.shape
	cells = vtkCellArray()
	offsets = numpy.arange(0, count * size + 1, size, dtype=numpy.int64)
	cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(connectivity.astype(numpy.int64).ravel(), deep=True))
	return cells


def _attach(data, arrays, count, where):
	for name, values in arrays.items():
		values = numpy.ascontiguousarray(values)
		if len(values) != count:
			raise ValueError(f"vtk.{where}['{name}'] = {len(values)} values: there are {count} {where}; fix: give one value each")
		array = numpy_to_vtk(values, deep=True)
		array.SetName(name)
		data.AddArray(array)


def write(path, points, cells=None, pointData=None, cellData=None):
	"""Write points (N, 3), as vertices, or with ``cells`` of three points (M, 3) as a surface, of two (M, 2) as lines, by temporary name and rename.

	:param pointData: name -> array of N values or N rows.
	:param cellData: the same per cell.
	:raises ValueError: an array has the wrong length.
	:raises OSError: the file cannot be written.
	"""
	path = pathlib.Path(path)
	points = numpy.ascontiguousarray(points).reshape(-1, 3)
	data, place = vtkPolyData(), vtkPoints()
	place.SetData(numpy_to_vtk(points, deep=True))
	data.SetPoints(place)
	cells = numpy.arange(len(points)).reshape(-1, 1) if cells is None else numpy.asarray(cells)
	{1: data.SetVerts, 2: data.SetLines, 3: data.SetPolys}[cells.shape[1]](_cells(cells))
	_attach(data.GetPointData(), pointData or {}, len(points), "points")
	_attach(data.GetCellData(), cellData or {}, len(cells), "cells")
	part = path.with_name(path.name + ".part")
	writer = vtkXMLPolyDataWriter()
	writer.SetFileName(str(part))
	writer.SetInputData(data)
	# a frame takes a seventh of the time that the default takes, and its file is smaller
	writer.SetCompressorTypeToLZ4()
	writer.SetEncodeAppendedData(False)
	if not os.access(path.parent, os.W_OK) or writer.Write() != 1 or writer.GetErrorCode():
		raise _fault(path, part)
	part.replace(path)


def _fault(path, part):
	"""VTK does not say why a file cannot be written: the error that the system gives for another one in its place."""
	reason = OSError(errno.EIO, "VTK could not write it", str(path))
	try:
		with open(part, "wb") as file:
			file.write(bytes(_PROBE))
			file.flush()
			os.fsync(file.fileno())
	except OSError as error:
		reason = OSError(error.errno, error.strerror, str(path))
	with contextlib.suppress(OSError):
		part.unlink()
	return reason


def read(path):
	"""What :func:`write` wrote: (points, cells, point arrays, cell arrays).

	:raises FileNotFoundError: no such file.
	"""
	if not pathlib.Path(path).is_file():
		raise FileNotFoundError(f"vtk.path = '{path}': there is no such file; fix: correct the path")
	reader = vtkXMLPolyDataReader()
	reader.SetFileName(str(path))
	reader.Update()
	data = reader.GetOutput()
	held = {1: data.GetVerts(), 2: data.GetLines(), 3: data.GetPolys()}
	size = next((size for size in (3, 2) if held[size].GetNumberOfCells()), 1)
	cells = vtk_to_numpy(held[size].GetConnectivityArray())

	def arrays(group):
		return {group.GetArrayName(k): vtk_to_numpy(group.GetArray(k)) for k in range(group.GetNumberOfArrays())}

	points = vtk_to_numpy(data.GetPoints().GetData())
	return points, cells.reshape(-1, size), arrays(data.GetPointData()), arrays(data.GetCellData())


def series(path, frames):
	"""Write a .pvd file that gives ParaView ``frames`` (pairs of time and file name) as a series in time."""
	path = pathlib.Path(path)
	lines = [f'    <DataSet timestep="{time!r}" part="0" file="{name}"/>' for time, name in frames]
	part = path.with_name(path.name + ".part")
	part.write_text(
		'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n  <Collection>\n'
		+ "\n".join(lines)
		+ "\n  </Collection>\n</VTKFile>\n",
		encoding="utf-8",
	)
	part.replace(path)
