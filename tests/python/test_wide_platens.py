# SPDX-License-Identifier: GPL-2.0-or-later
"""Platens wider than the specimen (``platens.radius``): the soil may widen over them, and the membrane does not meet them."""

import math

import numpy
import pytest
from hexmembrane.configuration import Config, ConfigError
from tinyTest import TINY, configure

WIDE = {"radius": 0.026, "friction": 0.0}


def test_givenWrongly(tmp_path):
	configure(tmp_path)
	with pytest.raises(ConfigError, match="^platens.radius = 0.019: the specimen of radius 0.02 m stands over it; fix: give that at least"):
		Config.of({**TINY, "platens": {"radius": 0.019}}, tmp_path)


@pytest.mark.parametrize("tier", ["compact", "reference"])
def test_membraneDoesNotMeetThem(O, tmp_path, runHere, tier):
	"""Its O-ring rows stand inside them; the axial stress acts on the specimen's ends."""
	from hexmembrane.scene.handles import Scene

	code, _, errors = runHere(configure(tmp_path, tier=tier, platens=WIDE), "--out", tmp_path / "out", "--until", "boundary")
	assert code == 0, errors
	scene = Scene()
	platens = [scene.bottomDrive.platen, scene.topDrive.platen]
	assert {O.bodies[i].shape.radius for i in platens} == {0.026}
	assert scene.endArea() == pytest.approx(math.pi * 0.02**2, rel=1e-9)
	membrane = set(scene.lateralBoundary.membrane.ids)
	bottom, top = scene.faces()
	inside = [i for i in membrane if not bottom < O.bodies[i].state.pos[2] < top]
	assert len(inside) == 2 * 2 * scene.lateralBoundary.membrane.perRing
	scene.lateralBoundary.setMaxVelocity(0.05)
	scene.setPressure(2e4)
	O.run(200, True)
	scene.exportContacts()
	met = {(c.id1 if c.id2 in platens else c.id2) for c in O.interactions if c.isReal and (c.id1 in platens or c.id2 in platens)}
	assert len(met) > 10 and not met & membrane


def test_soilMayWidenOverThem(O, tmp_path, runHere):
	"""A whole test: grains stand on the face beyond the specimen's first radius. Saved and loaded the scene goes on as it would have."""
	import yade
	from hexmembrane.scene.handles import Scene

	config = configure(tmp_path, platens=WIDE, shear={"strain": 0.12, "velocity": 0.4}, output={"records": 12})
	code, _, errors = runHere(config, "--out", tmp_path / "out")
	assert code == 0, errors
	scene = Scene()
	_, top = scene.faces()
	centres, radii = yade.BodyArrays.positions(scene.grainIds()), yade.BodyArrays.radii(scene.grainIds())
	resting = centres[:, 2] + 1.001 * radii > top
	assert resting.sum() > 5 and (numpy.hypot(*centres.T[:2]) + radii)[resting].max() > 0.0205
	state = str(tmp_path / "state.yade.gz")
	O.save(state)
	O.run(60, True)
	expected = yade.BodyArrays.positions(Scene().grainIds())
	O.reset()
	O.load(state)
	O.run(60, True)
	assert (yade.BodyArrays.positions(Scene().grainIds()) == expected).all()


def test_fromState(tmp_path, runHere):
	"""A state's platens have their radius; another is refused."""
	wall = {"boundary": "wall", "shear": {"strain": 0.002}, "output": {"records": 2}}
	code, _, errors = runHere(configure(tmp_path, platens=WIDE, **wall), "--out", tmp_path / "out", "--until", "consolidation")
	assert code == 0, errors
	state = tmp_path / "out" / "consolidated.yade.gz"
	code, _, errors = runHere(configure(tmp_path, platens={**WIDE, "radius": 0.03}, **wall), "--out", tmp_path / "other", "--from", state)
	assert code == 2 and "platens.radius = 0.03: the state was made with 0.026" in errors
	code, _, errors = runHere(configure(tmp_path, platens=WIDE, **wall), "--out", tmp_path / "shear", "--from", state)
	assert code == 0, errors


def test_fromTheWallToTheMembrane(O, tmp_path, runHere):
	"""A membrane that takes the wall's place does not meet them either."""
	from hexmembrane.scene.handles import Scene

	stages = [{"kind": "consolidation"}, {"kind": "membrane", "time": 0.008}, {"kind": "shear", "strain": 0.002, "records": 2}]
	code, _, errors = runHere(configure(tmp_path, boundary="wall", stages=stages, platens=WIDE, consolidation={"unbalanced": 0.02}), "--out", tmp_path / "out")
	assert code == 0, errors
	scene = Scene()
	scene.exportContacts()
	platens, membrane = {scene.bottomDrive.platen, scene.topDrive.platen}, set(scene.lateralBoundary.membrane.ids)
	assert {O.bodies[i].shape.radius for i in platens} == {0.026}
	assert not any({c.id1, c.id2} & platens and {c.id1, c.id2} & membrane for c in O.interactions if c.isReal)
