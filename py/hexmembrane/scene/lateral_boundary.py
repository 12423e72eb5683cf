# SPDX-License-Identifier: GPL-2.0-or-later
"""What a lateral boundary of the specimen is: the one interface that scene, measurement and stages know.

The kinds are listed in :mod:`hexmembrane.scene.boundaries`. The end platens are no part of it.
"""

import abc
import dataclasses
from typing import Callable

import numpy

from hexmembrane.scene.membrane_loads import MembraneLoads


@dataclasses.dataclass
class BoundaryParts:
	"""What a lateral boundary, whose bodies are in the scene, brings to a new scene.

	:param engines: ``engines(bottom, top)``, the ids of the platens -> (engines before the platens' drives, engines after them).
	:param platenRadius: radius that the platens need [m].
	:param overhang: how far it reaches beyond the specimen, both ends together [m].
	:param smallestRadius: of its spheres [m], inf without.
	:param around: what tells it to a SoilMeasure, ``membrane`` or ``wall``, as keyword arguments.
	:param criticalStep: its critical time step before there are contacts [s], inf without.
	:param log: lines that describe it.
	"""

	engines: Callable
	platenRadius: float
	overhang: float
	smallestRadius: float
	criticalStep: float
	around: dict
	log: list


@dataclasses.dataclass
class Surface:
	"""A triangulated surface with data, as a VTK file takes it: points (N, 3) [m], triangles (M, 3), arrays by name at points and triangles."""

	points: numpy.ndarray
	triangles: numpy.ndarray
	pointData: dict
	cellData: dict


def atFactor(loop):
	"""How a loop that multiplies a load stands at its ``maxFactor``, and what to do, for :meth:`hexmembrane.scene.lateral_boundary.LateralBoundary.saturated`."""
	return f"stands at its limit, {loop.factor:.4g} times what is asked for", "a larger maxFactor, or a membrane that carries less (young, thickness)"


class LateralBoundary(abc.ABC):
	"""Handles to the lateral boundary in ``O``. A kind's constructor takes the engines of the scene, a dict of type name -> list."""

	#: Keyword of ``boundary`` in a configuration; also the name of its VTK files.
	name: str

	@classmethod
	@abc.abstractmethod
	def make(cls, config, packing):
		"""Append its bodies, as configured, round the packing; its :class:`hexmembrane.scene.lateral_boundary.BoundaryParts`."""

	@property
	@abc.abstractmethod
	def pressure(self):
		"""Confining pressure asked for [Pa], positive inwards."""

	@property
	@abc.abstractmethod
	def appliedPressure(self):
		"""Pressure [Pa] that is on the boundary now to bring the one asked for to the soil."""

	@abc.abstractmethod
	def setPressure(self, pressure):
		"""Ask for a confining pressure [Pa]."""

	def setMaxVelocity(self, speed):
		"""Limit the speed of a servo's motion [m/s]; nothing where the pressure is applied and not approached."""

	def allowStraining(self, rate):
		"""Let a servo follow a specimen that is strained axially at a rate [1/s]; nothing where the pressure is applied and not approached."""

	def setTimeLimit(self, limit):
		"""Limit the time that a servo has to reach its target once [s], nan: any; nothing without a servo."""

	@abc.abstractmethod
	def meanRadius(self):
		"""Mean radius of the inner surface [m]."""

	@abc.abstractmethod
	def volume(self, bottom, top):
		"""Volume enclosed between two heights [m3]."""

	@abc.abstractmethod
	def endArea(self, face):
		"""Area [m2] that the axial stress acts on; ``face``: that of a platen."""

	@abc.abstractmethod
	def pressedArea(self, bottom, top):
		"""Area that the pressure acts on [m2]."""

	@abc.abstractmethod
	def transmittedPressures(self):
		"""Pressure that arrives at the soil [Pa] by group; 0: all, 2: beside the platens, 3: main body."""

	@property
	@abc.abstractmethod
	def around(self):
		"""What tells it to a SoilMeasure, ``membrane`` or ``wall``, as keyword arguments."""

	def movingIds(self):
		"""Ids of its bodies that move freely."""
		return []

	def saturated(self):
		"""Its closed loops that stand at a limit: {key, its value and what is loaded: (how it stands there, what to do)}."""
		return {}

	def brokenBonds(self):
		"""Number of broken bonds of the boundary itself."""
		return 0

	def unbalanced(self):
		"""Mean resultant force on the boundary's particles over the pressure's force on one, 0 without particles."""
		return 0.0

	def ownLoads(self, bottom, top):
		"""What the boundary itself carries, :class:`hexmembrane.scene.membrane_loads.MembraneLoads`."""
		return MembraneLoads()

	@abc.abstractmethod
	def outside(self, ids):
		"""Ids of those of these bodies whose centres are outside, for bodies between its ends."""

	def addFrequencySquare(self, square):
		"""Add to (bodies,) an upper bound of omega^2 [1/s2] of the springs that are no contacts."""

	@abc.abstractmethod
	def surface(self, startRadius):
		"""Its :class:`Surface`; ``startRadius``: :meth:`meanRadius` at the start of the stage [m]."""


def singleEngine(engines, name):
	"""The one engine of a type among ``engines``, a dict of type name -> list.

	:raises RuntimeError: there are none or several.
	"""
	ofType = engines.get(name, ())
	if len(ofType) != 1:
		raise RuntimeError(f"Scene.engines = {len(ofType)} {name}: 1 expected; fix: add one to O.engines, or to those of CompactLoop")
	return ofType[0]


def optionalEngine(engines, name):
	"""The one engine of a type among ``engines``, a dict of type name -> list; None without.

	:raises RuntimeError: there are several.
	"""
	return singleEngine(engines, name) if engines.get(name) else None
