# SPDX-License-Identifier: GPL-2.0-or-later
"""The configuration of a triaxial test: sections, keys, units, defaults and ranges. SI units everywhere.

``Config.of({...})`` gives a checked :class:`Config`. Files: :mod:`hexmembrane.configuration.files`. Uses nothing of YADE.
"""

import dataclasses
import math
import os
from typing import List, Optional

from hexmembrane.configuration import balls
from hexmembrane.configuration.cement import Cement
from hexmembrane.configuration.contacts import Contacts
from hexmembrane.configuration.lab import Lab
from hexmembrane.configuration.measure import Measure
from hexmembrane.configuration.schema import REQUIRED, ConfigError, build, key, paths, section, shared, toDict
from hexmembrane.configuration.specimen import PATHS, Specimen
from hexmembrane.configuration.stages import Stage, checkPlan
from hexmembrane.configuration.stiffness import Springs, checkSprings, ownKey, springsOf

#: Poisson's ratio of a lattice whose bonds have no shear stiffness, and how near to it a value, written with six digits say, is it.
_CENTRAL, _NEAR = 1 / 3, 1e-6


@dataclasses.dataclass
class Membrane:
	"""The hexagonal membrane, its own stiffness and the pressure on it."""

	particleRadius: Optional[float] = key(
		None, "radius of the membrane's spheres, adjusted so that rings close; none: from sizeRatio", "m", low=0, openLow=True
	)
	sizeRatio: float = key(
		0.8,
		"R/r, membrane sphere to smallest grain radius, used without particleRadius; from its upper limit on, Eq. 1, a grain passes three spheres that touch",
		"",
		low=0,
		openLow=True,
		high=3 / (2 * math.sqrt(3) - 3),
	)
	placement: str = shared("placement", "inner surface ('outside') or centres ('centred') on the specimen's surface")
	oRingRows: int = shared("o_ring_rows", "rows at each end, beyond the specimen, held by the O-rings (group 1)", low=1, high=50)
	platenRows: Optional[int] = shared(
		"platen_rows", "rows beside each platen, pressed radially (group 2); none: as many as cover the smallest grain, 2 at least", default=None, high=50
	)
	young: float = key(1.0e6, "Young's modulus of the membrane's material", "Pa", low=0, openLow=True)
	thickness: float = key(
		3e-4, "thickness of the material; only young * thickness matters, twice pressure * grain radius or more", "m", low=0, openLow=True
	)
	poisson: float = shared("lattice_poisson", "in-plane Poisson's ratio of the lattice; 1/3 has central forces only", default=_CENTRAL)
	contactKn: Optional[float] = key(
		None,
		"normal stiffness of a membrane sphere's own spring towards grains and platens, in series with theirs; none: the grains' own", "N/m", low=0, openLow=True
	)
	contactKs: Optional[float] = key(None, "shear stiffness of the same spring, which acts where there is friction; none: contactKn", "N/m", low=0, openLow=True)
	density: float = key(1000.0, "density of the membrane's spheres", "kg/m3", low=0, openLow=True)
	densityScaling: Optional[float] = key(
		1.0, "factor on the mass of the membrane's spheres, for a longer time step where they set it; none: as much as lets the grains set it", "", low=1
	)
	bendingStiffness: Optional[float] = shared(
		"plate_stiffness",
		"bending stiffness D of the sheet, of a plate E t^3/(12 (1 - nu^2)); 0: none; without a value it follows from sag",
		"N m",
		default=None,
	)
	sag: float = key(
		0.015,
		"sag of the sheet over a hollow between grains that D = pressure r^3/(64 sag) allows, as a share of the mean grain's radius r, the hollow's radius: "
		"grains scaled up need a stiffer sheet to sag as little as a laboratory's does over its sand; used without bendingStiffness",
		"",
		low=0,
		high=1,
		openLow=True,
	)
	selfContact: bool = key(False, "a folded sheet meets itself: its spheres repel each other where they are no neighbours in the lattice")
	facets: bool = key(
		True,
		"grains meet the sheet between the membrane's spheres where it is stretched, so that none presses itself through; not beside a broken bond",
	)
	tensileStrength: Optional[float] = key(None, "tension at which a bond of two membrane spheres breaks; none: never", "N", low=0, openLow=True)
	shearStrength: Optional[float] = key(
		None, "shear force at which such a bond breaks, with poisson below 1/3; none: never", "N", low=0, openLow=True
	)
	tensionOnly: bool = key(False, "bonds carry tension only: the sheet wrinkles instead of carrying compression")
	oRings: str = shared("o_ring_mode", "O-ring rows ride with the platens or stay fixed in space", default="platens")
	surface: str = shared("pressure_surface", "surface on which the pressure acts, inner surface or sphere centres")
	areaRule: str = shared(
		"area_rule",
		"area of a particle of group 2: its share of the present inner surface, 2 pi (r - R)/n times the rings' distance, or the cube's (2R)^2",
	)
	servoTime: Optional[float] = key(
		None,
		"time constant of the loop that brings group 2's transmitted pressure to the target; none: 4 d sqrt(rho/pressure), d the mean grain "
		"diameter; .inf: open loop",
		"s",
		low=0,
		openLow=True,
		infinite=True,
	)
	pressureTime: Optional[float] = key(
		None,
		"the same of the main body, whose own tension presses on the soil too; none: 10 d sqrt(rho/pressure); .inf: open loop, the pressure asked "
		"for is on the membrane",
		"s",
		low=0,
		openLow=True,
		infinite=True,
	)
	maxFactor: float = key(
		1.5,
		"largest factor between the pressure on the membrane and the one asked for, and the inverse of the least: where the membrane carries more, the loops stand at it",
		"",
		low=1,
		high=1000,
		openLow=True,
	)
	servoMaxFactor: float = key(2.0, "largest such factor of the rows beside the platens, whose least is 0", "", low=1, high=1000, openLow=True)
	REPLACED = {
		"gain": "membrane.servoTime, a time constant in s; for gain: 0, .inf",
		"pressureGain": "membrane.pressureTime, a time constant in s; for pressureGain: 0, .inf",
	}

	@property
	def centralBonds(self):
		"""Whether the bonds carry normal forces only, so that the spheres need not turn."""
		return self.poisson == _CENTRAL

	def check(self, path):
		if abs(self.poisson - _CENTRAL) <= _NEAR:
			self.poisson = _CENTRAL
		if self.tensionOnly and not self.centralBonds:
			raise ConfigError(
				f"{path}.tensionOnly", True, f"needs central bonds, and poisson = {self.poisson:g} has shear springs", "leave poisson at 1/3"
			)
		if self.shearStrength is not None and self.centralBonds:
			raise ConfigError(
				f"{path}.shearStrength", self.shearStrength, "bonds with poisson = 1/3 carry no shear force", "leave it out, or lower poisson"
			)
		if self.contactKs is not None and self.contactKn is None:
			raise ConfigError(f"{path}.contactKn", None, "the stiffness is given in half", "give contactKn too, or remove contactKs")


@dataclasses.dataclass
class Wall:
	"""The rigid cylinder wall of ``boundary: wall``: one radius, moved by a servo that holds the mean radial stress."""

	friction: float = shared("friction", "coefficient of friction on the wall; with grains the lesser of both acts", default=0.0, high=5)
	kn: Optional[float] = ownKey("normal stiffness of the wall's own spring towards the grains, with ks; with grains both springs are in series", "N/m")
	ks: Optional[float] = ownKey("shear stiffness of the same spring", "N/m")
	emod: Optional[float] = ownKey("contact modulus of the wall's own, instead of kn and ks", "Pa")
	kratio: Optional[float] = ownKey("kn/ks with emod", "", low=1.0, high=1000)
	damping: float = shared(
		"servo_damping",
		"damping ratio of the radial servo, 1: critical for the wall's contacts alone; while the radius grows at v the wall carries "
		"4 damping K dt v more than its target, K the stiffness of its contacts",
		default=0.2,
		high=10,
	)
	tolerance: float = shared("servo_tolerance", "relative error of the radial stress below which the servo has reached its target", high=0.5)
	maxVelocity: Optional[float] = key(
		None, "largest velocity of the radius; none: 1e-3 radius/(d sqrt(rho/pressure)), an inertial number of 1e-3, and outwards in shear at least 4 times what constant volume takes", "m/s", low=0, openLow=True
	)

	def check(self, path):
		checkSprings(path, self)


@dataclasses.dataclass
class Platens:
	"""The two rigid end platens."""

	radius: Optional[float] = key(
		None, "radius of the faces; none: the specimen's; larger, as with a laboratory's lubricated ends: the soil may widen over them, and the membrane, held as before, does not meet them", "m", low=0, openLow=True
	)
	thickness: Optional[float] = key(None, "thickness; none: the membrane's end rows plus twice the largest travel", "m", low=0, openLow=True)
	friction: float = shared("friction", "coefficient of friction on the platens, no rolling friction; with grains the lesser of both acts", default=0.3, high=5)
	consolidationFriction: Optional[float] = shared(
		"friction",
		"the same until the end of consolidation; none: friction; rough platens hold the soil's ends back as the specimen shrinks, and its radial "
		"stress there is then below the pressure",
		default=0.0,
		high=5,
	)
	kn: Optional[float] = ownKey("normal stiffness of the platens' own spring towards the grains, with ks; with grains both springs are in series", "N/m")
	ks: Optional[float] = ownKey("shear stiffness of the same spring", "N/m")
	emod: Optional[float] = ownKey("contact modulus of the platens' own, instead of kn and ks", "Pa")
	kratio: Optional[float] = ownKey("kn/ks with emod", "", low=1.0, high=1000)

	def check(self, path):
		checkSprings(path, self)


@dataclasses.dataclass
class Consolidation:
	"""Isotropic consolidation."""

	pressure: float = key(REQUIRED, "confining pressure sigma3, pushes inwards", "Pa", low=0, openLow=True)
	rampTime: Optional[float] = key(
		None, "time over which the pressure rises smoothly; none: 30 d sqrt(rho/pressure), d the mean grain diameter", "s", low=0, openLow=True
	)
	friction: Optional[float] = shared(
		"friction", "coefficient of friction between grains until the end of consolidation; none: specimen.friction; lower: denser", default=None, high=5
	)
	axial: str = key(
		"soil",
		"axial stress that is brought to the pressure: that of the soil itself, in its middle half and from its contacts, or the platen's "
		"force over its face ('platen', PFC's way: the soil then has what the membrane leaves of it)",
		"",
		choices=("soil", "platen"),
	)
	radial: Optional[str] = key(
		None,
		"likewise the radial stress in the membrane: the soil's own in its middle half ('soil'), or the transmitted pressure ('transmitted'); in shear the "
		"transmitted pressure is held that consolidation ended with; none: soil where the membrane's loop is closed, transmitted with pressureTime .inf",
		"",
		choices=("soil", "transmitted"),
	)
	stressTime: Optional[float] = key(
		None,
		"time constant of the loops that are closed on the soil; none: 5 d sqrt(rho/pressure) axially and 10 radially, d the mean grain diameter",
		"s",
		low=0,
		openLow=True,
	)
	maxFactor: float = key(
		1.5, "likewise of the loops that are closed on the soil: what a platen or the membrane presses with over the stress asked for", "", low=1, high=1000, openLow=True
	)
	unbalanced: float = key(1e-3, "limit of the unbalanced force ratio, membrane counted", "", low=0, high=0.1, openLow=True, free=True)
	tolerance: Optional[float] = key(
		None,
		"largest relative distance of transmitted pressure and axial stress from the pressure; none: 0.005, and 0.05 with an open loop on the membrane",
		"",
		low=0,
		high=0.5,
		openLow=True,
		free=True,
	)
	maxSteps: int = key(200000, "steps after which a test that has not come to rest stops with an error", "", low=100, high=10**9, free=True)
	timeLimit: Optional[float] = key(
		None,
		"time that the servos of top platen and rigid wall have to reach each target once, else the test stops with an error; none: maxSteps alone limits",
		"s",
		low=0,
		openLow=True,
		free=True,
	)


def restTolerance(tolerance, boundary, pressureTime):
	"""``consolidation.tolerance``, or without one what the boundary can hold: without a closed loop the membrane's own tension is on the soil too."""
	if tolerance is not None:
		return tolerance
	return 0.05 if boundary == "membrane" and pressureTime == math.inf else 0.005


@dataclasses.dataclass
class Shear:
	"""Shearing at constant confining pressure."""

	strain: float = key(0.12, "axial strain at the end, compression positive", "", low=0, high=0.5, openLow=True)
	velocity: float = key(0.02, "speed at which the platens approach each other", "m/s", low=0, high=10, openLow=True)
	moving: str = key("top", "platens that move; both: half the velocity each", "", choices=("top", "both"))
	rampStrain: float = key(0.0005, "axial strain over which the velocity rises smoothly from 0", "", low=0, high=0.1)
	pressureTolerance: float = key(
		0.05,
		"distance of the transmitted pressure from what the lateral boundary is to hold, as a share of sigma3 (column sigma3_distance), beyond which the log "
		"tells of it",
		"",
		low=0,
		high=10,
		openLow=True,
		free=True,
	)
	stopOutsideTolerance: bool = key(False, "a distance beyond pressureTolerance stops the test with an error; the last checkpoint stays", free=True)


@dataclasses.dataclass
class Numerics:
	"""Time step, damping, contact detection, threads."""

	dt: Optional[float] = key(None, "time step; none: safety times the critical one of contacts and membrane, rotations included", "s", low=0, openLow=True)
	safety: float = key(0.5, "share of the critical time step", "", low=0, high=1, openLow=True)
	damping: float = shared("local_damping", "local (Cundall) damping of NewtonIntegrator")
	verlet: float = key(0.2, "contact detection's skin in the reference tier, as a share of the smallest sphere's radius", "", low=0, high=1)
	skin: float = shared("list_skin", "skin of the neighbour lists in the compact tier, as a share of the smallest sphere's radius", high=1)
	substeps: int = shared("substeps", "steps that the compact tier takes in one YADE iteration at most", high=10**6)
	threads: Optional[int] = key(None, "OpenMP threads; none: as YADE was started", "", low=1, high=1024, free=True)


@dataclasses.dataclass
class Output:
	"""What is written and how often."""

	records: int = key(120, "rows of records.csv in shear", "", low=1, high=1000000)
	consolidationSteps: int = key(500, "steps between rows in consolidation", "", low=1, high=10**9)
	vtkEvery: int = key(20, "rows between VTK frames in shear, first and last state always; 0: no VTK", "", low=0, high=10**9, free=True)
	contacts: bool = key(True, "the soil's contacts with their forces in each VTK frame: lines for ParaView, force chains in report.html", free=True)
	checkpointEvery: int = key(20, "rows between checkpoints, start of the consolidation and end of each stage always; 0: only there", "", low=0, high=10**9, free=True)
	energy: bool = key(True, "track energies and record their balance")
	report: bool = key(True, "write report.html, a page with curves, scene and verdict, at the end of shear (examples/report.md)", free=True)


@dataclasses.dataclass
class Config:
	"""A whole test.

	Attribute: ``given``, the paths of the keys that it was made from, such as 'shear.velocity'; the others have their defaults.
	"""

	title: str = key("triaxial test", "a name for the plot and the log", free=True)
	accuracy: Optional[float] = key(
		None,
		"error of the peak of q that the settings of one run may cost, as a share: the cheapest that do are chosen for shear.velocity, specimen.emod, "
		"numerics.safety, membrane.sizeRatio, specimen.massScaling and membrane.densityScaling where these keys are left out; none: their defaults",
		"",
		low=0,
		high=1,
		openLow=True,
	)
	tier: str = key(
		"compact",
		"how steps are taken: by one engine over flat arrays ('compact', an order of magnitude faster) or by YADE's own loop ('reference')",
		"",
		choices=("compact", "reference"),
		free=True,
	)
	boundary: str = key(
		"membrane", "lateral boundary of the specimen: flexible membrane or rigid cylinder wall; the packing is the same", "", choices=("membrane", "wall")
	)
	stages: Optional[List[Stage]] = key(
		None, "what is done with the specimen, in order; none: consolidation and shear, as the sections of these names say, which also have what a stage leaves out"
	)
	specimen: Specimen = section(Specimen, "the grains")
	membrane: Membrane = section(Membrane, "the flexible membrane; particleRadius and placement also say the packing's radius")
	wall: Wall = section(Wall, "the rigid wall, used with boundary: wall")
	platens: Platens = section(Platens, "the end platens")
	cement: Cement = section(Cement, "cement at the contacts of grains: parallel bonds")
	contacts: Contacts = section(Contacts, "contacts of a pair of groups with a stiffness or friction of their own")
	consolidation: Consolidation = section(Consolidation, "isotropic consolidation")
	shear: Shear = section(Shear, "shearing")
	numerics: Numerics = section(Numerics, "time step, damping, threads")
	output: Output = section(Output, "records, VTK, checkpoints")
	measure: Measure = section(Measure, "measurement inside the specimen in shear")
	lab: Lab = section(Lab, "a laboratory's curve, drawn under the test's")

	@classmethod
	def of(cls, values, folder="."):
		"""A checked configuration from nested dictionaries; relative paths count from ``folder``.

		:raises ConfigError: says key path, value, what is wrong and the fix.
		"""
		if isinstance(values, dict):
			values = {name: value for name, value in values.items() if name != "made"}
		config = build(cls, values)
		config.given = frozenset(paths(values if isinstance(values, dict) else toDict(config)))
		if config.membrane.placement == "centred" and config.membrane.particleRadius is None:
			raise ConfigError("membrane.placement", "centred", "the soil's radius then follows from the particle's radius", "give membrane.particleRadius")
		if config.platens.radius is not None and config.platens.radius < config.specimen.radius:
			raise ConfigError("platens.radius", config.platens.radius, f"the specimen of radius {config.specimen.radius:g} m stands over it", "give that at least, or leave it out")
		for name in PATHS:
			path = getattr(config.specimen, name)
			if path is not None:
				path = os.path.realpath(os.path.join(folder, os.path.expanduser(path)))
				if not os.path.isfile(path):
					raise ConfigError(f"specimen.{name}", path, "there is no such file", "correct the path")
				setattr(config.specimen, name, path)
		config._takeLab(folder)
		config._takeSizeOfBalls()
		checkPlan(config)
		config.measure.checkWith(config.specimen, config.shear)
		return config

	def _takeLab(self, folder):
		"""The curve is read when a test begins or ends: a test whose curve has gone can still be resumed."""
		if self.lab.file is None:
			return
		if self.stages is not None:
			raise ConfigError("lab.file", self.lab.file, "a list of stages has no single curve", "leave out lab or stages")
		self.lab.file = os.path.realpath(os.path.join(folder, os.path.expanduser(self.lab.file)))

	def _takeSizeOfBalls(self):
		"""A specimen of balls that says no radius or height has those of the cylinder round them."""
		keys = self.specimen
		if keys.balls is not None and None in (keys.radius, keys.height):
			found = balls.read(keys.balls, keys.ballsUnit)
			around = balls.circumscribed(found.centres, found.radii)
			keys.radius, keys.height = keys.radius or around.radius, keys.height or around.height

	def springs(self, group):
		"""Stiffness of a group's own springs: of "specimen" (the grains), "membrane", "platens" or "wall"; where a group has none of its own, the grains'.

		:returns: :class:`hexmembrane.configuration.stiffness.Springs`.
		"""
		section = getattr(self, group)
		if group == "membrane":
			return Springs(section.contactKn, section.contactKs or section.contactKn) if section.contactKn else self.specimen.springs
		return springsOf(section) or self.specimen.springs
