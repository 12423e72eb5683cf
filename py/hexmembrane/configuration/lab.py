# SPDX-License-Identifier: GPL-2.0-or-later
"""The section ``lab`` of a configuration: a laboratory's curve that the test is laid over. Uses nothing of YADE; :mod:`hexmembrane.laboratory.curve` reads it."""

import dataclasses
from typing import Dict, Optional

from hexmembrane.configuration.schema import LONGEST_PATH, ConfigError, key


@dataclasses.dataclass
class Lab:
	"""A laboratory's curve; the keys are those of a curve of scripts/calibrate."""

	file: Optional[str] = key(None, "CSV file with the curve; none: there is none; relative to the configuration's folder", free=True, longest=LONGEST_PATH)
	strain: Optional[str] = key(None, "header of the axial strain's column, compression positive; none: axial_strain [unit]", free=True)
	stress_ratio: Optional[str] = key(None, "header of sigma1/sigma3's column; none, without q and volumetric_strain too: stress_ratio", free=True)
	q: Optional[str] = key(None, "header of the column of sigma1 - sigma3, instead of stress_ratio; none, the same: q [unit]", free=True)
	volumetric_strain: Optional[str] = key(None, "header of the volumetric strain's column; none, the same: volumetric_strain [unit], dilation positive", free=True)
	volumetric: Optional[str] = key(None, "what is positive in volumetric_strain, needed with it", "", choices=("dilation", "compression"), free=True)
	units: Optional[Dict[str, str]] = key(None, "header -> '%', '-', 'Pa', 'kPa' or 'MPa', where a header does not end in [unit]", free=True)

	def check(self, path):
		for name in [field.name for field in dataclasses.fields(self)][1:]:
			if self.file is None and getattr(self, name) is not None:
				raise ConfigError(f"{path}.{name}", getattr(self, name), "is of no curve", f"give {path}.file, or leave it out")
