# SPDX-License-Identifier: GPL-2.0-or-later
"""Scenes of the compact tier's reading contract, and the changes that a script may make to them between two iterations."""

import math
from dataclasses import dataclass
from typing import Callable, Optional

import numpy as np
import yade
from specimenScene import build
from tiers import engines
from yade import O, Quaternion, Vector3, utils

BEFORE, AFTER, SUBSTEPS = 20, 30, 10  # steps before and after the change, steps of an iteration
SMALL = dict(grains=40, porosity=0.5, particleRadius=4e-3, spin=0.05, substeps=SUBSTEPS)
SCENES = {
	"membrane": dict(membraneFriction=0.3, poisson=0.2, swell=1.02),  # rough, shear springs, free to spin
	"central": dict(membraneFriction=0.3, swell=1.02),  # rough, spins blocked
	"smooth": dict(swell=1.02),
	"wall": dict(lateral="wall", membraneFriction=0.3),
	"springs": dict(lateral="wall", membraneFriction=0.3, springs=True),  # stiffness of the grains by kn and ks
	"frictionless": dict(lateral="wall", friction=0.0, rollingFriction=0.0),
}


class Scene:
	"""A scene of SCENES in a tier, with the ids of a grain and a membrane particle that have contacts from the start."""

	def __init__(self, name, tier):
		O.reset()
		self.tier, self.name = tier, name
		self.made = build(tier, **SMALL, **SCENES[name])
		grains = [O.bodies[i] for i in range(SMALL["grains"])]
		self.ids = {"bottom": len(grains), "top": len(grains) + 1}
		x, r = np.array([b.state.pos for b in grains]), np.array([b.shape.radius for b in grains])
		touching = (np.linalg.norm(x[:, None] - x[None], axis=2) < r[:, None] + r[None]).sum(axis=1) - 1
		if "bonds" in self.made:
			membrane = self.made["bonds"].membrane
			particles = [i for i, group in zip(membrane.ids, membrane.groups) if group == 3]
			y = np.array([O.bodies[i].state.pos for i in particles])
			overlap = r[None] + membrane.sphereRadius - np.linalg.norm(y[:, None] - x[None], axis=2)
			self.ids["ring"] = membrane.ids[-1]
			self.ids["particle"] = particles[overlap.max(axis=1).argmax()]
			assert overlap.max() > 0
			beside = (overlap > 0).any(axis=0)
		else:
			self.ids["wall"] = self.made["wall"].wall
			beside = np.linalg.norm(x[:, :2], axis=1) + r > O.bodies[self.ids["wall"]].shape.radius
		self.ids["grain"] = int((touching * beside).argmax())
		assert touching[self.ids["grain"]] > 2 and beside[self.ids["grain"]]
		# the bottom platen is the script's to move
		self.made["bottom"].dead = True
		inner = [engine for name, engine in self.made.items() if name != "bottom"]
		O.engines = engines(tier, inner, damping=0.2, substeps=SUBSTEPS)

	def body(self, where):
		return O.bodies[self.ids[where]]

	def insert(self, engine, last=False):
		"""An engine before the tier's own, or last of all; returns what takes it out again."""
		kept = O.engines
		O.engines = [*kept, engine] if last else [kept[0], engine, *kept[1:]]
		return lambda: setattr(O, "engines", kept)


class Put:
	"""A change: the attribute `path` of a body, 'material LABEL', 'engine NAME' or O gets a value, or the value of a function of the old one.

	:return: what undoes it.
	"""

	def __init__(self, where, path, value):
		self.where, self.path, self.value = where, path, value

	def __call__(self, scene):
		body = scene.body(self.where) if self.where in scene.ids else None
		kind, _, label = self.where.partition(" ")
		owner = body or (O if kind == "O" else O.materials[label] if kind == "material" else scene.made[label])
		*way, name = self.path.split(".")
		for step in way:
			owner = getattr(owner, step)
		old = copied(getattr(owner, name))
		motion = {key: copied(getattr(body.state, key)) for key in ("pos", "ori", "vel", "angVel", "blockedDOFs")} if body else {}
		setattr(owner, name, self.value(old) if callable(self.value) else self.value)

		def undo():
			setattr(owner, name, old)
			for key, value in motion.items():  # `dynamic` stops a body, too
				setattr(body.state, key, value)

		return undo


def copied(value):
	"""YADE hands out vectors and quaternions by reference."""
	return type(value)(value) if isinstance(value, (Vector3, Quaternion)) else value


@dataclass
class Row:
	scene: str
	change: Callable
	body: Optional[str] = None  # whose id an error must name
	must: Optional[str] = None  # "acts" or "refused" where the other will not do
	first: Optional[Callable] = None  # a change of the scene before its first step
	remake: bool = False  # write the reference tier's contacts anew
	effect: Optional[bool] = True  # whether anything must come of it; False: nothing may
	exact: bool = True  # whether the repaired run keeps its bits: not when bodies have come and gone, which sorts the arrays anew
	at: tuple = (0, BEFORE)  # the steps at which the change is made


def body(scene, where, path, value, **options):
	return Row(scene, Put(where, path, value), body=where, **options)


def shifted(*by):
	return lambda old: old + Vector3(*by)


def scaled(factor):
	return lambda old: factor * old


def other(**changes):
	"""A material of its own, not in O.materials."""
	return lambda old: yade.LinearMat(**{**dict(emod=6e7, kratio=2, friction=0.1, rollingFriction=0.2, density=2650), **changes})


def tilted(angle):
	return lambda old: Quaternion(Vector3(1, 0, 0), angle) * old


def secondLaw():
	return yade.InteractionLoop(
		[yade.Ig2_Sphere_Sphere_ScGeom()], [yade.Ip2_LinearMat_LinearMat_LinearPhys()], [yade.Law2_ScGeom_LinearPhys_Linear()]
	)


def widestGap():
	"""Middle of the widest gap between the spheres (of a coarse grid), and its radius."""
	grains = [b for b in O.bodies if isinstance(b.shape, yade.Sphere)]
	x, r = np.array([b.state.pos for b in grains]), np.array([b.shape.radius for b in grains])
	places = np.array([(i, j, k) for i in range(-10, 11, 2) for j in range(-10, 11, 2) for k in range(10, 31, 2)]) * 1e-3
	gaps = (np.linalg.norm(places[:, None] - x, axis=2) - r).min(axis=1)
	return places[gaps.argmax()], gaps.max()


def addGrain(scene):
	"""Into the widest gap between the grains, with an overlap of 0.01 mm."""
	place, gap = widestGap()
	new = utils.sphere(place, gap + 1e-5, material="grain")
	new.state.vel = (0.1, 0.1, 0.1)
	O.bodies.append(new)


def clump(scene):
	new = O.bodies.clump([scene.ids["grain"], (scene.ids["grain"] + 1) % SMALL["grains"]])
	return lambda: O.bodies.erase(new)


def permanent(where, kind, value):
	def change(scene):
		put = getattr(O.forces, kind)
		put(scene.ids[where], value)
		return lambda: put(scene.ids[where], (0, 0, 0))

	return change


def seriesFrom(a, b, shape, lever):
	"""PFC's contact of two materials: springs in series, the smaller friction, or what the pair has of its own; kr = ks Rbar^2 where there is rolling friction."""

	def springs(m):
		return (2 * m.emod * shape, 2 * m.emod * shape / m.kratio) if math.isfinite(m.emod) else (m.kn, m.ks)

	kn, ks = (x * y / (x + y) if x > 0 and y > 0 else 0.0 for x, y in zip(springs(a), springs(b)))
	own = a.pairs().get(b.label) or b.pairs().get(a.label) or {}
	kn, ks = own.get("kn", kn), own.get("ks", ks)
	arm, friction = lever * min(a.rollingFriction, b.rollingFriction), own.get("friction", min(a.friction, b.friction))
	return dict(kn=kn, ks=ks, kr=ks * lever**2 if arm > 0 else 0.0, rollingArm=arm, tangensOfFrictionAngle=friction)


def remakeContacts():
	"""Give the reference tier's contacts the present radii and materials; a spring that is gone holds nothing."""
	for c in O.interactions:
		a, b = O.bodies[c.id1], O.bodies[c.id2]
		r = [body.shape.radius for body in (a, b) if isinstance(body.shape, yade.Sphere)]
		shape, lever = (math.pi * r[0], r[0]) if len(r) == 1 else (math.pi * min(r) ** 2 / sum(r), r[0] * r[1] / sum(r))
		for name, value in seriesFrom(a.mat, b.mat, shape, lever).items():
			setattr(c.phys, name, value)
		c.geom.refR1, c.geom.refR2 = r[0], r[-1]
		if c.phys.ks == 0:
			c.phys.shearForce = (0, 0, 0)
		if c.phys.kr == 0:
			c.phys.moment = (0, 0, 0)
