# SPDX-License-Identifier: GPL-2.0-or-later
"""``--from STATE``: what the configuration says otherwise than the state is applied or refused, never only written down.

Beside the state lies the ``config.yaml`` of the test that made it. A key that acts before the shear and was given otherwise is refused; one that was not given
gets the state's value. Keys that act from here on are applied. What can be read from the state itself is compared in any case.
"""

import math
import pathlib

import numpy
import yade
from yade import BodyArrays, O

from hexmembrane.configuration import ConfigError
from hexmembrane.configuration.contacts import PAIRS
from hexmembrane.configuration.reader import read
from hexmembrane.configuration.schema import sections
from hexmembrane.configuration.specimen import PATHS, SOURCES
from hexmembrane.configuration.stages import CONSOLIDATION, MEMBRANE, SHEAR, boundaries, plan
from hexmembrane.run import manifest
from hexmembrane.scene import specimen
from hexmembrane.scene.handles import Scene, compactLoop

#: Sections and keys that act from the state on, or only say how a result is shown; files are known by the grains that they give.
_APPLIED_SECTIONS = ("shear", "measure", "output", "numerics", "lab")
_APPLIED = ("title", "tier", "accuracy", "stages", "specimen.friction", "platens.friction", *(f"contacts.{name}.friction" for name in PAIRS), *(f"specimen.{name}" for name in PATHS))
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
	for section, keys, values in _sections(config, own):
		if section in _APPLIED_SECTIONS or _isOther(section, config, own, path) or section == "cement" and not _isCemented(values):
			continue
		for name, value in vars(keys).items():
			key = f"{section}.{name}"
			if key in _APPLIED or name not in values or isinstance(values[name], dict) or value == values[name] or (section, name) == ("consolidation", "pressure"):
				continue
			if section == "specimen" and name in _MAKING and not (config.specimen.made and values.get("packing") is None and values.get("balls") is None):
				continue
			if key in config.given:
				raise ConfigError(key, value, f"the state was made with {values[name]!r}", "give that value, leave the key out, or make a specimen anew without --from")
			setattr(keys, name, values[name])
			taken.append(f"{key} = {values[name]}")
	if taken:
		say("taken from the state's own configuration: " + ", ".join(taken))
	return own


def _sections(section, own, path=""):
	"""(path, section, its values in the state's configuration) of the sections in a configuration or one of them, at any depth."""
	for field in sections(type(section)):
		inner, values = getattr(section, field.name), own.get(field.name)
		if isinstance(values, dict):
			yield path + field.name, inner, values
			yield from _sections(inner, values, f"{path}{field.name}.")


def _isOther(section, config, own, path):
	"""Whether the section is of a lateral boundary that the test does not have, or that the state does not have yet."""
	if section not in ("membrane", "wall"):
		return False
	return section not in boundaries(config) or section == "membrane" and pathlib.Path(path).name in _inTheWall(own)


def _isCemented(values):
	"""Whether a state has cement already, or will have where its own test goes on; ``values``: the section of its configuration."""
	return values.get("emod") is not None or values.get("kn") is not None


def _inTheWall(own):
	"""Names of the states of a test that have a wall; ``own``: its configuration as it was read."""
	if own.get("boundary") != "wall":
		return ()
	kinds = [entry.get("kind") for entry in own.get("stages") or ({"kind": CONSOLIDATION}, {"kind": SHEAR})]
	before = kinds[: kinds.index(MEMBRANE)] if MEMBRANE in kinds else kinds
	return tuple(f"{'consolidated' if k == 0 else f'{CONSOLIDATION}-{k + 1}'}.yade.gz" for k in range(before.count(CONSOLIDATION)))


def nextStage(config, boundary):
	"""Number of the stage in the plan that a state with this lateral boundary goes on with."""
	stages = plan(config)
	kinds = [stage.kind for stage in stages]
	if boundary == "wall" and MEMBRANE in kinds:
		return kinds.index(MEMBRANE)
	return next(k for k, stage in enumerate(stages) if stage.chain)


def require(config, path):
	"""Check that the state in ``O`` is at the end of a consolidation and is what the configuration says.

	:param path: the state, for messages.
	:raises ConfigError: it is not; with key, value, the state's value and the fix.
	"""
	scene = Scene()
	boundary = scene.lateralBoundary
	if boundary.name not in boundaries(config):
		fix = f"give boundary: {boundary.name}" + (", with '- {kind: membrane}' among the stages" if boundary.name == "wall" else "")
		raise ConfigError("boundary", config.boundary, f"the state has a {boundary.name}", fix)
	grains = scene.grainIds()
	radii = BodyArrays.radii(grains)
	moved = numpy.linalg.norm(BodyArrays.displacements(grains), axis=1) / radii
	if moved.max() > _MOVED:
		raise ConfigError("--from", str(path), "is no state at the end of a consolidation: its grains have moved since its stage began", "give consolidated.yade.gz of its folder")
	wanted, pressure = plan(config)[nextStage(config, boundary.name)].before, scene.pressure
	if abs(pressure - wanted) > _SAME * wanted:
		raise ConfigError("consolidation.pressure", wanted, f"the state was consolidated at {pressure} Pa", "give that pressure")
	for key, wants, has in _facts(config, boundary):
		if wants is not None and not (wants == has or not isinstance(wants, (bool, str)) and abs(has - wants) <= _SAME * abs(wants)):
			raise ConfigError(key, wants, f"the state has {has!r}", "give that value, or make a specimen anew without --from")
	_requirePairs(config)
	planned = numpy.sort(specimen.plannedRadii(config))
	if len(planned) != len(radii) or abs(numpy.sort(radii) / planned - 1).max() > _SAME_SIZE:
		name = next(name for name in SOURCES if getattr(config.specimen, name) is not None)
		has = f"the state has {len(radii)} grains of {1e3 * radii.min():.4g} to {1e3 * radii.max():.4g} mm, this gives {len(planned)} of {1e3 * planned[0]:.4g} to {1e3 * planned[-1]:.4g} mm"
		raise ConfigError(f"specimen.{name}", getattr(config.specimen, name), has, "give the state's specimen: specimen.packing: packing.txt of its folder")
	_requireTravel(config, scene)


def _requirePairs(config):
	"""Check what contacts of pairs of groups have of their own against the state's materials; frictions are applied. What no file told is taken over."""
	for name, (one, other) in PAIRS.items():
		pair, has = getattr(config.contacts, name), O.materials[one].pairs().get(other, {})
		for key in (key for key in vars(pair) if key != "friction"):
			wants, value = getattr(pair, key), has.get(key)
			path = f"contacts.{name}.{key}"
			if path in config.given and wants != value:
				raise ConfigError(path, wants, f"the state has {value!r}", "give that value, leave the key out, or make a specimen anew without --from")
			setattr(pair, key, value)


def _facts(config, boundary):
	"""(key, value in the configuration, value in the state) of what a state tells; a None is not compared."""
	groups = {"specimen": "grain", "platens": "platen", boundary.name: boundary.name}
	found = []
	for section, label in groups.items():
		material, springs = O.materials[label], config.springs(section)
		names = {"kn": "contactKn", "ks": "contactKs", "emod": "emod", "kratio": "kratio"} if section == "membrane" else {}
		owner = section if section == "specimen" or springs != config.specimen.springs else "specimen"
		for name, value in vars(springs).items():
			found.append((f"{owner}.{names.get(name, name) if owner == section else name}", value, getattr(material, name)))
	keys = config.specimen
	found += [("specimen.density", keys.density, O.materials["grain"].density), ("specimen.rollingFriction", keys.rollingFriction, O.materials["grain"].rollingFriction)]
	found.append(("platens.radius", config.platens.radius, O.bodies[Scene().topDrive.platen].shape.radius))
	if cement := Scene().cement:
		names = config.cement.properties() if config.cement.given else ()
		has = {name: math.degrees(cement.frictionAngle) if name == "frictionAngle" else getattr(cement, name) for name in names}
		found += [(f"cement.{name}", getattr(config.cement, name), value) for name, value in has.items()]
	if boundary.name == "wall":
		servo = boundary.servo
		return [*found, ("wall.damping", config.wall.damping, servo.damping), ("wall.tolerance", config.wall.tolerance, servo.tolerance)]
	own, bonds = config.membrane, boundary.bonds
	found += [(f"membrane.{name}", getattr(own, name), getattr(bonds, name)) for name in ("young", "thickness", "poisson", "tensionOnly", "tensileStrength", "shearStrength")]
	found += [("membrane.maxFactor", own.maxFactor, boundary.pressureEngine.maxFactor), ("membrane.facets", own.facets, boundary.facets is not None), ("membrane.surface", own.surface, boundary.pressureEngine.surface)]
	found += [("membrane.oRings", own.oRings, boundary.oRings.mode), ("membrane.placement", own.placement, boundary.membrane.placement)]
	if config.boundary == "membrane":  # else it has the size that the specimen had in the wall
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
