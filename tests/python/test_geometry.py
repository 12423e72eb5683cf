# SPDX-License-Identifier: GPL-2.0-or-later
"""Triangulated surfaces: normals at their points."""

import numpy
from hexmembrane.scene import geometry


def test_normals():
	"""Of an octahedron: along the axes; a point without triangles has none."""
	points = numpy.array([(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (9, 9, 9)], dtype=float)
	ring = [(k, (k + 1) % 4) for k in range(4)]
	triangles = numpy.array([(a, b, 4) for a, b in ring] + [(b, a, 5) for a, b in ring])
	found = geometry.normals(points, triangles)
	assert abs(found[:6] - points[:6]).max() < 1e-15 and (found[6] == 0).all()
