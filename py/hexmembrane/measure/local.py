# SPDX-License-Identifier: GPL-2.0-or-later
"""Local strain of a test in steps: increments and their sums, grain by grain. What LocalMeasure measures: pkg/measure/README.md."""

import math

import numpy as np
from yade import BodyArrays, LocalMeasure

#: Of each grain: name -> (unit, meaning). Strains, rotations and non-affine motion are those of the last step, or sums over all steps since shear began.
FIELDS = {
	"position": ("m", "centre"),
	"displacement": ("m", "since shear began"),
	"volume": ("m3", "of the grain's cell"),
	"void_ratio": ("-", "of the cell: its volume over the grain's, less 1"),
	"coordination": ("", "contacts that carry a normal force, all partners"),
	"stress": ("Pa", "tensor over the cell, compression positive"),
	"volumetric": ("-", "volumetric strain in the last step, dilation positive"),
	"deviatoric": ("-", "deviatoric strain in the last step, sqrt(2/3 e:e)"),
	"rotation": ("rad", "in the last step, vector"),
	"non_affine": ("m2", "mean square of the neighbours' motion that no affine field explains, in the last step"),
	"volumetric_sum": ("-", "volumetric strain since shear began, sum of the steps, dilation positive"),
	"deviatoric_sum": ("-", "deviatoric strain since shear began, sum of the steps: the shear intensity"),
	"rotation_sum": ("rad", "since shear began, sum of the steps, vector"),
}
_SUMMED = ("volumetric", "deviatoric", "rotation")


class LocalHistory:
	"""Local strain step by step. The grains are those of the scene's SoilMeasure.

	Attributes: ``ids``, ``radii`` [m], ``startVolumes`` of the cells when it began [m3], ``fields`` (the last step's, see :data:`FIELDS`; strains are 0 before
	the first one).

	:param scene: handles, :class:`hexmembrane.scene.handles.Scene`.
	:param state: what :meth:`state` gave, to go on; None: the present state is the start.
	:raises RuntimeError: as LocalMeasure: a torn membrane, say.
	"""

	def __init__(self, scene, state=None):
		self._take(scene)
		if state is None:
			found = self._local.measure(advance=True)  # the same cells are the reference's
		else:
			self._local.setReference(state["reference"])
		self.ids = self._local.reference["ids"]
		self.radii = BodyArrays.radii(self.ids.tolist())
		n = len(self.ids)
		if state is None:
			shapes = {"volumetric": n, "deviatoric": n, "rotation": (n, 3)}
			self._sums = {name: np.zeros(shapes[name]) for name in _SUMMED}
			self.startPositions = BodyArrays.positions(self.ids.tolist())
			self.startVolumes = found["volume"]
			self.fields = self._fields(found, {**self._sums, "nonAffine": np.zeros(n)})
		else:
			self._sums = {name: state[name].copy() for name in _SUMMED}
			self.startPositions, self.startVolumes = state["startPositions"], state["startVolumes"]
			self.fields = state["fields"]

	def _take(self, scene):
		self._scene = scene
		self._local = LocalMeasure(soil=scene.measure)

	def moveTo(self, scene):
		"""Go on with handles to the same scene, loaded anew."""
		reference = self._local.reference
		self._take(scene)
		self._local.setReference(reference)

	def step(self):
		"""End a step: ``fields`` are its. Returns (places of the grains when it began [m], their displacements in it [m], volumes of their cells then [m3])."""
		before = self._local.reference["centres"]
		found = self._local.measure(advance=True)
		for name in _SUMMED:
			self._sums[name] = self._sums[name] + np.nan_to_num(found[name])
		self.fields = self._fields(found, found)
		return before, self.fields["position"] - before, found["referenceVolume"]

	def _fields(self, now, strains):
		ids = self.ids.tolist()
		x = BodyArrays.positions(ids)
		return {
			"position": x,
			"displacement": x - self.startPositions,
			"volume": now["volume"],
			"void_ratio": now["voidRatio"],
			"coordination": self._scene.measure.coordinationNumbers(ids),
			"stress": now["stress"],
			"volumetric": strains["volumetric"],
			"deviatoric": strains["deviatoric"],
			"rotation": strains["rotation"],
			"non_affine": strains["nonAffine"],
			**{f"{name}_sum": self._sums[name] for name in _SUMMED},
		}

	def porosities(self, inside, volumes):
		"""Porosity of the cells inside and outside together, nan without one; ``volumes`` [m3] of all cells, ``inside``: booleans."""
		solid = 4 / 3 * math.pi * self.radii**3
		return [float(1 - solid[part].sum() / volumes[part].sum()) if volumes[part].sum() > 0 else math.nan for part in (inside, ~inside)]

	def state(self):
		"""All that a resumed test needs, nested dictionaries of arrays."""
		kept = {"reference": self._local.reference, "startPositions": self.startPositions, "startVolumes": self.startVolumes, "fields": self.fields}
		return {**kept, **self._sums}
