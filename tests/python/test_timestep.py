# SPDX-License-Identifier: GPL-2.0-or-later
"""The critical time step against systems whose highest frequency is known, rotations included."""

import itertools
import math

import numpy
import pytest
from hexmembrane.configuration.specimen import Specimen
from hexmembrane.scene import timestep

X = numpy.array([[1.0, 0, 0]])
NONE = numpy.empty((0, 2), int), numpy.empty((0, 3)), numpy.empty((0, 4)), numpy.empty((0, 2))


def oneSpring(count, pair, mass, kn=1e5):
	"""Bound of bodies on one spring without shear."""
	return timestep.contactStep(numpy.array([pair]), X, numpy.array([[kn, 0.0, 0.0, 0.0]]), numpy.zeros((1, 2)), numpy.array(mass), numpy.ones(count))


def assembled(pairs, normals, stiffness, arms, mass, inertia):
	"""2/omega of the whole system: its 6N x 6N stiffness from the motion at each contact, divided by the roots of the masses."""
	n = len(mass)
	total = numpy.zeros((6 * n, 6 * n))
	for (i, j), normal, (kn, ks, kr, kt), (armI, armJ) in zip(pairs, normals, stiffness, arms):
		slide, bend = numpy.zeros((3, 6 * n)), numpy.zeros((3, 6 * n))
		for body, sign, arm in ((i, -1, armI * normal), (j, 1, -armJ * normal)):
			slide[:, 6 * body : 6 * body + 3] += sign * numpy.eye(3)
			slide[:, 6 * body + 3 : 6 * body + 6] += sign * numpy.cross(numpy.eye(3), arm).T  # w x arm
			bend[:, 6 * body + 3 : 6 * body + 6] += sign * numpy.eye(3)
		along = numpy.outer(normal, normal)
		across = numpy.eye(3) - along
		total += slide.T @ (kn * along + ks * across) @ slide + bend.T @ (kr * across + kt * along) @ bend
	root = numpy.column_stack([numpy.repeat(mass[:, None], 3, 1), numpy.repeat(inertia[:, None], 3, 1)]).ravel() ** -0.5
	return 2 / math.sqrt(numpy.linalg.eigvalsh(root[:, None] * total * root)[-1])


def faceCentred(ratio, cells=2):
	"""A periodic face-centred lattice of equal touching spheres, kn/ks = ratio."""
	corners = [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]
	places = numpy.array([numpy.add(cell, corner) for cell in itertools.product(range(cells), repeat=3) for corner in corners])
	pairs, normals = [], []
	for i, j in itertools.combinations(range(len(places)), 2):
		for shift in itertools.product((-cells, 0, cells), repeat=3):
			branch = places[j] + shift - places[i]
			if abs(numpy.linalg.norm(branch) - math.sqrt(0.5)) < 1e-9:
				pairs.append((i, j))
				normals.append(branch / numpy.linalg.norm(branch))
	assert len(pairs) == 6 * len(places)
	m, n, radius, mass = len(pairs), len(places), 1e-3, 1e-5
	stiffness = numpy.tile([1e5, 1e5 / ratio, 0.0, 0.0], (m, 1))
	inertia = numpy.full(n, 0.4 * mass * radius**2)
	return numpy.array(pairs), numpy.array(normals), stiffness, numpy.full((m, 2), radius), numpy.full(n, mass), inertia


@pytest.mark.parametrize("pair", [(0, 1), (1, 0)])
def test_sphereOnWall(pair):
	"""One spring to a fixed partner has omega = sqrt(k/m), and the bound is exact."""
	assert oneSpring(2, pair, [1e-3, math.inf]) == pytest.approx(2 / math.sqrt(1e5 / 1e-3), rel=1e-12)


def test_twoSpheres():
	"""Two equal masses on one spring: omega = sqrt(2 k/m), the bound is exact. Of unequal ones omega^2 = k (1/m + 1/m')."""
	assert oneSpring(2, (0, 1), [1e-3, 1e-3]) == pytest.approx(2 / math.sqrt(2 * 1e5 / 1e-3), rel=1e-12)
	unequal = 2 / math.sqrt(1e5 * (1 / 1e-3 + 1 / 9e-3))
	assert 0.9 * unequal < oneSpring(2, (0, 1), [1e-3, 9e-3]) < unequal


@pytest.mark.parametrize("rolling", [0.0, 0.25])
@pytest.mark.parametrize("ratio", [1.0, 1.5, 3.0, 10.0])
def test_neverAboveTheTrueOne(ratio, rolling):
	"""Random networks of spheres: not above 2/omega of the assembled system with rotations, not far below it."""
	random = numpy.random.default_rng(5)
	for _ in range(10):
		n, m = 12, 30
		pairs = numpy.array([random.choice(n, 2, replace=False) for _ in range(m)])
		normals = random.normal(size=(m, 3))
		normals /= numpy.linalg.norm(normals, axis=1, keepdims=True)
		radius = random.uniform(0.7e-3, 1.4e-3, n)
		mass = 1e4 * radius**3
		kn = random.uniform(1e4, 1e5, m)
		arms = radius[pairs]
		stiffness = numpy.column_stack([kn, kn / ratio, *(factor * kn / ratio * arms.min(axis=1) ** 2 for factor in (rolling, 0.5 * rolling))])
		system = pairs, normals, stiffness, arms, mass, 0.4 * mass * radius**2
		true = assembled(*system)
		assert 0.6 * true < timestep.contactStep(*system) <= true * (1 + 1e-12)


@pytest.mark.parametrize("ratio", [1.0, 2.0, 3.0, 10.0])
def test_faceCentredLattice(ratio):
	"""Exact where all spheres spinning alike is the fastest mode, kn/ks <= 3; a bound beyond."""
	system = faceCentred(ratio)
	true, bound = assembled(*system), timestep.contactStep(*system)
	assert bound == pytest.approx(true, rel=1e-9) if ratio <= 3 else 0.8 * true < bound < true
	mass, ks = system[4][0], system[2][0, 1]
	if ratio <= 3:
		assert true == pytest.approx(2 / math.sqrt(40 * ks / mass), rel=1e-9)  # 12 springs, 8 across an axis, twice, over 0.4


def test_freeAndFixedBodies():
	assert timestep.contactStep(*NONE, numpy.ones(2), numpy.ones(2)) == math.inf
	assert oneSpring(2, (0, 1), [math.inf, math.inf]) == math.inf
	# the springs of bonds, given as a frequency, add to the contacts'
	assert timestep.contactStep(*NONE, numpy.ones(1), numpy.ones(1), numpy.array([16.0])) == pytest.approx(0.5, rel=1e-12)


def test_blockedRotationIsLeftOut():
	"""A frictional contact of spheres that cannot turn: ks pushes, it turns nothing."""
	system = numpy.array([[0, 1]]), X, numpy.array([[1.0, 4.0, 0.0, 0.0]]), numpy.ones((1, 2)), numpy.ones(2)
	assert timestep.contactStep(*system, numpy.full(2, math.inf)) == pytest.approx(2 / math.sqrt(2 * 4.0), rel=1e-12)
	assert timestep.contactStep(*system, numpy.full(2, 0.4)) == pytest.approx(2 / math.sqrt(2 * 4.0 * (1 + 1 / 0.4)), rel=1e-12)


@pytest.mark.parametrize("ratio", [1.0, 3.0, 20.0])
def test_grainStep(ratio):
	"""The estimate is the bound of a sphere with equal neighbours at the eight corners of a cube."""
	specimen = Specimen(radius=1, height=1, gradation="x", kratio=ratio)
	radius = 1e-3
	kn, mass = timestep.contactStiffness(specimen.emod, radius, radius), timestep.sphereMass(radius, specimen.density)
	normals = numpy.array(list(itertools.product((-1, 1), repeat=3))) / math.sqrt(3)
	pairs = numpy.array([(0, k) for k in range(1, 9)])
	masses = numpy.full(9, mass)
	bound = timestep.contactStep(
		pairs, normals, numpy.tile([kn, kn / ratio, 0.0, 0.0], (8, 1)), numpy.full((8, 2), radius), masses, 0.4 * masses * radius**2
	)
	assert timestep.grainStep(specimen, radius) == pytest.approx(bound, rel=1e-12)


def estimate(grains, smallest, largest, particleRadius):
	"""Of grains and of a membrane with bonds that are soft, as a scene has them."""
	return timestep.grainStep(grains, smallest), timestep.membraneStep(grains.springs, grains.springs, 1000.0, largest, particleRadius, 1.0)


def test_estimateScales():
	"""dt goes with the size, with the root of the density and with 1/root of the modulus."""
	grains = Specimen(radius=1, height=1, gradation="x")
	base = estimate(grains, 1e-3, 2e-3, 1e-3)
	assert estimate(grains, 2e-3, 4e-3, 2e-3) == pytest.approx([2 * t for t in base], rel=1e-6)
	stiff = Specimen(radius=1, height=1, gradation="x", emod=4 * grains.emod, density=grains.density)
	assert estimate(stiff, 1e-3, 2e-3, 1e-3) == pytest.approx([t / 2 for t in base], rel=1e-6)
	heavy = Specimen(radius=1, height=1, gradation="x", density=4 * grains.density)
	assert estimate(heavy, 1e-3, 2e-3, 1e-3)[0] == pytest.approx(2 * base[0], rel=1e-12)


def test_membraneOfBondsAlone():
	"""Without grains to speak of, the membrane's step is its bonds'; the two kinds of spring add their omega^2."""
	soft = Specimen(radius=1, height=1, gradation="x", emod=1e-9)
	assert timestep.membraneStep(soft.springs, soft.springs, 1000.0, 2e-3, 1e-3, 3e-6) == pytest.approx(3e-6, rel=1e-9)
	hard = Specimen(radius=1, height=1, gradation="x")
	contacts = timestep.membraneStep(hard.springs, hard.springs, 1000.0, 2e-3, 1e-3, math.inf)
	assert timestep.membraneStep(hard.springs, hard.springs, 1000.0, 2e-3, 1e-3, contacts) == pytest.approx(contacts / math.sqrt(2), rel=1e-12)


def test_stiffness():
	"""PFC's deformability: equal grains of radius R have pi emod R/2; unequal ones go by the smaller."""
	assert timestep.contactStiffness(1e8, 1e-3, 1e-3) == pytest.approx(math.pi * 1e8 * 1e-3 / 2, rel=1e-15)
	assert timestep.contactStiffness(1e8, 3e-3, 1e-3) == timestep.contactStiffness(1e8, 1e-3, 3e-3) == pytest.approx(math.pi * 1e8 * 1e-3 / 4, rel=1e-15)
	assert timestep.stiffnessLevel(4e7, 1e5) == pytest.approx(timestep.contactStiffness(4e7, 1.0, 1.0) / (1e5 * 2.0), rel=1e-15)
