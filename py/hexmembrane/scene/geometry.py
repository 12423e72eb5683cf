# SPDX-License-Identifier: GPL-2.0-or-later
"""The geometry of triangulated surfaces. Uses nothing of YADE."""

import numpy


def normals(points, triangles):
	"""Unit normals at the points of a triangulated surface, area-weighted; zero where a point has no triangle."""
	a, b, c = (points[triangles[:, k]] for k in range(3))
	cross = numpy.cross(b - a, c - a)
	corners = triangles.ravel()
	total = numpy.column_stack([numpy.bincount(corners, numpy.repeat(cross[:, a], 3), len(points)) for a in range(3)])
	length = numpy.linalg.norm(total, axis=1, keepdims=True)
	return numpy.divide(total, length, out=numpy.zeros_like(total), where=length > 0)
