# SPDX-License-Identifier: GPL-2.0-or-later
"""Stress along the height: branches cut at the slices' borders, uniform states, the sum over slices."""

import itertools

import numpy
import pytest
from hexmembrane.measure import profile


def lattice(spacing, count, force):
	"""Branches of a simple cubic packing of count^3 spheres under an isotropic pressure, force F in each contact, boundary contacts included."""
	start, branch = [], []
	for cell in itertools.product(range(count), repeat=3):
		for axis in range(3):
			e = numpy.eye(3)[axis]
			centre = spacing * (numpy.array(cell) + 0.5)
			if cell[axis] == 0:  # from the lower boundary's contact point
				start.append(centre - 0.5 * spacing * e)
				branch.append(0.5 * spacing * e)
			start.append(centre)
			branch.append((0.5 if cell[axis] == count - 1 else 1.0) * spacing * e)
	branch = numpy.array(branch)
	return numpy.array(start), branch, force * branch / numpy.linalg.norm(branch, axis=1)[:, None]


def test_uniformPressure():
	"""A cube of cubic packing under the pressure F/d^2: exact axially for any slices, in all directions where each slice holds whole layers."""
	d, count, force = 0.003, 6, 0.9
	branches = lattice(d, count, force)
	top = count * d
	for edges in (numpy.linspace(0, top, 4), numpy.array([0.0, 0.0021, 0.0069, 0.0122, top])):
		stress = profile.sliceSums(edges, *branches) / (numpy.diff(edges) * top**2)[:, None, None]
		assert stress[:, 2, 2] == pytest.approx(force / d**2, rel=1e-12)
	stress = profile.sliceSums(numpy.linspace(0, top, 4), *branches) / (top**3 / 3)
	for s in stress:
		assert s == pytest.approx(force / d**2 * numpy.eye(3), rel=1e-12, abs=1e-9)


def test_slicesAddUpToTheWhole():
	random = numpy.random.default_rng(4)
	start, branch, force = (random.normal(size=(500, 3)) for _ in range(3))
	branch[:40, 2] = 0
	whole = numpy.einsum("mi,mj->ij", force, branch)
	for edges in ([-10, 10], [-0.5, 0.2, 0.3], numpy.linspace(-2, 2, 31)):
		part = profile.shares(edges, *numpy.sort([start[:, 2], start[:, 2] + branch[:, 2]], axis=0))
		assert part.min() >= 0 and part.sum(axis=1) == pytest.approx(1, abs=1e-12)
		assert profile.sliceSums(edges, start, branch, force).sum(axis=0) == pytest.approx(whole, rel=1e-10, abs=1e-10)


def test_shareIsTheLengthInTheSlice():
	low, high = numpy.array([0.1, -1.0, 0.5]), numpy.array([0.7, 3.0, 0.5])
	part = profile.shares([0.0, 0.4, 0.6, 1.0], low, high)
	assert part == pytest.approx(numpy.array([[0.5, 1 / 3, 1 / 6], [0.35, 0.05, 0.6], [0, 1, 0]]), abs=1e-12)


def test_bordersMustRise():
	with pytest.raises(ValueError, match="do not rise"):
		profile.shares([0.0, 1.0, 1.0], numpy.zeros(1), numpy.ones(1))
