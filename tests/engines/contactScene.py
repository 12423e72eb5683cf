# SPDX-License-Identifier: GPL-2.0-or-later
"""Few bodies that the tests of contact laws, platens and wall share."""

import math

import hexmembrane  # noqa: F401
import numpy as np
import tiers
import yade
from hexmembrane.scene.platens import platen
from yade import LinearMat, O, utils

EMOD, KRATIO, FRICTION, ROLLING, DENSITY = 1e8, 3.0, 0.4, 0.5, 2650.0
SOIL = dict(emod=EMOD, kratio=KRATIO, friction=FRICTION, rollingFriction=ROLLING, density=DENSITY)


def material(**changes):
	"""Appends the material of the tests, with changes (None takes a value away); returns it."""
	values = {name: value for name, value in {**SOIL, **changes}.items() if value is not None}
	O.materials.append(LinearMat(**values))
	return O.materials[-1]


def springs(kn=1e5, ks=5e4, friction=FRICTION, **changes):
	"""Appends a material of which every contact has these stiffnesses (N/m), whatever the radii: two springs in series."""
	return material(emod=None, kratio=None, kn=2 * kn, ks=2 * ks, friction=friction, **{"rollingFriction": None, **changes})


def referenceEngines(ratcheting=False, stock=False, bonds=False, damping=0.0, gravity=(0, 0, 0)):
	"""The reference tier's list, for what it alone has.

	:param ratcheting: YADE's shear increment instead of the true one at the contact point. :param stock: YADE's Ig2 for spheres.
	"""
	engines = tiers.engines("reference", damping=damping, bonds=bonds)
	kind = yade.Ig2_Sphere_Sphere_ScGeom if stock else yade.Ig2_Sphere_Sphere_LinearScGeom
	engines[2] = yade.InteractionLoop(
		[kind(avoidGranularRatcheting=ratcheting), yade.Ig2_Platen_Sphere_ScGeom()],
		[yade.Ip2_LinearMat_LinearMat_LinearPhys(bondNewContacts=bonds)],
		[yade.Law2_ScGeom_LinearPhys_Linear()],
	)
	engines[3].gravity = gravity
	return engines


def bonded(tier, reach=1.0):
	"""One step in which the reference tier bonds what touches, or is nearer than `reach` times the distance of touching; then the tier's engines."""
	O.engines = tiers.engines("reference", bonds=True)
	O.engines[1].boundDispatcher.functors[0].aabbEnlargeFactor = reach
	O.engines[2].geomDispatcher.functors[0].interactionDetectionFactor = reach
	O.step()
	if tier == "compact":
		O.engines = tiers.engines(tier)


def law():
	"""The reference tier's law."""
	return O.engines[2].lawDispatcher.functors[0]


def sphere(centre, radius, fixed=False):
	"""Appends a sphere, returns its id."""
	return O.bodies.append(utils.sphere(centre, radius, fixed=fixed))


def pair(r1, r2, overlap, direction=(0, 0, 1), velocity=(0, 0, 0)):
	"""Two spheres that only move as told; the second one lies in `direction` from the first and has `velocity`."""
	n = np.array(direction) / np.linalg.norm(direction)
	a, b = sphere((0, 0, 0), r1, fixed=True), sphere(tuple(n * (r1 + r2 - overlap)), r2, fixed=True)
	O.bodies[b].state.vel = velocity
	return a, b


def floor(radius=1.0, height=0.1, face=(0, 0, 0)):
	"""Appends a platen whose upper face lies at `face`, returns its id."""
	return O.bodies.append(platen(face, radius, height, +1))


def swarm(count=40, seed=1, radii=(0.8e-3, 1.2e-3), speed=1.0, spin=300.0, keep=None):
	"""Spheres that fly from a lattice towards its middle, spinning at random: many oblique collisions. `keep` changes the order of the ids."""
	random = np.random.default_rng(seed)
	side = math.ceil(count ** (1 / 3))
	places = [(i, j, k) for i in range(side) for j in range(side) for k in range(side)][:count]
	bodies = []
	for place in places:
		x = (np.array(place) - 0.5 * (side - 1)) * 2.3 * max(radii) + random.uniform(-1e-4, 1e-4, 3)
		body = utils.sphere(tuple(x), random.uniform(*radii))
		body.state.vel = tuple(-speed * x / (0.5 * side * 2.3 * max(radii)) + random.uniform(-0.1, 0.1, 3) * speed)
		body.state.angVel = tuple(random.uniform(-spin, spin, 3))
		bodies.append(body)
	order = range(count) if keep is None else keep
	for i in order:
		O.bodies.append(bodies[i])
	return [list(order).index(i) for i in range(count)]


def force(body):
	"""Force of the last step on a body."""
	return O.forces.f(body, sync=True)


def torque(body):
	"""Torque of the last step on a body."""
	return O.forces.t(body, sync=True)


def apart(a, b):
	return float(np.linalg.norm(np.array(a) - np.array(b)))
