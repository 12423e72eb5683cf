# SPDX-License-Identifier: GPL-2.0-or-later
"""The lateral boundaries that there are, by their keyword in a configuration, and which of them a scene has."""

from hexmembrane.scene.flexible_membrane import FlexibleMembrane
from hexmembrane.scene.rigid_wall import RigidWall

#: Classes of lateral boundary by keyword of ``boundary``.
CLASSES = {kind.name: kind for kind in (FlexibleMembrane, RigidWall)}


def ofEngines(engines):
	"""Handles to the lateral boundary of a scene with these engines (type name -> list).

	:raises RuntimeError: no lateral boundary is there, or not whole.
	"""
	return (RigidWall if "RadialWallServo" in engines else FlexibleMembrane)(engines)
