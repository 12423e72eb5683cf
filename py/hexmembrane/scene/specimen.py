# SPDX-License-Identifier: GPL-2.0-or-later
"""The grains of a test: from sizes through CylinderPacking, from a packing file, or from a table of balls."""

import math
import pathlib

import yade

from hexmembrane.configuration import ConfigError, balls
from hexmembrane.scene import packing_file
from hexmembrane.scene.gradation import Gradation
from hexmembrane.scene.number_sizes import NumberSizes

#: Spheres of a membrane's ring at least, as HexMembrane wants it.
_MIN_PER_RING = 6
#: How far balls of a table may reach beyond the specimen, and into one another, over their mean radius: what contacts of soft balls have.
_BEYOND, _OVERLAP = 0.1, 0.5


def soilRadius(config):
	"""Radius [m] of the cylinder that the grains are packed into, whatever the lateral boundary: the inner surface of the membrane as generated.

	With ``placement: outside`` that is the specimen's radius. With ``centred``, n = round(pi/asin(R/Rs)) spheres of radius R close a ring of
	the centre radius Rc = R/sin(pi/n) about the specimen's radius Rs, and the inner surface has Rc - R.

	:raises ConfigError: the membrane's spheres are too coarse to close a ring.
	"""
	radius, particleRadius = config.specimen.radius, config.membrane.particleRadius
	if config.membrane.placement == "outside":
		return radius
	perRing = math.floor(math.pi / math.asin(particleRadius / radius) + 0.5) if particleRadius < radius else 0
	if perRing < _MIN_PER_RING:
		raise ConfigError(
			"membrane.particleRadius",
			particleRadius,
			f"too coarse, a ring would have {perRing} spheres",
			f"at most {radius * math.sin(math.pi / _MIN_PER_RING):.6g} m for this specimen ({_MIN_PER_RING} spheres a ring)",
		)
	return particleRadius / math.sin(math.pi / perRing) - particleRadius


def grading(keys):
	"""The sizes in the configuration's specimen section ``keys``, not yet scaled: the gradation as read and cut, or a distribution by number.

	:raises ConfigError: the file cannot be read or is no gradation.
	"""
	if keys.radiusBins is not None:
		return NumberSizes.bins(keys.radiusBins)
	if keys.radiusMean is not None:
		return NumberSizes.gaussian(keys.radiusMean, keys.radiusDeviation, *keys.gaussianRange)
	if keys.radiusRange is not None:
		return NumberSizes.uniform(*keys.radiusRange)
	try:
		return Gradation.fromCsv(keys.gradation, keys.cutBelow, keys.cutAbove)
	except (OSError, ValueError) as error:
		raise ConfigError("specimen.gradation", keys.gradation, f"is no gradation ({error})", "see the end of that message") from None


def radii(keys, radius, height):
	"""Radii [m] of the grains that fill a cylinder at the wished porosity, in random order.

	:param keys: the configuration's specimen section.
	:param radius: of the cylinder [m].
	:param height: of the cylinder [m].
	"""
	curve = grading(keys)
	volume = math.pi * radius**2 * height
	if keys.grains is None:
		curve = curve.scaled(keys.scale or 1.0)
		count = curve.grainCount(keys.porosity, volume)
		if not 20 <= count <= 1000000:
			raise ConfigError("specimen.scale", keys.scale, f"gives {count} grains", "change it, or wish for a number of grains")
	else:
		count = keys.grains
		curve = curve.scaled(curve.scaleForGrains(count, keys.porosity, volume))
	return curve.sample(count, keys.seed)


def plannedRadii(config):
	"""Radii [m] of the grains that :func:`provide` will give, without packing them."""
	if config.specimen.packing is not None:
		return _load(config.specimen.packing).radii
	if config.specimen.balls is not None:
		return balls.read(config.specimen.balls, config.specimen.ballsUnit).radii
	return radii(config.specimen, soilRadius(config), config.specimen.height)


def make(config, say):
	"""Pack the grains of the configuration's sizes into the cylinder that its lateral boundary will enclose.

	Under ``specimen.stress`` contacts are as stiff as the test's. A direct stiffness is met by grains of the mean size.

	Grains without friction have one porosity under that stress: without the key ``specimen.porosity`` it is theirs, with it what is given must be it.

	:returns: a :class:`hexmembrane.scene.packing_file.Packing`.
	:raises RuntimeError: the porosity is out of reach; the message says what is in reach.
	"""
	keys = config.specimen
	radius = soilRadius(config)
	sizes = radii(keys, radius, keys.height)
	stressed, porosity = {}, keys.porosity
	if keys.stress is not None:
		if keys.friction == 0 and "specimen.porosity" not in config.given:
			porosity = math.nan
		mean = float((sizes**3).mean()) ** (1 / 3)
		stressed = {"stress": keys.stress, "emod": keys.springs.own(mean / 2) / (math.pi * mean), "stiffnessRatio": keys.springs.ratio}
		stressed.update(friction=keys.friction, rollingFriction=keys.packingRollingFriction)
	generator = yade.CylinderPacking(
		radius=radius, height=keys.height, radii=sizes.tolist(), porosity=porosity, seed=keys.seed, **stressed
	)
	generator.generate()
	packing = packing_file.Packing.of(generator, gradation=pathlib.Path(keys.gradation).name if keys.gradation else "by number")
	span = f"{1e3 * packing.radii.min():.4g} to {1e3 * packing.radii.max():.4g} mm"
	say(f"specimen: {len(packing)} grains of radius {span}, porosity {packing.porosity:.4f}")
	if stressed:
		side, ends = 1e-3 * generator.radialStress, 1e-3 * generator.axialStress
		say(f"packed under {side:.4g} kPa (side) and {ends:.4g} kPa (ends), coordination {generator.coordination:.3g}")
	return packing


def provide(config, out, say):
	"""The packing of a test: read from ``specimen.packing`` or ``specimen.balls``, or made; either way ``packing.txt`` in the folder ``out`` is it.

	:raises ConfigError: the file is none, or is for another specimen.
	"""
	packing = make(config, say) if config.specimen.made else _fitted(config, say) if config.specimen.packing is None else _read(config, say)
	packing_file.save(packing, pathlib.Path(out) / "packing.txt")
	return packing


def _load(path):
	try:
		return packing_file.load(path)
	except (OSError, ValueError) as error:
		raise ConfigError("specimen.packing", path, f"is no packing ({error})", "see the end of that message") from None


def _read(config, say):
	"""The packing in the configuration's file, which must fit its specimen."""
	keys = config.specimen
	packing = _load(keys.packing)
	for name, has, wants in (("radius", packing.radius, soilRadius(config)), ("height", packing.height, keys.height)):
		if abs(has - wants) > 1e-9 * wants:
			raise ConfigError("specimen.packing", keys.packing, f"has {name} {has:.9g} m, this specimen needs {wants:.9g} m", f"set specimen.{name} right")
	if packing.origin.any():
		raise ConfigError("specimen.packing", keys.packing, f"stands on {packing.origin.tolist()}", "give one that stands on the origin")
	say(f"specimen: {len(packing)} grains from {keys.packing}, porosity {packing.porosity:.4f}")
	return packing


def _fitted(config, say):
	"""The balls of the configuration's table, moved so that the cylinder round them stands on the origin; overlaps stay."""
	keys, radius = config.specimen, soilRadius(config)
	found = balls.read(keys.balls, keys.ballsUnit)
	around, mean = balls.circumscribed(found.centres, found.radii), float(found.radii.mean())
	for name, has, wants in (("radius", around.radius, radius), ("height", around.height, keys.height)):
		if has > wants + _BEYOND * mean:
			wrong = f"the balls need {has:.9g} m, they reach {(has - wants) / mean:.3g} mean radii beyond; {_BEYOND:g} is allowed"
			raise ConfigError(f"specimen.{name}", wants, wrong, f"specimen.{name}: {has:.9g}, or leave it out: it is then that of the cylinder round the balls")
	centres = found.centres - [around.x, around.y, around.z + (around.height - keys.height) / 2 * (around.height > keys.height)]
	try:
		packing = packing_file.Packing(centres, found.radii, radius, keys.height, extra={"balls": pathlib.Path(keys.balls).name}, maxOverlap=_OVERLAP)
	except ValueError as error:
		raise ConfigError("specimen.balls", keys.balls, f"is no specimen ({error})", "see the end of that message; is specimen.ballsUnit right?") from None
	say(
		f"specimen: {len(packing)} balls from {keys.balls} (in {keys.ballsUnit}), moved by ({-around.x:.4g}, {-around.y:.4g}, {-around.z:.4g}) m; the cylinder round them "
		f"has the radius {1e3 * around.radius:.5g} mm and the height {1e3 * around.height:.5g} mm, the specimen {1e3 * radius:.5g} mm and {1e3 * keys.height:.5g} mm; "
		f"largest overlap {100 * packing.maxOverlap:.2g} % of the mean radius, porosity {packing.porosity:.4f}"
		+ (f"; columns left out: {', '.join(found.left)}" if found.left else "")
	)
	return packing
