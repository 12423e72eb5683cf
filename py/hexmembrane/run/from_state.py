# SPDX-License-Identifier: GPL-2.0-or-later
"""``--from STATE``: what the configuration says otherwise than the state is applied or refused, never only written down.

Beside the state lies the ``config.yaml`` of the test that made it. A key that acts before the shear and was given otherwise is refused; one that was not given
gets the state's value. Keys that act from here on are applied. What can be read from the state itself is compared in any case.
"""

import pathlib

import numpy
import yade
from yade import BodyArrays, O

from hexmembrane.configuration import ConfigError, toDict
from hexmembrane.configuration.reader import read
from hexmembrane.configuration.specimen import PATHS, SOURCES
from hexmembrane.configuration.stages import plan
from hexmembrane.run import manifest
from hexmembrane.scene import specimen
from hexmembrane.scene.handles import Scene, compactLoop

#: Sections and keys that act from the state on, or only say how a result is shown; files are known by the grains that they give.
_APPLIED_SECTIONS = ("shear", "measure", "output", "numerics", "lab")
_APPLIED = ("title", "tier", "accuracy", "stages", "specimen.friction", "platens.friction", *(f"specimen.{name}" for name in PATHS))
#: Keys that say how a packing is made.
_MAKING = ("scale", "cutBelow", "cutAbove", "grains", "porosity", "seed", "stress", "packingRollingFriction", "ballsUnit", *SOURCES)
#: Relative difference of what counts as the same number, and of the same radius in a file.
_SAME, _SAME_SIZE = 1e-9, 1e-6
#: Displacement of a grain over its radius that a state at the beginning of a stage may have.
_MOVED = 1e-6


def adopt(config, path, say):
	"""Bring a configuration to a state's own: refuse what was given otherwise, take over what was not given; the state's keys, None where no file tells them.

	:param config: checked configuration, changed. :param path: the state. :param say: takes lines of the log.
	:raises ConfigError: a key was given otherwise; it says the state's value.
	"""
	beside = pathlib.Path(path).parent / "config.yaml"
	if not beside.is_file() or not (beside.parent / manifest.NAME).exists():
		say("WARNING: no config.yaml of its test lies beside the state: stiffness, density, sheet, servos and sizes are compared, other keys cannot be")
		return None
	own, taken = read(beside), []
	for section, keys in toDict(config).items():
		values = own.get(section)
		if not isinstance(keys, dict) or not isinstance(values, dict) or section in _APPLIED_SECTIONS or _isOther(section, config):
			continue
		for name, value in keys.items():
			key = f"{section}.{name}"
			if key in _APPLIED or name not in values or value == values[name] or (section, name) == ("consolidation", "pressure"):
				continue
			if section == "specimen" and name in _MAKING and not (config.specimen.made and values.get("packing") is None and values.get("balls") is None):
				continue
			if key in config.given:
				raise ConfigError(key, value, f"the state was made with {values[name]!r}", "give that value, leave the key out, or make a specimen anew without --from")
			setattr(getattr(config, section), name, values[name])
			taken.append(f"{key} = {values[name]}")
	if taken:
		say("taken from the state's own configuration: " + ", ".join(taken))
	return own


def _isOther(section, config):
	"""Whether the section is of a lateral boundary that the test does not have."""
	return section == {"membrane": "wall", "wall": "membrane"}[config.boundary]


def require(config, path):
	"""Check that the state in ``O`` is at the end of a consolidation and is what the configuration says.

	:param path: the state, for messages.
	:raises ConfigError: it is not; with key, value, the state's value and the fix.
	"""
	scene = Scene()
	boundary = scene.lateralBoundary
	if boundary.name != config.boundary:
		raise ConfigError("boundary", config.boundary, f"the state has a {boundary.name}", f"give boundary: {boundary.name}")
	grains = scene.grainIds()
	radii = BodyArrays.radii(grains)
	moved = numpy.linalg.norm(BodyArrays.displacements(grains), axis=1) / radii
	if moved.max() > _MOVED:
		raise ConfigError("--from", str(path), "is no state at the end of a consolidation: its grains have moved since its stage began", "give consolidated.yade.gz of its folder")
	wanted, pressure = next(stage for stage in plan(config) if stage.chain).before, scene.pressure
	if abs(pressure - wanted) > _SAME * wanted:
		raise ConfigError("consolidation.pressure", wanted, f"the state was consolidated at {pressure} Pa", "give that pressure")
	for key, wants, has in _facts(config, boundary):
		if wants is not None and not (wants == has or not isinstance(wants, (bool, str)) and abs(has - wants) <= _SAME * abs(wants)):
			raise ConfigError(key, wants, f"the state has {has!r}", "give that value, or make a specimen anew without --from")
	planned = numpy.sort(specimen.plannedRadii(config))
	if len(planned) != len(radii) or abs(numpy.sort(radii) / planned - 1).max() > _SAME_SIZE:
		name = next(name for name in SOURCES if getattr(config.specimen, name) is not None)
		has = f"the state has {len(radii)} grains of {1e3 * radii.min():.4g} to {1e3 * radii.max():.4g} mm, this gives {len(planned)} of {1e3 * planned[0]:.4g} to {1e3 * planned[-1]:.4g} mm"
		raise ConfigError(f"specimen.{name}", getattr(config.specimen, name), has, "give the state's specimen: specimen.packing: packing.txt of its folder")
	_requireTravel(config, scene)


def _facts(config, boundary):
	"""(key, value in the configuration, value in the state) of what a state tells; a None is not compared."""
	groups = {"specimen": "grain", "platens": "platen", config.boundary: config.boundary}
	found = []
	for section, label in groups.items():
		material, springs = O.materials[label], config.springs(section)
		names = {"kn": "contactKn", "ks": "contactKs", "emod": "emod", "kratio": "kratio"} if section == "membrane" else {}
		owner = section if section == "specimen" or springs != config.specimen.springs else "specimen"
		for name, value in vars(springs).items():
			found.append((f"{owner}.{names.get(name, name) if owner == section else name}", value, getattr(material, name)))
	keys = config.specimen
	found += [("specimen.density", keys.density, O.materials["grain"].density), ("specimen.rollingFriction", keys.rollingFriction, O.materials["grain"].rollingFriction)]
	if config.boundary == "wall":
		servo = boundary.servo
		return [*found, ("wall.damping", config.wall.damping, servo.damping), ("wall.tolerance", config.wall.tolerance, servo.tolerance)]
	own, bonds = config.membrane, boundary.bonds
	found += [(f"membrane.{name}", getattr(own, name), getattr(bonds, name)) for name in ("young", "thickness", "poisson", "tensionOnly", "tensileStrength", "shearStrength")]
	found += [("membrane.maxFactor", own.maxFactor, boundary.pressureEngine.maxFactor), ("membrane.facets", own.facets, boundary.facets is not None), ("membrane.surface", own.surface, boundary.pressureEngine.surface)]
	found += [("membrane.oRings", own.oRings, boundary.oRings.mode), ("membrane.placement", own.placement, boundary.membrane.placement)]
	found += [(f"specimen.{name}", getattr(keys, name), getattr(boundary.membrane, f"specimen{name.title()}")) for name in ("radius", "height")]
	found.append(("membrane.pressureTime", own.pressureTime, boundary.pressureEngine.timeConstant))
	if boundary.radialServo:
		found.append(("membrane.servoMaxFactor", own.servoMaxFactor, boundary.radialServo.maxFactor))
		found += [("membrane.servoTime", own.servoTime, boundary.radialServo.timeConstant), ("membrane.areaRule", own.areaRule, boundary.radialServo.areaRule)]
	return found


def _requireTravel(config, scene):
	"""Platens have the thickness that the state's own test needed: a longer way would bring grains behind them."""
	thickness = min(O.bodies[drive.platen].shape.height for drive in (scene.bottomDrive, scene.topDrive))
	bottom, top = scene.faces()
	share = max((max(map(abs, stage.velocities)) / stage.speed for stage in plan(config) if stage.straining), default=0.0)
	if share * config.shear.strain * (top - bottom) >= thickness:
		most = thickness / (share * (top - bottom))
		raise ConfigError("shear.strain", config.shear.strain, f"the state's platens are {thickness:.4g} m thick, and grains would come behind them", f"less than {most:.3g}")


def apply(config, own, say):
	"""Give the scene in ``O``, in the configuration's tier, the numerical settings of the configuration.

	:param own: what :func:`adopt` gave.
	"""
	keys, loop, scene = config.numerics, compactLoop(), Scene()
	smallest = min(body.shape.radius for body in O.bodies if isinstance(body.shape, yade.Sphere))
	if loop:
		loop.damping, loop.substeps, loop.skin = keys.damping, keys.substeps, keys.skin * smallest
	for engine in O.engines:
		if isinstance(engine, yade.NewtonIntegrator):
			engine.damping = keys.damping
		elif isinstance(engine, yade.InsertionSortCollider):
			engine.verletDist = keys.verlet * smallest
	before = (own or {}).get("numerics") or {}
	if keys.dt is not None:
		O.dt = keys.dt
	elif own is not None and before.get("dt") is None and before.get("safety"):
		O.dt *= keys.safety / before["safety"] if keys.safety != before["safety"] else 1
	elif "numerics.safety" in config.given:
		O.dt = keys.safety * scene.criticalTimeStep()
	say(f"time step {O.dt:.4g} s")
