# SPDX-License-Identifier: GPL-2.0-or-later
"""The section ``contacts`` of a configuration: stiffness and friction by pair of groups, as PFC's ``contact cmat`` gives them. Uses nothing of YADE."""

import dataclasses
import math
from typing import Optional

from hexmembrane.configuration.schema import key, section, shared
from hexmembrane.configuration.stiffness import checkSprings

#: Labels of the two materials of each pair; the first one holds what is given.
PAIRS = {"grainPlaten": ("grain", "platen"), "grainWall": ("grain", "wall"), "grainMembrane": ("grain", "membrane"), "membranePlaten": ("platen", "membrane")}


@dataclasses.dataclass
class PairContact:
	"""Contacts of one pair of groups. What is not given follows from the two groups: springs in series, the lesser friction."""

	kn: Optional[float] = key(None, "normal stiffness of the contact itself, with ks; none: the two groups' springs in series", "N/m", low=0, openLow=True)
	ks: Optional[float] = key(None, "shear stiffness of the contact itself", "N/m", low=0, openLow=True)
	emod: Optional[float] = key(
		None, "contact modulus, instead of kn and ks: kn = pi emod min(R1, R2)^2/(R1 + R2), pi emod R on platens and wall", "Pa", low=0, openLow=True
	)
	kratio: Optional[float] = key(None, "kn/ks of the contact, with emod", "", low=1.0, high=1000)
	friction: Optional[float] = shared("friction", "coefficient of friction of the contact, may be above either group's; none: the lesser of both", default=None, high=5)
	rollingFriction: Optional[float] = shared("rolling_friction", "coefficient of rolling friction of the contact; none: the lesser of both, 0", default=None, high=5)

	def check(self, path):
		checkSprings(path, self)

	def given(self):
		"""What is given, as keyword arguments of LinearMat.setPair."""
		return {name: value for name, value in dataclasses.asdict(self).items() if value is not None}

	@property
	def stiff(self):
		"""Whether there is a stiffness."""
		return self.kn is not None or self.emod is not None

	@property
	def ratio(self):
		"""Kn/ks of that stiffness."""
		return self.kratio if self.kn is None else self.kn / self.ks

	def normal(self, shape):
		"""Normal stiffness [N/m] of a contact of this shape [m]: min(R1, R2)^2/(R1 + R2), R on a boundary."""
		return math.pi * self.emod * shape if self.kn is None else self.kn


@dataclasses.dataclass
class Contacts:
	"""Pairs of groups; a pair of grains has what ``specimen`` says."""

	grainPlaten: PairContact = section(PairContact, "grains on platens; until the end of consolidation platens.consolidationFriction is the friction")
	grainWall: PairContact = section(PairContact, "grains on the rigid wall")
	grainMembrane: PairContact = section(PairContact, "grains on membrane spheres")
	membranePlaten: PairContact = section(PairContact, "membrane spheres on platens")

	def pairs(self):
		"""{(label, label): :class:`PairContact`} of all pairs."""
		return {labels: getattr(self, name) for name, labels in PAIRS.items()}

	def frictions(self, platens=None):
		"""{(label, label): friction or None}; ``platens``: that of grains on platens instead of their own, None: theirs."""
		found = {labels: pair.friction for labels, pair in self.pairs().items()}
		if platens is not None and found["grain", "platen"] is not None:
			found["grain", "platen"] = platens
		return found
