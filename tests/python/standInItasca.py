# SPDX-License-Identifier: GPL-2.0-or-later
"""A stand-in of PFC's Python module itasca with a model of its own, as far as scripts/pfc.d/export_pfc.py asks for it: made from tables of a state."""

import types

import numpy


class Vector:
	"""PFC's vec3, whose parts are methods."""

	def __init__(self, values):
		self._values = [float(value) for value in values]

	def x(self):
		return self._values[0]

	def y(self):
		return self._values[1]

	def z(self):
		return self._values[2]


def entity(kind, /, **values):
	"""An object of a class of that name, whose methods return the values; a function is a method as it is."""
	found = type(kind, (), {})()
	for key, value in values.items():
		setattr(found, key, value if callable(value) else lambda value=value: value)
	return found


def made(state, facetsFirst=False):
	"""The module, of a :class:`hexmembrane.exchange.tables.State`; ``facetsFirst``: contacts with walls have the facet at end 1."""
	module = types.ModuleType("itasca")
	balls = {row["id"]: _ball(row) for row in _rows(state.balls)}
	walls = {row["id"]: _wall(row) for row in _rows(state.walls)}
	bonds = {} if state.bonds is None else {row["id"]: row for row in _rows(state.bonds)}
	contacts = [_contact(row, balls, walls, facetsFirst, bonds.get(row["id"])) for row in _rows(state.contacts)]
	contacts.append(entity("BallPebbleContact"))
	measure = entity("Measure", id=7, pos=Vector((0, 0, 1)), radius=0.5, porosity=0.4, coordination=5.0, stress_xx=-1e5)
	for name, found in (("ball", balls.values()), ("wall", walls.values()), ("contact", contacts), ("measure", [measure])):
		setattr(module, name, types.SimpleNamespace(list=lambda found=found: iter(list(found))))
	module.cycle = lambda: int(state.balls.head["cycle"])
	module.timestep = lambda: float(state.balls.head["timestep"])
	asked = []
	module.command = asked.append
	module.fish = types.SimpleNamespace(get=lambda name: float(state.balls.head["time"]) if "mech.age" in asked[-1] else None)
	return module


def _rows(table):
	return [{name: values[k] for name, values in table.columns.items()} for k in range(len(table))]


def _vector(row, letter=""):
	return Vector([row[letter + name] for name in "xyz"])


def _ball(row):
	vectors = {"pos": _vector(row), "vel": _vector(row, "v"), "spin": _vector(row, "w")}
	return entity("Ball", id=int(row["id"]), radius=row["r"], density=row["density"], group=row["group"], **vectors)


def _wall(row):
	return entity("Wall", id=int(row["id"]), name=row["name"], pos=_vector(row), vel=_vector(row, "v"), force_contact=_vector(row, "f"))


def _contact(row, balls, walls, facetsFirst, bond):
	pair = row["kind"] == "ball-ball"
	one, two = balls[row["end1"]], balls[row["end2"]] if pair else entity("Facet", id=100, wall=walls[row["end2"]])
	sign = 1
	if facetsFirst and not pair:
		one, two, sign = two, one, -1
	axes = numpy.linalg.qr(numpy.column_stack([[row[f"n{name}"] for name in "xyz"], numpy.eye(3)]))[0]  # the contact plane's own axes
	local = {name: float(row[name]) for name in ("kn", "ks", "fric", "rr_fric", "rr_kr", "cb_tenf", "cb_shearf", "dp_nratio", "dp_sratio", "rgap") if row[name] == row[name]}
	local["lin_mode"] = 0
	if row["model"] == "linearcbond":
		local["cb_state"] = 3
	if row["model"] == "rrlinear":
		local["rr_moment"] = Vector(axes.T @ [sign * row[f"m{name}"] for name in "xyz"])
	force = [sign * row[f"f{name}"] for name in "xyz"]
	if bond:
		local |= {name: bond[name] for name in ("pb_rmul", "pb_kn", "pb_ks", "pb_ten", "pb_coh", "pb_fa", "pb_mcf", "pb_sigma", "pb_tau")}
		loads = {name: [bond[f"pb_{name[3]}{axis}"] for axis in "xyz"] for name in ("pb_force", "pb_moment")}
		local |= {"pb_state": 3, **{name: Vector(axes.T @ values) for name, values in loads.items()}}
		force = [own + more for own, more in zip(force, loads["pb_force"])]
	elif row["model"] == "linearpbond":
		local |= {"pb_state": 1, "pb_kn": 1e9}
	return entity(
		"BallBallContact" if pair else "BallFacetContact",
		id=int(row["id"]),
		end1=lambda: one,
		end2=lambda: two,
		model=row["model"],
		gap=row["gap"],
		pos=_vector(row, "p"),
		normal=Vector([sign * row[f"n{name}"] for name in "xyz"]),
		force_global=Vector(force),
		props=lambda: dict(local),
		to_global=lambda vector: tuple(axes @ [vector.x(), vector.y(), vector.z()]),
	)
