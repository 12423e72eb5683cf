# SPDX-License-Identifier: GPL-2.0-or-later
"""VTK frames of a test: grains and lateral boundary as time series. The arrays are listed in :mod:`hexmembrane.output.vtk`."""

import pathlib

import numpy
from yade import O

from hexmembrane.output import vtk
from hexmembrane.scene import geometry


def _contacts(count):
	"""Contacts with a normal force of each body."""
	contacts = numpy.zeros(count, dtype=numpy.int32)
	for contact in O.interactions:
		if contact.phys.normalForce.squaredNorm() > 0:
			contacts[contact.id1] += 1
			contacts[contact.id2] += 1
	return contacts


def writeGrains(path, grains):
	"""Write the grains' state as it stands."""
	x, v, u = geometry.motions(O.bodies[i].state for i in grains.ids)
	ids = numpy.array(grains.ids)
	radii = numpy.array([O.bodies[i].shape.radius for i in grains.ids])
	arrays = {"id": ids, "radius": radii, "velocity": v, "displacement": u, "coordination": _contacts(len(O.bodies))[ids]}
	vtk.write(path, x, pointData=arrays)


class Frames:
	"""The frames written into ``out/vtk`` so far, with the series ``grains.pvd`` and that of the lateral boundary, ``membrane.pvd`` or ``wall.pvd``.

	``written``: (time [s], number) of each.
	"""

	def __init__(self, out, before=()):
		self.folder = pathlib.Path(out) / "vtk"
		self.written = [tuple(frame) for frame in before]

	def write(self, scene, grains, startRadius):
		"""Add the present state to both series; ``startRadius``: mean radius of the lateral boundary when the stage began [m]."""
		self.folder.mkdir(exist_ok=True)
		number = len(self.written)
		boundary = scene.lateralBoundary
		writeGrains(self.folder / f"grains-{number:04d}.vtp", grains)
		surface = boundary.surface(startRadius)
		vtk.write(self.folder / f"{boundary.name}-{number:04d}.vtp", surface.points, surface.triangles, surface.pointData, surface.cellData)
		self.written.append((O.time, number))
		for name in ("grains", boundary.name):
			vtk.series(self.folder / f"{name}.pvd", [(time, f"{name}-{k:04d}.vtp") for time, k in self.written])
