# SPDX-License-Identifier: GPL-2.0-or-later
"""Parallel bonds of a state's tables as engines of YADE, and back: a GrainBonds for each set of strengths that bonds have."""

import math

import numpy
import yade
from yade import O

from hexmembrane.configuration import ConfigError
from hexmembrane.scene.handles import compactLoop

#: Sets of strengths at most, each an engine of its own.
_MOST = 1000
_STRENGTHS = ("pb_ten", "pb_coh", "pb_fa", "pb_mcf")


def engines(state, bodies, sign=1):
	"""([GrainBonds], of each the ids and rows of the table of its bonds) of a state's bonds; the bodies stand where the bonds' loads were computed.

	:param state: :class:`hexmembrane.exchange.tables.State`. :param bodies: ids by PFC's number of the ball.
	:param sign: -1: loads of the table are those on end 1.
	:raises ConfigError: the bonds have more sets of strengths than there may be engines.
	"""
	bonds = state.bonds
	if bonds is None or not len(bonds):
		return [], []
	strengths = numpy.column_stack([bonds[name] for name in _STRENGTHS])
	sets, which = numpy.unique(strengths, axis=0, return_inverse=True)
	if len(sets) > _MOST:
		raise ConfigError("bonds.csv", str(state.folder), f"has {len(sets)} sets of pb_ten, pb_coh, pb_fa and pb_mcf", f"at most {_MOST}: round strengths that vary to fewer values")
	ids = numpy.array([[bodies[one], bodies[two]] for one, two in zip(bonds["end1"].tolist(), bonds["end2"].tolist())])
	smaller = numpy.array([min(O.bodies[one].shape.radius, O.bodies[two].shape.radius) for one, two in ids.tolist()])
	columns = [ids, bonds["pb_rmul"] * smaller, bonds["pb_kn"], bonds["pb_ks"], sign * bonds.vectors("pb_f"), sign * bonds.vectors("pb_m")]
	made, rows = [], []
	for k, (tension, cohesion, angle, factor) in enumerate(sets.tolist()):
		places = numpy.nonzero(which.ravel() == k)[0]
		made.append(yade.GrainBonds(tensileStrength=tension, cohesion=cohesion, frictionAngle=math.radians(angle), momentFactor=factor))
		made[-1].take(*(column[places] for column in columns))
		rows.append((ids[places].tolist(), places))
	return made, rows


def held(made, rows, count):
	"""What engines of :func:`engines` hold now, by the rows of the table: arrays 'holds', 'force', 'moment', 'tension' and 'shear'; zero of a bond that broke."""
	found = {"holds": numpy.zeros(count), "force": numpy.zeros((count, 3)), "moment": numpy.zeros((count, 3)), "tension": numpy.zeros(count), "shear": numpy.zeros(count)}
	for engine, (ids, places) in zip(made, rows):
		row = dict(zip(map(tuple, ids), places.tolist()))
		told = engine.bonds()
		at = [row[tuple(pair)] for pair in told["ids"].tolist()]
		found["holds"][at] = 1
		for name in ("force", "moment", "tension", "shear"):
			found[name][at] = told[name]
	return found


def rowsOf(spheres, numbers, back):
	"""Rows of bonds.csv of the scene in ``O``, with the loads of the last step and the stresses that these give.

	:param spheres: bodies of the balls. :param back: time that the bodies have moved since then [s].
	:param numbers: of contacts, by their two bodies as a frozenset; bonds without a contact follow after them.
	"""
	loop = compactLoop()
	found, following = [], max(numbers.values(), default=0)
	for engine in [*O.engines, *(loop.engines if loop else ())]:
		if not isinstance(engine, yade.GrainBonds):
			continue
		told = engine.bonds()
		stresses = _stresses(told, engine.momentFactor, back)
		properties = {"pb_ten": engine.tensileStrength, "pb_coh": engine.cohesion, "pb_fa": math.degrees(engine.frictionAngle), "pb_mcf": engine.momentFactor}
		for k, (one, two) in enumerate(told["ids"].tolist()):
			if one not in spheres or two not in spheres:
				continue
			number = numbers.get(frozenset((one, two)))
			if number is None:
				number = following = following + 1
			smaller = min(O.bodies[body].shape.radius for body in (one, two))
			row = {"id": number, "end1": one, "end2": two, "pb_rmul": told["radius"][k] / smaller, "pb_kn": told["kn"][k], "pb_ks": told["ks"][k], **properties}
			row |= {f"pb_f{name}": value for name, value in zip("xyz", told["force"][k])} | {f"pb_m{name}": value for name, value in zip("xyz", told["moment"][k])}
			row |= {"pb_sigma": stresses["tension"][k], "pb_tau": stresses["shear"][k]}
			found.append({name: value if isinstance(value, int) else float(value) for name, value in row.items()})
	return sorted(found, key=lambda row: row["id"])


def _stresses(told, momentFactor, back):
	"""Stresses of bonds whose loads are all that is known. The engine's own have what turning loads have kept along the normal, of second order, in the shear force."""
	bodies = [O.bodies[k] for k in numpy.unique(told["ids"]).tolist()]
	places = [body.state.pos for body in bodies]
	other = yade.GrainBonds(tensileStrength=math.inf, cohesion=math.inf, momentFactor=momentFactor)
	try:
		for body in bodies:
			body.state.pos -= body.state.vel * back
		other.take(*(told[name] for name in ("ids", "radius", "kn", "ks", "force", "moment")))
	finally:
		for body, place in zip(bodies, places):
			body.state.pos = place
	return other.bonds()
