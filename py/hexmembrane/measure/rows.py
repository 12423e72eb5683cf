# SPDX-License-Identifier: GPL-2.0-or-later
"""One row of the records, measured on the scene as it stands. Columns, signs and formulas: :mod:`hexmembrane.output.records`."""

import dataclasses
import math

import numpy
from yade import O, utils

from hexmembrane.measure import correction, energy


@dataclasses.dataclass
class Reference:
	"""The state that a stage's strains count from, and what does not change: grains, solid volume.

	:param height: distance of the platens' faces [m].
	:param radius: mean radius of the lateral boundary's inner surface [m].
	:param volume: enclosed volume [m3].
	:param energies: see :func:`hexmembrane.measure.energy.current`.
	"""

	height: float
	radius: float
	volume: float
	energies: dict

	@classmethod
	def of(cls, scene):
		"""The reference taken from the scene as it stands."""
		bottom, top = scene.faces()
		return cls(top - bottom, scene.lateralBoundary.meanRadius(), scene.lateralBoundary.volume(bottom, top), energy.current())


@dataclasses.dataclass
class Grains:
	"""What the grains are once and for all.

	:param ids: of their bodies.
	:param solidVolume: of all of them [m3].
	:param meanDiameter: by volume [m].
	:param density: [kg/m3].
	"""

	ids: list
	solidVolume: float
	meanDiameter: float
	density: float

	@classmethod
	def of(cls, ids):
		radii = numpy.array([O.bodies[i].shape.radius for i in ids])
		solid = 4 / 3 * math.pi * float((radii**3).sum())
		return cls(list(ids), solid, 2 * float((radii**3).mean()) ** (1 / 3), sum(O.bodies[i].state.mass for i in ids) / solid)


def escaped(scene, grains):
	"""Id of a grain whose centre is outside the lateral boundary or behind a platen's face, None when all are inside."""
	centre = numpy.array([tuple(O.bodies[i].state.pos) for i in grains.ids])
	bottom, top = scene.faces()
	lost = scene.lateralBoundary.outside(centre) | (centre[:, 2] <= bottom) | (centre[:, 2] >= top)
	return grains.ids[int(numpy.argmax(lost))] if lost.any() else None


def coordination(first, count):
	"""2 (contacts among grains that carry a normal force)/(grains); grains are bodies ``first`` .. ``first + count - 1``."""
	last = first + count
	touching = 0
	for contact in O.interactions:
		if first <= contact.id1 < last and first <= contact.id2 < last and contact.phys.normalForce.squaredNorm() > 0:
			touching += 1
	return 2 * touching / count


def row(scene, grains, reference, stage, elapsed):
	"""The measured row as a dict; see :data:`hexmembrane.output.records.COLUMNS`."""
	boundary = scene.lateralBoundary
	bottom, top = scene.faces()
	height = top - bottom
	volume, radius = boundary.volume(bottom, top), boundary.meanRadius()
	pressure = boundary.pressure
	forces = scene.bottomDrive.force, scene.topDrive.force
	q = (sum(forces) / 2 - pressure * scene.endArea()) / (volume / height)
	speed = scene.approachSpeed()
	inertial = speed / height * grains.meanDiameter * math.sqrt(grains.density / pressure) if pressure > 0 else 0.0
	energies = energy.current()
	loads = boundary.ownLoads(bottom, top)
	dz, dr = height / reference.height - 1, radius / reference.radius - 1
	return {
		"stage": stage,
		"step": O.iter,
		"time": O.time,
		"axial_strain": -dz,
		"q": q,
		"axial_stress": q + pressure,
		"sigma3_target": pressure,
		"sigma3_applied": boundary.appliedPressure,
		"sigma3_transmitted_group3": boundary.transmittedPressure(3),
		"sigma3_transmitted_group2": boundary.transmittedPressure(2),
		"sigma3_transmitted_all": boundary.transmittedPressure(0),
		"volumetric_strain_radius": dz + 2 * dr,
		"volumetric_strain_volume": volume / reference.volume - 1,
		"porosity": 1 - grains.solidVolume / volume,
		"coordination": coordination(grains.ids[0], len(grains.ids)),
		"unbalanced": utils.unbalancedForce(),
		"membrane_unbalanced": boundary.unbalanced(),
		"inertial_number": abs(inertial),
		"platen_force_bottom": forces[0],
		"platen_force_top": forces[1],
		"height": height,
		"mean_radius": radius,
		"volume": volume,
		"membrane_area": boundary.pressedArea(bottom, top),
		"bonds_broken": boundary.brokenBonds(),
		"elapsed": round(elapsed, 2),
		**_energies(energies, reference.energies),
		**correction.columns(loads),
		"q_corrected": correction.correctedStress(sum(forces) / 2, boundary.appliedPressure, volume / height, loads),
	}


def _energies(now, start):
	"""The columns of energy: stored ones as they are, the others since the stage began; nan without ``O.trackEnergy``."""
	stored = {f"energy_{name}": now[name] for name in ("elastic", "membrane", "kinetic")}
	flows = {f"energy_{name}": now[name] - start[name] for name in ("friction", "damping")}
	columns = {**stored, **flows, "work_boundary": now["work"] - start["work"], "energy_error": energy.balance(now, start)}
	return columns if O.trackEnergy else dict.fromkeys(columns, math.nan)
