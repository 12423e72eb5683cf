# SPDX-License-Identifier: GPL-2.0-or-later
"""The stiffness of a group of bodies, given directly (kn, ks) or by PFC's deformability (emod, kratio). Uses nothing of YADE.

Either is that of the body's own spring, as in PFC's inheritance of properties: a contact has the springs of its two bodies in series.
"""

import dataclasses
import math
from typing import Optional

from hexmembrane.configuration.schema import ConfigError, key


@dataclasses.dataclass(frozen=True)
class Springs:
	"""Kn and ks [N/m], or emod [Pa] and kratio; the other two are None."""

	kn: Optional[float] = None
	ks: Optional[float] = None
	emod: Optional[float] = None
	kratio: Optional[float] = None

	@property
	def direct(self):
		"""Whether kn and ks are given, which do not grow with the radius."""
		return self.kn is not None

	@property
	def ratio(self):
		"""Kn/ks."""
		return self.kn / self.ks if self.direct else self.kratio

	def own(self, shape):
		"""Normal stiffness [N/m] of the body's own spring in a contact of this shape [m]: min(R1, R2)^2/(R1 + R2), R on a boundary."""
		return self.kn if self.direct else 2 * math.pi * self.emod * shape

	def given(self):
		"""What is given, as keyword arguments of LinearMat."""
		return {name: value for name, value in dataclasses.asdict(self).items() if value is not None}


def springsOf(section):
	"""The :class:`Springs` in a section's keys; None without any."""
	found = Springs(*(getattr(section, name) for name in ("kn", "ks", "emod", "kratio")))
	return found if found.given() else None


def ownKey(doc, unit, low=0.0, **more):
	"""A key of the section of a boundary: its own stiffness, none: the grains'."""
	return key(None, doc + "; none: the grains'", unit, low=low, openLow=low == 0, **more)


def checkSprings(path, section):
	"""Two of the four keys, of one kind; or none.

	:raises ConfigError: one is missing, or stiffness is given twice.
	"""
	kn, ks, emod, kratio = (getattr(section, name) for name in ("kn", "ks", "emod", "kratio"))
	for name, value, other in (("ks", ks, kn), ("kn", kn, ks), ("kratio", kratio, emod), ("emod", emod, kratio)):
		if value is None and other is not None:
			raise ConfigError(f"{path}.{name}", value, "the stiffness is given in half", "give both kn and ks, or both emod and kratio")
	if kn is not None and emod is not None:
		raise ConfigError(f"{path}.kn", kn, f"the stiffness is given twice, emod = {emod:g} Pa too", "give kn and ks, or emod and kratio")
