# SPDX-License-Identifier: GPL-2.0-or-later
"""The geometry of triangulated surfaces. Uses nothing of YADE."""

import math

import numpy


def normals(points, triangles):
	"""Unit normals at the points of a triangulated surface, area-weighted; zero where a point has no triangle."""
	a, b, c = (points[triangles[:, k]] for k in range(3))
	cross = numpy.cross(b - a, c - a)
	corners = triangles.ravel()
	total = numpy.column_stack([numpy.bincount(corners, numpy.repeat(cross[:, a], 3), len(points)) for a in range(3)])
	length = numpy.linalg.norm(total, axis=1, keepdims=True)
	return numpy.divide(total, length, out=numpy.zeros_like(total), where=length > 0)


def insideCore(points, x, triangles, perRing):
	"""Which points are so near to the axis of a tube of rings that no triangle is between: surely inside. Between its ends only.

	A horizontal line from the axis meets the triangles of a band of two rings at heights that the band reaches. Points of a triangle of longest edge L
	and nearest corner rho from the axis are at least sqrt(rho^2 - L^2/2) from it.

	:param points: (N, 3).
	:param x: (rings * perRing, 3) points from the lower ring to the upper one.
	:param triangles: (M, 3).
	"""
	axis = x[:, :2].mean(axis=0)
	away = ((x[:, :2] - axis) ** 2).sum(axis=1).reshape(-1, perRing).min(axis=1)
	z = x[:, 2].reshape(-1, perRing)
	low, high = (part(edge[:-1], edge[1:]) for part, edge in ((numpy.minimum, z.min(axis=1)), (numpy.maximum, z.max(axis=1))))
	corners = [x[triangles[:, k]] for k in range(3)]
	longest = max(float(((corners[k] - corners[k - 1]) ** 2).sum(axis=1).max()) for k in range(3))
	free = numpy.minimum(away[:-1], away[1:]) - longest / 2
	height = points[:, 2, None]
	reach = numpy.where((low <= height) & (height <= high), free, numpy.inf).min(axis=1)
	return ((points[:, :2] - axis) ** 2).sum(axis=1) < numpy.where(numpy.isfinite(reach), reach, -1)


def insideTube(point, x, triangles, perRing):
	"""Whether a point is inside a tube of rings, its ends closed by fans, however much the tube is folded.

	By the solid angles of the triangles, 2 atan2(a.(b x c), abc + (a.b)c + (b.c)a + (c.a)b), whose sum is 4 pi inside and 0 outside
	an outward oriented surface (A. Van Oosterom, J. Strackee, The solid angle of a plane triangle, IEEE Trans. Biomed. Eng. 30, 1983).

	:param x: (rings * perRing, 3) points from the lower ring to the upper one.
	:param triangles: (M, 3), outward.
	"""
	ring = numpy.arange(perRing)
	after = numpy.roll(ring, -1)
	last, n = len(x) - perRing, len(x)
	points = numpy.vstack([x, x[:perRing].mean(axis=0), x[last:].mean(axis=0)]) - point
	lower = numpy.column_stack([after, ring, numpy.full(perRing, n)])
	upper = numpy.column_stack([last + ring, last + after, numpy.full(perRing, n + 1)])
	a, b, c = (points[numpy.vstack([triangles, lower, upper])[:, k]] for k in range(3))
	la, lb, lc = (numpy.linalg.norm(v, axis=1) for v in (a, b, c))
	dots = [(p * q).sum(axis=1) * r for p, q, r in ((a, b, lc), (b, c, la), (c, a, lb))]
	angles = 2 * numpy.arctan2((a * numpy.cross(b, c)).sum(axis=1), la * lb * lc + sum(dots))
	return float(angles.sum()) > 2 * math.pi
