# SPDX-License-Identifier: GPL-2.0-or-later
"""The specimen's lateral boundary, flexible membrane or rigid wall: which one, and what both have in common.

A boundary is a class with ``name``, ``make(config, packing)`` -> :class:`Parts`, and a constructor that takes the engines of a scene by
type name. Its instances are the handles that stages, records and frames use, with one interface:

============================ ==========================================================================================
``pressure``, ``setPressure`` confining pressure asked for [Pa], positive inwards
``applied``                   pressure [Pa] that is on the boundary now to bring that to the soil
``setMaxVelocity(speed)``     largest speed of a servo's motion [m/s]
``setTimeLimit(limit)``       time that a servo has to reach its target once [s], nan: any
``meanRadius()``              of the inner surface [m]
``volume(bottom, top)``       enclosed between two heights [m3]
``endArea(face)``             area [m2] that the axial stress acts on; ``face``: that of a platen
``pressedArea(bottom, top)``  area that the pressure acts on [m2]
``transmitted(group)``        pressure that arrives at the soil [Pa]; 0: all, 2: beside the platens, 3: main body
``brokenBonds()``             their number
``unbalanced()``              resultant force on the membrane's particles over the pressure's, 0 without
``carried(bottom, top)``      what the boundary itself carries, columns of :mod:`hexmembrane.correction`
``outside(points)``           which points are outside, as booleans
``addStiffness(stiffness)``   add to (bodies,) stiffnesses [N/m] what contacts do not show
``writeFrame(path, start)``   its surface as VTK; ``start``: the :class:`hexmembrane.measure.Reference` of the stage
============================ ==========================================================================================
"""

import dataclasses
from typing import Callable


@dataclasses.dataclass
class Parts:
	"""What a boundary, whose bodies are made, brings to a new scene.

	:param engines: ``engines(bottom, top)``, the ids of the platens -> (engines before the platens' drives, after them).
	:param platenRadius: radius that the platens need [m]. :param overhang: how far it reaches beyond the specimen, both ends together [m].
	:param smallest: radius of its smallest spheres [m], inf without. :param critical: its critical time step [s], inf without.
	:param log: lines that describe it.
	"""

	engines: Callable
	platenRadius: float
	overhang: float
	smallest: float
	critical: float
	log: list


def only(engines, name):
	"""The one engine of a type among ``engines``, a dict of type name -> list.

	:raises RuntimeError: there are none or several.
	"""
	found = engines.get(name, ())
	if len(found) != 1:
		raise RuntimeError(f"Scene.engines = {len(found)} {name}: 1 expected; fix: load a state saved by this test")
	return found[0]


def classes():
	"""The boundaries by their keyword in the configuration."""
	from hexmembrane.flexible_membrane import FlexibleMembrane
	from hexmembrane.rigid_wall import RigidWall

	return {kind.name: kind for kind in (FlexibleMembrane, RigidWall)}


def of(engines):
	"""The handles of the boundary that a scene with these engines has (type name -> list).

	:raises RuntimeError: neither boundary is there, or not whole.
	"""
	kinds = classes()
	return kinds["wall" if "RadialWallServo" in engines else "membrane"](engines)
