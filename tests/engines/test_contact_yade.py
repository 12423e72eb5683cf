# SPDX-License-Identifier: GPL-2.0-or-later
"""The contact laws against YADE's own where the two coincide (reference tier), and against themselves: swapped ids, saved and loaded, energy."""

import math

import numpy as np
import pytest
from contactScene import DENSITY, EMOD, FRICTION, KRATIO, ROLLING, apart, floor, force, material, pair, referenceEngines, sphere, swarm, torque
from tiers import TIERS, contact, engines, run, state, writeContacts
from yade import (
	CohFrictMat,
	Ig2_Sphere_Sphere_ScGeom6D,
	InteractionLoop,
	Ip2_CohFrictMat_CohFrictMat_CohFrictPhys,
	Law2_ScGeom6D_CohFrictPhys_CohesionMoment,
	Law2_ScGeom_FrictPhys_CundallStrack,
)

RADIUS = 1e-3
DT = 5e-7  # 0.05 of sqrt(m/kn)
STEPS = 2500  # the swarm meets, collides and parts


def untilContacts(O, wanted, least=3):
	"""Runs until that many contacts are as wanted; returns all contacts' phys."""
	for _ in range(STEPS // 10):
		run(10)
		writeContacts()
		phys = [i.phys for i in O.interactions if i.isReal]
		if sum(map(wanted, phys)) >= least:
			return phys
	raise AssertionError("there were never %d such contacts" % least)


def relative(a, b):
	"""Largest difference of positions, of velocities and of spins, each over the largest of its kind; NaN anywhere makes it NaN."""
	parts = [slice(0, 3), slice(3, 6), slice(6, 9)]
	return float(np.max([np.abs(a[:, p] - b[:, p]).max() / np.abs(b[:, p]).max() for p in parts]))


def test_helperSeesDifferences():
	a = np.ones((2, 9))
	assert relative(a, a) == 0 and relative(a * (1 + 1e-9), a) > 0.9e-9
	b = a.copy()
	b[1, 7] = math.nan
	assert not relative(b, a) < 1


def collide(O, stock=False, **changes):
	material(**changes)
	swarm()
	O.engines = referenceEngines(ratcheting=True, stock=stock)
	O.dt = DT
	run(STEPS)
	return state()


def test_linearAsCundallStrack(O):
	"""YADE's law takes our contacts (a LinearPhys is a FrictPhys) and, without rolling resistance, makes the same of them; any radii."""
	ours = collide(O, rollingFriction=0)
	O.reset()
	material(rollingFriction=0)
	swarm()
	start = state()
	O.engines = referenceEngines(ratcheting=True)
	O.dt = DT
	functors = O.engines[2]
	O.engines = [
		*O.engines[:2],
		InteractionLoop(functors.geomDispatcher.functors, functors.physDispatcher.functors, [Law2_ScGeom_FrictPhys_CundallStrack()]),
		O.engines[3],
	]
	run(STEPS)
	assert relative(ours, state()) < 1e-10
	assert np.abs(ours[:, 6:] - start[:, 6:]).max() > 0.1 * np.abs(start[:, 6:]).max()  # they did collide
	# and it is sensitive: rolling resistance changes it
	O.reset()
	assert relative(collide(O), ours) > 1e-3


@pytest.mark.parametrize("changes", (dict(), dict(friction=0, rollingFriction=0)))
def test_ourGeometryIsYades(O, changes):
	"""The lean Ig2 against YADE's: the same motion to the last bit, also where it leaves out what frictionless contacts do not need."""
	ours = collide(O, **changes)
	O.reset()
	assert (collide(O, stock=True, **changes) == ours).all()


def test_frictionlessContactsAreLean(O):
	material(friction=0, rollingFriction=0)
	a, b = pair(RADIUS, RADIUS, 1e-6, velocity=(0.01, 0, 0))
	O.engines = referenceEngines()
	O.dt = DT
	run(5)
	contact = O.interactions[a, b]
	assert contact.geom.shearInc.norm() == 0 and contact.geom.penetrationDepth == pytest.approx(1e-6, rel=1e-3)
	contact.phys.tangensOfFrictionAngle = 0.4
	O.step()
	assert contact.geom.shearInc[0] == pytest.approx(0.01 * DT, rel=1e-3)
	assert contact.phys.shearForce[0] == pytest.approx(-contact.phys.ks * 0.01 * DT, rel=1e-3)


def cohesive(O, radii):
	"""YADE's cohesive-frictional law with moments, not cohesive, incremental, matched: kn = E R, kr = alpha R^2 ks = ks (R/2)^2, cap eta R Fn = mu_r R/2 Fn."""
	O.materials.append(
		CohFrictMat(
			young=0.5 * math.pi * EMOD,
			poisson=1 / KRATIO,
			frictionAngle=math.atan(FRICTION),
			density=DENSITY,
			isCohesive=False,
			momentRotationLaw=True,
			alphaKr=0.25,
			alphaKtw=0,
			etaRoll=0.5 * ROLLING,
			etaTwist=0,
		)
	)
	swarm(radii=radii)
	O.engines = referenceEngines()
	O.dt = DT
	O.engines = [
		*O.engines[:2],
		InteractionLoop(
			[Ig2_Sphere_Sphere_ScGeom6D()],
			[Ip2_CohFrictMat_CohFrictMat_CohFrictPhys()],
			[Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True, useIncrementalForm=True)],
		),
		O.engines[3],
	]
	run(STEPS)
	return state()


def test_rollingResistanceAsYadesCohesiveFrictional(O):
	"""Equal radii: the same to rounding. Unequal radii: not, as YADE takes kn from E1 R1 and E2 R2, kr from R1 R2 and the cap from the smaller radius."""
	equal, unequal = (RADIUS, RADIUS), (0.8 * RADIUS, 1.2 * RADIUS)
	for radii in (equal, unequal):
		O.reset()
		material()
		swarm(radii=radii)
		O.engines = referenceEngines(ratcheting=True)
		O.dt = DT
		run(STEPS)
		ours = state()
		O.reset()
		difference = relative(ours, cohesive(O, radii))
		if radii == equal:
			assert difference < 1e-10
		else:
			assert difference > 1e-3


def test_coefficientsWhereTheLawsDiffer(O):
	"""Radii 1 and 3: kn pi E*/4 R1 against YADE's 2 E R1 R2/(R1+R2), with E = pi E*/2 the same for equal radii."""
	material()
	a, b = pair(RADIUS, 3 * RADIUS, 1e-6)
	O.engines = referenceEngines()
	O.dt = 1e-9
	O.step()
	phys = O.interactions[a, b].phys
	assert phys.kn == pytest.approx(math.pi * EMOD * RADIUS / 4, rel=1e-12)
	young = O.materials[0].young
	assert young == pytest.approx(0.5 * math.pi * EMOD, rel=1e-15) and O.materials[0].poisson == 1 / KRATIO
	stock = 2 * young * RADIUS * 3 * RADIUS / (4 * RADIUS)
	assert stock == pytest.approx(3 * phys.kn, rel=1e-12)
	assert phys.kr == pytest.approx(phys.ks * (0.75 * RADIUS) ** 2, rel=1e-12) and phys.rollingArm == pytest.approx(ROLLING * 0.75 * RADIUS, rel=1e-12)


def test_swappedIdsGiveTheSame(O, tier):
	"""The first and the second body of a contact have no meaning: bodies appended in reverse, the same motion but for the order of sums."""
	found = []
	for order in (None, list(range(39, -1, -1))):
		O.reset()
		material()
		places = swarm(keep=order)
		O.engines = engines(tier, substeps=100)
		O.dt = DT
		run(STEPS)
		found.append(state(places))
	assert relative(*found) < 1e-9  # rounding, grown in collisions


def test_actionIsReaction(O, tier):
	"""No external force: momentum and angular momentum stay, with friction, rolling moments and platen-free contacts."""
	material()
	swarm()
	O.engines = engines(tier, substeps=100)
	O.dt = DT

	def momenta():
		bodies = [(b.state.mass, np.array(b.state.pos), np.array(b.state.vel), b.state.inertia[0] * np.array(b.state.angVel)) for b in O.bodies]
		return sum(m * v for m, _, v, _ in bodies), sum(m * np.cross(x, v) + s for m, x, v, s in bodies)

	before, start = momenta(), state()
	run(STEPS)
	for now, then, scale in zip(momenta(), before, (4e-4, 4e-7)):
		assert np.abs(now - then).max() < 1e-11 * scale
		assert scale > np.linalg.norm(then)
	assert relative(state(), start) > 0.1  # they did collide


def test_platenTorqueIsThatOfTheForceAtThePoint(O, tier):
	material()
	plate = floor()
	ball = sphere((0.3, 0, 0.99 * RADIUS), RADIUS, fixed=True)
	O.bodies[ball].state.vel = (0, 0.1, 0)
	O.engines = engines(tier)
	O.dt = DT
	run(20)
	pushed = np.array(force(ball))
	assert abs(pushed[1]) > 0 and np.all(np.array(force(plate)) == -pushed)
	arm = np.array(contact(plate, ball).geom.contactPoint) - np.array(O.bodies[plate].state.pos)
	assert apart(torque(plate), np.cross(arm, -pushed)) < 1e-12 * np.linalg.norm(pushed)


def test_savedAndLoadedMidRunIsTheSameRun(O, tier, tmp_path):
	material(cbTensile=1.0, cbShear=0.1)
	swarm()
	O.bodies[floor(face=(0, 0, -5.5e-3))].state.vel = (0, 0, 4)  # follows the lowest of them
	O.dt = DT
	O.engines = engines("reference", damping=0.1, bonds=True)
	untilContacts(O, lambda p: p.bonded)
	if tier == "compact":
		O.engines = engines(tier, damping=0.1)
	phys = untilContacts(O, lambda p: p.shearForce.norm() > 0 and not p.bonded and p.moment.norm() > 0)
	assert any(p.bonded for p in phys) and not all(p.spheres for p in phys)
	file = str(tmp_path / "half.yade.gz")
	O.save(file)
	run(1000)
	whole = state()
	O.reset()
	O.load(file)
	run(1000)
	if O.numThreads == 1:
		assert (state() == whole).all()
	else:
		assert relative(state(), whole) < 1e-6


#: damping of NewtonIntegrator, what changes in the material
BALANCES = {
	"friction": (0.0, dict(rollingFriction=0)),
	"rolling": (0.0, dict()),
	"rolling and damping": (0.2, dict()),
	"bonds": (0.0, dict(cbTensile=0.05, cbShear=0.05)),
}


@pytest.mark.parametrize("tier, case", [(tier, case) for tier in TIERS for case in BALANCES if (tier, case) != ("compact", "bonds")])
def test_energyBalanceCloses(O, tier, case):
	"""kinetic + elastic + sliding + rolling + broken bonds + damping stays what it was: what is off comes from the step alone and goes with it."""
	damping, changes = BALANCES[case]
	bonds = "cbShear" in changes  # of new contacts: the reference tier's alone
	drifts = []
	for refine in (1, 4):
		O.reset()
		material(**changes)
		swarm(spin=1000)
		O.engines = engines(tier, damping=damping, bonds=bonds, substeps=100)
		O.trackEnergy = True
		O.dt = DT / refine
		run(1)
		start = O.energy.total()
		assert start == O.energy["kinetic"] > 0
		run(STEPS * refine)
		energy = dict(O.energy.items())
		drifts.append(abs(O.energy.total() - start) / start)
		assert energy["plastDissip"] > 0.02 * start
		assert (energy["rollDissip"] > 1e-3 * start) == ("rollingFriction" not in changes)
		assert (energy["bondDissip"] > 1e-3 * start) == bonds
		assert (energy.get("nonviscDamp", 0) > 0.02 * start) == (damping > 0)
	# Measured: see pkg/contact/README.md.
	assert drifts[0] < 0.01 and drifts[1] < 0.4 * drifts[0], drifts


def test_energyIsTheContacts(O, tier):
	"""'elastPotential' = sum of (Fn^2/kn + Fs^2/ks + M^2/kr)/2 over the contacts."""
	material()
	swarm()
	O.engines = engines(tier, substeps=10)
	O.dt = DT
	O.trackEnergy = True
	phys = untilContacts(O, lambda p: p.shearForce.norm() > 0 and p.moment.norm() > 0)
	elastic = sum(0.5 * (p.normalForce.squaredNorm() / p.kn + p.shearForce.squaredNorm() / p.ks + p.moment.squaredNorm() / p.kr) for p in phys)
	assert O.energy["elastPotential"] == pytest.approx(elastic, rel=1e-12)
