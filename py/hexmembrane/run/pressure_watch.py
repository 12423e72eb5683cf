# SPDX-License-Identifier: GPL-2.0-or-later
"""Whether the lateral boundary holds its pressure in shear: told in the log, or the end of the test. Uses nothing of YADE.

What is watched is the column ``sigma3_distance`` of each row, against ``shear.pressureTolerance``.
"""

from hexmembrane.output import records

_FIX = "fix: a slower shear.velocity, smaller time constants or less damping of the boundary's servo, or a larger shear.pressureTolerance"


class PressureWatch:
	"""Told of each row of the shear.

	:param keys: the configuration's shear section.
	:param name: of the lateral boundary.
	:param stage: label of the stage.
	"""

	def __init__(self, keys, name, stage="shear"):
		self.keys, self.name, self.stage, self._told = keys, name, stage, False

	def strayed(self, row):
		"""What is to be said of a row: the first time that it is beyond the tolerance, or every time where that stops the test; else ''."""
		keys, distance = self.keys, row["sigma3_distance"]
		if abs(distance) <= keys.pressureTolerance or self._told and not keys.stopOutsideTolerance:
			return ""
		self._told = True
		return (
			f"shear.pressureTolerance = {keys.pressureTolerance:g}: at {100 * row['axial_strain']:.2f} % the {self.name} transmits "
			f"{1e-3 * row['sigma3_transmitted_group3']:.4g} kPa, {100 * distance:+.3g} % of sigma3 away from what it is to hold; {_FIX}"
		)

	def summary(self, path):
		"""The largest distance in all rows of the stage, in words.

		:param path: records.csv; it has the rows from before a resume too.
		"""
		table = records.read(path)
		rows = [i for i, stage in enumerate(table["stage"]) if stage == self.stage]
		worst = max(rows, key=lambda i: abs(table["sigma3_distance"][i]))
		distance = float(table["sigma3_distance"][worst])
		text = f"{100 * distance:+.2g} % from its target at most, at {100 * table['axial_strain'][worst]:.2f} %"
		return text + (": WARNING, the pressure was not held" if abs(distance) > self.keys.pressureTolerance else "")
