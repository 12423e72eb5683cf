# SPDX-License-Identifier: GPL-2.0-or-later
"""The deviatoric stress without the membrane: the free body of half a specimen, by hand."""

import numpy
import pytest
from hexmembrane.measure import correction
from hexmembrane.scene.membrane_loads import MembraneLoads, axialPush


def test_freeBodyOfHalfASpecimen():
	"""F = 500 N on a platen, 13 cm2 in the middle, 100 kPa; the pressure's own push is 10 N, the membrane pulls 8 N in the middle and 5 N at the
	O-rings, and presses 3 kPa."""
	loads = MembraneLoads(axialPush=10.0, axialPullMiddle=8.0, axialPullEnd=5.0, radialPressure=3e3)
	inSoil = 500.0 + 10 + 8 - 5  # what holds the half up, at mid-height [N]
	assert correction.correctedStress(500.0, 1e5, 13e-4, loads) == pytest.approx(inSoil / 13e-4 - 103e3, rel=1e-12)


def test_pushOfThePressure():
	"""A specimen that bulges is pushed together: up below mid-height, down above; a force that pushes all of it up is none."""
	z, force = numpy.array([0.01, 0.02, 0.06, 0.07]), numpy.array([2.0, 1.0, -0.5, -1.5])
	assert axialPush(z, force, 0.04) == pytest.approx(2.5, rel=1e-12)
	assert axialPush(z, numpy.ones(4), 0.04) == 0


def test_withoutAMembraneNothingIsTakenOff():
	assert correction.correctedStress(400.0, 1e5, 13e-4, MembraneLoads()) == pytest.approx(400 / 13e-4 - 1e5, rel=1e-12)
