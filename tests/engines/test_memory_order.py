# SPDX-License-Identifier: GPL-2.0-or-later
"""MemoryOrder: nothing but the order of memory and of sums is changed."""

import numpy as np
import pytest
import yade
from specimenScene import build
from tiers import run, state


def insert(O, **settings):
	O.engines = [O.engines[0], yade.MemoryOrder(**settings), *O.engines[1:]]


def attributes(thing):
	"""All attributes, also those that are not saved."""
	found = dict(thing.dict())
	for name in ("penetrationDepth", "shearInc"):
		if hasattr(thing, name):
			found[name] = getattr(thing, name)
	return found


def everything(O):
	"""Attributes of all bodies and interactions, by id."""
	bodies = {}
	for b in O.bodies:
		own = {k: v for k, v in b.dict().items() if k not in ("state", "shape", "bound", "material")}
		box = dict(b.bound.dict(), min=b.bound.min, max=b.bound.max) if b.bound else None
		bodies[b.id] = (own, b.state.dict(), b.shape.dict(), box, b.material.id)
	contacts = {}
	for i in O.interactions.all(onlyReal=False):
		own = {k: v for k, v in i.dict().items() if k not in ("geom", "phys")}
		parts = [attributes(part) if part else None for part in (i.geom, i.phys)]
		contacts[i.id1, i.id2] = (own, i.isActive, *parts)
	return bodies, contacts


def test_keepsEverything(O):
	build("reference", spin=0.05)
	run(60)
	O.interactions[next((i.id1, i.id2) for i in O.interactions)].isActive = False
	before = repr(everything(O)[0]), {k: repr(v) for k, v in everything(O)[1].items()}
	order = [(i.id1, i.id2) for i in O.interactions]
	engine = yade.MemoryOrder()
	engine()
	assert engine.moved == sum(isinstance(b.shape, yade.Sphere) for b in O.bodies) + len(O.interactions.all(onlyReal=False))
	after = repr(everything(O)[0]), {k: repr(v) for k, v in everything(O)[1].items()}
	assert after == before
	assert len(O.bodies[0].intrs()) == sum(0 in (i.id1, i.id2) for i in O.interactions)
	assert sorted(order) == sorted((i.id1, i.id2) for i in O.interactions)
	assert order != [(i.id1, i.id2) for i in O.interactions]


def test_neighboursInMemory(O):
	"""Interactions follow each other along space: a walk over them is shorter than in the order in which the collider found them."""

	def walk():
		middles = np.array([i.geom.contactPoint for i in O.interactions])
		return np.linalg.norm(np.diff(middles, axis=0), axis=1).sum()

	build("reference", grains=600)
	run(60)
	before = walk()
	yade.MemoryOrder()()
	assert walk() < 0.7 * before


def test_whatIsHeldStays(O):
	"""A script's handles are still those of the scene."""
	build("reference", spin=0.05)
	run(40)
	pair = next((i.id1, i.id2) for i in O.interactions)
	body, held, interaction, physics = O.bodies[3], O.bodies[5].state, O.interactions[pair], O.interactions[pair].phys
	yade.MemoryOrder()()
	run(5)
	assert body == O.bodies[3] and body.state == O.bodies[3].state
	held.vel = (1, 2, 3)
	assert O.bodies[5].state.vel == (1, 2, 3)
	assert interaction == O.interactions[pair] and physics == O.interactions[pair].phys


def test_runGoesOnWithinRounding(O):
	found = []
	for settings in (dict(dead=True), dict(iterPeriod=25)):
		O.reset()
		build("reference", spin=0.05, velocity=0.05)
		insert(O, **settings)
		run(150)
		found.append(state())
	scale = np.abs(found[0]).max(axis=0)
	assert (np.abs(found[1] - found[0]).max(axis=0) <= 1e-9 * scale).all()
	assert not (found[1] == found[0]).all()  # the engine has acted: sums have another order


@pytest.mark.parametrize("lateral", ["membrane", "wall"])
def test_saveAndLoadGoOnExactly(O, tmp_path, lateral):
	"""Sorted in every step, since YADE itself does not repeat the order in which its collider finds new contacts after a load."""
	build("reference", lateral=lateral, spin=0.05)
	insert(O, iterPeriod=1)
	run(60)
	file = str(tmp_path / "state.yade.gz")
	O.save(file, quiet=True)
	run(60)
	whole = state()
	O.load(file, quiet=True)
	run(60)
	assert (state() == whole).all()


def test_periodGoesOnAfterLoad(O, tmp_path):
	build("reference")
	insert(O, iterPeriod=40, initRun=False)
	run(100)
	file = str(tmp_path / "state.yade.gz")
	O.save(file, quiet=True)
	O.load(file, quiet=True)
	done = O.engines[1].nDone
	run(19)
	assert O.engines[1].nDone == done
	run(2)
	assert O.engines[1].nDone == done + 1


@pytest.mark.filterwarnings("ignore:dynamic=False:DeprecationWarning")  # YADE's own module
def test_shapesThatHoldBodiesStay(O):
	"""A grid's connections hold their nodes: they are left alone, with all that touches them."""
	import yade.gridpfacet as grid

	O.materials.append(yade.CohFrictMat(young=1e6, poisson=0.3, density=1000, frictionAngle=0.3, momentRotationLaw=True, isCohesive=True))
	O.engines = [
		yade.InteractionLoop(
			[yade.Ig2_GridNode_GridNode_GridNodeGeom6D()],
			[yade.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True)],
			[yade.Law2_ScGeom6D_CohFrictPhys_CohesionMoment()],
		)
	]
	nodes = [O.bodies.append(grid.gridNode((x, 0, 0), 1e-3)) for x in (0, 0.01)]
	connection = O.bodies.append(grid.gridConnection(*nodes, 1e-3))
	O.bodies.append(yade.utils.sphere((0.005, 0, 0.003), 1e-3))
	engine = yade.MemoryOrder()
	engine()
	assert engine.moved == 1
	assert O.bodies[connection].shape.node1 == O.bodies[nodes[0]] and O.bodies[connection].shape.node2 == O.bodies[nodes[1]]


def test_emptyScene(O):
	engine = yade.MemoryOrder()
	engine()
	assert engine.moved == 0
