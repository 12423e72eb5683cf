# SPDX-License-Identifier: GPL-2.0-or-later
"""The grains of a test: from a gradation through CylinderPacking, or from a packing file."""

import math
import pathlib

from hexmembrane import packing_file, scene
from hexmembrane.gradation import Gradation
from hexmembrane.schema import ConfigError


def grading(given):
	"""The gradation of the configuration's specimen section: read, cut, not yet scaled.

	:raises ConfigError: the file cannot be read or is no gradation.
	"""
	try:
		return Gradation.fromCsv(given.gradation, given.cutBelow, given.cutAbove)
	except (OSError, ValueError) as error:
		raise ConfigError("specimen.gradation", given.gradation, f"is no gradation ({error})", "see the end of that message") from None


def radii(given, radius, height):
	"""Radii [m] of the grains that fill a cylinder at the wished porosity, in random order.

	:param given: the configuration's specimen section. :param radius: of the cylinder [m]. :param height: of it [m].
	"""
	curve = grading(given)
	volume = math.pi * radius**2 * height
	if given.grains is None:
		curve = curve.scaled(given.scale or 1.0)
		count = curve.grainCount(given.porosity, volume)
		if not 20 <= count <= 1000000:
			raise ConfigError("specimen.scale", given.scale, f"gives {count} grains", "change it, or wish for a number of grains")
	else:
		count = given.grains
		curve = curve.scaled(curve.scaleForGrains(count, given.porosity, volume))
	return curve.sample(count, given.seed)


def make(config, say):
	"""Pack the grains of the configuration's gradation into the cylinder that its membrane or wall will enclose.

	Under ``specimen.stress`` the modulus is such that contacts of equal grains are as stiff as the test's: CylinderPacking's rule is
	kn = 2 young r1 r2/(r1 + r2), PFC's pi emod min(r1, r2)^2/(r1 + r2), equal with young = pi emod/2.

	:returns: a :class:`hexmembrane.packing_file.Packing`.
	:raises RuntimeError: the porosity is out of reach; the message says what is in reach.
	"""
	import yade

	given = config.specimen
	radius = scene.soilRadius(config)
	stressed = {}
	if given.stress is not None:
		stressed = {"stress": given.stress, "young": math.pi * given.emod / 2, "stiffnessRatio": given.kratio}
		stressed.update(friction=given.friction, rollingFriction=given.packingRollingFriction)
	packing = yade.CylinderPacking(
		radius=radius, height=given.height, radii=radii(given, radius, given.height).tolist(), porosity=given.porosity, seed=given.seed, **stressed
	)
	packing.generate()
	made = packing_file.Packing.of(packing, gradation=pathlib.Path(given.gradation).name)
	say(f"specimen: {len(made)} grains of radius {1e3 * made.radii.min():.4g} to {1e3 * made.radii.max():.4g} mm, porosity {made.porosity:.4f}")
	if stressed:
		say(f"packed under {1e-3 * packing.radialStress:.4g} kPa (side) and {1e-3 * packing.axialStress:.4g} kPa (ends), coordination {packing.coordination:.3g}")
	return made


def provide(config, out, say):
	"""The packing of a test: read from ``specimen.packing`` or made; either way ``packing.txt`` in the folder ``out`` is it.

	:raises ConfigError: the packing file is none, or is for another specimen.
	"""
	given = config.specimen
	if given.packing is None:
		packing = make(config, say)
	else:
		try:
			packing = packing_file.load(given.packing)
		except (OSError, ValueError) as error:
			raise ConfigError("specimen.packing", given.packing, f"is no packing ({error})", "see the end of that message") from None
		wanted = scene.soilRadius(config), given.height
		for name, has, wants in zip(("radius", "height"), (packing.radius, packing.height), wanted):
			if abs(has - wants) > 1e-9 * wants:
				raise ConfigError(
					"specimen.packing", given.packing, f"has {name} {has:.9g} m, this specimen needs {wants:.9g} m", f"set specimen.{name} right"
				)
		if packing.origin.any():
			raise ConfigError("specimen.packing", given.packing, f"stands on {packing.origin.tolist()}", "give one that stands on the origin")
		say(f"specimen: {len(packing)} grains from {given.packing}, porosity {packing.porosity:.4f}")
	packing_file.save(packing, pathlib.Path(out) / "packing.txt")
	return packing
