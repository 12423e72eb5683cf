# SPDX-License-Identifier: GPL-2.0-or-later
"""What a test needs, told before anything is made: steps, time, memory, disk. What is beyond the machine is refused. Uses nothing of YADE.

Estimates, good to a factor of two: the time step is that of the grains, the membrane's contacts and its bonds; what comes after the pressure's rise
is taken to last 0.3 times as long as the rise.
"""

import dataclasses
import math
import os
import pathlib
import shutil

import numpy

from hexmembrane.configuration import ConfigError
from hexmembrane.configuration.stages import CONSOLIDATION, MEMBRANE, boundaries, plan
from hexmembrane.run.progress import clock
from hexmembrane.scene import timestep

#: Time [s] of one step of the compact tier on one thread: of any, a grain's part, a membrane sphere's: README.md, Speed, and 65 us of a test of 200 grains; more of
#: a membrane sphere whose bonds have shear springs (scripts/bench.d/README.md). The reference tier's steps last so many times as long.
STEP, GRAIN_STEP, MEMBRANE_STEP, SHEAR_SPRINGS, REFERENCE = 25e-6, 8.2e-8, 4.2e-8, 1.1e-7, 29
#: More grains than CACHED leave the processor's cache: a grain's part grows by GROWTH for each factor e. A step took 4.4 ms with 30,000 grains and 17,000 membrane spheres,
#: 18.2 ms with 100,000 and 67,000 (AMD EPYC, 32 MB of shared cache, nothing else running, 27 November 2026).
CACHED, GROWTH = 7000, 0.32
#: Share of a step that a thread more takes as well: 0.11 and 0.17 of it in the study's membranes of 0.25 and 0.5 mm (scripts/bench.d/README.md).
UNDIVIDED = 0.15
#: Memory [bytes]: of YADE, Python and the picture; of a sphere with its contacts. Measured with 3,416 and 15,328 spheres in both tiers: 300 MB, 4 kB, and 80 MB for the picture.
PROGRAM, SPHERE = 400e6, 6e3
#: Disk [bytes] a sphere: a kept state, a last checkpoint, a VTK frame; bytes of a row. Measured with 3,416 spheres.
STATE, CHECKPOINT, FRAME, ROW = 220, 1000, 120, 1000
#: Disk [bytes] a sphere of a frame's contacts. Measured with 19,429 spheres and 20,312 contacts.
CONTACTS = 51
#: Disk [bytes] of a report's page, and of a sphere in one of its frames, without and of contacts. Measured with 3,416 and 19,429 spheres.
PAGE, PAGE_FRAME, PAGE_CONTACTS = 1.3e6, 25, 10
#: Largest number of steps of the pressure's rise, and of the shear: at 20 us a step, that of a few hundred spheres, they take six hours.
MOST_STEPS = 10**9
#: Largest number of threads a processor: more of them only wait for each other.
MOST_THREADS = 4
#: Least kn/(p d): grains overlap by about d over this number, and below it the specimen is no longer one of grains.
LEAST_LEVEL = 10
#: Strain of a way to a deviatoric stress, which is not known before.
_UNKNOWN = 0.005
#: The pressure's rise of a test that says none, in d sqrt(rho/p).
RISE = 30


@dataclasses.dataclass
class Machine:
	"""What there is: processors, memory [bytes] that can be had, free disk [bytes]."""

	processors: int
	memory: float
	disk: float

	@classmethod
	def here(cls, out="."):
		"""This machine, and the disk on which the folder ``out`` is or would be."""
		folder = pathlib.Path(out).absolute()
		while not folder.is_dir() and folder != folder.parent:
			folder = folder.parent
		return cls(len(os.sched_getaffinity(0)), _freeMemory(), shutil.disk_usage(folder).free)


def _freeMemory():
	"""Memory that can be had [bytes]: of the machine, and of the control group (container, batch job) that limits it."""
	free = math.inf
	try:
		with open("/proc/meminfo", encoding="ascii") as lines:
			free = next((float(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:")), math.inf)
		limit, used = (pathlib.Path("/sys/fs/cgroup", name).read_text(encoding="ascii") for name in ("memory.max", "memory.current"))
		if limit.strip() != "max":
			free = min(free, float(limit) - float(used) + _cached())
	except (OSError, ValueError):
		pass  # no such file on this machine: it sets no such limit
	return free


def _cached():
	"""Bytes of the control group's memory that are files, which give way."""
	with open("/sys/fs/cgroup/memory.stat", encoding="ascii") as lines:
		return next((float(line.split()[1]) for line in lines if line.startswith("inactive_file ")), 0.0)


@dataclasses.dataclass
class Estimate:
	"""What a test needs.

	:param grains, membrane: spheres of either.
	:param step: time step [s].
	:param rise, shear: steps of the pressure's rise and of the shear.
	:param consolidation: steps of the whole consolidation.
	:param seconds: time of the steps [s] on one thread.
	:param memory, disk: bytes.
	"""

	grains: int
	membrane: float
	step: float
	rise: float
	consolidation: float
	shear: float
	seconds: float
	memory: float
	disk: float

	@classmethod
	def of(cls, config, radii):
		"""The estimate for a configuration.

		:param config: checked configuration, ``accuracy`` chosen.
		:param radii: of its grains [m].
		"""
		particles, particleRadius = _membrane(config, float(radii.min()))
		step = _step(config, radii, particleRadius)
		stages = plan(config)
		rises = [_changeTime(config, radii, stage) / step for stage in stages if stage.kind in (CONSOLIDATION, MEMBRANE)]
		rise = max(rises)
		consolidation = sum(min(1.3 * steps + config.output.consolidationSteps, config.consolidation.maxSteps) for steps in rises)
		sheared = _seconds(config, radii, stages) / step
		spheres = len(radii) + particles
		frames = sum(stage.records for stage in stages) / config.output.vtkEvery + 2 * (len(stages) - 1) if config.output.vtkEvery else 0
		frame, pageFrame = FRAME + CONTACTS * config.output.contacts, PAGE_FRAME + PAGE_CONTACTS * config.output.contacts
		rows = sum(stage.records for stage in stages) + consolidation / config.output.consolidationSteps
		return cls(
			grains=len(radii),
			membrane=particles,
			step=step,
			rise=rise,
			consolidation=consolidation,
			shear=sheared,
			seconds=(consolidation + sheared) * _stepTime(config, len(radii), particles),
			memory=PROGRAM + SPHERE * spheres,
			disk=spheres * (3 * STATE + 3 * CHECKPOINT + frame * frames) + ROW * rows + (PAGE + pageFrame * spheres * frames) * config.output.report,
		)

	def line(self):
		"""The estimate in one line of the log."""
		return (
			f"work: {self.grains + self.membrane:,.0f} spheres, about {_rounded(self.consolidation)} steps of consolidation and {_rounded(self.shear)} of shear, "
			f"{clock(self.seconds)} for the steps on one thread; memory {_size(self.memory)}, disk {_size(self.disk)}"
		)

	def require(self, config, machine):
		"""Check that the machine has what the test needs.

		:raises ConfigError: it has not, or the steps are more than MOST_STEPS; the message says what would do.
		"""
		shear, grains = config.shear, config.specimen
		if self.rise > MOST_STEPS:
			raise ConfigError(
				"consolidation.rampTime", config.consolidation.rampTime, f"takes {_rounded(self.rise)} steps of {self.step:.3g} s, {MOST_STEPS:,} are the most",
				f"at most {MOST_STEPS * self.step:.3g} s, or larger grains, whose steps are longer",
			)  # fmt: skip
		if self.shear > MOST_STEPS:
			raise ConfigError(
				"shear.velocity", shear.velocity, f"takes {_rounded(self.shear)} steps of {self.step:.3g} s, {MOST_STEPS:,} are the most",
				f"at least {shear.velocity * self.shear / MOST_STEPS:.3g} m/s, or larger grains, whose steps are longer",
			)  # fmt: skip
		if self.memory > machine.memory:
			wrong = f"the test needs about {_size(self.memory)} of memory, and {_size(machine.memory)} can be had"
			if self.membrane > self.grains:
				name = "sizeRatio" if config.membrane.particleRadius is None else "particleRadius"
				raise ConfigError(f"membrane.{name}", getattr(config.membrane, name), f"makes {self.membrane:,.0f} spheres: {wrong}", "a larger one, or fewer and larger grains")
			raise ConfigError("specimen.grains", grains.grains, f"{self.grains:,} grains: {wrong}", "fewer and larger grains")
		if self.disk > machine.disk:
			raise ConfigError(
				"output.vtkEvery", config.output.vtkEvery, f"the test needs about {_size(self.disk)} on the disk, and {_size(machine.disk)} are free",
				"a larger one, 0 for no VTK, fewer output.records, or another folder with --out",
			)  # fmt: skip


def _stepTime(config, grains, membrane):
	"""Time [s] of a step on one thread. :param grains, membrane: numbers of spheres."""
	bonded = MEMBRANE_STEP + (0 if config.membrane.centralBonds else SHEAR_SPRINGS)
	far = 1 + GROWTH * math.log(max(grains / CACHED, 1))
	return (STEP + GRAIN_STEP * far * grains + bonded * membrane) * (REFERENCE if config.tier == "reference" else 1)


def requireThreads(config, machine=None):
	"""Check ``numerics.threads`` against the processors there are.

	:raises ConfigError: they are more than MOST_THREADS a processor.
	"""
	wanted, processors = config.numerics.threads, (machine or Machine.here()).processors
	if wanted is not None and wanted > MOST_THREADS * processors:
		raise ConfigError(
			"numerics.threads", wanted, f"is more than {MOST_THREADS} a processor, and {processors} are there", f"at most {MOST_THREADS * processors}, best {processors}"
		)


def requireStiffness(config, radii):
	"""Check that the contacts carry the pressure.

	:param radii: of the grains [m].
	:raises ConfigError: kn/(p d) is below LEAST_LEVEL.
	"""
	springs, pressure = config.specimen.springs, max(stage.pressure for stage in plan(config))
	level = timestep.levelOf(springs, radii, pressure)
	if level < LEAST_LEVEL:
		value, unit = (springs.kn, "N/m") if springs.direct else (springs.emod, "Pa")
		raise ConfigError(
			config.specimen.stiffnessKey, value,
			f"gives kn/(p d) = {level:.3g} at {pressure:g} Pa, so soft that grains pass through one another; {LEAST_LEVEL} is the least",
			f"at least {value * LEAST_LEVEL / level:.3g} {unit}, {value * 300 / level:.3g} {unit} for small overlaps",
		)  # fmt: skip


def improbable(config, radii):
	"""Lines about sizes and loads that a laboratory's test does not have: most often a slip of the unit.

	:param radii: of the grains [m].
	"""
	keys, mean = config.specimen, float(numpy.mean(radii))
	found = [
		("specimen.radius", keys.radius, "m", 2e-3, 0.5),
		("specimen.height", keys.height, "m", 4e-3, 2.0),
		("the grains' mean radius", mean, "m", 1e-6, 0.05),
		("specimen.density", keys.density, "kg/m3", 500.0, 12000.0),
		("consolidation.pressure", config.consolidation.pressure, "Pa", 500.0, 1e8),
		("shear.velocity", config.shear.velocity, "m/s", 0.0, 2.0),
		("numerics.damping", config.numerics.damping, "", 0.0, 0.95),
	]
	return [
		f"WARNING: {name} = {value:.4g} {unit}".rstrip() + f" is improbable, tests have {low:g} to {high:g}"
		+ (f"; in mm it would be {value / 1000:g} m" if unit == "m" and value > high else "") + "; fix: see the unit, all are SI"
		for name, value, unit, low, high in found
		if not low <= value <= high
	]  # fmt: skip


def requireTravel(config):
	"""Check that a platen that was given its thickness is thicker than it travels: grains would come behind it.

	:raises ConfigError: it is not.
	"""
	moving = [stage for stage in plan(config) if stage.straining]
	thickness, share = config.platens.thickness, max((max(map(abs, stage.velocities)) / stage.speed for stage in moving), default=0.0)
	travel = share * config.shear.strain * config.specimen.height
	if thickness is not None and thickness <= travel:
		raise ConfigError("platens.thickness", thickness, f"is no more than the {travel:.4g} m that a platen travels", f"more than {travel:.4g} m, or leave it out")


def _changeTime(config, radii, stage):
	"""Time of the stage's change of pressure, or of its standing platens [s]."""
	return stage.time or RISE * timestep.inertialTime(radii, config.specimen.density, max(stage.pressure, stage.before))


def _seconds(config, radii, stages):
	"""Time in the test [s] of the stages that are no consolidation, nearly."""
	total, at = 0.0, 0.0
	for stage in stages:
		if stage.kind in (CONSOLIDATION, MEMBRANE):
			at = 0.0
		elif not stage.straining:
			total += _changeTime(config, radii, stage)
		else:
			end = at + stage.direction * _UNKNOWN if stage.strain is None else stage.strain
			total += (abs(end - at) + config.shear.rampStrain) * config.specimen.height / stage.speed
			at = end
	return total


def _membrane(config, smallest):
	"""(number, radius [m]) of the membrane's spheres, nearly; (0, None) with a rigid wall."""
	if "membrane" not in boundaries(config):
		return 0, None
	keys, specimen = config.membrane, config.specimen
	radius = keys.particleRadius or keys.sizeRatio * smallest
	centre = specimen.radius + (radius if keys.placement == "outside" else 0)
	rows = max(1, 1 + (specimen.height - 2 * radius) / (math.sqrt(3) * radius)) + 2 * keys.oRingRows
	return rows * max(6, math.pi * centre / radius), radius


def _step(config, radii, particleRadius):
	"""The time step [s], nearly."""
	numerics, keys, specimen = config.numerics, config.membrane, config.specimen
	if numerics.dt is not None:
		return numerics.dt
	grains = timestep.grainsStep(config, radii)
	if particleRadius is None:
		return numerics.safety * grains
	mass = timestep.sphereMass(particleRadius, keys.density)
	bonds = 2 * math.sqrt(mass / (6 * keys.young * keys.thickness / (math.sqrt(3) * (1 - keys.poisson))))
	membrane = timestep.membraneStep(specimen.springs, config.springs("membrane"), keys.density, float(radii.max()), particleRadius, bonds, config.contacts.grainMembrane)
	return numerics.safety * min(grains, math.sqrt(timestep.densityScaling(keys.densityScaling, grains, membrane)) * membrane)


def _rounded(count):
	"""Two digits of a number, with commas."""
	return f"{float(f'{count:.2g}'):,.0f}" if count < 1e15 else f"{count:.2g}"


def _size(count):
	for unit, size in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
		if count >= size:
			return f"{count / size:.2g} {unit}" if count < 100 * size else f"{count / size:,.0f} {unit}"
	return f"{count / 1e3:.2g} kB"
