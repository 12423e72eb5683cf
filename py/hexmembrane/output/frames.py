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


#: What a grain touches, by the number that ``SoilMeasure.contacts`` gives it.
KINDS = ("grain", "membrane", "lower platen", "upper platen", "wall")


def writeContacts(path, measure):
	"""Write the soil's contacts as they stand, each as a line between its ``ends``; ``measure``: the scene's SoilMeasure."""
	contacts = measure.contacts()
	# single precision holds a place to 1e-8 m, and halves the file
	ends, normal, shear = (contacts[name].astype(numpy.float32) for name in ("ends", "normalForce", "shearForce"))
	lines = numpy.arange(2 * len(ends)).reshape(-1, 2)
	vtk.write(path, ends, lines, {"normal_force": numpy.repeat(normal, 2)}, {"kind": contacts["kind"].astype(numpy.uint8), "shear_force": shear})


class Frames:
	"""The frames written into ``out/vtk`` so far, with the series ``grains.pvd``, that of the lateral boundary, ``membrane.pvd`` or ``wall.pvd``, and ``contacts.pvd``.

	:param contacts: whether there are frames of the contacts. Attribute: ``written``, (time [s], number) of each.
	"""

	def __init__(self, out, contacts, before=()):
		self.folder, self.contacts = pathlib.Path(out) / "vtk", contacts
		self.written = [tuple(frame) for frame in before]

	def write(self, scene, grains, startRadius, grainArrays=()):
		"""Add the present state to each series.

		:param startRadius: mean radius of the lateral boundary when the stage began [m]. :param grainArrays: further arrays of the grains by name.
		"""
		self.folder.mkdir(exist_ok=True)
		number = len(self.written)
		boundary = scene.lateralBoundary
		writeGrains(self.folder / f"grains-{number:04d}.vtp", grains, scene.measure, grainArrays)
		surface = boundary.surface(startRadius)
		vtk.write(self.folder / f"{boundary.name}-{number:04d}.vtp", surface.points, surface.triangles, surface.pointData, surface.cellData)
		if self.contacts:
			writeContacts(self.folder / f"contacts-{number:04d}.vtp", scene.measure)
		self.written.append((O.time, number))
		for name in ("grains", boundary.name, *["contacts"] * self.contacts):
			frames = [(time, f"{name}-{k:04d}.vtp") for time, k in self.written]
			# a test that was stopped may have gone on with another output.contacts
			vtk.series(self.folder / f"{name}.pvd", [frame for frame in frames if (self.folder / frame[1]).is_file()])
