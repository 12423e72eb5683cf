# SPDX-License-Identifier: GPL-2.0-or-later
"""The key ``stages`` of a configuration, and the plan of a test: its stages in order, each with all that it needs. Uses nothing of YADE.

Without the key the plan is a consolidation and a shear, as the sections of these names say.
"""

import dataclasses
import math
from typing import List, Optional

from hexmembrane.configuration.schema import REQUIRED, ConfigError, key

CONSOLIDATION, MEMBRANE, SHEAR, UNLOADING, HOLD, PRESSURE, CYCLES = KINDS = ("consolidation", "membrane", "shear", "unloading", "hold", "pressure", "cycles")
#: Kinds of stages until rest at the confining pressure, after which strains count anew.
ISOTROPIC = (CONSOLIDATION, MEMBRANE)
_TURNING = ("strain", "q")
_STRAINING = (*_TURNING, "velocity", "velocities", "records", "strainStep")
#: Keys that a kind of stage has.
_KEYS = {
	CONSOLIDATION: ("pressure", "time"),
	MEMBRANE: ("time",),
	SHEAR: _STRAINING,
	UNLOADING: _STRAINING,
	HOLD: ("time", "records"),
	PRESSURE: ("pressure", "time", "records"),
	CYCLES: (*_STRAINING, "upperStrain", "upperQ", "count"),
}
#: Names of the states at the end of stages, where they are not the stage's label.
_STATES = {CONSOLIDATION: "consolidated", SHEAR: "sheared"}
#: Rows of a stage that lasts a time; rows of an unloading to a stress for one of the shear's.
_TIMED_ROWS, _FINER = 10, 10


@dataclasses.dataclass
class Stage:
	"""One entry of ``stages``."""

	kind: str = key(
		REQUIRED,
		"consolidation: isotropic, to a pressure, until rest; membrane: the rigid wall goes and the membrane comes in its place, at the same pressure, until rest; shear: platens approach; unloading: they part; hold: they stand; pressure: they stand while the confining "
		"pressure changes; cycles: unloading and shear in turn",
		"",
		choices=KINDS,
	)
	pressure: Optional[float] = key(None, "confining pressure at the end, of consolidation and pressure; none: consolidation.pressure", "Pa", low=0, openLow=True)
	strain: Optional[float] = key(
		None, "axial strain at the end, since the last consolidation; of cycles the lower end; of shear, without q, none: shear.strain", "", low=-0.5, high=0.5
	)
	q: Optional[float] = key(None, "deviatoric stress of the soil at which the stage ends, instead of strain; of cycles the lower end", "Pa")
	upperStrain: Optional[float] = key(None, "axial strain at the upper end of cycles", "", low=-0.5, high=0.5)
	upperQ: Optional[float] = key(None, "deviatoric stress at the upper end of cycles, instead of upperStrain", "Pa")
	count: int = key(1, "number of cycles", "", low=1, high=10000)
	velocity: Optional[float] = key(None, "speed at which the platens approach or part; none: shear.velocity", "m/s", low=0, high=10, openLow=True)
	velocities: Optional[List[float]] = key(
		None, "[bottom, top], the speed of each platen, towards each other in shear and apart in unloading; instead of velocity and shear.moving", "m/s", low=-10, high=10
	)
	time: Optional[float] = key(
		None,
		"how long the platens are held; over which the pressure changes smoothly, or comes onto the membrane, none: 30 d sqrt(rho/pressure)",
		"s",
		low=0,
		openLow=True,
	)
	records: Optional[int] = key(None, "rows to the strain or in the time; none: output.records, in hold and pressure 10", "", low=1, high=1000000)
	strainStep: Optional[float] = key(None, "axial strain between rows on the way to q; none: a tenth of shear.strain/output.records", "", low=0, high=0.1, openLow=True)

	def check(self, path):
		for name in [field.name for field in dataclasses.fields(self)][1:]:
			value = getattr(self, name)
			if name not in _KEYS[self.kind] and value is not None and not (name == "count" and value == 1):
				raise ConfigError(f"{path}.{name}", value, f"means nothing in a stage of kind {self.kind}", f"its keys are {', '.join(_KEYS[self.kind])}")
		if self.kind in (UNLOADING, CYCLES) and (self.strain is None) == (self.q is None) or self.kind == SHEAR and None not in (self.strain, self.q):
			raise ConfigError(f"{path}.strain", self.strain, "the stage needs one end", "give exactly one of strain and q")
		if self.kind == CYCLES and (self.upperStrain is None) == (self.upperQ is None):
			raise ConfigError(f"{path}.upperStrain", self.upperStrain, "the cycles need one upper end", "give exactly one of upperStrain and upperQ")
		if self.kind == HOLD and self.time is None:
			raise ConfigError(f"{path}.time", None, "is missing", "give how long the platens are held (s)")
		if self.kind == PRESSURE and self.pressure is None:
			raise ConfigError(f"{path}.pressure", None, "is missing", "give the confining pressure at the end (Pa)")
		if self.velocities is not None and (self.velocity is not None or len(self.velocities) != 2 or sum(self.velocities) <= 0):
			raise ConfigError(f"{path}.velocities", self.velocities, "is not a speed of each platen", "give [bottom, top], with a sum > 0, and no velocity")


@dataclasses.dataclass(frozen=True)
class Planned:
	"""A stage of a test.

	:param label: its name in the records, such as 'unloading-2'.
	:param kind: one of KINDS but CYCLES.
	:param pressure: confining pressure at its end [Pa].
	:param before: the same at its beginning, 0 for the first stage [Pa].
	:param chain: labels of the stages since the last consolidation, this one last; strains count from the first one's beginning.
	:param farthest: largest strain that the stages before it in the chain go to, -1: none.
	:param strain, q: where it ends; strain, or deviatoric stress [Pa].
	:param velocities: speeds of bottom and top platen, inwards positive [m/s].
	:param time: its duration or that of the pressure's change [s], None: by the grains.
	:param records: rows. :param strainStep: strain between rows on the way to q.
	:param path: of its keys in the configuration.
	"""

	label: str
	kind: str
	pressure: float
	before: float
	chain: tuple = ()
	farthest: float = -1.0
	strain: Optional[float] = None
	q: Optional[float] = None
	velocities: tuple = (0.0, 0.0)
	time: Optional[float] = None
	records: int = 0
	strainStep: float = 0.0
	path: str = ""

	@property
	def straining(self):
		"""Whether the platens move at a given speed."""
		return self.kind in (SHEAR, UNLOADING)

	@property
	def speed(self):
		"""Speed [m/s] at which the platens approach or part."""
		return abs(sum(self.velocities))

	@property
	def direction(self):
		"""1 where the strain grows, -1 where it falls."""
		return -1 if self.kind == UNLOADING else 1

	def describe(self):
		"""The stage in words."""
		if self.kind == MEMBRANE:
			return f"round the specimen instead of the wall, at {1e-3 * self.pressure:g} kPa, until rest"
		if not self.straining:
			change = f"from {1e-3 * self.before:g} to {1e-3 * self.pressure:g} kPa" if self.pressure != self.before else f"at {1e-3 * self.pressure:g} kPa"
			return change + (f" in {self.time:g} s" if self.time else "") + (f", {self.records} rows" if self.records else ", until rest")
		if self.q is not None:
			return f"to q = {1e-3 * self.q:g} kPa at {self.speed:g} m/s, rows at strain steps of {self.strainStep:.3g}"
		return f"to {100 * self.strain:g} % at {self.speed:g} m/s, {self.records} rows"

	@property
	def state(self):
		"""Name of the state at its end, without suffix."""
		return _STATES.get(self.label, self.label)


def plan(config):
	"""The :class:`Planned` stages of a configuration.

	:raises ConfigError: they do not follow one another.
	"""
	if config.stages is None:
		entries = [("consolidation", Stage(CONSOLIDATION)), ("shear", Stage(SHEAR))]
	else:
		entries = [(f"stages[{k}]", entry) for k, entry in enumerate(config.stages)]
		if not entries or entries[0][1].kind != CONSOLIDATION:
			raise ConfigError("stages", config.stages and config.stages[0].kind, "the first stage is no consolidation", "begin with '- {kind: consolidation}'")
	made, counts = [], {}
	for path, entry in [single for path, entry in entries for single in _singles(path, entry)]:
		counts[entry.kind] = counts.get(entry.kind, 0) + 1
		label = entry.kind if counts[entry.kind] == 1 else f"{entry.kind}-{counts[entry.kind]}"
		made.append(_planned(config, path, entry, label, made))
	_requirePlaceOfMembrane(config, made)
	return made


def _requirePlaceOfMembrane(config, stages):
	""":raises ConfigError: the membrane comes where there is no wall, or at another time than between consolidation and shear."""
	at = next((k for k, stage in enumerate(stages) if stage.kind == MEMBRANE), None)
	if at is None:
		return
	if config.boundary != "wall":
		raise ConfigError(f"{stages[at].path}.kind", MEMBRANE, f"there is no wall to put the membrane in the place of, boundary is {config.boundary}", "boundary: wall")
	if config.membrane.placement != "outside":
		raise ConfigError("membrane.placement", config.membrane.placement, "the membrane comes onto the grains where the wall was", "placement: outside")
	again = [stage for stage in stages if stage.kind == MEMBRANE][1:]
	if again or any(stage.chain for stage in stages[:at]):
		stage = again[0] if again else stages[at]
		raise ConfigError(f"{stage.path}.kind", MEMBRANE, "the membrane comes once, and before the platens shear", "one '- {kind: membrane}' after a consolidation")


def boundaries(config):
	"""Keywords of the lateral boundaries that a test has, one after the other."""
	changed = any(stage.kind == MEMBRANE for stage in config.stages or ())
	return ("wall", "membrane") if changed else (config.boundary,)


def boundariesIn(config, label):
	"""Those that the checkpoints of a stage may have: of the one that puts the membrane in the wall's place, either."""
	stages = plan(config)
	at = next((k for k, stage in enumerate(stages) if stage.kind == MEMBRANE), None)
	if at is None:
		return boundaries(config)
	now = next((k for k, stage in enumerate(stages) if stage.label == label), -1)
	return boundaries(config)[slice(0, 1) if now < at else slice(1, 2) if now > at else slice(None)]


def _singles(path, entry):
	"""Cycles as the stages that they are; (path, stage) of each."""
	if entry.kind != CYCLES:
		return [(path, entry)]
	upper = dataclasses.replace(entry, kind=SHEAR, strain=entry.upperStrain, q=entry.upperQ, upperStrain=None, upperQ=None, count=1)
	return entry.count * [(path, dataclasses.replace(entry, kind=UNLOADING, upperStrain=None, upperQ=None, count=1)), (path, upper)]


def _planned(config, path, entry, label, before):
	keys = config.shear
	last = before[-1] if before else None
	now = last.pressure if last else 0.0
	if entry.kind == CONSOLIDATION:
		pressure = config.consolidation.pressure if entry.pressure is None else entry.pressure
		return Planned(label, entry.kind, pressure, now, time=entry.time or config.consolidation.rampTime, path=path)
	if entry.kind == MEMBRANE:
		return Planned(label, entry.kind, now, now, time=entry.time, path=path)
	chain = (*last.chain, label)
	reached = [stage.strain for stage in before if stage.label in chain and stage.strain is not None]
	common = {"before": now, "chain": chain, "farthest": max(reached, default=-1.0), "path": path}
	if entry.kind in (HOLD, PRESSURE):
		pressure = now if entry.kind == HOLD else entry.pressure
		return Planned(label, entry.kind, pressure, time=entry.time, records=entry.records or _TIMED_ROWS, **common)
	strain = keys.strain if entry.kind == SHEAR and entry.strain is None and entry.q is None else entry.strain
	_requireWay(path, entry, strain, [stage for stage in before if stage.label in chain and stage.straining])
	speeds = entry.velocities or [share * (entry.velocity or keys.velocity) for share in {"top": (0.0, 1.0), "both": (0.5, 0.5)}[keys.moving]]
	sign = -1 if entry.kind == UNLOADING else 1
	return Planned(
		label,
		entry.kind,
		now,
		strain=strain,
		q=entry.q,
		velocities=tuple(sign * speed for speed in speeds),
		records=entry.records or config.output.records,
		strainStep=entry.strainStep or keys.strain / config.output.records / _FINER,
		**common,
	)


def _requireWay(path, entry, strain, before):
	"""A shear ends at a larger strain than the stage before it, an unloading at a smaller one, as far as that is known."""
	at = before[-1].strain if before else 0.0
	if strain is None or at is None:
		return
	if entry.kind == SHEAR and strain <= at:
		raise ConfigError(f"{path}.strain", strain, f"is not more than the strain {at:g} before it", "a larger one, or kind: unloading")
	if entry.kind == UNLOADING and strain >= at:
		raise ConfigError(f"{path}.strain", strain, f"is not less than the strain {at:g} before it", "a smaller one, or kind: shear")


def span(stages, k):
	"""Axial strain that stage ``k`` of a plan passes through; None where it is not known, 0 where platens stand."""
	stage = stages[k]
	if not stage.straining:
		return 0.0
	before = [other for other in stages[:k] if other.label in stage.chain and other.straining]
	at = before[-1].strain if before else 0.0
	return None if None in (at, stage.strain) else abs(stage.strain - at)


def largestStrain(stages):
	"""The largest strain in a plan, of those that are known."""
	return max((stage.strain for stage in stages if stage.strain is not None), default=-math.inf)


def checkPlan(config):
	"""Check the stages, and give ``shear.strain`` the largest of theirs: platens, estimate and measurement go by it.

	:raises ConfigError: the stages do not follow one another, or ``measure`` would begin twice.
	"""
	if config.stages is None:
		return
	stages = plan(config)
	if (largest := largestStrain(stages)) > 0:
		config.shear.strain = largest if "shear.strain" not in config.given else max(largest, config.shear.strain)
	kinds = [stage.kind for stage in stages]
	chains = sum(kind not in ISOTROPIC and before in ISOTROPIC for before, kind in zip(kinds, kinds[1:]))
	if chains > 1 and (config.measure.local or config.measure.regions or config.measure.slices):
		raise ConfigError("stages", len(stages), "a consolidation follows a shear, and measure counts from one of them", "leave measure out, or run two tests with --from")
