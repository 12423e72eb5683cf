# SPDX-License-Identifier: GPL-2.0-or-later
"""Triangulated surfaces: normals at their points, inside and outside of a tube."""

import numpy
import pytest
from hexmembrane.scene import geometry


def test_normals():
	"""Of an octahedron: along the axes; a point without triangles has none."""
	points = numpy.array([(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (9, 9, 9)], dtype=float)
	ring = [(k, (k + 1) % 4) for k in range(4)]
	triangles = numpy.array([(a, b, 4) for a, b in ring] + [(b, a, 5) for a, b in ring])
	found = geometry.normals(points, triangles)
	assert abs(found[:6] - points[:6]).max() < 1e-15 and (found[6] == 0).all()


def foldedTube(perRing=40):
	"""A tube with a collar that overhangs itself: points and triangles."""
	angle = 2 * numpy.pi * numpy.arange(perRing) / perRing
	profile = [(1, 0), (1, 1), (2, 0.8), (2, 1.5), (1, 1.2), (1, 2)]
	x = numpy.vstack([numpy.column_stack([r * numpy.cos(angle), r * numpy.sin(angle), numpy.full(perRing, z)]) for r, z in profile])
	a, b = numpy.arange(perRing), numpy.roll(numpy.arange(perRing), -1)
	triangles = []
	for k in range(len(profile) - 1):
		low, high = k * perRing, (k + 1) * perRing
		triangles += [numpy.column_stack([low + a, low + b, high + a]), numpy.column_stack([low + b, high + b, high + a])]
	return x, numpy.vstack(triangles)


def test_insideTube():
	"""Inside and outside of a folded tube."""
	perRing = 40
	x, triangles = foldedTube(perRing)
	inside = [(0, 0, 0.1), (0.9, 0, 0.5), (0, -1.9, 1.0), (1.5, 0.2, 1.2), (0, 0, 1.9)]
	outside = [(1.1, 0, 0.5), (1.5, 0, 0.85), (0, 1.9, 1.5), (0, 0, -0.1), (0, 0, 2.1), (5, 5, 1)]
	assert [geometry.insideTube(p, x, triangles, perRing) for p in inside + outside] == [True] * len(inside) + [False] * len(outside)


def test_insideCore():
	"""Of random points in a folded tube, none that is called near the axis is outside, and many are called so."""
	perRing = 40
	x, triangles = foldedTube(perRing)
	random = numpy.random.default_rng(3)
	points = numpy.column_stack([random.uniform(-2.2, 2.2, (400, 2)), random.uniform(0.01, 1.99, 400)])
	near = geometry.insideCore(points, x, triangles, perRing)
	inside = numpy.array([geometry.insideTube(p, x, triangles, perRing) for p in points])
	assert not (near & ~inside).any()
	assert 0.3 * inside.sum() < near.sum() < inside.sum()


def test_insideCoreEndsWhereTrianglesCutTheCorner():
	"""A point between two far corners of one long edge is not called near the axis, though every corner is further out than it."""
	angle = 2 * numpy.pi * numpy.arange(3) / 3
	x = numpy.vstack([numpy.column_stack([numpy.cos(angle), numpy.sin(angle), numpy.full(3, z)]) for z in (0.0, 1.0)])
	triangles = numpy.array([(0, 1, 3), (1, 4, 3), (1, 2, 4), (2, 5, 4), (2, 0, 5), (0, 3, 5)])
	assert list(geometry.insideCore(numpy.array([(-0.6, 0, 0.5), (0, 0, 0.5)]), x, triangles, 3)) == [False, False]
