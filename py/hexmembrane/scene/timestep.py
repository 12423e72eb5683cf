# SPDX-License-Identifier: GPL-2.0-or-later
"""The critical time step of central differences, 2/omega: estimates before there are contacts, and a lower bound with them.

A sphere of mass m and radius R has the moment of inertia 0.4 m R^2. A shear spring turns it as it would push a mass of 0.4 m. Where
kn/ks < 3, rotations are therefore faster than translations. Uses nothing of YADE.
"""

import math

import numpy

#: Contacts of a grain assumed before there are any; a dense sand has about 5 on average, its largest grains more but they are heavy.
CONTACTS = 8
#: Grains that press on one membrane sphere at the same time, from one side.
GRAINS_PER_PARTICLE = 3
#: Largest inertial number of what counts as quasi-static.
QUASISTATIC = 1e-3


def sphereMass(radius, density):
	return 4 / 3 * math.pi * radius**3 * density


def contactStiffness(emod, r1, r2):
	"""Normal stiffness [N/m] of two spheres of one modulus by PFC's deformability: pi emod min(r1, r2)^2/(r1 + r2)."""
	return math.pi * emod * min(r1, r2) ** 2 / (r1 + r2)


def pairStiffness(a, b, r1, r2):
	"""Normal stiffness [N/m] of two spheres: their own springs in series.

	:param a, b: the bodies' :class:`hexmembrane.configuration.stiffness.Springs`.
	:param r1, r2: their radii [m].
	"""
	shape = min(r1, r2) ** 2 / (r1 + r2)
	return 1 / (1 / a.own(shape) + 1 / b.own(shape))


def stiffnessLevel(emod, pressure):
	"""kn/(p d) of contacts of two equal grains of diameter d: pi emod/(4 p)."""
	return math.pi * emod / (4 * pressure)


def levelOf(springs, radii, pressure):
	"""kn/(p d) of contacts of two grains of the mean diameter by volume d; with emod it is the same for all sizes.

	:param springs: of the grains, :class:`hexmembrane.configuration.stiffness.Springs`.
	:param radii: of the grains, or one radius [m].
	"""
	if not springs.direct:
		return stiffnessLevel(springs.emod, pressure)
	return springs.kn / 2 / (pressure * 2 * float((numpy.asarray(radii) ** 3).mean()) ** (1 / 3))


def inertialTime(radii, density, pressure):
	"""d sqrt(rho/p) [s], d the mean grain diameter by volume: a strain rate times this is the inertial number.

	:param radii: of the grains, or one radius [m].
	"""
	diameter = 2 * float((numpy.asarray(radii) ** 3).mean()) ** (1 / 3)
	return diameter * math.sqrt(density / pressure)


def massFactors(radii, direct=False):
	"""Factors on the grains' masses and moments of inertia with ``specimen.massScaling``: (r_max/r)^2, with a direct stiffness (r_max/r)^3.

	2/omega of a grain among its equals goes with sqrt(m/kn), and kn with r. It is that of the largest grain with m = m_max r/r_max, and m itself goes
	with r^3. A direct stiffness does not go with r, so there all grains get the mass of the largest.

	:param radii: of the grains [m].
	"""
	return (numpy.max(radii) / numpy.asarray(radii)) ** (3 if direct else 2)


def meanMassFactor(radii, direct=False):
	"""Mass of all grains with :func:`massFactors` over their own."""
	volumes = numpy.asarray(radii) ** 3
	return float((volumes * massFactors(radii, direct)).sum() / volumes.sum())


def grainStep(specimen, radii):
	"""Critical step [s] of the grains before there are contacts: CONTACTS equal neighbours stand all round a smallest grain.

	With ``specimen.massScaling`` it is that of a largest grain, which all grains then have.

	Their normals are spread evenly, so each direction has a third of kn and two thirds of ks, and each axis of rotation two thirds of
	ks R^2. Twice that, over m and over 0.4 m R^2, is omega^2 of neighbours that move against each other and of spheres that all spin alike.

	:param specimen: configuration's specimen section.
	:param radii: of the grains, or one radius [m].
	"""
	radius = float(numpy.max(radii) if specimen.massScaling else numpy.min(radii))
	springs = specimen.springs
	kn = pairStiffness(springs, springs, radius, radius)
	translation, rotation = 1 + 2 / springs.ratio, 2 / springs.ratio / 0.4
	return 2 / math.sqrt(2 * CONTACTS / 3 * kn * max(translation, rotation) / sphereMass(radius, specimen.density))


def grainsStep(config, radii):
	"""The same of the grains of a test, among them a smallest one on a platen or wall whose contacts have a stiffness of their own.

	Such a contact adds kn/m to omega^2, or ks (1/m + R^2/(0.4 m R^2)) = 3.5 ks/m.

	:param config: a configuration.
	:param radii: of the grains, or one radius [m].
	"""
	specimen, radius = config.specimen, float(numpy.min(radii))
	mass = sphereMass(radius, specimen.density)
	if specimen.massScaling:
		mass *= float(numpy.max(massFactors(radii, specimen.springs.direct)))
	pairs = (config.contacts.grainPlaten, config.contacts.grainWall)
	stiffest = max((pair.normal(radius) * max(1.0, 3.5 / pair.ratio) for pair in pairs if pair.stiff), default=0.0)
	step = grainStep(specimen, radii)
	return 2 / math.sqrt((2 / step) ** 2 + stiffest / mass) if stiffest else step


def membraneStep(grains, membrane, density, largest, particleRadius, sheetStep, own=None):
	"""Critical step [s] of the membrane's spheres before there are contacts: GRAINS_PER_PARTICLE grains of the largest radius and the sheet's own springs at once.

	The contacts are smooth, so they turn nothing; those with a friction of their own add 3.5 ks.

	:param grains, membrane: stiffness of either, :class:`hexmembrane.configuration.stiffness.Springs`.
	:param density: of the membrane's spheres [kg/m3].
	:param largest: largest grain radius [m].
	:param particleRadius: of the membrane's spheres [m].
	:param sheetStep: critical step of the sheet alone [s], its bonds and what else holds it together.
	:param own: what contacts of grains and membrane have of their own, a :class:`hexmembrane.configuration.contacts.PairContact`; None: nothing.
	:returns: the step without ``membrane.densityScaling``, which multiplies it by its root.
	"""
	kn = pairStiffness(grains, membrane, particleRadius, largest)
	if own and own.stiff:
		kn = own.normal(min(particleRadius, largest) ** 2 / (particleRadius + largest))
	rough = 3.5 / (own.ratio if own.stiff else min(grains.ratio, membrane.ratio)) if own and own.friction else 0.0
	contacts = GRAINS_PER_PARTICLE * kn * (1 + rough)
	return 2 / math.sqrt(contacts / sphereMass(particleRadius, density) + (2 / sheetStep) ** 2)


def densityScaling(wished, grains, membrane):
	"""Factor on the membrane's mass: as wished, or the least with which the membrane's critical step is no shorter than the grains'.

	:param wished: configuration's ``membrane.densityScaling``.
	:param grains: critical step of the grains [s].
	:param membrane: critical step of the membrane [s].
	"""
	return max(1.0, (grains / membrane) ** 2) if wished is None else wished


def contactStep(pairs, normals, stiffness, arms, mass, inertia, square=0.0):
	"""A lower bound of the critical step [s] of bodies under given contact springs, rotations included.

	A contact of bodies 1 and 2 has the elastic energy

		E = kn/2 (n.(x2 - x1))^2 + ks/2 |p2 - p1|^2 + kr/2 |(w2 - w1)_t|^2 + kt/2 (n.(w2 - w1))^2,	p = x_t + l w x n

	with x and w a body's small displacement and rotation, n its own outward normal at the contact, l the arm from its centre to the contact
	and t the part across n. Since |a - b|^2 <= (1 + s) |a|^2 + (1 + 1/s) |b|^2 for every s > 0, and with s = sqrt(m1/m2), E is at most the sum
	over both ends of

		(1 + sqrt(m/m'))/2 (kn (n.x)^2 + ks |p|^2 + kr |w_t|^2 + kt (n.w)^2),	m the body's own mass, m' its partner's.

	That has no terms between bodies: K <= blockdiag(D), with a 6x6 block D of each body, translation and rotation. So omega^2 is at most the
	largest eigenvalue of D, in coordinates scaled by the roots of mass and inertia, over all bodies. For equal bodies the weight is 2, for a
	partner that does not move it is 1. The roots keep light membrane spheres between heavy grains from halving the step: in sheared specimens of 1,000
	grains the bound is 2 to 4 % below 2/omega, with weights of 2 throughout it is 30 %.

	The bound is exact for two equal bodies on a spring without shear, and for a face-centred lattice of equal spheres with kn/ks <= 3, whose
	fastest mode is all spheres spinning alike.

	:param pairs: (M, 2) bodies of each contact.
	:param normals: (M, 3) from the first body to the second.
	:param stiffness: (M, 4) kn, ks [N/m], kr and kt [N m], against bending and twisting.
	:param arms: (M, 2) distances from the centres to the contact [m].
	:param mass: (bodies,) [kg], inf for what does not move.
	:param inertia: (bodies,) [kg m2], inf for what does not turn.
	:param square: (bodies,) omega^2 of further springs [1/s2], which adds to a body's own.
	:returns: the step; inf without springs.
	"""
	count = len(mass)
	root = numpy.sqrt([mass, inertia])
	blocks = numpy.zeros((count, 6, 6))
	for end, sign in ((0, 1.0), (1, -1.0)):
		body, partner = pairs[:, end], pairs[:, 1 - end]
		ratio = numpy.divide(root[0, body], root[0, partner], out=numpy.zeros(len(pairs)), where=numpy.isfinite(root[0, body]))
		weighted = (1 + ratio)[:, None] * stiffness
		numpy.add.at(blocks, body, _ends(sign * normals, weighted, arms[:, end], *(1 / root[:, body])))
	largest = (numpy.linalg.eigvalsh(blocks)[:, -1] + square).max(initial=0.0)
	return 2 / math.sqrt(largest) if largest > 0 else math.inf


def _ends(normal, stiffness, arm, perRootMass, perRootInertia):
	"""(M, 6, 6) blocks that contacts add to the body at one end, in coordinates scaled by the roots of mass and inertia."""
	x, y, z = normal.T
	zero = numpy.zeros_like(x)
	along = normal[:, :, None] * normal[:, None, :]
	across = numpy.eye(3) - along
	turn = numpy.stack([zero, z, -y, -z, zero, x, y, -x, zero], axis=1).reshape(-1, 3, 3)  # turn @ w = w x n
	kn, ks, kr, kt = (k[:, None, None] for k in stiffness.T)
	linear = perRootMass[:, None, None]
	angular = perRootInertia[:, None, None]
	arm = arm[:, None, None]
	blocks = numpy.empty((len(normal), 6, 6))
	blocks[:, :3, :3] = linear**2 * (kn * along + ks * across)
	blocks[:, 3:, 3:] = angular**2 * ((ks * arm**2 + kr) * across + kt * along)
	blocks[:, :3, 3:] = linear * angular * ks * arm * turn
	blocks[:, 3:, :3] = blocks[:, :3, 3:].transpose(0, 2, 1)
	return blocks
