# SPDX-License-Identifier: GPL-2.0-or-later
"""The knobs of the study of accuracy: what a level of each changes in the base test, its abscissa, and about what it costs.

The base test is examples/quick.yaml to 15 % strain. A level that is quick.yaml's own value is the base run itself, which many knobs share.
"""

import dataclasses
import math

from hexmembrane.configuration import load
from hexmembrane.scene.timestep import inertialTime, stiffnessLevel
from survey import QUICK

#: Of every run. The time step is looked at where there are checkpoints, so there are some.
COMMON = {"shear": {"strain": 0.15}, "output": {"records": 60, "vtkEvery": 0, "checkpointEvery": 20, "energy": False, "report": False}}
#: Share of the base run's steps that its consolidation takes: 8,500 of 38,000.
CONSOLIDATION = 0.22
BASE = "base"
#: kn/(p d) of the stiffest grains, the reference of the stiffness.
STIFF = 3000
#: Porosity at which all numbers of grains can be packed; 500 do not go in at the base test's.
LOOSER = 0.43
_QUICK = load(QUICK)
_SOIL, _PRESSURE = _QUICK.specimen, _QUICK.consolidation.pressure


@dataclasses.dataclass
class Level:
	"""A value of a knob.

	:param value: as it is called.
	:param x: its abscissa; nan: none, or what the run's log says (``Knob.log``).
	:param change: what it changes in the base test.
	:param cost: about how many times the base run's processor time it takes.
	:param run: name of its runs, which levels of several knobs may share.
	:param slow: run only when slow levels are asked for.
	"""

	value: str
	x: float = math.nan
	change: dict = dataclasses.field(default_factory=dict)
	cost: float = 1.0
	run: str = ""
	slow: bool = False


@dataclasses.dataclass
class Knob:
	"""Levels of one thing, the reference first.

	:param axis: what the abscissa is.
	:param theory: order of the error in the abscissa that theory gives; negative: in its reciprocal; 0: none is known, the observed one is looked for; None: no order.
	:param paired: whether a packing is the same at all levels.
	:param packings: at most so many.
	:param log: pattern whose first group is the abscissa in a run's log.
	"""

	name: str
	axis: str
	levels: list
	theory: float = None
	paired: bool = True
	packings: int = 1000
	log: str = ""

	def __post_init__(self):
		for level in self.levels:
			level.run = level.run or (f"{self.name} {level.value}" if level.change else BASE)


def meanDiameter(grains):
	"""Mean diameter [m] by volume of so many grains in the base test's specimen, of which 1 - porosity they fill."""
	solid = (1 - _SOIL.porosity) * math.pi * _SOIL.radius ** 2 * _SOIL.height
	return (6 * solid / (math.pi * grains)) ** (1 / 3)


#: d sqrt(rho/p) of the base test [s].
TIME = inertialTime(meanDiameter(_SOIL.grains) / 2, _SOIL.density, _PRESSURE)


def shearing(factor):
	"""Cost of a shear stage with so many times the base's steps, the consolidation as it is."""
	return CONSOLIDATION + (1 - CONSOLIDATION) * factor


def _velocities():
	base = _QUICK.shear.velocity
	for v in (0.0075, 0.015, 0.03, 0.06, 0.12, 0.24, 0.48, 0.96):
		yield Level(f"{v:g}", v / _SOIL.height * TIME, {} if v == base else {"shear": {"velocity": v}}, shearing(base / v))


def _velocitiesOnStiffGrains():
	base = _QUICK.shear.velocity
	for v in (0.015, 0.06, 0.12, 0.24, 0.48, 0.96):
		change = {} if v == base else {"shear": {"velocity": v}}
		cost = math.sqrt(_emod(STIFF) / _SOIL.emod) * shearing(base / v)
		yield Level(f"{v:g}", v / _SOIL.height * TIME, {"specimen": {"emod": _emod(STIFF)}, **change}, cost, run="" if change else f"stiffness {STIFF}")


def _emod(kappa):
	"""Modulus [Pa] at which kn/(p d) is kappa."""
	return 4 * _PRESSURE * kappa / math.pi


def _moduli():
	for kappa in (STIFF, 1000, 300, 100, None):
		emod = _emod(kappa) if kappa else _SOIL.emod
		level = stiffnessLevel(emod, _PRESSURE)
		yield Level(f"{level:.0f}", level, {"specimen": {"emod": emod}} if kappa else {}, math.sqrt(emod / _SOIL.emod))


def _values(section, key, values, cost=lambda value: 1.0):
	"""Levels of a number of the configuration."""
	base = getattr(getattr(_QUICK, section), key)
	return [Level(f"{v:g}", v, {} if v == base else {section: {key: v}}, cost(v)) for v in values]


def _times(section, key, base):
	"""Levels of a time constant, in d sqrt(rho/p); ``base``: what it is by default, None where that is no single time."""
	middle = base or 10
	levels = [Level(f"{f * middle:g}", f * middle, {} if f * middle == base else {section: {key: f * middle * TIME}}) for f in (0.5, 1, 2, 4)]
	return levels if base else [*levels, Level("by default")]


def _sizes():
	for ratio, cost, slow in ((0.4, 3.5, False), (0.2, 28, True), (0.6, 1.6, False), (0.8, 1, False), (1.0, 0.8, False), (1.5, 0.7, False), (2.0, 0.6, False)):
		yield Level(f"{ratio:g}", ratio, {} if ratio == _QUICK.membrane.sizeRatio else {"membrane": {"sizeRatio": ratio}}, cost, slow=slow)


def _numbers():
	for grains, slow in ((3000, False), (500, False), (1200, False), (7000, True), (30000, True)):
		yield Level(f"{grains}", grains, {"specimen": {"grains": grains, "porosity": LOOSER}}, (grains / _SOIL.grains) ** (4 / 3), slow=slow)


def _tiers():
	short = {"shear": {"strain": 0.01}, "output": {"records": 4}}
	yield Level("reference", change={"tier": "reference", **short}, cost=20 * shearing(1 / 15))
	yield Level("compact", change=short, cost=shearing(1 / 15))


def knobs():
	"""All knobs, the most telling first."""
	raised, freed = {"specimen": {"massScaling": True}}, {"membrane": {"densityScaling": None}}
	fine = {"membrane": {"sizeRatio": 0.4, "densityScaling": None}}
	alike = {"membrane": {"poisson": 0.333}}
	return [
		Knob("velocity", "inertial number", list(_velocities()), theory=1),
		Knob("stiffness", "kn/(p d)", list(_moduli()), theory=-1),
		Knob("velocity on stiff grains", "inertial number", list(_velocitiesOnStiffGrains()), theory=1),
		Knob("damping", "local damping", _values("numerics", "damping", (0.1, 0.2, 0.3, 0.5, 0.7, 0.9)), theory=0),
		Knob("size ratio", "R/r", list(_sizes()), theory=0),
		Knob("skin", "skin over the smallest radius", _values("numerics", "skin", (0.1, 0.3, 0.6))),
		Knob(
			"mass scaling", "factor on the mass of all grains", [Level("off", 1.0), Level("on", change=raised, cost=0.85), Level("on with the membrane", change={**raised, **freed}, cost=0.45)],
			log=r"grains' mass times ([\d.]+)",
		),
		Knob("step", "share of the critical step", _values("numerics", "safety", (0.1, 0.2, 0.4, 0.5, 0.8), lambda safety: 0.5 / safety), theory=2),
		Knob("density scaling", "factor on the membrane's mass", _values("membrane", "densityScaling", (1, 4, 16, 64)), theory=1),
		Knob(
			"density scaling of a fine membrane", "factor on the membrane's mass at R/r = 0.4",
			[Level("1", 1.0, fine, 3.5, run="size ratio 0.4"), Level("as needed", change=fine, cost=2)],
			log=r"membrane's density times ([\d.]+)",
		),
		# R/r = 0.2 takes 28 times a base run unscaled, and a fifth of that with the masses it needs for the grains' step.
		Knob(
			"size ratio of a scaled membrane", "R/r",
			[
				Level("0.4", 0.4, fine, 2, run="density scaling of a fine membrane as needed"),
				Level("0.2", 0.2, {"membrane": {"sizeRatio": 0.2, "densityScaling": None}}, 6, slow=True),
			],
		),
		Knob("pressure loop", "membrane.pressureTime over d sqrt(rho/p)", _times("membrane", "pressureTime", 10), theory=1),
		Knob("loop beside the platens", "membrane.servoTime over d sqrt(rho/p)", _times("membrane", "servoTime", 4), theory=1),
		Knob("soil loops", "consolidation.stressTime over d sqrt(rho/p)", _times("consolidation", "stressTime", None), theory=1),
		Knob(
			"shear springs", "Poisson's ratio of the lattice",
			[Level("0.333", 0.333, alike, 1.3), Level("none", 1 / 3), *_values("membrane", "poisson", (0.3, 0.2), lambda _: 1.3)],
		),
		Knob("area rule", "", [Level("tributary"), Level("cube", change={"membrane": {"areaRule": "cube"}})]),
		Knob("surface", "", [Level("inner"), Level("centre", change={"membrane": {"surface": "centre"}})]),
		Knob("self-contact", "", [Level("on", change={"membrane": {"selfContact": True}}, cost=1.2), Level("off")]),
		Knob("grains", "number of grains", list(_numbers()), paired=False),
		Knob("tier", "", list(_tiers()), packings=2),
	]  # fmt: skip


#: Knobs of the tests in the rigid wall: those that their error budgets are made from.
OF_WALL = ("velocity", "stiffness", "velocity on stiff grains", "damping", "skin", "mass scaling", "step")


def ofWall():
	"""The knobs in the rigid wall, without levels that change a membrane."""
	found = [knob for knob in knobs() if knob.name in OF_WALL]
	for knob in found:
		knob.levels = [level for level in knob.levels if "membrane" not in level.change]
	return found


def short():
	"""One knob with a few quick levels, for a test of the study: (what all runs change, knobs)."""
	common = {
		"specimen": {"grains": 150, "porosity": 0.46},
		"consolidation": {"unbalanced": 0.08, "tolerance": 0.3, "rampTime": 0.004},
		"membrane": {"particleRadius": 3e-3},
		"shear": {"strain": 0.012, "velocity": 0.4, "rampStrain": 1e-4},
		"output": {"records": 12},
	}
	levels = [Level("0.4", 0.4), *(Level(f"{v:g}", v, {"shear": {"velocity": v}}, 0.4 / v) for v in (0.8, 1.6))]
	return common, [Knob("velocity", "velocity [m/s]", levels, theory=1)]
