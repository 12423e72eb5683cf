# SPDX-License-Identifier: GPL-2.0-or-later
"""The critical time step of central differences, 2/omega, of grains and of the light membrane spheres between them.

A sphere of mass m on a stiffness K has omega^2 = K/m when its partners stand still and at most 2 K/m when equal partners move
against it (Gershgorin's bound on the mass-scaled stiffness matrix). Needs no YADE except for :func:`measured`.
"""

import math

import numpy

#: Contacts of a grain assumed before there are any; a dense sand has about 5 on average, its largest grains more but they are heavy.
CONTACTS = 8
#: Grains that press on one membrane sphere at the same time, from one side.
PRESSING = 3


def sphereMass(radius, density):
	return 4 / 3 * math.pi * radius**3 * density


def contactStiffness(emod, r1, r2):
	"""Normal stiffness [N/m] of two spheres of one modulus by PFC's deformability: pi emod min(r1, r2)^2/(r1 + r2)."""
	return math.pi * emod * min(r1, r2) ** 2 / (r1 + r2)


def stiffnessLevel(emod, pressure):
	"""kn/(p d) of contacts of two equal grains of diameter d: pi emod/(4 p)."""
	return math.pi * emod / (4 * pressure)


def bondStiffness(young, thickness, poisson):
	"""(kn, ks) [N/m] of the hexagonal lattice with E t and nu: kn = E t/(sqrt(3)(1 - nu)), ks = kn (1 - 3 nu)/(1 + nu)."""
	kn = young * thickness / (math.sqrt(3) * (1 - poisson))
	return kn, max(0.0, kn * (1 - 3 * poisson) / (1 + poisson))


def grainStep(specimen, smallest):
	"""Critical step [s] of the grains before there are contacts: CONTACTS equal neighbours all round a smallest grain share their
	stiffness among three directions.

	:param specimen: configuration's specimen section. :param smallest: smallest grain radius [m].
	"""
	kn = contactStiffness(specimen.emod, smallest, smallest)
	directional = CONTACTS / 3 * kn * (1 + 2 / specimen.kratio)
	return 2 / math.sqrt(2 * directional / sphereMass(smallest, specimen.density))


def membraneStep(specimen, membrane, largest, particleRadius):
	"""Critical step [s] of the membrane's spheres before there are contacts: PRESSING grains of the largest radius at once, and six
	bonds of which a lattice mode sees at most 6 kn.

	:param specimen, membrane: configuration's sections. :param largest: largest grain radius [m]. :param particleRadius: [m].
	:returns: the step without ``membrane.densityScaling``, which multiplies it by its root.
	"""
	bond = sum(bondStiffness(membrane.young, membrane.thickness, membrane.poisson))
	pressed = PRESSING * contactStiffness(specimen.emod, particleRadius, largest) + 6 * bond
	return 2 / math.sqrt(pressed / sphereMass(particleRadius, membrane.density))


def densityScaling(wished, grains, membrane):
	"""Factor on the membrane's mass: as wished, or the least with which the membrane's critical step is no shorter than the grains'.

	:param wished: configuration's ``membrane.densityScaling``. :param grains, membrane: critical steps [s].
	"""
	return max(1.0, (grains / membrane) ** 2) if wished is None else wished


def bound(count, pairs, normals, kn, ks, mass, extra=None):
	"""Critical step [s] of bodies 0 .. count-1 under given springs.

	:param pairs: (M, 2) ends, -1 for a partner that does not move. :param normals: (M, 3). :param kn, ks: (M,) [N/m].
	:param mass: (count,) [kg], inf for what does not move. :param extra: (count,) further stiffness in every direction [N/m].
	:returns: min over bodies of 2/sqrt(2 K/m), K the largest eigenvalue of sum(kn n n^T + ks (1 - n n^T)); inf without springs.
	"""
	stiffness = numpy.zeros((count, 3, 3))
	outer = normals[:, :, None] * normals[:, None, :]
	each = kn[:, None, None] * outer + ks[:, None, None] * (numpy.eye(3) - outer)
	for end in range(2):
		moving = pairs[:, end] >= 0
		numpy.add.at(stiffness, pairs[moving, end], each[moving])
	if extra is not None:
		stiffness += extra[:, None, None] * numpy.eye(3)
	largest = numpy.linalg.eigvalsh(stiffness)[:, -1]
	square = float((2 * largest / mass).max(initial=0.0))
	return 2 / math.sqrt(square) if square > 0 else math.inf


def measured(scene):
	"""Critical step [s] of YADE's scene with the contacts that it has now and the springs of the boundary."""
	from yade import O

	contacts = [(i.id1, i.id2, tuple(i.geom.normal), i.phys.kn, i.phys.ks) for i in O.interactions]
	bodies = list(O.bodies)
	mass = numpy.array([b.state.mass if b.dynamic and b.state.blockedDOFs != "xyzXYZ" else math.inf for b in bodies])
	extra = numpy.zeros(len(bodies))
	scene.lateral.addStiffness(extra)
	if not contacts:
		return bound(len(bodies), numpy.empty((0, 2), int), numpy.empty((0, 3)), numpy.empty(0), numpy.empty(0), mass, extra)
	first, second, normal, kn, ks = zip(*contacts)
	pairs = numpy.array([first, second]).T
	return bound(len(bodies), pairs, numpy.array(normal), numpy.array(kn), numpy.array(ks), mass, extra)
