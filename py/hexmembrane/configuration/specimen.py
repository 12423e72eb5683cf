# SPDX-License-Identifier: GPL-2.0-or-later
"""The section ``specimen`` of a configuration: the grains. Uses nothing of YADE."""

import dataclasses
from typing import Optional

from hexmembrane.configuration.schema import LONGEST_PATH, REQUIRED, ConfigError, key, shared
from hexmembrane.configuration.stiffness import checkSprings, springsOf

#: Keys that are files.
PATHS = ("packing", "gradation")


@dataclasses.dataclass
class Specimen:
	"""The grains: gradation, packing, contact law."""

	radius: float = key(REQUIRED, "radius of the specimen", "m", low=0, openLow=True)
	height: float = key(REQUIRED, "height of the specimen", "m", low=0, openLow=True)
	packing: Optional[str] = key(None, "packing file to take instead of making one; relative to the configuration's folder", free=True, longest=LONGEST_PATH)
	gradation: Optional[str] = key(None, "CSV file of the gradation (see gradation.py); relative to the configuration's folder", free=True, longest=LONGEST_PATH)
	scale: Optional[float] = key(
		None, "factor on the gradation's diameters; none with a wished number of grains: it follows from that", "", low=0, openLow=True
	)
	cutBelow: Optional[float] = key(None, "leave out grains with a diameter below this, before scaling", "m", low=0)
	cutAbove: Optional[float] = key(None, "leave out grains with a diameter above this, before scaling", "m", low=0, openLow=True)
	grains: Optional[int] = key(None, "number of grains wished; none: follows from porosity, volume and scale", "", low=20, high=1000000)
	porosity: float = key(
		0.40, "porosity of the packing, before consolidation; grains without friction under a stress have their own, leave the key out", "", low=0.3, high=0.6
	)
	seed: int = shared("packing_seed", "seed of the packing's random numbers", high=2**31 - 1)
	density: float = key(2650.0, "density of the grains", "kg/m3", low=0, openLow=True)
	stress: Optional[float] = key(
		None,
		"isotropic stress under which the packing is made, small against the test's; none: grains that touch nothing",
		"Pa",
		low=0,
		openLow=True,
	)
	friction: float = shared(
		"friction",
		"coefficient of friction mu between grains, tan of the angle, Fs <= mu Fn: in shear, in consolidation unless that has its own, "
		"and in a packing made under stress",
		default=0.5,
		high=5,
	)
	rollingFriction: float = shared("rolling_friction", "coefficient of rolling friction mu_r between grains, moment <= mu_r R1 R2/(R1 + R2) Fn", high=5)
	packingRollingFriction: float = shared(
		"rolling_friction", "coefficient of rolling friction while a packing is made under stress; looser ones need it, it may be rollingFriction's value", high=5
	)
	kn: Optional[float] = key(
		None,
		"normal stiffness of a grain's own spring, with ks and instead of emod and kratio: it does not grow with the radius; two grains have kn/2, a contact's springs "
		"are in series",
		"N/m",
		low=0,
		openLow=True,
	)
	ks: Optional[float] = key(None, "shear stiffness of the same spring", "N/m", low=0, openLow=True)
	emod: Optional[float] = key(
		4e7,
		"contact modulus of PFC's deformability: kn = pi emod min(R1, R2)^2/(R1 + R2), pi emod R on platens and wall; "
		"equal grains of diameter d: kn/(p d) = pi emod/(4 p), at 314 the peak of q was 10 %, at 1000 4 % above that at 3000 (examples/accuracy); none with kn",
		"Pa",
		low=0,
		openLow=True,
	)
	kratio: Optional[float] = shared("stiffness_ratio", "kn/ks of the contacts", high=1000)
	massScaling: bool = key(
		False,
		"grains smaller than the largest get its mass times their share of its radius, m = m_max r/r_max: all grains then have the critical step of the "
		"largest, volumes and forces stay, inertia grows; with kn the largest's mass itself",
	)

	def check(self, path):
		if (self.packing is None) == (self.gradation is None):
			raise ConfigError(
				f"{path}.gradation", self.gradation, "the grains need one source, a gradation or a packing", "give exactly one of the two"
			)
		if self.scale is not None and self.grains is not None:
			raise ConfigError(f"{path}.scale", self.scale, "the number of grains is wished too, it fixes the scale", "remove one of the two")
		if None not in (self.cutBelow, self.cutAbove) and self.cutBelow >= self.cutAbove:
			raise ConfigError(f"{path}.cutBelow", self.cutBelow, f"is not below cutAbove = {self.cutAbove}", "swap or change the cuts")
		checkSprings(path, self)
		if self.springs is None:
			raise ConfigError(f"{path}.emod", None, "the grains have no stiffness", "give emod and kratio, or kn and ks")

	@classmethod
	def prepared(cls, values):
		"""The keys that were given, without the defaults that others take the place of: emod and kratio where there is a direct stiffness."""
		direct = values.get("kn") is not None or values.get("ks") is not None
		return {"emod": None, "kratio": None, **values} if direct else values

	@property
	def springs(self):
		"""Stiffness of the grains, :class:`hexmembrane.configuration.stiffness.Springs`."""
		return springsOf(self)

	@property
	def stiffnessKey(self):
		"""The key that the stiffness is given by."""
		return "specimen.kn" if self.springs.direct else "specimen.emod"
