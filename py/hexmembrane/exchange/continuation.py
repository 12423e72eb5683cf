# SPDX-License-Identifier: GPL-2.0-or-later
"""Going on from a state's tables: balls with their velocities, contacts with forces, moments and bonds, parallel bonds, flat walls, materials of the contacts' properties.

A cycle of PFC ends with the forces, a step of YADE with the motion. So the last thing done here is the motion that the state's forces cause.
"""

import numpy
import yade
from yade import O, utils

from hexmembrane.configuration import ConfigError
from hexmembrane.exchange import bonds, comparison, materials, scenes, tables
from hexmembrane.scene.builder import boxes, interactionLoop

#: Relative difference of planes that count as one.
_SAME = 1e-6
_PLANES = 2000
#: A ball that reaches through a wall by more than this share of its radius is behind it.
_BEHIND = 0.5


def resume(state, damping=0.0):
	"""Bring the state into YADE's empty scene, with the engines of the reference tier, one motion later than its tables.

	Materials are those of :func:`hexmembrane.exchange.materials.materialsOf`. Each plane that a wall's contacts show is a fixed ``Platen`` with the wall's velocity.
	Parallel bonds are in engines of ``GrainBonds``, one for each set of strengths.

	:param state: :class:`hexmembrane.exchange.tables.State`, see :func:`hexmembrane.exchange.tables.read`. :param damping: PFC's damp, local damping.
	:returns: ids of bodies, by PFC's number of the ball.
	:raises ConfigError: contacts of one pair of materials have different properties, bonds have too many sets of strengths, a wall is not convex, or the tables
		lack velocities, density or the timestep.
	"""
	if len(O.bodies):
		raise RuntimeError(f"O.bodies = {len(O.bodies)} bodies: an empty scene is needed; fix: O.reset() first")
	_require(state)
	contacts = state.contacts
	made, pairs, labels = materials.materialsOf(state)
	common = float(state.balls["density"][0])
	for label, properties in made.items():
		O.materials.append(yade.LinearMat(label=label, density=common, **properties))
	for (one, two), properties in pairs.items():
		O.materials[one].setPair(two, **properties)
	bodies = scenes.appendBalls(state.balls, labels, dynamic=True)
	for body, density in zip(bodies.values(), state.balls["density"].tolist()):
		moving = O.bodies[body].state
		factor = density / common
		moving.mass, moving.inertia = factor * moving.mass, factor * moving.inertia
	planes = _planes(state)
	O.engines = [yade.ForceResetter(), interactionLoop()]
	_, shear = scenes.split(contacts)
	moments = numpy.nan_to_num(contacts.vectors("m"))
	for k, kind in enumerate(contacts["kind"]):
		first = bodies[contacts["end1"][k]]
		second = bodies[contacts["end2"][k]] if kind == tables.BALL_BALL else planes[k]
		contact = utils.createInteraction(first, second)
		if contacts["cb_state"][k] == tables.BONDED:
			contact.phys.bond(float(contacts["cb_tenf"][k]), float(contacts["cb_shearf"][k]))
		scenes.setMemory(contact, first, shear[k], moments[k])
	_move(state, bodies, damping, bonds.engines(state, bodies)[0])
	return bodies


def _require(state):
	if any(model not in comparison.MODELS for model in state.contacts["model"]):
		raise ConfigError("contacts.csv", sorted(set(state.contacts["model"])), "has a contact model that is not here", f"contacts of {', '.join(comparison.MODELS)}")
	for name in ("vx", "vy", "vz", "wx", "wy", "wz", "density"):
		if numpy.isnan(state.balls[name]).any():
			raise ConfigError("balls.csv", str(state.folder), f"has balls without {name}", "export velocities, spins and density")
	if not state.contacts.number("timestep") > 0:
		raise ConfigError("contacts.csv", str(state.folder), "names no timestep in its first line", "export it by scripts/pfc.d")


def _planes(state):
	"""Append a platen for each plane of the walls; the body of each contact with a wall, by its place in the table."""
	contacts, balls = state.contacts, state.balls
	rows = {number: k for k, number in enumerate(balls["id"].tolist())}
	centres, radii, normals = balls.vectors(), balls["r"], contacts.vectors("n")
	speeds = {} if state.walls is None else dict(zip(state.walls["id"].tolist(), state.walls.vectors("v").tolist()))
	mean, made, found = float(radii.mean()), {}, {}
	for k, kind in enumerate(contacts["kind"]):
		if kind == tables.BALL_BALL:
			continue
		ball, wall, normal = rows[contacts["end1"][k]], contacts["end2"][k], normals[k]
		offset = float(normal @ centres[ball]) + radii[ball] + contacts["gap"][k]
		key = (wall, *numpy.round(normal / _SAME).astype(int).tolist(), round(offset / (_SAME * mean)))
		if key not in made:
			behind = (centres @ normal + radii - offset) / radii
			if behind.max() > _BEHIND:
				wrong = f"ball {balls['id'][int(behind.argmax())]:g} is behind wall {wall:g}, which has the ball {contacts['end1'][k]:g} before it"
				raise ConfigError("walls.csv", str(state.folder), wrong, "walls that stand round the balls; leave others out of the export")
			if len(made) == _PLANES:
				raise ConfigError("walls.csv", str(state.folder), f"the walls have more than {_PLANES} planes", "walls of fewer facets")
			made[key] = _platen(centres, radii, normal, offset, f"wall-{wall:g}", speeds.get(wall, (0, 0, 0)))
		found[k] = made[key]
	return found


def _platen(centres, radii, normal, offset, material, velocity):
	"""A platen before all balls; its body's id."""
	middle = centres.mean(axis=0)
	middle = middle + (offset - normal @ middle) * normal
	reach = float((numpy.linalg.norm(centres - middle, axis=1) + radii).max())
	body = scenes.plate(middle - normal * reach / 3, reach / 3, normal, 0.0, O.materials[material])
	body.state.vel = yade.Vector3(*velocity)
	return O.bodies.append(body)


def _move(state, bodies, damping, cement):
	"""The state's forces, from contacts and bonds at rest, and the motion that they cause from the state's velocities; then the reference tier's engines."""
	O.engines = [*O.engines, *cement]
	O.dt = comparison.STILL
	O.step()
	speeds = zip(bodies.values(), state.balls.vectors("v").tolist(), state.balls.vectors("w").tolist())
	for body, velocity, spin in speeds:
		O.bodies[body].state.vel, O.bodies[body].state.angVel = yade.Vector3(*velocity), yade.Vector3(*spin)
	loop, motion = O.engines[1], yade.NewtonIntegrator(damping=damping, warnNoForceReset=False)
	O.dt = state.contacts.number("timestep")
	O.engines = [motion]
	O.step()
	motion.warnNoForceReset = True
	O.engines = [yade.ForceResetter(), yade.InsertionSortCollider(boxes(), verletDist=-0.1), loop, *cement, motion]
