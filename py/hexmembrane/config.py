# SPDX-License-Identifier: GPL-2.0-or-later
"""The configuration of a triaxial test: sections, keys, units, defaults and ranges. SI units everywhere.

``load('test.yaml')`` or ``Config.of({...})`` gives a checked :class:`Config`; nothing is made before it has passed.
``resolved(config)`` adds seed and versions, and what it gives can be run again. Needs no YADE.
"""

import dataclasses
import datetime
import os
import pathlib
import platform
import subprocess
import sys
from typing import Optional

import numpy
import yaml

from hexmembrane.schema import REQUIRED, ConfigError, build, key, section, toDict

#: Keys of the specimen that are files.
_PATHS = ("packing", "gradation")


@dataclasses.dataclass
class Specimen:
	"""The grains: gradation, packing, contact law."""

	radius: float = key(REQUIRED, "radius of the specimen", "m", low=0, openLow=True)
	height: float = key(REQUIRED, "height of the specimen", "m", low=0, openLow=True)
	packing: Optional[str] = key(None, "packing file to take instead of making one; relative to the configuration's folder")
	gradation: Optional[str] = key(None, "CSV file of the gradation (see gradation.py); relative to the configuration's folder")
	scale: Optional[float] = key(
		None, "factor on the gradation's diameters; none with a wished number of grains: it follows from that", "", low=0, openLow=True
	)
	cutBelow: Optional[float] = key(None, "leave out grains with a diameter below this, before scaling", "m", low=0)
	cutAbove: Optional[float] = key(None, "leave out grains with a diameter above this, before scaling", "m", low=0, openLow=True)
	grains: Optional[int] = key(None, "number of grains wished; none: follows from porosity, volume and scale", "", low=20, high=1000000)
	porosity: float = key(0.40, "porosity of the packing, before consolidation", "", low=0.3, high=0.6)
	seed: int = key(1, "seed of the packing's random numbers", "", low=0, high=2**31 - 1)
	density: float = key(2650.0, "density of the grains", "kg/m3", low=0, openLow=True)
	stress: Optional[float] = key(
		None,
		"isotropic stress under which the packing is made, small against the test's; none: grains that touch nothing",
		"Pa",
		low=0,
		openLow=True,
	)
	friction: float = key(0.5, "coefficient of friction between grains, tan of the angle; also of a packing made under stress", "", low=0, high=5)
	rollingFriction: float = key(0.0, "coefficient of rolling friction mu_r between grains, moment <= mu_r R1 R2/(R1 + R2) Fn", "", low=0, high=5)
	packingRollingFriction: float = key(
		0.0, "coefficient of rolling friction while a packing is made under stress; looser ones need it, it may be rollingFriction's value", "", low=0, high=5
	)
	emod: float = key(
		4e7,
		"contact modulus of PFC's deformability: kn = pi emod min(R1, R2)^2/(R1 + R2), pi emod R on platens and wall; "
		"equal grains of diameter d: kn/(p d) = pi emod/(4 p), which should be 300 or more",
		"Pa",
		low=0,
		openLow=True,
	)
	kratio: float = key(3.0, "kn/ks of the contacts", "", low=1, high=1000)

	def check(self, path):
		if (self.packing is None) == (self.gradation is None):
			raise ConfigError(
				f"{path}.gradation", self.gradation, "the grains need one source, a gradation or a packing", "give exactly one of the two"
			)
		if self.scale is not None and self.grains is not None:
			raise ConfigError(f"{path}.scale", self.scale, "the number of grains is wished too, it fixes the scale", "remove one of the two")
		if None not in (self.cutBelow, self.cutAbove) and self.cutBelow >= self.cutAbove:
			raise ConfigError(f"{path}.cutBelow", self.cutBelow, f"is not below cutAbove = {self.cutAbove}", "swap or change the cuts")


@dataclasses.dataclass
class Membrane:
	"""The hexagonal membrane, its own stiffness and the pressure on it."""

	particleRadius: Optional[float] = key(
		None, "radius of the membrane's spheres, adjusted so that rings close; none: from sizeRatio", "m", low=0, openLow=True
	)
	sizeRatio: float = key(
		0.8, "R/r, membrane sphere to smallest grain radius, used without particleRadius", "", low=0, high=6.464, openLow=True
	)
	placement: str = key(
		"outside", "inner surface ('outside') or centres ('centred') on the specimen's surface", "", choices=("outside", "centred")
	)
	oRingRows: int = key(2, "rows at each end, beyond the specimen, held by the O-rings (group 1)", "", low=1, high=50)
	platenRows: Optional[int] = key(
		None, "rows beside each platen, pressed radially (group 2); none: as many as cover the smallest grain, 2 at least", "", low=0, high=50
	)
	young: float = key(1.0e6, "Young's modulus of the membrane's material", "Pa", low=0, openLow=True)
	thickness: float = key(
		3e-4, "thickness of the material; only young * thickness matters, twice pressure * grain radius or more", "m", low=0, openLow=True
	)
	poisson: float = key(1 / 3, "in-plane Poisson's ratio of the lattice; 1/3 has central forces only", "", low=0, high=0.33333334)
	density: float = key(1000.0, "density of the membrane's spheres", "kg/m3", low=0, openLow=True)
	densityScaling: Optional[float] = key(
		1.0, "factor on the mass of the membrane's spheres, for a longer time step where they set it; none: as much as lets the grains set it", "", low=1
	)
	tensionOnly: bool = key(False, "bonds carry tension only: the sheet wrinkles instead of carrying compression")
	oRings: str = key("platens", "O-ring rows ride with the platens or stay fixed in space", "", choices=("platens", "fixed"))
	surface: str = key("inner", "surface on which the pressure acts, inner surface or sphere centres", "", choices=("inner", "centre"))
	areaRule: str = key(
		"tributary", "area of a particle of group 2: 2 sqrt(3) R^2 or the circumscribed cube's (2R)^2", "", choices=("tributary", "cube")
	)
	gain: float = key(0.05, "gain of the loop that brings group 2's transmitted pressure to the target, 0: open loop", "", low=0, high=1)
	pressureGain: float = key(
		0.2,
		"the same of the main body, whose own tension presses on the soil too; 0: the pressure asked for is on the membrane",
		"",
		low=0,
		high=1,
	)

	def check(self, path):
		if self.tensionOnly and self.poisson < 0.333333:
			raise ConfigError(
				f"{path}.tensionOnly", True, f"needs central bonds, and poisson = {self.poisson:g} has shear springs", "leave poisson at 1/3"
			)


@dataclasses.dataclass
class Wall:
	"""The rigid cylinder wall of ``boundary: wall``: one radius, moved by a servo that holds the mean radial stress."""

	friction: float = key(0.0, "coefficient of friction on the wall; with grains the lesser of both acts", "", low=0, high=5)
	damping: float = key(
		0.2,
		"damping ratio of the radial servo, 1: critical for the wall's contacts alone; while the radius grows at v the wall carries "
		"4 damping K dt v more than its target, K the stiffness of its contacts",
		"",
		low=0,
		high=10,
	)
	tolerance: float = key(
		0.01, "relative error of the radial stress below which the servo has reached its target", "", low=0, high=0.5, openLow=True
	)
	maxVelocity: Optional[float] = key(
		None, "largest velocity of the radius; none: 1e-3 radius/(d sqrt(rho/pressure)), an inertial number of 1e-3", "m/s", low=0, openLow=True
	)


@dataclasses.dataclass
class Platens:
	"""The two rigid end platens."""

	thickness: Optional[float] = key(None, "thickness; none: the membrane's end rows plus twice the largest travel", "m", low=0, openLow=True)
	friction: float = key(0.3, "coefficient of friction on the platens, no rolling friction; with grains the lesser of both acts", "", low=0, high=5)


@dataclasses.dataclass
class Consolidation:
	"""Isotropic consolidation."""

	pressure: float = key(REQUIRED, "confining pressure sigma3, pushes inwards", "Pa", low=0, openLow=True)
	rampTime: Optional[float] = key(
		None, "time over which the pressure rises smoothly; none: 30 d sqrt(rho/pressure), d the mean grain diameter", "s", low=0, openLow=True
	)
	friction: Optional[float] = key(
		None, "coefficient of friction between grains until the end of consolidation; none: specimen.friction; lower: denser", "", low=0, high=5
	)
	unbalanced: float = key(1e-3, "limit of the unbalanced force ratio, membrane counted", "", low=0, high=0.1, openLow=True)
	tolerance: Optional[float] = key(
		None,
		"largest relative distance of transmitted pressure and axial stress from the pressure; none: 0.005, and 0.05 with membrane.pressureGain 0",
		"",
		low=0,
		high=0.5,
		openLow=True,
	)
	maxSteps: int = key(200000, "steps after which a test that has not come to rest stops with an error", "", low=100)
	timeLimit: Optional[float] = key(
		None,
		"time that the servos of top platen and rigid wall have to reach each target once, else the test stops with an error; none: maxSteps alone limits",
		"s",
		low=0,
		openLow=True,
	)


@dataclasses.dataclass
class Shear:
	"""Shearing at constant confining pressure."""

	strain: float = key(0.12, "axial strain at the end, compression positive", "", low=0, high=0.5, openLow=True)
	velocity: float = key(0.02, "speed at which the platens approach each other", "m/s", low=0, high=10, openLow=True)
	moving: str = key("top", "platens that move; both: half the velocity each", "", choices=("top", "both"))
	rampStrain: float = key(0.0005, "axial strain over which the velocity rises smoothly from 0", "", low=0, high=0.1)


@dataclasses.dataclass
class Numerics:
	"""Time step, damping, contact detection, threads."""

	dt: Optional[float] = key(None, "time step; none: safety times the critical one of contacts and membrane", "s", low=0, openLow=True)
	safety: float = key(0.5, "share of the critical time step", "", low=0, high=1, openLow=True)
	damping: float = key(0.2, "local (Cundall) damping of NewtonIntegrator", "", low=0, high=1, openHigh=True)
	verlet: float = key(0.2, "contact detection's skin in the reference tier, as a share of the smallest sphere's radius", "", low=0, high=1)
	skin: float = key(0.3, "skin of the neighbour lists in the compact tier, as a share of the smallest sphere's radius", "", low=0, high=1, openLow=True)
	substeps: int = key(100, "steps that the compact tier takes in one YADE iteration at most", "", low=1)
	threads: Optional[int] = key(None, "OpenMP threads; none: as YADE was started", "", low=1, high=1024)


@dataclasses.dataclass
class Output:
	"""What is written and how often."""

	records: int = key(120, "rows of records.csv in shear", "", low=1, high=1000000)
	consolidationSteps: int = key(500, "steps between rows in consolidation", "", low=1)
	vtkEvery: int = key(20, "rows between VTK frames in shear, first and last state always; 0: no VTK", "", low=0)
	checkpointEvery: int = key(20, "rows between checkpoints, start of the consolidation and end of each stage always; 0: only there", "", low=0)
	energy: bool = key(True, "track energies and record their balance")


@dataclasses.dataclass
class Config:
	"""A whole test."""

	title: str = key("triaxial test", "a name for the plot and the log")
	tier: str = key(
		"compact",
		"how steps are taken: by one engine over flat arrays ('compact', an order of magnitude faster) or by YADE's own loop ('reference')",
		"",
		choices=("compact", "reference"),
	)
	boundary: str = key(
		"membrane", "lateral boundary of the specimen: flexible membrane or rigid cylinder wall; the packing is the same", "", choices=("membrane", "wall")
	)
	specimen: Specimen = section(Specimen, "the grains")
	membrane: Membrane = section(Membrane, "the flexible membrane; particleRadius and placement also say the packing's radius")
	wall: Wall = section(Wall, "the rigid wall, used with boundary: wall")
	platens: Platens = section(Platens, "the end platens")
	consolidation: Consolidation = section(Consolidation, "isotropic consolidation")
	shear: Shear = section(Shear, "shearing")
	numerics: Numerics = section(Numerics, "time step, damping, threads")
	output: Output = section(Output, "records, VTK, checkpoints")

	@classmethod
	def of(cls, given, folder="."):
		"""A checked configuration from nested dictionaries; relative paths count from ``folder``.

		:raises ConfigError: says key path, value, what is wrong and the fix.
		"""
		if isinstance(given, dict):
			given = {name: value for name, value in given.items() if name != "made"}
		config = build(cls, given)
		if config.membrane.placement == "centred" and config.membrane.particleRadius is None:
			raise ConfigError("membrane.placement", "centred", "the soil's radius then follows from the particle's radius", "give membrane.particleRadius")
		for name in _PATHS:
			path = getattr(config.specimen, name)
			if path is not None:
				path = pathlib.Path(folder, path).expanduser().resolve()
				if not path.is_file():
					raise ConfigError(f"specimen.{name}", str(path), "there is no such file", "correct the path")
				setattr(config.specimen, name, str(path))
		return config


def merged(given, changes):
	"""Nested dictionaries with changes: those of a section change its keys, everything else is replaced; neither argument is changed."""
	made = dict(given)
	for name, value in changes.items():
		old = made.get(name)
		made[name] = merged(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
	return made


def derived(config, changes):
	"""A checked configuration like ``config`` but for ``changes``, such as ``{"boundary": "wall", "specimen": {"seed": 2}}``.

	:raises ConfigError: as :meth:`Config.of`.
	"""
	return Config.of(merged(toDict(config), changes))


def load(path):
	"""The checked configuration in a YAML file. With a key ``base``, another file relative to this one, it is that with this one's changes.

	:raises ConfigError: a file is missing or no YAML, is its own base, or a key is wrong.
	"""
	return Config.of(*_layers(pathlib.Path(path), ()))


def _layers(path, above):
	"""(keys of the file and its bases, folder that relative paths count from); ``above``: the files that it is a base of."""
	given = _read(path)
	if not isinstance(given, dict) or "base" not in given:
		return given, path.parent
	changes = {name: value for name, value in given.items() if name != "base"}
	if not isinstance(given["base"], str):
		raise ConfigError("base", given["base"], "is not text", "give the YAML file that this one changes")
	base = path.parent / given["base"]
	if base.resolve() in (*above, path.resolve()):
		raise ConfigError("base", given["base"], "is its own base", "correct the path")
	below, folder = _layers(base, (*above, path.resolve()))
	if not isinstance(below, dict):
		raise ConfigError("base", str(base), "is not a mapping of keys", "write 'key: value' lines in it")
	specimen = below.get("specimen")
	if isinstance(specimen, dict):
		paths = {name: os.path.join(folder, specimen[name]) for name in _PATHS if isinstance(specimen.get(name), str)}
		below = merged(below, {"specimen": {name: os.path.abspath(os.path.expanduser(value)) for name, value in paths.items()}})
	return merged(below, changes), path.parent


def _read(path):
	"""What the YAML file says."""
	try:
		text = path.read_text(encoding="utf-8")
	except OSError as error:
		raise ConfigError("configuration", str(path), f"cannot be read ({error.strerror})", "correct the path") from None
	except UnicodeDecodeError:
		raise ConfigError("configuration", str(path), "is not text in UTF-8", "give a YAML file") from None
	try:
		return yaml.load(text, Loader=_UniqueKeys)
	except yaml.YAMLError as error:
		where = getattr(error, "problem_mark", None)
		line = f", line {where.line + 1}" if where else ""
		problem = getattr(error, "problem", None) or error
		raise ConfigError("configuration", f"{path}{line}", f"is not YAML ({problem})", "correct the line") from None


class _UniqueKeys(yaml.SafeLoader):
	"""PyYAML's safe loader, except that a key given twice is an error and not silently the last one."""

	def construct_mapping(self, node, deep=False):
		seen = set()
		for place, _ in node.value:
			name = self.construct_object(place, deep=True)
			if not isinstance(name, str):
				raise yaml.constructor.ConstructorError(None, None, f"key {name!r} is not text", place.start_mark)
			if name in seen:
				raise yaml.constructor.ConstructorError(None, None, f"key '{name}' is given twice", place.start_mark)
			seen.add(name)
		return super().construct_mapping(node, deep)


def _commit():
	"""The git commit of the checkout that this package is in ('-dirty' when changed), None elsewhere."""
	here = os.path.dirname(os.path.abspath(__file__))
	try:
		said = subprocess.run(
			["git", "-C", here, "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"], capture_output=True, text=True, timeout=10
		)
	except (OSError, subprocess.TimeoutExpired):
		return None
	return said.stdout.strip() if said.returncode == 0 else None


def resolved(config):
	"""The configuration with every default filled in and, under ``made``, date, versions and threads; ready for YAML."""
	from hexmembrane import __version__

	made = {
		"date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
		"hexmembrane": __version__,
		"commit": _commit(),
		"python": platform.python_version(),
		"numpy": numpy.__version__,
		"machine": platform.machine(),
	}
	if "yade" in sys.modules:
		import yade.config

		made.update(yade=yade.config.version, threads=yade.wrapper.Omega().numThreads)
	return {**toDict(config), "made": made}


def save(config, path):
	"""Write ``resolved(config)`` as YAML, by temporary name and rename."""
	path = pathlib.Path(path)
	part = path.with_name(path.name + ".part")
	part.write_text(yaml.safe_dump(resolved(config), sort_keys=False, allow_unicode=True, width=110), encoding="utf-8")
	part.replace(path)
