# SPDX-License-Identifier: GPL-2.0-or-later
"""One row of the records, measured on the scene as it stands. Columns, signs and formulas: :mod:`hexmembrane.output.records`."""

import dataclasses
import math

import numpy
from yade import BodyArrays, O

from hexmembrane.measure import energy


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
	:param density: of their material [kg/m3]; their masses may be raised (``specimen.massScaling``).
	"""

	ids: list
	solidVolume: float
	meanDiameter: float
	density: float

	@classmethod
	def of(cls, ids):
		ids = list(ids)
		radii = BodyArrays.radii(ids)
		solid = 4 / 3 * math.pi * float((radii**3).sum())
		return cls(ids, solid, 2 * float((radii**3).mean()) ** (1 / 3), O.bodies[ids[0]].material.density)


def escaped(scene, grains):
	"""Id of a grain whose centre is outside the lateral boundary or behind a platen's face, None when all are inside."""
	height = BodyArrays.positions(grains.ids)[:, 2]
	bottom, top = scene.faces()
	behind = (height <= bottom) | (height >= top)
	lost = [*numpy.array(grains.ids)[behind].tolist(), *scene.lateralBoundary.outside(grains.ids)]
	return min(lost, default=None)


def inertialStress(grains, volume):
	"""Sum f (x) x/V over the grains [Pa], f the sum of all forces on one as it is moved by them."""
	return BodyArrays.forces(grains.ids).T @ BodyArrays.positions(grains.ids) / volume


def soilStress(measured, inertia):
	"""The columns of the soil's stress [Pa] from what ``SoilMeasure.stress()`` gives, and from :func:`inertialStress`."""
	columns = {}
	parts = {"soil_{}": measured["whole"], "soil_{}_middle": measured["middle"], "boundary_{}": measured["boundary"], "inertia_{}": inertia}
	for name, stress in parts.items():
		columns[name.format("axial")] = stress[2, 2]
		columns[name.format("radial")] = 0.5 * (stress[0, 0] + stress[1, 1])
	axial, radial = columns["soil_axial"], columns["soil_radial"]
	return {"q": axial - radial, "p": (axial + 2 * radial) / 3, **columns}


def deviator(measured):
	"""Deviatoric stress of the soil [Pa] from what ``SoilMeasure.stress()`` gives."""
	stress = measured["whole"]
	return stress[2, 2] - 0.5 * (stress[0, 0] + stress[1, 1])


def unbalanced(ids, contactForce):
	"""Mean resultant force on moving bodies over the mean contact force, 1 without contacts; as YADE's ``unbalancedForce``."""
	return float(numpy.linalg.norm(BodyArrays.forces(ids), axis=1).mean()) / contactForce if contactForce > 0 else 1.0


def row(scene, grains, reference, stage, elapsed, cement=False):
	"""The measured row as a dict, of the last step in either tier; see ``columns(cement)`` of :mod:`hexmembrane.output.records`."""
	measured = scene.measure.stress()
	boundary = scene.lateralBoundary
	bottom, top = scene.faces()
	height = top - bottom
	volume, radius = measured["volume"], boundary.meanRadius()
	pressure = scene.pressure
	forces = scene.bottomDrive.force, scene.topDrive.force
	speed = scene.approachSpeed()
	inertial = speed / height * grains.meanDiameter * math.sqrt(grains.density / pressure) if pressure > 0 else 0.0
	energies, transmitted = energy.current(), boundary.transmittedPressures()
	loads = boundary.ownLoads(bottom, top)
	dz, dr = height / reference.height - 1, radius / reference.radius - 1
	return {
		"stage": stage,
		"step": O.iter,
		"time": O.time,
		"axial_strain": -dz,
		**soilStress(measured, inertialStress(grains, measured["volume"])),
		"q_cell": (sum(forces) / 2 - pressure * scene.endArea()) / (volume / height),
		"sigma3_target": pressure,
		"sigma3_applied": boundary.appliedPressure,
		"sigma3_transmitted_group3": transmitted[3],
		"sigma3_transmitted_group2": transmitted[2],
		"sigma3_transmitted_all": transmitted[0],
		"volumetric_strain_radius": dz + 2 * dr,
		"volumetric_strain_volume": volume / reference.volume - 1,
		"porosity": 1 - grains.solidVolume / volume,
		"coordination": measured["coordination"],
		"unbalanced": unbalanced(grains.ids + boundary.movingIds(), measured["contactForce"]),
		"membrane_unbalanced": boundary.unbalanced(),
		"inertial_number": abs(inertial),
		"platen_force_bottom": forces[0],
		"platen_force_top": forces[1],
		"height": height,
		"mean_radius": radius,
		"volume": volume,
		"membrane_area": boundary.pressedArea(bottom, top),
		"bonds_broken": boundary.brokenBonds(),
		"loops_saturated": len(scene.saturated()),
		"elapsed": round(elapsed, 2),
		**_energies(energies, reference.energies),
		"pressure_axial": loads.axialPush,
		"membrane_axial_mid": loads.axialPullMiddle,
		"membrane_axial_end": loads.axialPullEnd,
		"sigma3_membrane": loads.radialPressure,
		"sigma3_distance": (transmitted[3] - boundary.pressure) / pressure if pressure > 0 else 0.0,
		**(_cement(scene.cement) if cement else {}),
	}


def _cement(bonds):
	"""The columns of cement; ``bonds``: the GrainBonds, None: not there yet."""
	counts = (bonds.count, bonds.tensileBreaks, bonds.shearBreaks) if bonds else (0, 0, 0)
	return dict(zip(("cement_bonds", "cement_broken_tension", "cement_broken_shear"), counts))


def _energies(now, start):
	"""The columns of energy: stored ones as they are, the others since the stage began; nan without ``O.trackEnergy``."""
	stored = {f"energy_{name}": now[name] for name in ("elastic", "membrane", "kinetic")}
	flows = {f"energy_{name}": now[name] - start[name] for name in ("friction", "damping")}
	columns = {**stored, **flows, "work_boundary": now["work"] - start["work"], "energy_error": energy.balance(now, start)}
	return columns if O.trackEnergy else dict.fromkeys(columns, math.nan)
