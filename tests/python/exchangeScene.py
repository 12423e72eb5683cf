# SPDX-License-Identifier: GPL-2.0-or-later
"""Balls pressed together between platens, and the tables of two cycles of theirs: the states that the tests of the exchange with PFC take."""

import math

import numpy
import yade
from hexmembrane.exchange import scenes
from hexmembrane.scene.builder import boxes, interactionLoop
from hexmembrane.scene.platens import platen
from yade import utils

#: Of the balls towards one another [m/s]; their local damping.
SPEED, DAMP = 0.05, 0.7
_STEPS = 900


def collide(O, springs, bonds, cement=False):
	"""Balls that are pressed together between two platens, in the reference tier; bonded while they move, where they are cemented, across gaps too."""
	O.reset()
	strength = 5.0 if bonds else 0.0
	O.materials.append(yade.LinearMat(friction=0.4, rollingFriction=0.0 if bonds or cement else 0.3, density=2650, cbTensile=strength, cbShear=strength, label="grain", **springs))
	O.materials.append(yade.LinearMat(kn=1e6, ks=5e5, friction=0.2, density=2650, label="platen"))
	random = numpy.random.default_rng(1)
	for place in numpy.argwhere(numpy.ones((4, 4, 4))):
		radius = 1e-3 * random.uniform(0.8, 1.0)
		ball = O.bodies.append(utils.sphere(tuple(1.9e-3 * place + random.uniform(-5e-5, 5e-5, 3)), radius, material="grain"))
		O.bodies[ball].state.vel = tuple(SPEED * (1.5 - place) + random.uniform(-1e-2, 1e-2, 3))
		O.bodies[ball].state.angVel = tuple(random.uniform(-5, 5, 3))
	for height, facing in ((-0.95e-3, 1), (6.6e-3, -1)):
		wall = O.bodies.append(platen((2.8e-3, 2.8e-3, height), 2e-2, 5e-3, facing=facing, material="platen"))
		O.bodies[wall].state.vel = (0, 0, SPEED * facing)
	loop = interactionLoop()
	loop.physDispatcher.functors[0].bondNewContacts = bonds
	collider = yade.InsertionSortCollider(boxes(), verletDist=1e-4)
	O.engines = [yade.ForceResetter(), collider, loop, yade.NewtonIntegrator(damping=DAMP)]
	O.dt = 4e-6
	for step in range(_STEPS):
		if cement and step == _STEPS // 2:
			cementWith(O, loop)
		O.step()
	loop.physDispatcher.functors[0].bondNewContacts = False


def cementWith(O, loop):
	"""Parallel bonds of two strengths, some of which break."""
	kinds = [yade.GrainBonds(emod=2e7, kratio=2, radiusMultiplier=0.8, tensileStrength=2e6, cohesion=1e6, frictionAngle=0.5, momentFactor=0.3)]
	kinds.append(yade.GrainBonds(kn=1e10, ks=4e9, tensileStrength=math.inf, cohesion=math.inf))
	assert kinds[0].bond(range(32), gap=4e-5) > 10 and kinds[1].bond(range(32, 64), gap=4e-5) > 10
	before = O.engines.index(loop) + 1
	O.engines = [*O.engines[:before], *kinds, *O.engines[before:]]


def _flatten(O):
	"""Shear forces have no part along the normal, as PFC's: the law lets a load that turns keep one of second order."""
	for contact in O.interactions:
		contact.phys.shearForce -= contact.phys.shearForce.dot(contact.geom.normal) * contact.geom.normal


def cycle(O, folder, number):
	"""One step in PFC's order, the motion first; the tables as they are then."""
	engines = list(O.engines)
	O.engines = [yade.NewtonIntegrator(damping=engines[-1].damping, warnNoForceReset=False)]
	O.step()
	O.engines = engines[:-1]
	O.step()
	O.engines = engines
	_flatten(O)
	folder.mkdir()
	scenes.write(folder, moved=False)
	for path in folder.iterdir():  # YADE's number has gone up by two
		path.write_text(path.read_text().replace(f"cycle={O.iter} ", f"cycle={number} "))


def cycles(O, springs, bonds, cement, folders):
	"""Collide, and leave the tables of a cycle in each folder; the scene's engines are as before."""
	collide(O, springs, bonds, cement)
	engines = list(O.engines)
	_flatten(O)
	O.engines = engines[:-1]
	O.step()
	O.engines = engines
	for number, folder in enumerate(folders, 1):
		cycle(O, folder, number)


def states(O, first, second):
	"""Tables of cemented balls in two folders, a cycle apart; leaves the scene empty."""
	cycles(O, {"kn": 2e5, "ks": 1e5}, False, True, (first, second))
	O.reset()
