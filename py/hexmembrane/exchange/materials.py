# SPDX-License-Identifier: GPL-2.0-or-later
"""Materials of a state: what its contacts' properties say of groups of balls and of walls, and of pairs of these beyond the rules of series and minimum."""

import numpy

from hexmembrane.configuration import ConfigError
from hexmembrane.exchange import comparison, tables

#: Relative difference of properties that count as one.
_SAME = 1e-6


def materialsOf(state):
	"""(keyword arguments of LinearMat by label; those of LinearMat.setPair by two labels; the label of each ball).

	Balls are one material, "grain", where all contacts of two balls have the same properties, else one of each group, "grain-GROUP". A wall is "wall-ID".

	:raises ConfigError: contacts of one pair of these have different properties, or a group of balls has no contact of two balls.
	"""
	return _Materials(state).found()


class _Materials:
	def __init__(self, state):
		self.state, contacts = state, state.contacts
		self.units = comparison.units(state)
		self.balls = numpy.array([kind == tables.BALL_BALL for kind in contacts["kind"]], dtype=bool)
		self.values = {"kn": contacts["kn"], "ks": contacts["ks"], "friction": contacts["fric"], "rollingFriction": numpy.nan_to_num(contacts["rr_fric"])}
		if not self.balls.any():
			raise self._wrong("has no contact of two balls, so their stiffness is unknown", "a state whose balls touch")

	def found(self):
		groups = dict(zip(self.state.balls["id"].tolist(), self._groups()))
		contacts = self.state.contacts
		ends = [[groups[first], groups[second] if ball else f"wall-{second:g}"] for ball, first, second in zip(self.balls, contacts["end1"].tolist(), contacts["end2"].tolist())]
		kinds = {}
		for place, (one, two) in enumerate(ends):
			key = (one, two) if one <= two or not self.balls[place] else (two, one)
			kinds.setdefault(key, []).append(place)
		kinds = {key: numpy.array(places) for key, places in sorted(kinds.items())}
		made = {}
		for label in sorted(set(groups.values())):
			made[label] = self._grain(label, kinds)
		for wall in sorted({two for _, two in kinds} - made.keys()):
			made[wall] = self._wall([(made[one], places) for (one, two), places in kinds.items() if two == wall])
		pairs = {key: self._beyond(*(made[label] for label in key), f"{key[0]} and {key[1]}", places) for key, places in kinds.items()}
		return made, {key: beyond for key, beyond in pairs.items() if beyond}, list(groups.values())

	def _groups(self):
		"""The label of each ball: one of all where their contacts agree."""
		groups = [f"grain-{group}" if group else "grain" for group in self.state.balls["group"]]
		places = numpy.nonzero(self.balls)[0]
		if len(set(groups)) == 1 or not (self._springTrouble(places) or self._frictionTrouble(places)):
			return ["grain"] * len(groups)
		return groups

	def _grain(self, label, kinds):
		"""A group's material: by its contacts with itself, else by the first with another group."""
		keys = [key for key in kinds if label in key and not key[1].startswith("wall-")]
		if not keys:
			raise self._wrong(f"balls of the group {label.removeprefix('grain-')!r} touch no other balls, so their stiffness is unknown", "one group for balls of one material")
		key = (label, label) if (label, label) in keys else keys[0]
		springs = self._springs(" and ".join(key), kinds[key])
		if "kn" in springs:
			springs = {name: 2 * value for name, value in springs.items()}
		return {**springs, **self._frictions(kinds[key])}

	def _wall(self, grains):
		"""A wall's material, of (material of grains, their contacts): a spring in series with one's own, else one's own spring."""
		for grain, places in grains:
			modulus = grain.get("emod")
			if modulus is not None and _same(self.values["kn"][places] / self.units[places], modulus):
				return {**grain, **self._frictions(places)}
			rest = [1 / self.values[name][places] - 1 / own for name, own in zip(("kn", "ks"), self._own(grain, places))]
			if all((one > 0).all() and _same(one) for one in rest):
				return {"kn": 1 / float(rest[0][0]), "ks": 1 / float(rest[1][0]), **self._frictions(places)}
		grain, places = grains[0]
		return {**grain, **self._frictions(places)}

	def _frictions(self, places):
		return {name: float(self.values[name][places[0]]) for name in ("friction", "rollingFriction")}

	def _own(self, material, places):
		"""kn and ks of a body's own spring [N/m] in contacts."""
		if "kn" in material:
			return tuple(numpy.full(len(places), material[name]) for name in ("kn", "ks"))
		kn = 2 * material["emod"] * self.units[places]
		return kn, kn / material["kratio"]

	def _springs(self, name, places):
		"""The one stiffness that contacts have: kn and ks, or emod and kratio."""
		trouble = self._springTrouble(places)
		if trouble:
			raise self._differ(trouble, name)
		kn, ks = (self.values[name][places] for name in ("kn", "ks"))
		if _same(kn) and _same(ks):
			return {"kn": float(kn[0]), "ks": float(ks[0])}
		return {"emod": float((kn / self.units[places])[0]), "kratio": float((kn / ks)[0])}

	def _springTrouble(self, places):
		kn, ks = (self.values[name][places] for name in ("kn", "ks"))
		if _same(kn) and _same(ks):
			return None
		return _range("kn/(pi min(R1, R2)^2/(R1 + R2))", kn / self.units[places]) or _range("kn/ks", kn / ks)

	def _frictionTrouble(self, places):
		return _range("fric", self.values["friction"][places]) or _range("rr_fric", self.values["rollingFriction"][places])

	def _beyond(self, one, two, name, places):
		"""What the rules of series and minimum do not give contacts of two materials: keyword arguments of LinearMat.setPair."""
		trouble = self._frictionTrouble(places)
		if trouble:
			raise self._differ(trouble, name)
		own = self._frictions(places)
		beyond = {name: value for name, value in own.items() if not _near(value, min(one[name], two[name]))}
		inSeries = [1 / (1 / first + 1 / second) for first, second in zip(self._own(one, places), self._own(two, places))]
		if not all(_same(self.values[name][places] / made, 1) for name, made in zip(("kn", "ks"), inSeries)):
			beyond |= self._springs(name, places)
		return beyond

	def _differ(self, trouble, name):
		return self._wrong(f"{trouble} in contacts of {name}", "contacts of two groups with one set of properties; a script can set contact.phys one by one")

	def _wrong(self, what, fix):
		return ConfigError("contacts.csv", str(self.state.folder), what, fix)


def _near(value, other):
	return abs(value - other) <= _SAME * abs(other)


def _same(values, value=None):
	"""Whether all values are one, or the one that is given."""
	return bool((abs(values - (values[0] if value is None else value)) <= _SAME * abs(values[0] if value is None else value)).all())


def _range(name, values):
	"""That values differ, as a text; None where they do not."""
	return None if _same(values) else f"{name} is from {values.min():g} to {values.max():g}"
