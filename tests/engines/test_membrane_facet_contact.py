# SPDX-License-Identifier: GPL-2.0-or-later
"""MembraneFacetContact in both tiers. All grains and triangles by an oracle: tests/kernels/FacetContactTest.cpp."""

import math

import numpy as np
import pytest
from membraneScene import KN, forcesOn, makeMembrane, positions, slack
from tiers import engines, find, loop, run, state
from yade import ForceEngine, HexMembrane, MembraneBonds, MembraneFacetContact, Vector3, utils

STIFF, STRETCH = 2e3, 1.5


def stretchedMembrane(O, blocked=False):
	"""A membrane stretched so far that a grain of R/1.5 fits through its meshes."""
	m = makeMembrane()
	for i in m.ids:
		O.bodies[i].state.pos *= STRETCH
		O.bodies[i].state.blockedDOFs = "xyzXYZ" if blocked else "XYZ"
	return m


def mesh(m, t):
	"""Corners of a triangle in the middle of the tube, its centroid, its inward normal."""
	corners = tuple(m.triangles[2 * m.perRing * (m.rings // 2) + t])
	x = positions(m)[list(corners)]
	outwards = np.cross(x[1] - x[0], x[2] - x[0])
	return corners, x.mean(axis=0), -outwards / np.linalg.norm(outwards)


def grainAt(O, m, t, height, radius=None):
	"""Appends a grain over the middle of a triangle, its centre at this height (m) inside the sheet; returns its id."""
	radius = radius or m.sphereRadius / 1.5
	_, middle, inwards = mesh(m, t)
	body = utils.sphere(Vector3(*(middle + height * inwards)), radius)
	return O.bodies.append(body)


def test_forcesAndEnergyAreThoseOfTheTriangle(O, tier):
	m = stretchedMembrane(O)
	radius, h = m.sphereRadius / 1.5, m.sphereRadius / 4
	grain = grainAt(O, m, 0, 0.9 * radius)
	away = grainAt(O, m, 20, radius + 1.01 * h)
	facets = MembraneFacetContact(membrane=m, kn=STIFF)
	O.engines = engines(tier, [slack(m), facets])
	O.trackEnergy = True
	O.dt = 1e-9  # positions stay
	O.step()
	corners, _, inwards = mesh(m, 0)
	force = STIFF * (radius + h - 0.9 * radius)
	assert facets.usedOffset == h and facets.normalStiffness == STIFF
	assert facets.grains == [grain] and tuple(facets.triangles[0]) == corners
	assert facets.overlaps == pytest.approx([h + 0.1 * radius], rel=1e-9)
	assert forcesOn([grain, away]) == pytest.approx(np.array([force * inwards, np.zeros(3)]), abs=1e-9 * force)
	expected = np.zeros((len(m.ids), 3))
	expected[list(corners)] = -force * inwards / 3
	assert forcesOn(m.ids) == pytest.approx(expected, abs=1e-9 * force)
	assert facets.elasticEnergy() == pytest.approx(0.5 * force**2 / STIFF, rel=1e-9)
	assert dict(O.energy.items())["elastFacet"] == facets.elasticEnergy()
	masses = O.bodies[grain].state.mass, 3 * O.bodies[m.ids[0]].state.mass
	assert facets.criticalTimeStep() == pytest.approx(2 * math.sqrt(min(masses) / (2 * STIFF)), rel=1e-9)


def test_stiffnessIsTheMaterials(O):
	m = makeMembrane()
	assert MembraneFacetContact(membrane=m).normalStiffness == pytest.approx(KN, rel=1e-14)  # two springs of 2 KN in series
	assert MembraneFacetContact(membrane=m, kn=5.0).normalStiffness == 5.0


@pytest.mark.parametrize("held", (False, True))
def test_aGrainUnderAForceIsHeldByTheSheetAlone(O, tier, held):
	"""The mesh is wider than the grain: without facets it goes through, with them it comes to rest at F/kn."""
	m = stretchedMembrane(O, blocked=True)
	radius, h, push = m.sphereRadius / 1.5, m.sphereRadius / 4, 0.2
	grain = grainAt(O, m, 0, radius + 0.9 * h)
	corners, middle, inwards = mesh(m, 0)
	facets = MembraneFacetContact(membrane=m, kn=STIFF, dead=not held)
	O.engines = engines(tier, [slack(m), facets], damping=0.4, substeps=20, before=[ForceEngine(force=Vector3(*(-push * inwards)), ids=[grain])])
	O.dt = 1e-5
	run(600 if held else 110)
	height = (np.array(O.bodies[grain].state.pos) - middle) @ inwards
	if held:
		assert height == pytest.approx(radius + h - push / STIFF, abs=1e-3 * radius)
	else:
		assert height < -m.sphereRadius - radius  # it is outside


def test_aTornSheetLeaksAndSetsItsEnergyFree(O, tier):
	m = stretchedMembrane(O, blocked=True)
	radius, h, push = m.sphereRadius / 1.5, m.sphereRadius / 4, 0.2
	corners, middle, inwards = mesh(m, 0)
	# one side of the mesh is longer than all other bonds
	one, other = (O.bodies[m.ids[c]].state for c in corners[:2])
	apart = 0.04 * (other.pos - one.pos)
	one.pos, other.pos = one.pos - apart, other.pos + apart
	grain = grainAt(O, m, 0, radius + 0.9 * h)
	bonds = MembraneBonds(membrane=m, kn=1.0)
	facets = MembraneFacetContact(membrane=m, bonds=bonds, kn=STIFF)
	O.engines = engines(tier, [bonds, facets], damping=0.4, substeps=20, before=[ForceEngine(force=Vector3(*(-push * inwards)), ids=[grain])])
	O.trackEnergy = True
	O.dt = 1e-5
	run(600)
	assert facets.grains == [grain] and bonds.brokenCount == 0
	stored = facets.elasticEnergy()
	assert stored == pytest.approx(0.5 * push**2 / STIFF, rel=0.01)
	lengths = np.sort([np.linalg.norm(np.subtract(*positions(m)[list(b)])) for b in m.bonds])
	bonds.tensileStrength = 0.5 * (lengths[-1] + lengths[-2]) - 2 * m.sphereRadius
	bondStored = 0.5 * (lengths[-1] - 2 * m.sphereRadius) ** 2
	run(20)
	assert bonds.brokenCount == 1 and facets.elasticEnergy() < stored
	freed = dict(O.energy.items())["bondDissip"]
	assert freed == pytest.approx(stored, rel=0.02) or freed == pytest.approx(stored + bondStored, rel=0.02)
	run(110)
	assert (np.array(O.bodies[grain].state.pos) - middle) @ inwards < -m.sphereRadius - radius


def test_energyAndMomentumAreKept(O, tier):
	"""A grain flies against the sheet and comes back: what the contact stored becomes kinetic again."""
	m = stretchedMembrane(O)
	radius, h = m.sphereRadius / 1.5, m.sphereRadius / 4
	grain = grainAt(O, m, 0, radius + 1.1 * h)
	_, _, inwards = mesh(m, 0)
	body = O.bodies[grain].state
	body.vel = Vector3(*(-0.3 * inwards))
	start, momentum = 0.5 * body.mass * 0.09, body.mass * np.array(body.vel)
	facets = MembraneFacetContact(membrane=m, kn=STIFF)
	O.engines = engines(tier, [slack(m), facets], substeps=10)
	O.dt = 0.01 * math.sqrt(body.mass / STIFF)
	stored = []
	for _ in range(60):
		run(20)
		stored.append(facets.elasticEnergy())
		assert stored[-1] + utils.kineticEnergy() == pytest.approx(start, rel=0.02)
		total = sum(O.bodies[i].state.mass * np.array(O.bodies[i].state.vel) for i in [*m.ids, grain])
		assert total == pytest.approx(momentum, abs=1e-9 * np.linalg.norm(momentum))
	assert max(stored) > 0.2 * start and stored[-1] == 0


def test_itsContactsAreCountedAsContacts(O, tier):
	"""transmittedPressure ring by ring is that of the forces on the corners."""
	m = stretchedMembrane(O)
	for t in (0, 9, 24):
		grainAt(O, m, t, 0.9 * m.sphereRadius / 1.5)
	facets = MembraneFacetContact(membrane=m, kn=STIFF)
	O.engines = engines(tier, [slack(m), facets])
	O.dt = 1e-9
	O.step()
	x, f = positions(m), forcesOn(m.ids)
	outwards = x * (1, 1, 0) / np.hypot(x[:, 0], x[:, 1])[:, None]
	radial = (f * outwards).sum(axis=1).reshape(m.rings, m.perRing).sum(axis=1)
	area = 2 * math.pi * (STRETCH * m.centreRadius - m.sphereRadius) * STRETCH * m.ringSpacing
	inner = slice(1, -1)
	assert radial[inner].max() > 0.1
	assert np.array(m.transmittedByRing())[inner] == pytest.approx(radial[inner] / area, rel=1e-9, abs=1e-12)
	if loop():
		assert loop().contactCount() == 9
		loop().exportContacts()  # they are none of O.interactions, and counted all the same
		assert np.array(m.transmittedByRing())[inner] == pytest.approx(radial[inner] / area, rel=1e-9, abs=1e-12)


def test_compactCriticalStepCountsContacts(O):
	m = stretchedMembrane(O)
	grainAt(O, m, 0, 0.9 * m.sphereRadius / 1.5)
	facets = MembraneFacetContact(membrane=m, kn=STIFF)
	O.engines = engines("compact", [slack(m), facets])
	O.dt = 1e-9
	O.step()
	assert facets.criticalTimeStep() <= loop().criticalTimeStep() < 2 * facets.criticalTimeStep()


def swarm(O):
	"""A stretched membrane on weak bonds, and grains flying against it from inside."""
	m = stretchedMembrane(O)
	random = np.random.default_rng(1)
	for t in range(0, 4 * m.perRing, 3):
		i = grainAt(O, m, t - 2 * m.perRing, 1.5 * m.sphereRadius, radius=m.sphereRadius / 1.5 * random.uniform(1, 1.2))
		O.bodies[i].state.vel = Vector3(*(-random.uniform(0.2, 0.4) * mesh(m, t - 2 * m.perRing)[2]))
	return m


def test_tiersAgree(O):
	found = []
	for tier in ("reference", "compact"):
		O.reset()
		m = swarm(O)
		facets = MembraneFacetContact(membrane=m, kn=STIFF)
		O.engines = engines(tier, [MembraneBonds(membrane=m, kn=4.0), facets], damping=0.2)
		O.dt = 2e-5
		run(150)
		assert len(facets.grains) > 3
		found.append(state())
	assert np.abs(found[0] - found[1]).max() < 1e-9 * np.abs(found[0]).max()


def test_saveAndLoadContinueExactly(O, tier, tmp_path):
	"""The lists are not saved: the loaded run makes its own, and has the same bits."""
	m = swarm(O)
	facets = MembraneFacetContact(membrane=m, kn=STIFF)
	O.engines = engines(tier, [MembraneBonds(membrane=m, kn=4.0), facets], substeps=20)
	O.dt = 2e-5
	run(140)
	assert facets.grains and facets.listsMade > 1
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	run(60)
	whole = state()
	O.reset()
	O.load(file)
	run(60)
	loaded = find(MembraneFacetContact)
	assert loaded.listsMade < facets.listsMade
	assert (state() == whole).all()


def test_badInput(O):
	m = makeMembrane()
	O.dt = 1e-6
	for arguments, message in (
		(dict(membrane=m, kn=0.0), "MembraneFacetContact.kn = 0"),
		(dict(membrane=m, offset=0.0), "MembraneFacetContact.offset = 0"),
		(dict(membrane=m, offset=m.sphereRadius), "MembraneFacetContact.offset = .*reaches through the particles"),
		(dict(kn=STIFF), "MembraneFacetContact.membrane = None"),
		(dict(membrane=HexMembrane(), kn=STIFF), "no particles"),
	):
		O.engines = engines("reference", [MembraneFacetContact(**arguments)])
		with pytest.raises((ValueError, RuntimeError), match=message):
			O.step()
	with pytest.raises(RuntimeError, match="MembraneFacetContact.grains: nothing computed yet"):
		MembraneFacetContact(membrane=m).grains
