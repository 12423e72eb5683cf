# SPDX-License-Identifier: GPL-2.0-or-later
"""CylinderPacking: what the kernel promises arrives in YADE, and results are read only when there are some."""

import math

import pytest
import yade
from yade import Vector3, utils

from hexmembrane.scene import packing_file

RADIUS, HEIGHT, ORIGIN = 0.02, 0.04, Vector3(0.1, -0.2, 0.3)
RADII = [1e-3 * (1 + 0.6 * (i % 7) / 6) for i in range(300)]


def made(**changes):
    packing = yade.CylinderPacking(radius=RADIUS, height=HEIGHT, origin=ORIGIN, radii=RADII, porosity=0.45, seed=5)
    for name, value in changes.items():
        setattr(packing, name, value)
    packing.generate()
    return packing


@pytest.fixture(scope="module")
def packing():
    return made()


def test_porosityAndSizes(packing):
    solid = 4 / 3 * math.pi * sum(r**3 for r in packing.sizes)
    assert 1 - solid / (math.pi * RADIUS**2 * HEIGHT) == pytest.approx(0.45, abs=1e-12)
    assert packing.porosityReached == pytest.approx(0.45, abs=1e-12)
    assert packing.sizes == pytest.approx([r * packing.scale for r in RADII], rel=1e-15) and packing.radii == RADII
    assert packing.maxOverlap == 0 and packing.shakesUsed == 0


def test_noOverlapAndInsideTheCylinder(packing):
    """By brute force, round the given origin."""
    places = [tuple(c) for c in packing.centres]
    spheres = list(zip(places, packing.sizes))
    for i, (a, ra) in enumerate(spheres):
        assert math.hypot(a[0] - ORIGIN[0], a[1] - ORIGIN[1]) + ra <= RADIUS * (1 + 1e-12)
        assert ra - 1e-12 <= a[2] - ORIGIN[2] <= HEIGHT - ra + 1e-12
        for b, rb in spheres[:i]:
            assert math.dist(a, b) >= (ra + rb) * (1 - 1e-12)


def test_seed(packing):
    assert made().centres == packing.centres
    assert made(seed=6).centres != packing.centres


def test_nanKeepsTheRadii(packing):
    kept = made(porosity=float("nan"), radii=packing.sizes)
    assert kept.sizes == packing.sizes and kept.scale == 1 and kept.porosityReached == pytest.approx(0.45, abs=1e-12)


def test_noResultsBeforeTheyAreThere():
    fresh = yade.CylinderPacking(radius=RADIUS, height=HEIGHT, radii=RADII, porosity=0.45)
    for name in ("centres", "sizes", "porosityReached", "maxOverlap", "scale", "shakesUsed"):
        with pytest.raises(RuntimeError, match="generate"):
            getattr(fresh, name)


def test_failureKeepsTheResultsOfBefore():
    packing = made()
    before = packing.centres
    packing.porosity = 0.2
    with pytest.raises(RuntimeError, match=r"CylinderPacking.porosity = 0.2: denser .* a porosity of at least 0\.[34]"):
        packing.generate()
    assert packing.centres == before and packing.porosityReached == pytest.approx(0.45)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"radius": float("nan")}, "CylinderPacking.radius = nan: not given"),
        ({"radius": -1.0}, "CylinderPacking.radius = -1"),
        ({"height": 0.0}, "CylinderPacking.height = 0"),
        ({"origin": Vector3(0, float("nan"), 0)}, "CylinderPacking.origin = nan"),
        ({"radii": []}, "CylinderPacking.radii = "),
        ({"radii": [1e-3, -1e-3]}, r"CylinderPacking.radii\[1\] = -0.001"),
        ({"porosity": 1.5}, "CylinderPacking.porosity = 1.5"),
        ({"seed": -1}, "CylinderPacking.seed = -1"),
        ({"tolerance": 0.0}, "CylinderPacking.tolerance = 0"),
        ({"shakes": -2}, "CylinderPacking.shakes = -2"),
        ({"radii": [0.1], "porosity": float("nan")}, "does not go into the cylinder"),
    ],
)
def test_badInput(change, message):
    with pytest.raises(ValueError, match=message):
        made(**change)


@pytest.fixture(scope="module")
def stressed():
    return made(porosity=0.44, stress=2e4, emod=1e7, friction=0.4)


def test_stressAndPorosityAsAsked(stressed):
    assert (2 * stressed.radialStress + stressed.axialStress) / 3 == pytest.approx(2e4, rel=0.03)
    assert stressed.radialStress == pytest.approx(stressed.axialStress, rel=0.2)  # 300 grains
    assert stressed.porosityReached == pytest.approx(0.44, abs=1e-3)
    solid = 4 / 3 * math.pi * sum(r**3 for r in stressed.sizes)
    assert 1 - solid / (math.pi * RADIUS**2 * HEIGHT) == pytest.approx(stressed.porosityReached, abs=1e-12)
    assert stressed.coordination > 3 and stressed.rattlers < 0.3 and 0 < stressed.frictionReached < 0.4 and 0 < stressed.maxOverlap < 0.05


def test_aSceneFindsTheSameStress(O, stressed):
    """Love-Weber over the contacts of a scene at the first step: walls apart, the grains' share of the stress of the packing."""
    O.materials.append(yade.LinearMat(emod=1e7, kratio=3, friction=0.4, density=2650, label="grain"))
    O.bodies.append([utils.sphere(c, r, material="grain") for c, r in zip(stressed.centres, stressed.sizes)])
    O.engines = [
        yade.ForceResetter(),
        yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb()]),
        yade.InteractionLoop([yade.Ig2_Sphere_Sphere_ScGeom()], [yade.Ip2_LinearMat_LinearMat_LinearPhys()], [yade.Law2_ScGeom_LinearPhys_Linear()]),
        yade.NewtonIntegrator(),
    ]
    O.dt = 1e-12
    O.step()
    total, pressed = 0.0, 0.0
    for i in O.interactions:
        if i.isReal:
            a, b = O.bodies[i.id1], O.bodies[i.id2]
            total += i.phys.normalForce.norm() * (a.state.pos - b.state.pos).norm()
    # grain to wall: force times radius, from the same spring
    for c, r in zip(stressed.centres, stressed.sizes):
        x = c - ORIGIN
        for overlap in (r - x[2], x[2] + r - HEIGHT, math.hypot(x[0], x[1]) + r - RADIUS):
            pressed += math.pi * 1e7 * r * max(overlap, 0) * r
    mean = (total + pressed) / (3 * math.pi * RADIUS**2 * HEIGHT)
    assert mean == pytest.approx((2 * stressed.radialStress + stressed.axialStress) / 3, rel=0.02)


def test_resultsOfStressOnlyWithStress(packing):
    for name in ("radialStress", "axialStress", "coordination", "rattlers", "frictionReached"):
        with pytest.raises(RuntimeError, match="without stress"):
            getattr(packing, name)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"stress": -1.0}, "CylinderPacking.stress = -1"),
        ({"stress": float("nan")}, "CylinderPacking.stress = nan"),
        ({"stress": 2e5}, r"CylinderPacking.stress = 200000: .* at most 0.01 of the contact modulus, 1e\+07 Pa"),
        ({"emod": float("nan")}, "CylinderPacking.emod = nan: not given"),
        ({"friction": float("nan")}, "CylinderPacking.friction = nan: not given"),
        ({"stiffnessRatio": 0.0}, "CylinderPacking.stiffnessRatio = 0"),
        ({"porosityTolerance": 0.0}, "CylinderPacking.porosityTolerance = 0"),
        ({"porosity": float("nan")}, "CylinderPacking.porosity = nan"),
    ],
)
def test_badInputUnderStress(change, message):
    with pytest.raises(ValueError, match=message):
        made(**{"stress": 2e4, "emod": 1e7, "friction": 0.4, **change})


def test_porosityOutOfReachUnderStress():
    with pytest.raises(RuntimeError, match=r"CylinderPacking.porosity = 0.5: looser .* a porosity of at most 0\.4"):
        made(porosity=0.5, stress=5e4, emod=1e7, friction=0.4)


def test_withoutFrictionItHasADensityOfItsOwn():
    own = made(porosity=float("nan"), stress=2e4, emod=1e7, friction=0.0)
    assert (2 * own.radialStress + own.axialStress) / 3 == pytest.approx(2e4, rel=0.03) and own.frictionReached == 0
    solid = 4 / 3 * math.pi * sum(r**3 for r in own.sizes)
    assert 1 - solid / (math.pi * RADIUS**2 * HEIGHT) == pytest.approx(own.porosityReached, abs=1e-12)
    # another one is refused, with what helps: tried here
    with pytest.raises(RuntimeError, match=r"CylinderPacking.porosity = 0.445: .*%.6g was reached; fix: friction, no stress, or no porosity \(nan" % own.porosityReached):
        made(porosity=0.445, stress=2e4, emod=1e7, friction=0.0)
    assert made(porosity=0.445, stress=2e4, emod=1e7, friction=0.4).porosityReached == pytest.approx(0.445, abs=1e-3)
    assert made(porosity=0.445, friction=0.0).porosityReached == pytest.approx(0.445)
    assert made(porosity=own.porosityReached, stress=2e4, emod=1e7, friction=0.0).porosityReached == own.porosityReached


def test_bodiesOfThePackingFeelNoForce(O, packing):
    O.materials.append(yade.FrictMat(young=1e8, label="grain"))
    O.bodies.append([utils.sphere(c, r, material="grain") for c, r in zip(packing.centres, packing.sizes)])
    O.engines = [
        yade.ForceResetter(),
        yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb()]),
        yade.InteractionLoop([yade.Ig2_Sphere_Sphere_ScGeom()], [yade.Ip2_LinearMat_LinearMat_LinearPhys()], [yade.Law2_ScGeom_LinearPhys_Linear()]),
        yade.NewtonIntegrator(),
    ]
    O.dt = 1e-9
    O.step()
    assert len(O.bodies) == 300 and sum(1 for i in O.interactions if i.isReal) == 0


def test_fileOfAPacking(packing, tmp_path):
    packing_file.save(packing_file.Packing.of(packing, gradation="seven sizes"), tmp_path / "p.packing")
    again = packing_file.load(tmp_path / "p.packing")
    assert [tuple(c) for c in again.centres.tolist()] == [tuple(c) for c in packing.centres] and again.radii.tolist() == list(packing.sizes)
    assert (again.seed, again.gradation, again.radius, again.height) == (5, "seven sizes", RADIUS, HEIGHT)
    assert again.porosity == pytest.approx(0.45, abs=1e-12) and again.maxOverlap == pytest.approx(0, abs=1e-10)


def test_fileOfAPackingUnderStress(stressed, tmp_path):
    """Its overlaps are part of it."""
    packing_file.save(packing_file.Packing.of(stressed), tmp_path / "p.packing")
    assert packing_file.load(tmp_path / "p.packing").maxOverlap == pytest.approx(stressed.maxOverlap, rel=1e-6)
