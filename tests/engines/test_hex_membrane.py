# SPDX-License-Identifier: GPL-2.0-or-later
import math

import numpy as np
import pytest
from contactScene import sphere
from membraneScene import HEIGHT, KN, RADIUS, inward, makeMembrane, positions, slack
from tiers import engines


def test_bodiesAreOrdinarySpheres(O):
	m = makeMembrane(mask=2)
	assert list(m.ids) == list(range(len(m.ids))) and len(m.ids) == m.perRing * m.rings == len(O.bodies)
	body = O.bodies[m.ids[len(m.ids) // 2]]
	assert body.shape.__class__.__name__ == "Sphere" and body.shape.radius == m.sphereRadius and body.mask == 2
	assert body.state.mass == pytest.approx(1000 * 4 / 3 * math.pi * m.sphereRadius**3, rel=1e-12)
	assert body.state.blockedDOFs == "XYZ"
	assert O.bodies[m.ids[0]].state.blockedDOFs == "xyzXYZ"


def test_listsBelongTogether(O):
	m = makeMembrane()
	x = positions(m)
	bonds, triangles = np.array([tuple(b) for b in m.bonds]), np.array([tuple(t) for t in m.triangles])
	lengths = np.linalg.norm(x[bonds[:, 1]] - x[bonds[:, 0]], axis=1)
	assert np.allclose(lengths, 2 * m.sphereRadius, rtol=1e-12, atol=0)
	assert sorted(set(m.groups)) == [1, 2, 3] and m.groups[0] == m.groups[-1] == 1
	a, b, c = (x[triangles[:, k]] for k in range(3))
	outward = np.einsum("ij,ij->i", np.cross(b - a, c - a)[:, :2], ((a + b + c) / 3)[:, :2])
	assert (outward > 0).all()


def test_measuresOfTheGeneratedTube(O):
	m = makeMembrane()
	x = positions(m)
	height = np.ptp(x[:, 2])
	# the tube is a prism of flat triangles: its section lies between those of the n-gons in and round the circle
	for surface, radius in (("inner", m.innerRadius), ("centre", m.centreRadius)):
		polygon = 0.5 * m.perRing * math.sin(2 * math.pi / m.perRing)
		volume = m.enclosedVolume(surface=surface)
		assert polygon * radius**2 * height * 0.999 < volume < math.pi * radius**2 * height
		assert m.surfaceArea(surface) == pytest.approx(2 * math.pi * radius * height, rel=0.01)
	assert m.meanRadius() == pytest.approx(m.innerRadius, rel=1e-12)
	assert m.meanRadius(surface="centre") == pytest.approx(m.centreRadius, rel=1e-12)
	assert m.enclosedVolume(0.005, 0.025) == pytest.approx(m.enclosedVolume(0.005, 0.015) + m.enclosedVolume(0.015, 0.025), rel=1e-12)


def test_originMovesEverything(O):
	m = makeMembrane(origin=(0.1, -0.2, 0.3))
	x = positions(m)
	assert x[:, :2].mean(axis=0) == pytest.approx([0.1, -0.2], abs=1e-12)
	assert 0.5 * (x[:, 2].min() + x[:, 2].max()) == pytest.approx(0.3 + HEIGHT / 2, rel=1e-12)
	assert m.meanRadius() == pytest.approx(RADIUS, rel=1e-12)


def test_transmittedPressureOfOneContact(O, tier):
	"""One grain pressed on one particle by 1e-6 m: the pressure is that radial force, kn u, over the inner area."""
	m = makeMembrane()
	index = m.perRing * (m.rings // 2)
	x = O.bodies[m.ids[index]].state.pos
	sphere(x + inward(x) * (m.sphereRadius + 0.001 - 1e-6), 0.001, fixed=True)
	O.engines = engines(tier, [slack(m)])
	O.dt = 1e-9
	O.step()
	rows = m.rings - 2 * m.oRingRows
	area = 2 * math.pi * m.innerRadius * m.ringSpacing * rows
	assert m.transmittedPressure() == pytest.approx(KN * 1e-6 / area, rel=1e-9)
	assert m.transmittedPressure(3) == pytest.approx(m.transmittedPressure() * rows / (rows - 2 * m.platenRows), rel=1e-9)
	assert m.transmittedPressure(2) == 0
	rings = np.array(m.transmittedByRing())
	assert rings[m.rings // 2] == pytest.approx(m.transmittedPressure() * rows, rel=1e-9) and np.count_nonzero(rings) == 1
	assert m.transmittedByGroup() == {group: m.transmittedPressure(group) for group in (0, 2, 3)}
	with pytest.raises(ValueError, match="group"):
		m.transmittedPressure(1)


def test_outside(O, tier):
	"""Bodies on both sides of the surface through the membrane's centres; a body that is not there is named."""
	m = makeMembrane()
	x = O.bodies[m.ids[m.perRing * (m.rings // 2)]].state.pos
	grains = [sphere(x + way * inward(x) * m.sphereRadius, 1e-4, fixed=True) for way in (-2, -0.5, 0.5, 2)]
	assert m.outside(grains) == grains[:2]
	with pytest.raises(ValueError, match="HexMembrane.outside: ids = 99999999"):
		m.outside([*grains, 99999999])


BAD = [
	(dict(specimenRadius=float("nan")), "HexMembrane.specimenRadius"),
	(dict(specimenRadius=-1), "HexMembrane.specimenRadius = -1"),
	(dict(specimenHeight=0), "HexMembrane.specimenHeight"),
	(dict(particleRadius=float("inf")), "HexMembrane.particleRadius"),
	(dict(particleRadius=0.05), "too coarse"),
	(dict(specimenHeight=0.001), "no ring fits"),
	(dict(platenRows=20), "overlap"),
	(dict(oRingRows=-1), "HexMembrane.oRingRows"),
	(dict(placement="inside"), "'outside' or 'centred'"),
	(dict(density=-5), "HexMembrane.density"),
	(dict(origin=(0, 0, float("nan"))), "HexMembrane.origin"),
	(dict(smallestGrain=0.0001), "at most 0.000646"),
]


@pytest.mark.parametrize("changes, message", BAD, ids=[m for _, m in BAD])
def test_badInputLeavesTheSceneEmpty(O, changes, message):
	with pytest.raises(ValueError) as error:
		makeMembrane(**changes)
	assert message in str(error.value) and "fix:" in str(error.value)
	assert len(O.bodies) == 0


def test_coarseMembraneOnRequest(O):
	assert len(makeMembrane(smallestGrain=0.0001, allowCoarse=True).ids) > 0


def test_withoutMaterial(O):
	from yade.wrapper import HexMembrane

	with pytest.raises(ValueError, match="O.materials.append"):
		HexMembrane(specimenRadius=RADIUS, specimenHeight=HEIGHT, particleRadius=0.002).generate()


def test_generateTwiceIsRefused(O):
	m = makeMembrane()
	count = len(O.bodies)
	with pytest.raises(ValueError, match="already"):
		m.generate()
	assert len(O.bodies) == count


def test_planesInTheWrongOrderAreNamed(O):
	m = makeMembrane()
	for method in ("surfaceArea", "enclosedVolume"):
		with pytest.raises(ValueError, match=r"HexMembrane.%s: zBottom = 0.02: not below zTop = 0.01; fix:" % method):
			getattr(m, method)(zBottom=0.02, zTop=0.01)


def test_nothingIsReadBeforeGenerate(O):
	from yade.wrapper import HexMembrane

	m = HexMembrane(specimenRadius=RADIUS, specimenHeight=HEIGHT, particleRadius=0.002)
	for read in (lambda: m.groups, lambda: m.triangles, lambda: m.bonds, lambda: m.positions, m.enclosedVolume, m.meanRadius, m.transmittedPressure):
		with pytest.raises(RuntimeError, match="generate"):
			read()
