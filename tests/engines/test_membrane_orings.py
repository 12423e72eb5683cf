# SPDX-License-Identifier: GPL-2.0-or-later
import numpy as np
import pytest

from membraneScene import makeMembrane, positions


def platens():
	from yade import O, utils

	low, high = O.bodies.append([utils.sphere((0, 0, z), 0.01, fixed=True) for z in (-0.02, 0.05)])
	O.bodies[low].state.vel = (0, 0, 0.1)
	O.bodies[high].state.vel = (0.05, 0, -0.3)
	return low, high


def test_ridingAndFixed(O):
	from yade import NewtonIntegrator
	from yade.wrapper import MembraneORings

	m = makeMembrane()
	low, high = platens()
	rings = MembraneORings(membrane=m, mode="platens", bottomPlaten=low, topPlaten=high)
	O.engines = [rings, NewtonIntegrator()]
	O.dt = 1e-3
	before = positions(m)
	O.run(10, True)
	moved = positions(m) - before
	rows = m.oRingRows * m.perRing
	assert np.allclose(moved[:rows], (0, 0, 0.1 * 0.01), rtol=1e-9, atol=1e-15)
	assert np.allclose(moved[-rows:], (0.05 * 0.01, 0, -0.3 * 0.01), rtol=1e-9, atol=1e-15)
	assert (moved[rows:-rows] == 0).all()
	rings.mode = "fixed"
	before = positions(m)
	O.run(10, True)
	assert (positions(m) == before).all()


def test_badInput(O):
	from yade.wrapper import MembraneORings

	m = makeMembrane()
	with pytest.raises(ValueError, match="'fixed' or 'platens'"):
		MembraneORings(membrane=m, mode="free")()
	with pytest.raises(RuntimeError, match="MembraneORings.bottomPlaten = -1"):
		MembraneORings(membrane=m, mode="platens")()
	with pytest.raises(RuntimeError, match="MembraneORings.membrane = None"):
		MembraneORings()()
