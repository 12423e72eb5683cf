# SPDX-License-Identifier: GPL-2.0-or-later
"""VTK frames of a test: grains and membrane surface as time series. The arrays are listed in :mod:`hexmembrane.vtk`."""

import pathlib

import numpy
from yade import O

from hexmembrane import vtk


def _states(ids):
	"""Positions, velocities and displacements since the stage began, (N, 3) each, of the bodies."""
	bodies = [O.bodies[i].state for i in ids]
	x = numpy.array([tuple(s.pos) for s in bodies])
	return x, numpy.array([tuple(s.vel) for s in bodies]), x - numpy.array([tuple(s.refPos) for s in bodies])


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
	x, v, u = _states(grains.ids)
	ids = numpy.array(grains.ids)
	radii = numpy.array([O.bodies[i].shape.radius for i in grains.ids])
	arrays = {"id": ids, "radius": radii, "velocity": v, "displacement": u, "coordination": _contacts(len(O.bodies))[ids]}
	vtk.write(path, x, pointData=arrays)


def writeMembrane(path, scene):
	"""Write the membrane's state as it stands: a surface through the centres."""
	membrane = scene.membrane
	x, v, u = _states(membrane.ids)
	triangles = numpy.array([tuple(t) for t in membrane.triangles])
	group = numpy.array(membrane.groups, dtype=numpy.int32)
	outward = vtk.normals(x - u, triangles)
	points = {
		"id": numpy.array(membrane.ids),
		"group": group,
		"radius": numpy.full(len(x), membrane.sphereRadius),
		"velocity": v,
		"displacement": u,
		"normal_displacement": (u * outward).sum(axis=1),
		"pressure": numpy.where(group == 1, 0.0, numpy.where(group == 2, scene.servo.pressure, scene.pressure.pressure)),
	}
	vtk.write(path, x, triangles, points, {"group": group[triangles].min(axis=1)})


class Frames:
	"""The frames written into ``out/vtk`` so far, with the series ``grains.pvd`` and ``membrane.pvd``."""

	def __init__(self, out, before=()):
		self.folder = pathlib.Path(out) / "vtk"
		self.list = [tuple(frame) for frame in before]

	def write(self, scene, grains):
		"""Add the present state to both series."""
		self.folder.mkdir(exist_ok=True)
		number = len(self.list)
		writeGrains(self.folder / f"grains-{number:04d}.vtp", grains)
		writeMembrane(self.folder / f"membrane-{number:04d}.vtp", scene)
		self.list.append((O.time, number))
		for name in ("grains", "membrane"):
			vtk.series(self.folder / f"{name}.pvd", [(time, f"{name}-{k:04d}.vtp") for time, k in self.list])
