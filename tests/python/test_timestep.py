# SPDX-License-Identifier: GPL-2.0-or-later
"""The critical time step against systems whose highest frequency is known."""

import math

import numpy
import pytest
from hexmembrane import timestep
from hexmembrane.config import Membrane, Specimen

X = numpy.array([[1.0, 0, 0]])


def test_sphereOnWall():
	"""One spring to a fixed partner has omega = sqrt(k/m); the bound, which lets partners move, is sqrt(2) below 2/omega."""
	found = timestep.bound(1, numpy.array([[0, -1]]), X, numpy.array([1e5]), numpy.array([0.0]), numpy.array([1e-3]))
	assert found == pytest.approx(2 / math.sqrt(1e5 / 1e-3) / math.sqrt(2), rel=1e-12)


def test_twoSpheres():
	"""Two equal masses on one spring: omega = sqrt(2 k/m), the bound is exact."""
	found = timestep.bound(2, numpy.array([[0, 1]]), X, numpy.array([1e5]), numpy.array([0.0]), numpy.array([1e-3, 1e-3]))
	assert found == pytest.approx(2 / math.sqrt(2 * 1e5 / 1e-3), rel=1e-12)


def test_neverAboveTheTrueOne():
	"""Random spring networks: not above 2/omega of the assembled system, not far below it."""
	random = numpy.random.default_rng(5)
	for _ in range(20):
		n, m = 12, 30
		pairs = numpy.array([random.choice(n, 2, replace=False) for _ in range(m)])
		normals = random.normal(size=(m, 3))
		normals /= numpy.linalg.norm(normals, axis=1, keepdims=True)
		kn, mass = random.uniform(1e4, 1e5, m), random.uniform(1e-4, 1e-3, n)
		ks = kn / 3
		stiffness = numpy.zeros((3 * n, 3 * n))
		for (i, j), u, a, b in zip(pairs, normals, kn, ks):
			block = a * numpy.outer(u, u) + b * (numpy.eye(3) - numpy.outer(u, u))
			for p, q, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
				stiffness[3 * p : 3 * p + 3, 3 * q : 3 * q + 3] += sign * block
		root = numpy.repeat(mass, 3) ** -0.5
		true = 2 / math.sqrt(numpy.linalg.eigvalsh(root[:, None] * stiffness * root)[-1])
		found = timestep.bound(n, pairs, normals, kn, ks, mass)
		assert 0.5 * true < found < 1.0 * true


def test_freeAndFixedBodies():
	none = numpy.empty((0, 2), int), numpy.empty((0, 3)), numpy.empty(0), numpy.empty(0)
	assert timestep.bound(2, *none, numpy.ones(2)) == math.inf
	both = numpy.array([[0, 1]])
	one = timestep.bound(2, both, X, numpy.array([4.0]), numpy.array([0.0]), numpy.array([1.0, math.inf]))
	assert one == pytest.approx(2 / math.sqrt(8.0), rel=1e-12)
	assert timestep.bound(1, *none, numpy.ones(1), numpy.array([8.0])) == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("poisson", [0.0, 0.1, 0.25, 1 / 3])
def test_latticeConstants(poisson):
	"""Bond stiffnesses give back E t and nu by the inverse formulas."""
	kn, ks = timestep.bondStiffness(2e6, 3e-4, poisson)
	assert 2 * math.sqrt(3) * kn * (kn + ks) / (3 * kn + ks) == pytest.approx(600, rel=1e-12)
	assert (kn - ks) / (3 * kn + ks) == pytest.approx(poisson, abs=1e-15)


def estimate(grains, smallest, largest, particleRadius):
	"""Of grains and membrane, as a scene has them."""
	return timestep.grainStep(grains, smallest), timestep.membraneStep(grains, Membrane(young=1.0), largest, particleRadius)


def test_estimateScales():
	"""dt goes with the size, with the root of the density and with 1/root of the modulus."""
	grains = Specimen(radius=1, height=1, gradation="x")
	base = estimate(grains, 1e-3, 2e-3, 1e-3)
	assert estimate(grains, 2e-3, 4e-3, 2e-3) == pytest.approx([2 * t for t in base], rel=1e-6)
	stiff = Specimen(radius=1, height=1, gradation="x", emod=4 * grains.emod, density=grains.density)
	assert estimate(stiff, 1e-3, 2e-3, 1e-3) == pytest.approx([t / 2 for t in base], rel=1e-6)
	heavy = Specimen(radius=1, height=1, gradation="x", density=4 * grains.density)
	assert estimate(heavy, 1e-3, 2e-3, 1e-3)[0] == pytest.approx(2 * base[0], rel=1e-12)


def test_stiffness():
	"""PFC's deformability: equal grains of radius R have pi emod R/2; unequal ones go by the smaller."""
	assert timestep.contactStiffness(1e8, 1e-3, 1e-3) == pytest.approx(math.pi * 1e8 * 1e-3 / 2, rel=1e-15)
	assert timestep.contactStiffness(1e8, 3e-3, 1e-3) == timestep.contactStiffness(1e8, 1e-3, 3e-3) == pytest.approx(math.pi * 1e8 * 1e-3 / 4, rel=1e-15)
	assert timestep.stiffnessLevel(4e7, 1e5) == pytest.approx(timestep.contactStiffness(4e7, 1.0, 1.0) / (1e5 * 2.0), rel=1e-15)
