# SPDX-License-Identifier: GPL-2.0-or-later
"""MembranePressure in both tiers; on a mesh of one's own, which the compact tier refuses, in the reference tier."""

import numpy as np
import pytest
from contactScene import sphere
from membraneScene import KN, coreStep, forcesOn, makeMembrane, pressOnCore, inward, positions, shake, slack
from tiers import contact, engines, find, run, state
from yade import ForceResetter, MembraneBonds, MembranePressure, MembraneRadialServo, NewtonIntegrator, Vector3, utils

P = 1e5


def test_groupThreeOnly(O, tier):
	m = makeMembrane()
	pressure = MembranePressure(membrane=m, pressure=P)
	O.engines = engines(tier, [slack(m), pressure])
	O.dt = 1e-9
	O.step()
	f, groups, x = forcesOn(m.ids), np.array(m.groups), positions(m)
	assert np.abs(f[groups != 3]).max() < 1e-30  # the slack bonds'
	inward = -np.einsum("ij,ij->i", f[:, :2], x[:, :2])
	assert (inward[groups == 3] > 0).all()
	# a full turn of the lattice: no resultant across the axis
	assert np.abs(f.sum(axis=0)[:2]).max() < 1e-12 * np.abs(f).sum()
	assert np.array(pressure.resultant) == pytest.approx(f.sum(axis=0), abs=1e-12 * np.abs(f).sum())


@pytest.mark.parametrize("surface", ["inner", "centre"])
def test_equationsOfTheStudy(O, tier, surface):
	"""Eqs. 3-5 in numpy, on either surface, on a deformed membrane."""
	m = makeMembrane()
	x = shake(m, 2e-4)
	pressure = MembranePressure(membrane=m, pressure=P, surface=surface)
	O.engines = engines(tier, [slack(m), pressure])
	O.dt = 1e-9
	O.step()
	t = np.array([tuple(k) for k in m.triangles])

	def areaVectors(y):
		return 0.5 * np.cross(y[t[:, 1]] - y[t[:, 0]], y[t[:, 2]] - y[t[:, 0]])

	def atVertices(values):
		out = np.zeros_like(x)
		for k in range(3):
			np.add.at(out, t[:, k], values)
		return out

	y = x
	if surface == "inner":
		normals = atVertices(areaVectors(x))
		y = x - m.sphereRadius * normals / np.linalg.norm(normals, axis=1)[:, None]
	expected = atVertices(-P * areaVectors(y) / 3)
	main = np.array(m.groups) == 3
	assert np.abs(forcesOn(m.ids)[main] - expected[main]).max() < 1e-12 * np.abs(expected).max()
	area = sum(np.linalg.norm(areaVectors(y), axis=1) @ main[t[:, k]] / 3 for k in range(3))
	assert pressure.area == pytest.approx(area, rel=1e-12)


def test_meshOfOnesOwn(O):
	"""A closed tetrahedron: no resultant, no moment, force = -p dV/dx."""
	corners = [(0, 0, 0), (1, 0, 0.1), (0, 1, 0), (0.2, 0.1, 1)]
	ids = O.bodies.append([utils.sphere(c, 0.1) for c in corners])
	pressure = MembranePressure(ids=ids, triangles=[(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)], pressure=P, surface="centre")
	O.engines = [ForceResetter(), pressure, NewtonIntegrator()]
	O.dt = 1e-12
	O.step()
	f, x = forcesOn(ids), np.array(corners)
	assert np.abs(f.sum(axis=0)).max() < 1e-12 * P
	assert np.abs(np.cross(x, f).sum(axis=0)).max() < 1e-12 * P
	volume = lambda y: np.linalg.det(y[1:] - y[0]) / 6
	h = 1e-3
	for v in range(4):
		for a in range(3):
			up, down = x.copy(), x.copy()
			up[v, a] += h
			down[v, a] -= h
			assert f[v, a] == pytest.approx(-P * (volume(up) - volume(down)) / (2 * h), abs=1e-9 * P)


def test_workIsPressureTimesVolume(O):
	"""A closed cube shrunk by hand in small steps: work = -p dV, trapezoidal."""
	corners = np.array([(i, j, k) for i in (0.0, 1.0) for j in (0.0, 1.0) for k in (0.0, 1.0)])
	ids = O.bodies.append([utils.sphere(c, 0.1) for c in corners])
	quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
	triangles = [t for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]
	pressure = MembranePressure(ids=ids, triangles=triangles, pressure=P, surface="centre")
	O.engines = [ForceResetter(), pressure]
	for step in range(101):
		for i, c in zip(ids, corners):
			O.bodies[i].state.pos = tuple(c * (1 - 0.001 * step))
		O.step()
	# trapezoid of a cubic: error h^2/12 of the second derivative, 1e-6 of the whole here
	assert pressure.work == pytest.approx(P * (1 - 0.9**3), rel=1e-5)


def test_saveAndLoadContinueExactly(O, tier, tmp_path):
	m = makeMembrane()
	O.engines = engines(tier, [MembraneBonds(membrane=m, kn=5e4), MembranePressure(membrane=m, pressure=P)], damping=0.2)
	O.dt = 1e-6
	run(40)
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	run(40)
	whole, work = state(), find(MembranePressure).work
	O.reset()
	O.load(file)
	assert find(MembranePressure).membrane is not None
	run(40)
	assert (state() == whole).all() and find(MembranePressure).work == work and work > 0


def pressedOnCore(tier):
	m = makeMembrane()
	pressure = MembranePressure(membrane=m, pressure=P, surface="centre", timeConstant=200 * coreStep(m))
	pressOnCore(tier, m, 3, MembraneBonds(membrane=m, kn=1e4), pressure)
	return m, pressure


def test_closedLoopReachesItsTarget(O, tier):
	"""A stiff frictionless core, pressure on the triangles of the centres: Rc/(Rc - R) too much arrives, and the loop takes it away."""
	m, pressure = pressedOnCore(tier)
	assert pressure.transmitted == pytest.approx(P, rel=5e-3)
	assert pressure.factor == pytest.approx(m.innerRadius / m.centreRadius, rel=0.01)
	assert pressure.applied == pressure.factor * P and not pressure.saturated


def test_whatArrivesIsReadFromTheLastStep(O, tier):
	"""By the membrane itself, without more ado; the loop's own measure is of up to 20 steps before."""
	m, pressure = pressedOnCore(tier)
	assert m.transmittedPressure(3) == pytest.approx(pressure.transmitted, rel=1e-3)
	rings = np.array(m.transmittedByRing())
	main = np.array(m.groups).reshape(m.rings, m.perRing)[:, 0] == 3
	assert rings[main] == pytest.approx(P, rel=0.1)
	assert (rings[~main] == 0).all()


@pytest.mark.parametrize("loop", [MembranePressure, MembraneRadialServo], ids=["pressure", "servo"])
@pytest.mark.parametrize("case", ["at rest", "sliding", "pushed by a script"])
def test_theLoopsMeasureIsOfNormalForces(O, tier, loop, case):
	"""One grain that presses on one particle from 45 degrees below: kn u cos 45 inwards, over the group's area, is all that is transmitted.

	Not the shear force of a grain that slides, though a part of it acts inwards, nor what a script adds to the particle's force.
	"""
	m = makeMembrane(platenRows=1)
	O.materials[0].friction = 1.0
	group, ring = (3, m.rings // 2) if loop is MembranePressure else (2, m.oRingRows)
	particle = m.ids[ring * m.perRing]
	x, u = O.bodies[particle].state.pos, 1e-6
	normal = (inward(x) - Vector3(0, 0, 1)).normalized()
	grain = O.bodies[sphere(x + normal * (m.sphereRadius + 0.001 - u), 0.001, fixed=True)]
	engine = loop(membrane=m, pressure=P, timeConstant=1e-8)
	O.engines = engines(tier, [slack(m), engine])
	O.dt = 1e-9
	if case == "sliding":  # shear of half the normal force in one step
		grain.state.vel = 0.5 * u / O.dt * (inward(x) + Vector3(0, 0, 1)).normalized()
	if case == "pushed by a script":
		O.forces.setPermF(particle, 0.1 * inward(x))
	O.step()
	rows = m.groups.count(group) / m.perRing
	area = 2 * np.pi * m.innerRadius * m.ringSpacing * rows
	assert engine.transmitted == pytest.approx(KN * u / np.sqrt(2) / area, rel=1e-6)
	if case == "sliding":
		assert contact(grain.id, particle).phys.shearForce.norm() == pytest.approx(0.5 * KN * u, rel=1e-3)


def test_closedLoopStopsAtItsLimit(O, tier):
	"""Nothing inside to press on: the factor stays within its limits and says so."""
	m = makeMembrane()
	pressure = MembranePressure(membrane=m, pressure=P, timeConstant=2e-9, maxFactor=1.25)
	O.engines = engines(tier, [slack(m), pressure])
	O.dt = 1e-9
	O.step()
	O.step()
	assert pressure.saturated and pressure.factor == 1.25 and pressure.transmitted == 0


BAD = [
	(lambda m: MembranePressure(membrane=m), ValueError, "MembranePressure.pressure"),
	(lambda m: MembranePressure(membrane=m, pressure=float("nan")), ValueError, "MembranePressure.pressure = nan"),
	(lambda m: MembranePressure(pressure=1.0), ValueError, "MembranePressure.membrane = None"),
	(lambda m: MembranePressure(membrane=m, ids=[0], triangles=[(0, 0, 0)], pressure=1.0), ValueError, "given together"),
	(lambda m: MembranePressure(membrane=m, pressure=1.0, surface="outer"), ValueError, "'inner' or 'centre'"),
	(lambda m: MembranePressure(ids=[0, 1, 2], triangles=[(0, 1, 2)], pressure=1.0), ValueError, "surfaceOffset"),
	(lambda m: MembranePressure(ids=[0, 1, 2], triangles=[(0, 1, 3)], pressure=1.0, surface="centre"), ValueError, "MembranePressure.triangles[0] = 3"),
	(lambda m: MembranePressure(membrane=m, pressure=1.0, surfaceOffset=-1), ValueError, "MembranePressure.surfaceOffset = -1"),
	(lambda m: MembranePressure(ids=[0, 1, 2], triangles=[(0, 1, 2)], pressure=1.0, surfaceOffset=-2), ValueError, "MembranePressure.surfaceOffset = -2"),
	(lambda m: MembranePressure(membrane=m, pressure=1.0, timeConstant=-0.1), ValueError, "MembranePressure.timeConstant = -0.1"),
	(lambda m: MembranePressure(membrane=m, pressure=1.0, timeConstant=1e-12), ValueError, "MembranePressure.timeConstant = 1e-12: is shorter than two"),
	(lambda m: MembranePressure(membrane=m, pressure=1.0, timeConstant=1.0, maxFactor=1.0), ValueError, "MembranePressure.maxFactor = 1"),
	(lambda m: MembranePressure(ids=[0, 1, 2], triangles=[(0, 1, 2)], pressure=1.0, surface="centre", timeConstant=0.1), ValueError, "MembranePressure.timeConstant = 0.1"),
]


@pytest.mark.parametrize("make, kind, message", BAD, ids=[b[2] for b in BAD])
def test_badInput(O, tier, make, kind, message):
	m = makeMembrane()
	pressure = make(m)
	O.engines = engines(tier, [slack(m), pressure])
	with pytest.raises(kind) as error:
		O.step()
	assert message in str(error.value) and "fix:" in str(error.value)
	with pytest.raises(RuntimeError, match="run a step first"):
		pressure.resultant


def test_meshOfABodyThatIsNotThere(O):
	makeMembrane()
	with pytest.raises(RuntimeError, match="body 99999.*fix: "):
		MembranePressure(ids=[0, 1, 99999], triangles=[(0, 1, 2)], pressure=1.0, surface="centre")()


def test_erasedBodyIsNamed(O, tier):
	m = makeMembrane()
	O.engines = engines(tier, [slack(m), MembranePressure(membrane=m, pressure=P)])
	O.dt = 1e-8
	run(2)
	O.bodies.erase(m.ids[150])
	with pytest.raises(RuntimeError, match=r"body %d .*gone.*; fix: " % m.ids[150]):
		O.step()


@pytest.mark.parametrize("kind", [MembranePressure, MembraneRadialServo], ids=["pressure", "servo"])
def test_aRampIsACosineAndGoesOnAfterALoad(O, tier, kind, tmp_path):
	"""From 0 to P, then to 3 P before the first ramp has ended: the two add up. The force is linear in the pressure."""
	m = makeMembrane(platenRows=1)
	O.engines = engines(tier, [slack(m), kind(membrane=m, pressure=P, rampTime=40e-9)])
	O.dt = 1e-9
	index = m.ids[m.perRing * (m.rings // 2 if kind is MembranePressure else m.oRingRows)]
	ramp = lambda age: 0.5 * (1 - np.cos(np.pi * min(max(age, 0), 40) / 40))
	found = {}
	for step in range(71):
		if step == 20:
			find(kind).pressure = 3 * P
			O.save(str(tmp_path / "ramp.yade.gz"))
			O.load(str(tmp_path / "ramp.yade.gz"))
		run(1)
		found[step] = np.linalg.norm(forcesOn([index])[0])
	full = found[70]
	expected = np.array([(ramp(step) + 2 * ramp(step - 20)) / 3 for step in found])
	assert np.array(list(found.values())) / full == pytest.approx(expected, abs=1e-7)  # the particles move a little meanwhile
	if kind is MembranePressure:
		assert find(kind).applied == 3 * P
		find(kind).pressure = P
		assert find(kind).applied == 3 * P  # not before a step
	find(kind).rampTime = -1.0
	with pytest.raises(ValueError, match=f"{kind.__name__}.rampTime = -1"):
		O.step()


def test_rampOnAMeshOfOnesOwn(O):
	corners = [(0, 0, 0), (1, 0, 0.1), (0, 1, 0), (0.2, 0.1, 1)]
	ids = O.bodies.append([utils.sphere(c, 0.1) for c in corners])
	triangles = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
	pressure = MembranePressure(ids=ids, triangles=triangles, pressure=P, surface="centre", rampTime=20e-12)
	O.engines = [ForceResetter(), pressure, NewtonIntegrator()]
	O.dt = 1e-12
	run(1)
	assert pressure.applied == 0 and np.abs(forcesOn(ids)).max() == 0
	run(10)
	assert pressure.applied == pytest.approx(P / 2)
	run(20)
	assert pressure.applied == P
