# SPDX-License-Identifier: GPL-2.0-or-later
"""The section ``measure`` of a configuration: what is measured inside the specimen. Uses nothing of YADE."""

import dataclasses
import math
from typing import List, Optional

from hexmembrane.configuration.schema import ConfigError, key


@dataclasses.dataclass
class Measure:
	"""What is measured inside the specimen in shear, beside the records."""

	bands: bool = key(False, "look for shear bands in each strain step: bands.csv, and local strain in the frames")
	step: float = key(0.01, "axial strain of the steps whose local strain is measured and in which bands are sought", "", low=0.001, high=0.1)
	replicates: int = key(0, "replicates of the bootstrap that gives a band's intervals, 100 give steady ones; 0: no intervals", "", low=0, high=10000)
	strains: Optional[List[float]] = key(None, "axial strains at which the fields of all grains are kept in fields.h5; none: nowhere", "", low=0)
	centres: Optional[List[List[float]]] = key(
		None, "centres [x, y, z] of measurement regions at the start of shear, z from the bottom platen's face; their rows are in regions.csv", "m"
	)
	spacing: Optional[float] = key(None, "a grid of regions this far apart, those of it that are whole inside the specimen, beside or without centres", "m", low=0, openLow=True)
	radius: Optional[float] = key(None, "radius of the regions; none: 2.5 mean grain diameters by volume", "m", low=0, openLow=True)
	carried: bool = key(True, "the material carries the regions with it; false: they stay where they are")
	every: int = key(5, "rows of records.csv between rows of regions.csv and profile.csv", "", low=1)
	slices: int = key(0, "slices of the height whose mean radius and stress go to profile.csv; 0: none", "", low=0, high=1000)

	@property
	def local(self):
		"""Whether local strain is measured."""
		return self.bands or self.strains is not None

	@property
	def regions(self):
		"""Whether there are regions."""
		return self.centres is not None or self.spacing is not None

	def check(self, path):
		for k, centre in enumerate(self.centres or ()):
			if len(centre) != 3:
				raise ConfigError(f"{path}.centres[{k}]", centre, "is not a place", "give three numbers, [x, y, z] in m")
		if self.centres == []:
			raise ConfigError(f"{path}.centres", [], "are no regions", "give centres, or remove the key")
		if self.strains is not None and sorted(set(self.strains)) != self.strains:
			raise ConfigError(f"{path}.strains", self.strains, "do not rise", "give each strain once, smallest first")

	def checkWith(self, specimen, shear):
		"""Refuse what does not fit the specimen and its shear.

		:raises ConfigError: a place or a size outside the specimen, a strain that is never reached.
		"""
		radius, height = specimen.radius, specimen.height
		for k, (x, y, z) in enumerate(self.centres or ()):
			if math.hypot(x, y) >= radius or not 0 <= z <= height:
				raise ConfigError(
					f"measure.centres[{k}]", [x, y, z], f"is outside the specimen of radius {radius:g} m and height {height:g} m", "give a place inside it"
				)
		if self.radius is not None and self.radius > min(radius, height / 2):
			raise ConfigError("measure.radius", self.radius, "is more than the specimen's radius or half its height", "give a smaller one")
		if self.spacing is not None and self.spacing > 2 * radius:
			raise ConfigError("measure.spacing", self.spacing, "is more than the specimen's diameter", "give a smaller one")
		if self.strains and self.strains[-1] > shear.strain * (1 + 1e-9):
			raise ConfigError("measure.strains", self.strains, f"go beyond shear.strain = {shear.strain:g}", "leave out what is never reached")
		if self.local and self.step > shear.strain:
			raise ConfigError("measure.step", self.step, f"is more than shear.strain = {shear.strain:g}", "give a smaller one")
