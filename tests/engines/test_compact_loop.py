# SPDX-License-Identifier: GPL-2.0-or-later
"""The compact tier against the reference tier, and with itself over a saved state."""

import numpy as np
import pytest
from specimenScene import bondGrains, build
from tiers import TIERS, engines, forces, run, state, writeContacts

SCENES = {
	"membrane": {},
	"wall": dict(lateral="wall"),
	"moving": dict(spin=0.05, velocity=0.05),
	"rough membrane": dict(membraneFriction=0.2, spin=0.02),
	"membrane with shear": dict(poisson=0.2, spin=0.02),
	"no friction": dict(friction=0.0, rollingFriction=0.0),
	"no rolling resistance": dict(rollingFriction=0.0, spin=0.02),
	"closed loop beside the platens": dict(servoTime=4e-4),
	"closed loop of the main body": dict(pressureTime=4e-4),
	"closed loops, rough membrane": dict(servoTime=4e-4, pressureTime=4e-4, membraneFriction=0.3, spin=0.05),
	"bonds": dict(bonds=True, spin=0.02),
	"bonds that break": dict(bonds=True, spin=0.05, velocity=0.05),
}


def results(tier, steps, O, bonds=False, **options):
	O.reset()
	made = build("reference" if bonds else tier, **options)
	if bonds:
		run(1)
		bondGrains(0.02 if "velocity" in options else 1e3)
		if tier == "compact":
			O.engines = engines(tier, made.values(), damping=0.2, substeps=20)
	run(steps)
	return state(), forces(), made


@pytest.mark.parametrize("scene", SCENES)
def test_forcesAfterOneStep(O, scene):
	"""Same formulas, another order of sums: forces agree to rounding of positions over overlaps."""
	reference, compact = (results(tier, 1, O, **SCENES[scene])[1] for tier in ("reference", "compact"))
	size = np.abs(reference).max(axis=0)
	assert (size[:3] > 0).all()
	scale = np.repeat([size[:3].max(), max(size[3:].max(), 1e-30)], 3)
	assert (np.abs(compact - reference) / scale).max() < 1e-11


@pytest.mark.parametrize("scene", SCENES)
def test_statesAfterManySteps(O, scene):
	"""200 steps with collisions, sliding and rolling: differences of rounding have grown, but by no error of any formula."""
	(reference, loads, madeReference), (compact, other, madeCompact) = (results(tier, 200, O, **SCENES[scene]) for tier in ("reference", "compact"))
	start = results("reference", 0, O, **SCENES[scene])[0]
	moved = np.abs(reference[:, :3] - start[:, :3]).max()
	assert moved > 1e-8
	assert np.abs(compact - reference)[:, :3].max() < 1e-7 * moved
	assert np.abs(compact - reference)[:, 3:6].max() < 1e-7 * np.abs(reference[:, 3:6]).max()
	assert np.abs(other - loads)[:, :3].max() < 1e-7 * np.abs(loads[:, :3]).max()
	for name, engine in madeReference.items():
		for attribute in ("force", "displacement", "radialStress", "velocity", "stiffness", "factor", "transmitted", "area"):
			value = getattr(engine, attribute, None)
			if isinstance(value, float) and np.isfinite(value):
				assert getattr(madeCompact[name], attribute) == pytest.approx(value, rel=1e-6, abs=1e-9), (name, attribute)
		closed = {"servo": "servoTime", "pressure": "pressureTime"}.get(name) in SCENES[scene]
		assert not closed or (engine.factor != 1 and engine.transmitted > 0)  # the loop has acted


def test_bondsBreakInOneSceneAndNotInTheOther(O):
	"""Of the two rows of SCENES with bonds; the tiers agree on which."""

	def bonded():
		writeContacts()
		return {tuple(sorted((i.id1, i.id2))) for i in O.interactions if i.isReal and i.phys.bonded}

	for scene, breaks in (("bonds", False), ("bonds that break", True)):
		results("reference", 0, O, **SCENES[scene])
		begun = len(bonded())
		left = []
		for tier in TIERS:
			results(tier, 200, O, **SCENES[scene])
			left.append(bonded())
		assert left[0] == left[1]
		assert (0 < len(left[0]) < begun) if breaks else len(left[0]) == begun > 100


def test_bodyOfPythonIsGone(O):
	"""Its shape dies where the arrays are collected anew, in YADE's own thread, which does not hold Python's lock."""
	made = build("compact", lateral="wall")
	O.run(20, True)
	wall = made["wall"].wall
	O.engines[1].engines = [engine for name, engine in made.items() if name != "wall"]
	del made
	O.bodies.erase(wall)
	O.run(20, True)
	assert O.iter == 40


def test_stepsAreCounted(O):
	build("compact", substeps=7)
	O.run(1, True)
	assert O.iter == 1 and O.time == pytest.approx(O.dt)
	O.run(20, True)
	assert O.iter == 21 and O.time == pytest.approx(21 * O.dt)
	O.step()
	assert O.iter == 28 and O.time == pytest.approx(28 * O.dt)


@pytest.mark.parametrize("scene", ["moving", "wall", "membrane with shear", "rough membrane"])
def test_energies(O, scene):
	"""Each energy as in the reference tier."""
	found = []
	for tier in ("reference", "compact"):
		results(tier, 0, O, **SCENES[scene])
		O.trackEnergy = True
		run(400)
		found.append(dict(O.energy.items()))
	reference, compact = found
	total = sum(abs(value) for value in reference.values())
	assert {name for name, value in reference.items() if value} == {name for name, value in compact.items() if value}
	for name, value in compact.items():
		assert value == pytest.approx(reference[name], rel=1e-6, abs=1e-9 * total), name
