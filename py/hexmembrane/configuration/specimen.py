# SPDX-License-Identifier: GPL-2.0-or-later
"""The section ``specimen`` of a configuration: the grains. Uses nothing of YADE."""

import dataclasses
from typing import List, Optional

from hexmembrane.configuration.balls import UNITS
from hexmembrane.configuration.schema import LONGEST_PATH, ConfigError, key, shared
from hexmembrane.configuration.stiffness import checkSprings, springsOf

#: Keys that are files.
PATHS = ("packing", "gradation", "balls")
#: Where the grains come from: each key is a source of its own.
SOURCES = ("gradation", "radiusRange", "radiusMean", "radiusBins", "packing", "balls")
#: A Gaussian distribution without a range is cut off this many standard deviations from its mean.
_DEVIATIONS = 3


@dataclasses.dataclass
class Specimen:
	"""The grains: gradation, packing, contact law."""

	radius: Optional[float] = key(None, "radius of the specimen, required; with balls none: that of the cylinder round them", "m", low=0, openLow=True)
	height: Optional[float] = key(None, "height of the specimen, required; with balls none: that of the cylinder round them", "m", low=0, openLow=True)
	packing: Optional[str] = key(None, "packing file to take instead of making one; relative to the configuration's folder", free=True, longest=LONGEST_PATH)
	gradation: Optional[str] = key(None, "CSV file of the gradation (see gradation.py); relative to the configuration's folder", free=True, longest=LONGEST_PATH)
	balls: Optional[str] = key(
		None,
		"CSV table of balls to take as they are, columns x, y, z, r and id in any order, PFC's for example; relative to the configuration's folder",
		free=True,
		longest=LONGEST_PATH,
	)
	ballsUnit: str = key("m", "unit of the table of balls", choices=tuple(UNITS))
	radiusRange: Optional[List[float]] = key(
		None,
		"[least, largest] radius of grains, all between them as frequent by number (PFC's ball distribute radius); with radiusMean where it is cut off",
		"m",
		low=0,
		openLow=True,
	)
	radiusMean: Optional[float] = key(None, "mean radius of a Gaussian distribution by number (PFC's gauss), with radiusDeviation", "m", low=0, openLow=True)
	radiusDeviation: Optional[float] = key(None, "standard deviation of that distribution, cut off at radiusRange or at 3 of them", "m", low=0, openLow=True)
	radiusBins: Optional[List[List[float]]] = key(
		None,
		"bins [least radius, largest radius, share of the volume], in each all radii as frequent by number (PFC's bin); shares are of their sum",
		"m",
		low=0,
		openLow=True,
	)
	scale: Optional[float] = key(
		None, "factor on the diameters of gradation or radii; none with a wished number of grains: it follows from that", "", low=0, openLow=True
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
		for name in ("radius", "height"):
			if getattr(self, name) is None and self.balls is None:
				raise ConfigError(f"{path}.{name}", None, "is missing", f"give {name} of the specimen (m)")
		given = [name for name in SOURCES if getattr(self, name) is not None and not (name == "radiusRange" and self.radiusMean is not None)]
		if len(given) != 1:
			wrong = f"the grains need one source, {', '.join(given) or 'nothing'} is given"
			raise ConfigError(f"{path}.{(given or SOURCES)[0]}", getattr(self, (given or SOURCES)[0]), wrong, f"give exactly one of {', '.join(SOURCES)}")
		self._checkSizes(path)
		if self.scale is not None and self.grains is not None:
			raise ConfigError(f"{path}.scale", self.scale, "the number of grains is wished too, it fixes the scale", "remove one of the two")
		if None not in (self.cutBelow, self.cutAbove) and self.cutBelow >= self.cutAbove:
			raise ConfigError(f"{path}.cutBelow", self.cutBelow, f"is not below cutAbove = {self.cutAbove}", "swap or change the cuts")
		checkSprings(path, self)
		if self.springs is None:
			raise ConfigError(f"{path}.emod", None, "the grains have no stiffness", "give emod and kratio, or kn and ks")

	def _checkSizes(self, path):
		"""What is given by number."""
		if (self.radiusMean is None) != (self.radiusDeviation is None):
			raise ConfigError(f"{path}.radiusDeviation", self.radiusDeviation, "the distribution is given in half", "give both radiusMean and radiusDeviation")
		if self.radiusRange is not None and (len(self.radiusRange) != 2 or not self.radiusRange[0] <= self.radiusRange[1]):
			raise ConfigError(f"{path}.radiusRange", self.radiusRange, "is not a least and a largest radius", "give [least, largest] in m")
		if self.radiusMean is not None and self.radiusRange is None and self.radiusMean <= _DEVIATIONS * self.radiusDeviation:
			wrong = f"reaches down to radii below 0, {_DEVIATIONS} standard deviations are {_DEVIATIONS * self.radiusDeviation:g} m"
			raise ConfigError(f"{path}.radiusMean", self.radiusMean, wrong, "give radiusRange, where it is cut off, or a smaller radiusDeviation")
		if self.radiusMean is not None and self.radiusRange is not None and not self.radiusRange[0] < self.radiusMean < self.radiusRange[1]:
			raise ConfigError(f"{path}.radiusMean", self.radiusMean, f"is not inside radiusRange = {self.radiusRange}", "give a range round it")
		for k, one in enumerate(self.radiusBins or ()):
			if len(one) != 3 or not one[0] <= one[1]:
				raise ConfigError(f"{path}.radiusBins[{k}]", one, "is not a bin", "give [least radius, largest radius, share of the volume]")
		if self.radiusBins == []:
			raise ConfigError(f"{path}.radiusBins", [], "are no bins", "give bins, or remove the key")

	@property
	def made(self):
		"""Whether the grains are packed here, and not given one by one."""
		return self.packing is None and self.balls is None

	@property
	def gaussianRange(self):
		"""Radii [m] at which the Gaussian distribution is cut off."""
		reach = _DEVIATIONS * self.radiusDeviation
		return self.radiusRange or [self.radiusMean - reach, self.radiusMean + reach]

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
