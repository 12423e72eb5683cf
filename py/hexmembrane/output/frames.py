# SPDX-License-Identifier: GPL-2.0-or-later
"""VTK frames of a test: grains and lateral boundary as time series. The arrays are listed in :mod:`hexmembrane.output.vtk`."""

import pathlib

import numpy
import yade
from yade import O

from hexmembrane.output import vtk


def writeGrains(path, grains, measure, more=()):
	"""Write the grains' state as it stands; ``measure``: the scene's SoilMeasure, for the coordination numbers; ``more``: further arrays by name."""
	ids, arrays = grains.ids, yade.BodyArrays
	data = {
		"id": numpy.array(ids),
		"radius": arrays.radii(ids),
		"velocity": arrays.velocities(ids),
		"displacement": arrays.displacements(ids),
		"coordination": measure.coordinationNumbers(ids),
		**dict(more),
	}
	vtk.write(path, arrays.positions(ids), pointData=data)


class Frames:
	"""The frames written into ``out/vtk`` so far, with the series ``grains.pvd`` and that of the lateral boundary, ``membrane.pvd`` or ``wall.pvd``.

	``written``: (time [s], number) of each.
	"""

	def __init__(self, out, before=()):
		self.folder = pathlib.Path(out) / "vtk"
		self.written = [tuple(frame) for frame in before]

	def write(self, scene, grains, startRadius, grainArrays=()):
		"""Add the present state to both series.

		:param startRadius: mean radius of the lateral boundary when the stage began [m]. :param grainArrays: further arrays of the grains by name.
		"""
		self.folder.mkdir(exist_ok=True)
		number = len(self.written)
		boundary = scene.lateralBoundary
		writeGrains(self.folder / f"grains-{number:04d}.vtp", grains, scene.measure, grainArrays)
		surface = boundary.surface(startRadius)
		vtk.write(self.folder / f"{boundary.name}-{number:04d}.vtp", surface.points, surface.triangles, surface.pointData, surface.cellData)
		self.written.append((O.time, number))
		for name in ("grains", boundary.name):
			vtk.series(self.folder / f"{name}.pvd", [(time, f"{name}-{k:04d}.vtp") for time, k in self.written])
