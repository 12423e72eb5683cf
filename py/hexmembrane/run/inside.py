# SPDX-License-Identifier: GPL-2.0-or-later
"""Measurement inside the specimen while it is sheared: regions, profile, local strain and bands, in the test's folder. Keys: ``measure``.

All that a resumed test needs is in the checkpoint's facts: how far each file was, and the states that strain counts from.
"""

import base64
import math

import numpy as np
import yade
from yade import BodyArrays

from hexmembrane.configuration.stages import boundaries
from hexmembrane.measure import bands, profile
from hexmembrane.measure.local import FIELDS, LocalHistory
from hexmembrane.measure.regions import RegionHistory
from hexmembrane.output.fields import FieldsFile
from hexmembrane.output.inside import BANDS, PROFILE, REGIONS
from hexmembrane.output.tables import Table

_TENSOR = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


class Inside:
	"""What ``measure`` asks for. Its folder gets regions.csv, profile.csv, bands.csv, fields.h5.

	Attribute: ``grainArrays``, arrays for the frames' grains by name, none without local strain.

	:param config: checked configuration. :param out: existing folder.
	:param facts: what :meth:`position` gave, to go on; None: not begun.
	"""

	def __init__(self, config, out, facts=None):
		self.config, self.keys, self.out = config, config.measure, out
		self.grainArrays = {}
		self._facts, self._begun, self._scene = facts, False, None
		self._tables = {}

	@property
	def _wanted(self):
		keys = self.keys
		return {"regions": keys.regions, "profile": keys.slices > 0, "bands": keys.bands}

	def row(self, scene, record, number, nominal):
		"""Measure at a row of what follows the consolidation.

		:param record: the row. :param number: its number since then, 0 at the start.
		:param nominal: (strain meant at the row before, at this one, whether the stage ends), see :meth:`hexmembrane.run.stage.Stage.nominal`.
		"""
		*self._nominal, last = nominal
		if not (self.keys.local or any(self._wanted.values())):
			return
		self._prepare(scene, record)
		if number % self.keys.every == 0 or last:
			if self.keys.regions:
				self._regionRows(scene, record, number)
			if self.keys.slices:
				self._profileRows(scene, record)
		if self.keys.local and (number == 0 or self._isDue()):
			self._localStep(scene, record, number)

	def position(self):
		"""Facts for a checkpoint, JSON values; None before the first row."""
		if not self._begun:
			return self._facts
		facts = {"bytes": {name: table.position() for name, table in self._tables.items()}, "row": self._row, "before": self._before}
		if self.keys.local:
			facts["local"] = _encoded(self._local.state())
		if self.keys.regions:
			facts["regions"] = _encoded(self._regions.state())
		return facts

	def close(self):
		for table in self._tables.values():
			table.close()

	# The parts

	def _prepare(self, scene, record):
		"""Make what measures, once, and again after the scene was loaded anew."""
		if self._begun and scene is not self._scene and self.keys.local:
			self._local.moveTo(scene)
		self._scene = scene
		if self._begun:
			return
		facts = self._facts or {}
		places = facts.get("bytes", {})
		for name, columns in (("regions", REGIONS), ("profile", PROFILE), ("bands", BANDS)):
			if self._wanted[name]:
				self._tables[name] = Table(self.out / f"{name}.csv", columns, places.get(name))
		self._row, self._before = facts.get("row", -1), facts.get("before") or _strains(record)
		if self.keys.local:
			self._local = LocalHistory(scene, _decoded(facts["local"]) if facts else None)
			self._d50 = bands.medianDiameter(self._local.radii)
			test = {"title": self.config.title, "boundary": boundaries(self.config)[-1], "pressure": self.config.consolidation.pressure, "d50": self._d50}
			self._fields = FieldsFile(self.out / "fields.h5", test, FIELDS, facts.get("row")) if self.keys.strains else None
			self._arrays()
		if self.keys.regions:
			self._regions = self._makeRegions(scene, _decoded(facts["regions"]) if facts else None)
		self._begun = True

	def _makeRegions(self, scene, state):
		keys, membrane = self.keys, scene.measure.membrane
		measure = yade.MeasureRegions(membrane=membrane) if membrane else yade.MeasureRegions()
		radius = keys.radius or 2.5 * 2 * float((BodyArrays.radii(scene.grainIds()) ** 3).mean()) ** (1 / 3)
		centres = self._centres(scene, radius) if state is None else state["centres"]
		return RegionHistory(measure, centres, radius, keys.carried, state)

	def _centres(self, scene, radius):
		bottom, top = scene.faces()
		found = [(x, y, bottom + z) for x, y, z in self.keys.centres or ()]
		if self.keys.spacing:
			wide = scene.lateralBoundary.meanRadius()
			grid = yade.MeasureRegions.grid((-wide, -wide, bottom), (wide, wide, top), spacing=self.keys.spacing)
			low, high, core = bottom + radius, top - radius, wide - radius
			found += [tuple(x) for x in grid if math.hypot(x[0], x[1]) <= core and low <= x[2] <= high]
		if not found:
			raise ValueError(f"measure.spacing = {self.keys.spacing:g}: no region of radius {radius:.3g} m is whole inside the specimen; fix: a smaller measure.radius")
		return np.array(found)

	def _isDue(self):
		"""Whether a step ends or a kept strain is reached between the row before and this one."""
		before, now = self._nominal
		return math.floor(now / self.keys.step + 1e-6) > math.floor(before / self.keys.step + 1e-6) or self._isKept()

	def _isKept(self):
		(before, now), small = self._nominal, 1e-9
		return any(before + small < strain <= now + small for strain in self.keys.strains or ())

	def _localStep(self, scene, record, number):
		increment = record["axial_strain"] - self._before["axial_strain"]
		if number > self._row and number > 0:
			x, u, volumes = self._local.step()
			if self.keys.bands and increment >= self.keys.step / 2:
				self._bandRows(scene, record, increment, x, u, volumes)
		self._row = number
		if self._fields and self._isKept():
			bottom, top = scene.faces()
			state = {"row": number, "step": record["step"], "axial_strain": record["axial_strain"], "increment": increment}
			state.update(bottom=bottom, top=top, radius=record["mean_radius"])
			self._fields.add(state, self._local.ids, self._local.radii, self._local.fields)
		self._before = _strains(record)
		self._arrays()

	def _arrays(self):
		"""Strains and stresses of the last step for the frames."""
		fields = self._local.fields
		stress = fields["stress"]
		p = np.trace(stress, axis1=1, axis2=2) / 3
		shear = stress - p[:, None, None] * np.eye(3)
		kept = ("void_ratio", "volumetric", "deviatoric", "rotation", "non_affine", "volumetric_sum", "deviatoric_sum", "rotation_sum")
		self.grainArrays = {name: fields[name] for name in kept}
		self.grainArrays.update(mean_stress=p, shear_stress=np.sqrt(1.5 * (shear**2).sum(axis=(1, 2))))

	def _bandRows(self, scene, record, increment, x, u, volumes):
		bottom, _ = scene.faces()
		found = bands.find(x, u, volumes, self._local.fields["deviatoric"], self._d50, replicates=self.keys.replicates)
		inside = np.any([plane.inside(x) for plane in found.planes], axis=0)
		now, start = self._local.porosities(inside, self._local.fields["volume"]), self._local.porosities(inside, self._local.startVolumes)
		phi, psi = self._angles(record, increment)
		coulomb, roscoe, arthur = bands.expectedDips(phi, psi)
		for k, plane in enumerate(found.planes):
			ends = {name: found.intervals.get(key, (math.nan, math.nan)) for name, key in (("index", "index"), *((n, f"{n}[{k}]") for n in ("dip", "azimuth", "thickness")))}
			self._tables["bands"].append(
				{
					"step": record["step"],
					"axial_strain": record["axial_strain"],
					"increment": increment,
					"verdict": found.verdict,
					"plane": k,
					"index": found.index,
					"explained": found.explained,
					"barrel": found.barrel,
					"certainty": found.certainty,
					"dip": plane.dip,
					"azimuth": plane.azimuth,
					"thickness": plane.thickness,
					**{f"{name}_{end}": value for name, pair in ends.items() for end, value in zip(("low", "high"), pair)},
					"thickness_d50": plane.thickness / self._d50,
					"height": plane.point[2] - bottom,
					"jump": float(np.linalg.norm(plane.jump)),
					"friction_angle": phi,
					"dilatancy_angle": psi,
					"dip_coulomb": coulomb,
					"dip_roscoe": roscoe,
					"dip_arthur": arthur,
					"porosity_inside": now[0],
					"porosity_outside": now[1],
					"start_porosity_inside": start[0],
					"start_porosity_outside": start[1],
				}
			)

	def _angles(self, record, increment):
		"""Mobilised angles of friction and dilatancy [degrees]."""
		s1, s3 = record["soil_axial_middle"], record["soil_radial_middle"]
		rate = -(record["volumetric_strain_volume"] - self._before["volumetric_strain_volume"]) / increment  # both compression positive
		sines = (s1 - s3) / (s1 + s3), -rate / (2 - rate)
		return [math.degrees(math.asin(max(-1.0, min(1.0, sine)))) for sine in sines]

	def _regionRows(self, scene, record, number):
		if number > 0:
			self._regions.move()
		bottom, _ = scene.faces()
		found, centres, radii = self._regions.measure(), self._regions.centres, self._regions.radii
		for k, (centre, radius) in enumerate(zip(centres, radii)):
			stress = found["stress"][k]
			axial, volumetric, deviatoric = self._regions.strains[k]
			self._tables["regions"].append(
				{
					"step": record["step"],
					"axial_strain": record["axial_strain"],
					"region": k,
					"x": centre[0],
					"y": centre[1],
					"z": centre[2] - bottom,
					"radius": radius,
					"grains": int(found["grains"][k]),
					**{name: float(found[name][k]) for name in ("porosity", "coordination", "sliding")},
					**{f"stress_{name}": float(stress[at]) for name, at in _TENSOR.items()},
					"q": float(stress[2, 2] - (stress[0, 0] + stress[1, 1]) / 2),
					"p": float(np.trace(stress) / 3),
					"axial_strain_region": float(axial),
					"volumetric_strain": float(volumetric),
					"deviatoric_strain": float(deviatoric),
				}
			)

	def _profileRows(self, scene, record):
		found = profile.measure(scene, self.keys.slices)
		for k, height in enumerate(found.middle):
			row = {"step": record["step"], "axial_strain": record["axial_strain"], "slice": k, "height": float(height)}
			self._tables["profile"].append({**row, **{name: float(getattr(found, name)[k]) for name in ("radius", "axial", "radial")}})


def _strains(record):
	return {name: record[name] for name in ("axial_strain", "volumetric_strain_volume")}


def _encoded(values):
	"""Nested dictionaries of arrays as JSON values, to the last bit."""
	if isinstance(values, dict):
		return {name: _encoded(one) for name, one in values.items()}
	array = np.ascontiguousarray(values)
	return [array.dtype.str, list(array.shape), base64.b64encode(array.tobytes()).decode()]


def _decoded(values):
	if isinstance(values, dict):
		return {name: _decoded(one) for name, one in values.items()}
	kind, shape, data = values
	return np.frombuffer(base64.b64decode(data), kind).reshape(shape)
