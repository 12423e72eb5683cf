# SPDX-License-Identifier: GPL-2.0-or-later
"""VTK frames of a test: grains and lateral boundary as time series. The arrays are listed in :mod:`hexmembrane.vtk`."""

import pathlib

import numpy
from yade import O

from hexmembrane import vtk


def _contacts(count):
	"""Contacts with a normal force of each body."""
	found = numpy.zeros(count, dtype=numpy.int32)
	for contact in O.interactions:
		if contact.phys.normalForce.squaredNorm() > 0:
			found[contact.id1] += 1
			found[contact.id2] += 1
	return found


def writeGrains(path, grains):
	"""Write the grains' state as it stands."""
	x, v, u = vtk.states(O.bodies[i].state for i in grains.ids)
	ids = numpy.array(grains.ids)
	radii = numpy.array([O.bodies[i].shape.radius for i in grains.ids])
	arrays = {"id": ids, "radius": radii, "velocity": v, "displacement": u, "coordination": _contacts(len(O.bodies))[ids]}
	vtk.write(path, x, pointData=arrays)


class Frames:
	"""The frames written into ``out/vtk`` so far, with the series ``grains.pvd`` and that of the boundary, ``membrane.pvd`` or ``wall.pvd``."""

	def __init__(self, out, before=()):
		self.folder = pathlib.Path(out) / "vtk"
		self.list = [tuple(frame) for frame in before]

	def write(self, scene, grains, reference):
		"""Add the present state to both series; ``reference``: the stage's :class:`hexmembrane.measure.Reference`."""
		self.folder.mkdir(exist_ok=True)
		number = len(self.list)
		writeGrains(self.folder / f"grains-{number:04d}.vtp", grains)
		scene.lateral.writeFrame(self.folder / f"{scene.lateral.name}-{number:04d}.vtp", reference)
		self.list.append((O.time, number))
		for name in ("grains", scene.lateral.name):
			vtk.series(self.folder / f"{name}.pvd", [(time, f"{name}-{k:04d}.vtp") for time, k in self.list])
