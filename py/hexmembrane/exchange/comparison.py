# SPDX-License-Identifier: GPL-2.0-or-later
"""Contact by contact: what the plugin's law makes of a state's tables, against the forces in them.

Each contact of the table becomes one of YADE's with the table's stiffness, friction, strengths, shear force and moment, each parallel bond one of GrainBonds. The laws
take a step in which nothing moves, or the step from one export to the next. What it computes or cuts is compared. Nothing of the law is written down here: factors of a contact's shape
(lever arm, min(R1, R2)^2/(R1 + R2)) are read from a contact of unit material too.
"""

import dataclasses

import numpy
import yade
from yade import O, utils

from hexmembrane.configuration import ConfigError
from hexmembrane.exchange import bonds, scenes, tables
from hexmembrane.scene.builder import interactionLoop

#: Contact models whose law is here.
MODELS = ("linear", "rrlinear", "linearcbond", tables.PARALLEL)
#: The least force that a difference is taken relative to, as a share of the mean normal force.
_LEAST = 1e-3
#: A step in which nothing moves [s].
STILL = 1e-12
_WORST = 5


@dataclasses.dataclass
class Quantity:
	"""One comparison: ``place``, rows of the ``table``, contacts or bonds; ``there`` and ``here``, the values; ``difference``, relative."""

	name: str
	table: str
	place: numpy.ndarray
	there: numpy.ndarray
	here: numpy.ndarray
	difference: numpy.ndarray


@dataclasses.dataclass
class Comparison:
	"""``state``; the quantities; why contacts were left out, with their numbers; notes for the reader."""

	state: tables.State
	quantities: list
	left: dict
	notes: list

	def beyond(self, tolerance):
		"""Number of differences above a tolerance."""
		return sum(int((quantity.difference > tolerance).sum()) for quantity in self.quantities)

	def lines(self, tolerance):
		"""What is told, as lines of text."""
		contacts = self.state.contacts
		kinds = [contacts["kind"].count(kind) for kind in (tables.BALL_BALL, tables.BALL_FACET)]
		left = sum(self.left.values())
		cemented = f"; {len(self.state.bonds)} parallel bonds" if self.state.bonds is not None and len(self.state.bonds) else ""
		told = [f"{len(self.state.balls)} balls, {len(contacts)} contacts: {kinds[0]} of balls, {kinds[1]} with walls{cemented}; cycle {contacts.head.get('cycle', 'unknown')}"]
		told += [f"compared {len(contacts) - left}, left out {left}" + "".join(f"; {count}: {why}" for why, count in self.left.items()), *self.notes]
		told.append(f"{'':34}{'compared':>9}{'beyond ' + format(tolerance, '.0e'):>14}{'largest difference':>20}")
		for quantity in self.quantities:
			many = int((quantity.difference > tolerance).sum())
			largest = f"{quantity.difference.max():.1e}" if len(quantity.place) else "-"
			told.append(f"{quantity.name:34}{len(quantity.place):>9}{many:>14}{largest:>20}")
		for quantity in self.quantities:
			for k in numpy.argsort(-quantity.difference)[:_WORST]:
				if quantity.difference[k] > tolerance:
					told.append(self._worst(quantity, k))
		return told

	def _worst(self, quantity, k):
		table, place = getattr(self.state, quantity.table), int(quantity.place[k])
		ends = f"{table['end1'][place]:.0f} and {table['end2'][place]:.0f}"
		what = f"({table['kind'][place]}, line {table.lines[place]})" if quantity.table == "contacts" else f"(bonds.csv, line {table.lines[place]})"
		return f"{quantity.name}: contact {table['id'][place]:.0f} of {ends} {what}: {quantity.there[k]:.9g} there, {quantity.here[k]:.9g} here"


def compare(state, then=None):
	"""The :class:`Comparison` of a state, in YADE's empty scene.

	:param then: the state one cycle later, whose contacts are then those that are compared; None: the state itself, at rest.
	:raises ConfigError: the tables do not belong together.
	"""
	if len(O.bodies):
		raise RuntimeError(f"O.bodies = {len(O.bodies)} bodies: an empty scene is needed; fix: O.reset() first")
	shown = then or state
	before, notes = _pairsOf(state, then), []
	loads, sign = _signed(shown.contacts, notes)
	left, taken = {}, []
	for place in range(len(shown.contacts)):
		why = _whyNot(shown.contacts, place) or ("not in the first export" if before[place] is None else "")
		if why:
			left[why] = left.get(why, 0) + 1
		else:
			taken.append(place)
	unit, contacts, bodies = _make(state, shown, taken, before, sign)
	cement, rows = bonds.engines(state, bodies, sign)
	laws, O.dt = list(O.engines), STILL
	if then is not None:
		O.engines = [laws[0], *cement]
		O.step()  # a bond's first step is the one in which it is made
		_advance(state, then, taken, contacts)
	O.engines = [*laws, *cement]
	O.step()
	quantities = _quantities(shown, taken, unit, contacts, loads, then is not None) + _ofBonds(state, shown, cement, rows, sign, then is not None)
	return Comparison(shown, [one for one in quantities if len(one.place)], left, notes)


def units(state):
	"""Normal stiffness [N/m] that a unit modulus gives each contact, by the plugin's law; leaves YADE's scene empty."""
	everything = list(range(len(state.contacts)))
	found, *_ = _make(state, state, everything, everything, 1)
	O.reset()
	return found[:, 0]


def _pairsOf(state, then):
	"""For each contact that is shown, its place in the first export; None where that has none."""
	if then is None:
		return list(range(len(state.contacts)))
	cycles = [other.contacts.number("cycle") for other in (state, then)]
	if not cycles[1] - cycles[0] == 1:
		raise ConfigError("--next", str(then.folder), f"is of cycle {cycles[1]:g}, the first of {cycles[0]:g}", "export, one cycle, export")
	if sorted(state.balls["id"].tolist()) != sorted(then.balls["id"].tolist()):
		raise ConfigError("--next", str(then.folder), "has other balls than the first export", "export the same balls twice")
	if not then.contacts.number("timestep") > 0:
		raise ConfigError("--next", str(then.folder), "names no timestep in its first line", "export it by scripts/pfc.d")
	places, several = {}, set()
	for k, key in enumerate(_keys(state.contacts)):
		several |= {key} & places.keys()
		places[key] = k
	return [None if key in several else places.get(key) for key in _keys(then.contacts)]


def _keys(contacts):
	return list(zip(contacts["kind"], contacts["end1"].tolist(), contacts["end2"].tolist()))


def _whyNot(contacts, k):
	"""Why the contact's force cannot be compared; '' where it can."""
	if contacts["model"][k] not in MODELS:
		return f"model {contacts['model'][k]}"
	if contacts["dp_nratio"][k] > 0 or contacts["dp_sratio"][k] > 0:
		return "dashpots are in the force"
	if contacts["lin_mode"][k] == 1:
		return "normal force by increments (lin_mode 1)"
	if contacts["rgap"][k] > 0 or contacts["rgap"][k] < 0:
		return "a reference gap (rgap)"
	return ""


def _signed(contacts, notes):
	"""Loads with the sign of this format: those of an exporter that tells them on end 1 are turned; (normal, shear, moment), the sign."""
	normal, shear = scenes.split(contacts)
	moment = numpy.nan_to_num(contacts.vectors("m"))
	pressed = contacts["gap"] < 0
	against = (normal[pressed] < 0).sum()
	if pressed.any() and against > 0.9 * pressed.sum():
		notes.append(f"forces and moments are turned: {against} of {pressed.sum()} contacts with an overlap would pull, so the table has them on end 1")
		return (-normal, -shear, -moment), -1
	return (normal, shear, moment), 1


def _make(state, shown, taken, before, sign):
	"""Bodies and contacts: (kn, ks, kr and rollingArm of a contact of unit material, by contact; the contacts with their two bodies; bodies by PFC's number)."""
	material = O.materials.append(yade.LinearMat(emod=1, kratio=1, friction=0, rollingFriction=1, density=1000, label="unit"))
	bodies = scenes.appendBalls(state.balls, [material] * len(state.balls), dynamic=False)
	O.engines = [yade.ForceResetter(), interactionLoop()]
	first, now = state.contacts, shown.contacts
	centres = dict(zip(state.balls["id"].tolist(), zip(state.balls.vectors().tolist(), state.balls["r"].tolist())))
	_, shear = scenes.split(first)
	moments, normals = numpy.nan_to_num(first.vectors("m")), first.vectors("n")
	pairs, plates = [], []
	for place in taken:
		old = before[place]
		one = bodies[first["end1"][old]]
		if first["kind"][old] == tables.BALL_BALL:
			pairs.append((one, bodies[first["end2"][old]]))
		else:
			plates.append(scenes.plate(*centres[first["end1"][old]], normals[old], first["gap"][old], material))
			pairs.append((one, len(O.bodies) + len(plates) - 1))
	O.bodies.append(plates)
	contacts = [(utils.createInteraction(one, two), one, two) for one, two in pairs]
	unit = numpy.array([(c.phys.kn, c.phys.ks, c.phys.kr, c.phys.rollingArm) for c, *_ in contacts]).reshape(-1, 4)
	for (contact, one, _), place, (_, ks, kr, arm) in zip(contacts, taken, unit.tolist()):
		phys, rolling = contact.phys, now["rr_fric"][place]
		phys.kn, phys.ks, phys.tangensOfFrictionAngle = (float(now[name][place]) for name in ("kn", "ks", "fric"))
		phys.rollingArm = arm * rolling if now["model"][place] == "rrlinear" and rolling > 0 else 0.0
		phys.kr = phys.ks * kr / ks if phys.rollingArm > 0 else 0.0
		if now["model"][place] == "linearcbond" and first["cb_state"][before[place]] == tables.BONDED:
			phys.bond(float(now["cb_tenf"][place]), float(now["cb_shearf"][place]))
		scenes.setMemory(contact, one, sign * shear[before[place]], sign * moments[before[place]])
	return unit, contacts, bodies


def _advance(state, then, taken, contacts):
	"""Bodies to where they are one cycle later, with the velocities that took them there."""
	O.dt = then.contacts.number("timestep")
	balls, table = then.balls, then.contacts
	places, velocities, spins, normals = balls.vectors(), balls.vectors("v"), balls.vectors("w"), table.vectors("n")
	for values, name in ((velocities, "vx, vy, vz"), (spins, "wx, wy, wz")):
		if numpy.isnan(values).any():
			raise ConfigError("balls.csv", str(then.folder), f"has balls without {name}", "export velocities and spins")
	rows = {number: k for k, number in enumerate(balls["id"].tolist())}
	for body, number in enumerate(state.balls["id"].tolist()):
		k, moved = rows[number], O.bodies[body].state
		moved.pos, moved.vel, moved.angVel = (yade.Vector3(*values[k]) for values in (places, velocities, spins))
	walls = {} if then.walls is None else dict(zip(then.walls["id"].tolist(), then.walls.vectors("v").tolist()))
	for place, (_, _, other) in zip(taken, contacts):
		if table["kind"][place] == tables.BALL_FACET:
			k = rows[table["end1"][place]]
			scenes.placePlate(O.bodies[other], places[k], balls["r"][k], normals[place], table["gap"][place])
			O.bodies[other].state.vel = yade.Vector3(*walls.get(table["end2"][place], (0, 0, 0)))


def _length(vectors):
	return numpy.linalg.norm(vectors, axis=1)


def _gaps(shown, taken):
	"""Distances of the balls' surfaces [m], NaN of a ball and a wall."""
	balls, table = shown.balls, shown.contacts
	rows, centres = {number: k for k, number in enumerate(balls["id"].tolist())}, balls.vectors()
	gaps = numpy.full(len(taken), numpy.nan)
	for k, place in enumerate(taken):
		if table["kind"][place] == tables.BALL_BALL:
			one, two = (rows[table[end][place]] for end in ("end1", "end2"))
			gaps[k] = numpy.linalg.norm(centres[two] - centres[one]) - balls["r"][one] - balls["r"][two]
	return gaps


def _quantities(shown, taken, unit, contacts, loads, stepped):
	table, taken = shown.contacts, numpy.array(taken, dtype=int)
	normal, shear, moment = (values[taken] for values in loads)
	ours = [scenes.memoryOf(contact, one) if contact.isReal else (0.0, numpy.zeros(3), numpy.zeros(3), numpy.zeros(3)) for contact, one, _ in contacts]
	hereNormal = numpy.array([one[0] for one in ours])
	hereShear, hereMoment = (numpy.array([one[k] for one in ours]).reshape(-1, 3) for k in (1, 2))
	size = numpy.hypot(normal, _length(shear))
	scale = numpy.maximum(size, _LEAST * (size.mean() if len(size) else 1)) + 1e-300
	lever = unit[:, 3]
	rolling = numpy.array([table["model"][k] == "rrlinear" for k in taken], dtype=bool)
	pairs = numpy.array([table["kind"][k] == tables.BALL_BALL for k in taken], dtype=bool)
	emod, stiffness = table["emod"][taken], table["kn"][taken]
	bonded = table["cb_state"][taken] == tables.BONDED
	gaps = _gaps(shown, taken)
	still = numpy.array([contact.isReal and contact.phys.bonded for contact, *_ in contacts], dtype=float)

	def quantity(name, mask, there, here, difference):
		return Quantity(name, "contacts", taken[mask], there[mask], here[mask], difference[mask])

	everything = numpy.ones(len(taken), dtype=bool)
	told = " of the step" if stepped else " within mu Fn"
	found = [
		quantity("gap, by radii", pairs, table["gap"][taken], gaps, abs(table["gap"][taken] - gaps) / numpy.maximum(2 * lever, 1e-300)),
		quantity("normal force, kn u", everything, normal, hereNormal, abs(normal - hereNormal) / scale),
		quantity("shear force" + told, everything, _length(shear), _length(hereShear), _length(shear - hereShear) / scale),
		quantity("rolling moment" + (told if stepped else " within its limit"), rolling, _length(moment), _length(hereMoment), _length(moment - hereMoment) / (lever * scale)),
	]
	kr = table["ks"][taken] * unit[:, 2] / unit[:, 1]
	there = table["rr_kr"][taken]
	found.append(quantity("rolling stiffness, ks Rm^2", rolling & ~numpy.isnan(there), there, kr, abs(there - kr) / kr))
	byModulus = emod * unit[:, 0]
	found.append(quantity("kn, by emod", emod > 0, stiffness, byModulus, abs(stiffness - byModulus) / stiffness))
	found.append(quantity("bond holds", bonded, bonded.astype(float), still, abs(bonded - still)))
	return found


def _ofBonds(state, shown, cement, rows, sign, stepped):
	"""Parallel bonds that both exports have: of a step the loads, else the stresses that the loads give."""
	if not cement:
		return []
	first, table = state.bonds, shown.bonds
	row = {ends: k for k, ends in enumerate(zip(first["end1"].tolist(), first["end2"].tolist()))}
	both = [(row[ends], k) for k, ends in enumerate(zip(table["end1"].tolist(), table["end2"].tolist())) if ends in row] if table is not None else []
	before, place = numpy.array(both, dtype=int).reshape(-1, 2).T
	here = {name: values[before] for name, values in bonds.held(cement, rows, len(first)).items()}
	force, moment = (sign * table.vectors(f"pb_{letter}")[place] for letter in "fm") if len(place) else (numpy.zeros((0, 3)),) * 2

	def compared(name, there, found, difference):
		known = ~numpy.isnan(there)
		return Quantity(name, "bonds", place[known], there[known], found[known], difference[known])

	def size(values):
		return numpy.maximum(values, _LEAST * (values.mean() if len(values) else 1)) + 1e-300

	found = []
	if stepped:
		scale = size(_length(force))
		found.append(compared("parallel bond's force of the step", _length(force), _length(here["force"]), _length(force - here["force"]) / scale))
		scale = size(_length(moment))
		found.append(compared("parallel bond's moment of the step", _length(moment), _length(here["moment"]), _length(moment - here["moment"]) / scale))
	for name, column, key in () if stepped else (("parallel bond's normal stress", "pb_sigma", "tension"), ("parallel bond's shear stress", "pb_tau", "shear")):
		there = table[column][place] if len(place) else numpy.zeros(0)
		found.append(compared(name, there, here[key], abs(there - here[key]) / size(numpy.nan_to_num(abs(there)))))
	found.append(compared("parallel bond holds", numpy.ones(len(place)), here["holds"], 1 - here["holds"]))
	return found
