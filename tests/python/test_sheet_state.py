# SPDX-License-Identifier: GPL-2.0-or-later
"""Strain and tension of the sheet, triangle by triangle, against closed forms."""

import numpy as np
import pytest
import yade
from hexmembrane.scene.sheet_state import sheetState


@pytest.fixture
def membrane(O):
	O.materials.append(yade.LinearMat(friction=0, density=1000, emod=1e7, kratio=3))
	made = yade.HexMembrane(specimenRadius=0.02, specimenHeight=0.06, particleRadius=1e-3, material=O.materials[0], mask=3)
	made.generate()
	return made


def stateOf(membrane, stretch, forces):
	"""The sheet stretched by factors (radially, axially), with normal forces ``forces`` (one number or one a bond); and which triangles are inside."""
	x = np.array([tuple(p) for p in membrane.positions]) * [stretch[0], stretch[0], stretch[1]]
	triangles, bonds = (np.array([tuple(t) for t in rows]) for rows in (membrane.triangles, membrane.bonds))
	found = sheetState(x, triangles, membrane.perRing, 2 * membrane.sphereRadius, bonds, np.broadcast_to(forces, len(bonds)))
	ring = triangles // membrane.perRing
	return found, (ring.min(axis=1) > 0) & (ring.max(axis=1) < membrane.rings - 1)


def test_withoutStress(membrane):
	found, _ = stateOf(membrane, (1, 1), 0.0)
	for name, values in found.items():
		assert len(values) == len(membrane.triangles) and np.abs(values).max() < 1e-12, name


def test_strain(membrane):
	found, _ = stateOf(membrane, (1.02, 0.99), 0.0)
	assert found["hoop_strain"] == pytest.approx(0.02, rel=1e-9)
	assert found["axial_strain"] == pytest.approx(-0.01, abs=3e-4)  # the sheet is curved: its triangles lean a little


def test_tension(membrane):
	"""Equal forces N of bonds of length L: sqrt(3) N/L in every direction. Forces along the rings alone: 2 N/(sqrt(3) L), nothing across."""
	length = 2 * membrane.sphereRadius
	found, inside = stateOf(membrane, (1, 1), 0.7)
	for name in ("hoop_tension", "axial_tension"):
		assert found[name][inside] == pytest.approx(np.sqrt(3) * 0.7 / length, rel=1e-3), name
	bonds = np.array([tuple(bond) for bond in membrane.bonds])
	along = bonds[:, 0] // membrane.perRing == bonds[:, 1] // membrane.perRing
	found, inside = stateOf(membrane, (1, 1), np.where(along, 0.7, 0.0))
	assert found["hoop_tension"][inside] == pytest.approx(2 * 0.7 / (np.sqrt(3) * length), rel=1e-3)
	assert np.abs(found["axial_tension"]).max() < 1e-9
