# SPDX-License-Identifier: GPL-2.0-or-later
"""One test body for both tiers: the list of engines round the same inner ones, steps, and what a test looks at.

The fixture `tier` (tests/conftest.py) gives a test each of :data:`TIERS` in turn::

	def test_something(O, tier):
		...  # bodies of LinearMat
		drive = PlatenDrive(...)
		O.engines = engines(tier, [drive], damping=0.2)
		run(100)
		assert contact(a, b).phys.kn == ...

A test of a stock law, or of what the compact tier refuses (gravity in NewtonIntegrator, periodic cells, clumps), stays in the reference
tier and says why.
"""

import numpy as np
import yade
from yade import O

TIERS = ("reference", "compact")


def engines(tier, inner=(), damping=0.0, substeps=1, before=(), after=(), verlet=0.05, bonds=False):
	"""The list of engines of a tier, for O.engines.

	:param tier: one of :data:`TIERS`. :param inner: engines of membrane and boundaries, the same objects in either tier.
	:param substeps: steps of one O.step() in the compact tier; 1 is what the reference tier does.
	:param before: engines that add forces before the contacts are computed. :param after: engines that look at the end of a step.
	:param verlet: reach of the reference tier's collider over the smallest sphere's radius. :param bonds: bond new contacts; reference tier only.
	"""
	if tier == "compact":
		assert not bonds, "contacts are bonded in the reference tier and taken over"
		middle = [yade.CompactLoop(engines=list(inner), damping=damping, substeps=substeps)]
	else:
		middle = [
			yade.InsertionSortCollider(
				[yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb(), yade.Bo1_CylinderWall_Aabb()], verletDist=-verlet, avoidSelfInteractionMask=2
			),
			yade.InteractionLoop(
				[
					yade.Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False),
					yade.Ig2_Platen_Sphere_ScGeom(),
					yade.Ig2_CylinderWall_Sphere_ScGeom(),
				],
				[yade.Ip2_LinearMat_LinearMat_LinearPhys(bondNewContacts=bonds)],
				[yade.Law2_ScGeom_LinearPhys_Linear()],
			),
			*inner,
			yade.NewtonIntegrator(damping=damping),
		]
	return [yade.ForceResetter(), *before, *middle, *after]


def loop():
	"""The compact tier's engine in the scene, None in the reference tier."""
	return next((engine for engine in O.engines if isinstance(engine, yade.CompactLoop)), None)


def find(kind):
	"""The one engine of this class, wherever its tier keeps it: of use after O.load, when handles are of the scene before."""
	(found,) = [engine for engine in [*O.engines, *(loop().engines if loop() else ())] if isinstance(engine, kind)]
	return found


def run(steps):
	"""That many steps in either tier, in the compact one in iterations of its `substeps`.

	No O.run: its wait takes 20 ms and can lose an error.
	"""
	compact, end = loop(), O.iter + steps
	wished = compact and compact.substeps
	try:
		while O.iter < end:
			if compact:
				compact.substeps = min(wished, end - O.iter)
			O.step()
	finally:
		if compact:
			compact.substeps = wished
	assert O.iter == end


def writeContacts():
	"""Make O.interactions hold the contacts of the last step; the reference tier's do anyway, and so do those that were not taken over yet."""
	if loop() and loop().listsMade:
		loop().exportContacts()


def contact(a, b):
	"""The contact of two bodies as of the last step, None when they do not touch."""
	writeContacts()
	return O.interactions[a, b] if O.interactions.has(a, b, True) else None


def state(ids=None):
	"""Positions, velocities and spins, one row a body; of all that were not erased when no ids are given."""
	bodies = O.bodies if ids is None else (O.bodies[i] for i in ids)
	return np.array([tuple(b.state.pos) + tuple(b.state.vel) + tuple(b.state.angVel) for b in bodies])


def forces(ids=None):
	"""Forces and torques of the last step, one row a body."""
	ids = [b.id for b in O.bodies] if ids is None else ids
	return np.array([tuple(O.forces.f(i)) + tuple(O.forces.t(i)) for i in ids])
