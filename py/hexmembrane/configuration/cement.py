# SPDX-License-Identifier: GPL-2.0-or-later
"""The section ``cement`` of a configuration: parallel bonds between the grains, PFC's model linearpbond. Uses nothing of YADE."""

import dataclasses
import math
from typing import Optional

from hexmembrane.configuration.schema import ConfigError, key
from hexmembrane.configuration.stiffness import checkSprings

CONSOLIDATED, PACKED = MOMENTS = ("consolidated", "packed")


@dataclasses.dataclass
class Cement:
	"""Cement at the contacts of grains: a disc of elastic springs, that breaks. Without a stiffness there is none."""

	emod: Optional[float] = key(
		None, "modulus of the cement, with kratio: a bond has kn = emod/(R1 + R2) by area (PFC's pb_deformability); none without kn: no cement", "Pa", low=0, openLow=True
	)
	kratio: Optional[float] = key(None, "kn/ks of the bonds, with emod (PFC's pb_kratio)", "", low=0, high=1000, openLow=True)
	kn: Optional[float] = key(None, "normal stiffness of a bond by area, with ks and instead of emod and kratio (PFC's pb_kn)", "N/m3", low=0, openLow=True)
	ks: Optional[float] = key(None, "shear stiffness of a bond by area (PFC's pb_ks)", "N/m3", low=0, openLow=True)
	tensileStrength: Optional[float] = key(
		None, "tensile strength of a bond, required: it breaks where -N/A + momentFactor |Mb| R/I is above (PFC's pb_ten)", "Pa", low=0, infinite=True
	)
	cohesion: Optional[float] = key(
		None,
		"shear strength of a bond without normal stress, required: it breaks where |Fs|/A + momentFactor |Mt| R/J is above cohesion + N/A tan frictionAngle (PFC's pb_coh)",
		"Pa",
		low=0,
		infinite=True,
	)
	frictionAngle: float = key(0.0, "friction angle of a bond (PFC's pb_fa)", "deg", low=0, high=89)
	radiusMultiplier: float = key(1.0, "radius R of a bond over the smaller grain's (PFC's pb_rmul); A = pi R^2, I = pi R^4/4, J = 2 I", "", low=0, high=10, openLow=True)
	momentFactor: float = key(1.0, "share of the moments in a bond's stresses (PFC's pb_mcf)", "", low=0, high=1)
	gap: float = key(0.0, "grains are bonded whose surfaces are nearer than this", "m", low=0)
	when: str = key(
		CONSOLIDATED,
		"when bonds are made, once and without load: 'consolidated', before the first stage after consolidation, or 'packed', before consolidation",
		"",
		choices=MOMENTS,
	)

	def check(self, path):
		checkSprings(path, self)
		others = [field.name for field in dataclasses.fields(self) if field.name not in ("emod", "kratio", "kn", "ks") and getattr(self, field.name) != field.default]
		if not self.given and others:
			raise ConfigError(f"{path}.{others[0]}", getattr(self, others[0]), "there is no cement without a stiffness", "give emod and kratio, or kn and ks")
		for name in ("tensileStrength", "cohesion") if self.given else ():
			if getattr(self, name) is None:
				raise ConfigError(f"{path}.{name}", None, "is missing", "a strength in Pa, or .inf")

	@property
	def given(self):
		"""Whether there is cement."""
		return self.emod is not None or self.kn is not None

	def properties(self):
		"""What an engine of bonds has of it, as keyword arguments of GrainBonds."""
		stiffness = {name: getattr(self, name) for name in ("emod", "kratio", "kn", "ks") if getattr(self, name) is not None}
		strengths = {name: getattr(self, name) for name in ("tensileStrength", "cohesion", "radiusMultiplier", "momentFactor")}
		return {**stiffness, **strengths, "frictionAngle": math.radians(self.frictionAngle)}
