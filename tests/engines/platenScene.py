# SPDX-License-Identifier: GPL-2.0-or-later
"""A platen over grains, and the engine that drives it."""

import math

from contactScene import DENSITY, floor, sphere, springs
from hexmembrane.scene.platens import platen
from tiers import engines
from yade import PlatenDrive

RADIUS, HEIGHT, GRAIN = 0.01, 0.004, 0.001


def topPlaten(O, face, radius=RADIUS):
	"""A platen that looks down on `face`, its id."""
	return O.bodies.append(platen((0, 0, face), radius, HEIGHT, -1))


def driven(O, tier, **drive):
	"""Engines with a drive of the top platen, which is returned."""
	drive = PlatenDrive(**{"direction": (0, 0, -1), **drive})
	O.engines = engines(tier, [drive], damping=0.2)
	return drive


def bystander():
	"""A fixed sphere far away: the compact tier wants one."""
	return sphere((1, 0, 0), GRAIN, fixed=True)


def grainMass():
	return DENSITY * 4 / 3 * math.pi * GRAIN**3


def stack(O, layers, side, kn, platenRadius=RADIUS):
	"""side x side columns of `layers` spheres of uneven height; returns (bottom, top) platen ids.

	Nothing holds a column but its symmetry: its spheres' horizontal coordinates are the same to the last bit, so no force has a horizontal part. The
	columns end at different heights, by up to a few overlaps under 0.2 N, so that the number of contacts grows as the platen comes down.
	"""
	uneven = 0.5 / kn
	springs(kn, 0.5 * kn)
	bottom = floor(platenRadius, HEIGHT)
	for i in range(side):
		for j in range(side):
			low = uneven * ((3 * i + 5 * j) % 7) / 7
			for k in range(layers):
				sphere((3 * GRAIN * (i - 0.5 * (side - 1)), 3 * GRAIN * (j - 0.5 * (side - 1)), low + GRAIN * (2 * k + 1)), GRAIN)
	top = topPlaten(O, 2 * GRAIN * layers + 1.2 * uneven, platenRadius)
	O.dt = 0.3 * math.sqrt(grainMass() / kn)
	return bottom, top
