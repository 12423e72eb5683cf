# SPDX-License-Identifier: GPL-2.0-or-later
"""What the membrane's own forces add to the pressure on the soil, and its axial pull, in both tiers."""

import math

import numpy as np
import pytest
import yade
from hexmembrane.scene.membrane_loads import endHeights, endRows, membraneLoads
from membraneScene import HEIGHT, core, forcesOn, makeMembrane, positions, shake
from tiers import engines, run
from yade import MembraneBonds, MembraneORings, MembranePressure, MembraneRadialServo, O

P = 1e5


def coreScene(tier, stretch):
	"""A membrane on a stiff core of fixed spheres, one behind each particle, pushed out so that the membrane is stretched by about `stretch`."""
	m = makeMembrane()
	core(m, (2, 3), 2 * m.sphereRadius - stretch * m.centreRadius)
	bonds = MembraneBonds(membrane=m, kn=1.5e5)
	pressure = MembranePressure(membrane=m, pressure=P)
	inner = [bonds, pressure, MembraneRadialServo(membrane=m, pressure=P), MembraneORings(membrane=m)]
	O.engines = engines(tier, inner, damping=0.5, substeps=100)
	O.dt = 0.1 * bonds.criticalTimeStep()
	return m, bonds, pressure


def test_appliedPressureAndTheMembranesShareArrive(O, tier):
	"""transmitted = applied + share, with a share that is as large as the pressure.

	To 0.3 % with the nominal pressure (34 spheres a ring: the applied forces belong to a polygon, whose perimeter is 1 - (pi/n)^2/6 of the
	circle's), and to rounding and what is left of motion with the radial parts of the forces that were really applied.
	"""
	m, bonds, pressure = coreScene(tier, 0.01)
	run(3000)
	assert np.linalg.norm(forcesOn([i for i, g in zip(m.ids, m.groups) if g != 1]), axis=1).max() < 1e-4
	assert bonds.radialShare(3) > 0.3 * P
	for group in (0, 2, 3):
		assert m.transmittedPressure(group) == pytest.approx(P + bonds.radialShare(group), rel=3e-3)
	# row by row: the middle rows carry the group's mean, and the rows over their areas make the mean
	rows = np.array(m.transmittedByRing())
	assert len(rows) == m.rings and (rows[: m.oRingRows] == 0).all()
	middle = rows[m.rings // 2]
	assert middle == pytest.approx(m.transmittedPressure(3), rel=0.05)
	x = positions(m).reshape(m.rings, m.perRing, 3)
	radius = np.linalg.norm((x - x.mean(axis=1, keepdims=True))[:, :, :2], axis=2).mean(axis=1) - m.sphereRadius
	spacing = np.gradient(x[:, :, 2].mean(axis=1))
	main = np.array(m.groups).reshape(m.rings, m.perRing)[:, 0] == 3
	area = (2 * math.pi * radius * spacing)[main]
	assert (rows[main] * area).sum() / area.sum() == pytest.approx(m.transmittedPressure(3), rel=1e-9)
	inward = (x.mean(axis=1, keepdims=True) - x)[:, :, :2]
	inward /= np.linalg.norm(inward, axis=2, keepdims=True)
	applied = np.array([tuple(f) for f in pressure.forces()]).reshape(m.rings, m.perRing, 3)[:, :, :2]
	applied = (applied * inward)[main].sum() / area.sum()
	assert m.transmittedPressure(3) == pytest.approx(applied + bonds.radialShare(3), rel=1e-6)


@pytest.mark.parametrize("kind", ["central", "shear", "broken"])
def test_axialPullIsTheForceOnAllThatIsAbove(O, tier, kind):
	"""Bond forces are internal: those on the particles above a plane add up to the pull through it, with shear forces and broken bonds too."""
	m = makeMembrane(rotations=kind != "central")
	shake(m, 2e-4)
	springs = {"central": {}, "shear": dict(ks=200.0), "broken": dict(ks=200.0, tensileStrength=0.03)}[kind]
	bonds = MembraneBonds(membrane=m, kn=500.0, **springs)
	O.engines = engines(tier, [bonds])
	O.dt = 0.2 * bonds.criticalTimeStep()
	for _ in range(20):
		before = positions(m)[:, 2]
		O.step()
	if kind == "broken":
		assert 0 < bonds.brokenCount < len(m.bonds)
	force = forcesOn(m.ids)[:, 2]
	for z in (0.1 * HEIGHT, 0.47 * HEIGHT, 0.8 * HEIGHT):
		assert bonds.axialTension([z])[0] == pytest.approx(-force[before >= z].sum(), abs=1e-12 * np.abs(force).sum())


def test_termsOfACylinderPulledLengthwise(O, tier):
	"""T_mid = T_end = 2 pi r N_z with r and eps_theta kept: N_z = E t/(1 - nu^2) eps_z; the hoop force nu N_z over the inner radius."""
	m = makeMembrane(particleRadius=0.0006)
	kn, strain = 500.0, 1e-5
	for i in m.ids:
		x = O.bodies[i].state.pos
		O.bodies[i].state.pos = (x[0], x[1], x[2] * (1 + strain))
	bonds = MembraneBonds(membrane=m, kn=kn)
	pressing = MembranePressure(membrane=m, pressure=P)
	O.engines = engines(tier, [bonds, pressing])
	O.dt = 1e-12  # nothing moves
	O.step()
	ends = endHeights(yade.BodyArrays.positions(endRows(m))[:, 2])
	loads = membraneLoads(ends, [bonds], pressing, 0, HEIGHT)
	assert abs(loads.axialPush) < 1e-3 * P * math.pi * m.innerRadius**2  # a straight tube has no axial push
	along = 2 / math.sqrt(3) * kn / (1 - 1 / 9) * strain
	assert loads.axialPullMiddle == pytest.approx(2 * math.pi * m.centreRadius * along, rel=2e-3)
	assert loads.axialPullEnd == pytest.approx(loads.axialPullMiddle, rel=1e-9)
	assert loads.radialPressure == pytest.approx(along / 3 / m.innerRadius, rel=5e-3)
	low, high = ends
	assert low + high == pytest.approx(HEIGHT * (1 + strain), rel=1e-9) and low < 0 < HEIGHT < high


def test_badInput(O, tier):
	m = makeMembrane()
	bonds = MembraneBonds(membrane=m, kn=500.0)
	for call in (lambda: bonds.axialTension([0.0])[0], lambda: bonds.radialShare(3)):
		with pytest.raises(RuntimeError, match="fix: run a step first"):
			call()
	O.engines = engines(tier, [bonds])
	O.step()
	with pytest.raises(ValueError, match="MembraneBonds.axialTension: heights"):
		bonds.axialTension([float("nan")])[0]
	with pytest.raises(ValueError, match="MembraneBonds.radialShare: group"):
		bonds.radialShare(1)
	with pytest.raises(RuntimeError, match="HexMembrane.transmittedByRing"):
		yade.HexMembrane().transmittedByRing()
