# SPDX-License-Identifier: GPL-2.0-or-later
"""The deviatoric stress without the membrane: the free body of half a specimen, by hand."""

import pytest
from hexmembrane import correction


def test_freeBodyOfHalfASpecimen():
	"""F = 0.5 kN on a platen of 12 cm2, 13 cm2 in the middle, 100 kPa; the membrane pulls 8 N in the middle, 5 N at the O-rings, and presses 3 kPa."""
	force, pressure, end, middle = 500.0, 1e5, 12e-4, 13e-4
	found = {"membrane_axial_mid": 8.0, "membrane_axial_end": 5.0, "sigma3_membrane": 3e3}
	axialStress = (force - pressure * end) / middle + pressure  # the record's
	inSoil = force + pressure * (middle - end) + 8 - 5  # what holds the half up, at mid-height [N]
	assert correction.corrected(axialStress, pressure, middle, found) == pytest.approx(inSoil / middle - 103e3, rel=1e-12)


def test_withoutAMembraneNothingIsTakenOff():
	assert correction.corrected(3.1e5, 1e5, 13e-4, correction.NONE) == pytest.approx(2.1e5, rel=1e-12)
