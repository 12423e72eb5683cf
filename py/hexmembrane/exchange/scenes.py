# SPDX-License-Identifier: GPL-2.0-or-later
"""Tables of a state as bodies and contacts of YADE, and back.

Forces and moments of a contact are those on its second body, in YADE as in the tables; either may have the bodies the other way round.
"""

import math
import pathlib

import numpy
import yade
from yade import O, utils

from hexmembrane.exchange import bonds, tables
from hexmembrane.scene.handles import compactLoop
from hexmembrane.scene.platens import platen

_Z = yade.Vector3(0, 0, 1)


def appendBalls(balls, materials, dynamic):
	"""Spheres of a table; ids of bodies by PFC's id. ``materials``: that of each ball, as ``utils.sphere`` takes it."""
	made = []
	for centre, radius, material in zip(balls.vectors().tolist(), balls["r"].tolist(), materials):
		made.append(utils.sphere(tuple(centre), radius, material=material, fixed=not dynamic))
	return dict(zip(balls["id"].tolist(), O.bodies.append(made)))


def plate(centre, radius, normal, gap, material):
	"""A platen of its own for one contact of a ball with a wall, see :func:`placePlate`."""
	body = platen((0, 0, 0), 3 * radius, radius, facing=-1, material=material)
	placePlate(body, centre, radius, normal, gap)
	return body


def placePlate(body, centre, radius, normal, gap):
	"""Move a platen's face to the distance ``gap`` [m] from a ball, on the side of ``normal``."""
	axis = yade.Vector3(*normal)
	body.state.pos = yade.Vector3(*centre) + axis * (radius + gap + 0.5 * body.shape.height)
	body.state.ori.setFromTwoVectors(_Z, axis)


def setMemory(contact, first, shear, moment):
	"""Give a contact shear force [N] and moment [N m] on the table's second body; ``first``: the body that the table has first."""
	sign = 1 if contact.id1 == first else -1
	contact.phys.shearForce, contact.phys.moment = yade.Vector3(*(sign * shear)), yade.Vector3(*(sign * moment))


def memoryOf(contact, first):
	"""(normal force, > 0 in compression; shear force; moment; normal from the first body) as a table has them."""
	sign = 1 if contact.id1 == first else -1
	normal = numpy.array(contact.geom.normal)
	phys = contact.phys
	return float(numpy.dot(phys.normalForce, normal)), sign * numpy.array(phys.shearForce), sign * numpy.array(phys.moment), sign * normal


def split(contacts):
	"""Normal forces (N), > 0 in compression, and shear forces (N, 3) of a table of contacts."""
	forces, normals = contacts.vectors("f"), contacts.vectors("n")
	normal = (forces * normals).sum(axis=1)
	return normal, forces - normal[:, None] * normals


def write(folder, ids=None, moved=True):
	"""Write the tables of the scene in ``O``: forces as last computed, with the places that they were computed for.

	:param folder: an existing folder. :param ids: bodies of the balls; None: all spheres. Contacts are those among them and with bodies that are no spheres.
	:param moved: whether the bodies have moved since the forces were computed, as they have after a whole step; places are then those before that.
	:raises OSError: a file cannot be written. :raises ValueError: a body or contact is of another kind. :raises RuntimeError: the compact tier has not taken a step.
	"""
	loop = compactLoop()
	if loop is not None:
		loop.exportContacts()
	spheres = {body.id for body in O.bodies if isinstance(body.shape, yade.Sphere)} if ids is None else set(ids)
	back = O.dt if moved else 0.0
	head = {"cycle": O.iter, "timestep": repr(float(O.dt)), "time": repr(float(O.time)), "code": "YADE"}
	found = [contact for contact in O.interactions if contact.isReal and (contact.id1 in spheres or contact.id2 in spheres)]
	found = [contact for contact in found if {contact.id1, contact.id2} <= spheres or not all(isinstance(O.bodies[k].shape, yade.Sphere) for k in (contact.id1, contact.id2))]
	walls = sorted({k for contact in found for k in (contact.id1, contact.id2)} - spheres)
	folder = pathlib.Path(folder)
	tables.write(folder, "balls", [_ball(O.bodies[k], back) for k in sorted(spheres)], head)
	numbers = {frozenset((contact.id1, contact.id2)): k + 1 for k, contact in enumerate(found)}
	cement = bonds.rowsOf(spheres, numbers, back)
	bonded = {row["id"] for row in cement}
	tables.write(folder, "contacts", [_contact(k + 1, contact, spheres, k + 1 in bonded) for k, contact in enumerate(found)], head)
	tables.write(folder, "bonds", cement, head)
	tables.write(folder, "walls", [_wall(O.bodies[k], back, found) for k in walls], head)


def _named(letter, vector):
	return {letter + name: float(value) for name, value in zip("xyz", vector)}


def _ball(body, back):
	state = body.state
	place = state.pos - state.vel * back
	label = body.material.label
	return {"id": body.id, **_named("", place), "r": body.shape.radius, **_named("v", state.vel), **_named("w", state.angVel), "density": body.material.density, "group": label}


def _contact(number, contact, spheres, bonded):
	phys, geom = contact.phys, contact.geom
	if not isinstance(phys, yade.LinearPhys):
		raise ValueError(f"contact {contact.id1}-{contact.id2}: is a {type(phys).__name__}; fix: bodies of LinearMat alone")
	first, second = (contact.id1, contact.id2) if contact.id1 in spheres else (contact.id2, contact.id1)
	normal, shear, moment, axis = memoryOf(contact, first)
	shear = shear - shear.dot(axis) * axis  # a load that has turned in this step has a part of second order along the normal, which is no normal force
	kind = tables.BALL_BALL if second in spheres else tables.BALL_FACET
	radii = [O.bodies[k].shape.radius for k in (first, second)[: 2 if kind == tables.BALL_BALL else 1]]
	lever = 1 / sum(1 / radius for radius in radii)
	model = "linearcbond" if phys.bonded else "rrlinear" if phys.rollingArm > 0 else tables.PARALLEL if bonded else "linear"
	row = {"id": number, "kind": kind, "end1": first, "end2": second, "model": model, "gap": -geom.penetrationDepth, "kn": phys.kn, "ks": phys.ks}
	row |= {**_named("p", geom.contactPoint), **_named("n", axis), **_named("f", normal * axis + shear), "fric": phys.tangensOfFrictionAngle}
	row |= {"dp_nratio": 0, "dp_sratio": 0, "rgap": 0, "lin_mode": 0}
	if model == "rrlinear":
		row |= {**_named("m", moment), "rr_fric": phys.rollingArm / lever, "rr_kr": phys.kr}
	if model == "linearcbond":
		row |= {"cb_state": tables.BONDED, "cb_tenf": phys.tensileStrength, "cb_shearf": phys.shearStrength}
	return row


def _wall(body, back, contacts):
	force = numpy.zeros(3)
	for contact in contacts:
		if body.id in (contact.id1, contact.id2):
			sign = 1 if contact.id2 == body.id else -1
			force += sign * (numpy.array(contact.phys.normalForce) + numpy.array(contact.phys.shearForce))
	state = body.state
	return {"id": body.id, "name": type(body.shape).__name__, **_named("", state.pos - state.vel * back), **_named("v", state.vel), **_named("f", force)}
