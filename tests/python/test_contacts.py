# SPDX-License-Identifier: GPL-2.0-or-later
"""The section ``contacts``: stiffness and friction by pair of groups, in the scene, in the time step, through the stages and with ``--from``."""

import copy
import math

import pytest
from hexmembrane.configuration import Config, ConfigError, toDict
from hexmembrane.scene import timestep
from tinyTest import TINY, configure

PAIRS = {
	"grainPlaten": {"kn": 4e5, "ks": 2e5, "friction": 0.7},
	"grainWall": {"emod": 5e7, "kratio": 2, "friction": 0.6},
	"grainMembrane": {"kn": 3e5, "ks": 1e5},
}
LOOSE = {"specimen": {"stress": 5e4, "friction": 0.3, "porosity": 0.45}, "consolidation": {"friction": 0.2, "unbalanced": 0.05, "tolerance": 0.3}}


def made(folder, **changes):
	configure(folder)
	return Config.of({**copy.deepcopy(TINY), **changes}, folder)


@pytest.mark.parametrize(
	"pairs, message",
	[
		({"grainPlaten": {"kn": 1e7}}, "contacts.grainPlaten.ks = None: the stiffness is given in half"),
		({"grainWall": {"kn": 1e7, "ks": 1e7, "emod": 1e8, "kratio": 2}}, "contacts.grainWall.kn = 10000000.0: the stiffness is given twice"),
		({"grainPlaten": {"friction": -0.1}}, "contacts.grainPlaten.friction = -0.1: is out of range"),
		({"grainGrain": {"friction": 0.1}}, "contacts.grainGrain = .*: unknown key; fix: .*known keys are grainPlaten"),
		({"grainPlaten": {"fric": 0.1}}, "contacts.grainPlaten.fric = 0.1: is PFC's name; fix: here it is friction"),
		({"grainPlaten": {"rr_fric": 0.1}}, "contacts.grainPlaten.rr_fric = 0.1: is PFC's name; fix: here it is rollingFriction"),
	],
)
def test_givenWrongly(tmp_path, pairs, message):
	with pytest.raises(ConfigError, match=f"^{message}"):
		made(tmp_path, contacts=pairs)


def test_whatIsWrittenBack(tmp_path):
	config = made(tmp_path, contacts=PAIRS)
	assert toDict(Config.of(toDict(config), tmp_path)) == toDict(config)
	assert config.contacts.frictions()["grain", "platen"] == 0.7 and config.contacts.frictions(platens=0.0)["grain", "platen"] == 0.0
	assert made(tmp_path).contacts.frictions(platens=0.1)["grain", "platen"] is None


def test_stiffPairsShortenTheStep(tmp_path):
	"""omega^2 of a smallest grain grows by kn/m, or 3.5 ks/m where that is more; that of a membrane sphere has the pair's kn."""
	plain, stiff = made(tmp_path), made(tmp_path, contacts={"grainPlaten": {"kn": 1e7, "ks": 5e6}, "grainMembrane": {"kn": 1e6, "ks": 1e6}})
	assert timestep.grainsStep(plain, 2e-3) == timestep.grainStep(plain.specimen, 2e-3)
	square = (2 / timestep.grainStep(plain.specimen, 2e-3)) ** 2 + 3.5 * 5e6 / timestep.sphereMass(2e-3, 2650)
	assert timestep.grainsStep(stiff, 2e-3) == pytest.approx(2 / math.sqrt(square), rel=1e-12)
	springs = plain.specimen.springs
	step = timestep.membraneStep(springs, springs, 1000.0, 3e-3, 1e-3, math.inf, stiff.contacts.grainMembrane)
	assert step == pytest.approx(2 / math.sqrt(timestep.GRAINS_PER_PARTICLE * 1e6 / timestep.sphereMass(1e-3, 1000)), rel=1e-12)
	stiff.contacts.grainMembrane.friction = 0.1
	assert timestep.membraneStep(springs, springs, 1000.0, 3e-3, 1e-3, math.inf, stiff.contacts.grainMembrane) == pytest.approx(step / math.sqrt(4.5), rel=1e-12)


@pytest.mark.parametrize("tier, boundary", [("compact", "membrane"), ("reference", "wall")])
def test_contactsInTheScene(O, tmp_path, runHere, tier, boundary):
	from hexmembrane.scene.handles import Scene

	file = configure(tmp_path, tier=tier, boundary=boundary, contacts=PAIRS, **LOOSE)
	code, _, errors = runHere(file, "--out", tmp_path / "out", "--until", "boundary")
	assert code == 0, errors
	scene = Scene()
	if boundary == "membrane":
		assert scene.lateralBoundary.facets.kn == 3e5
	scene.lateralBoundary.setMaxVelocity(0.05)
	scene.setPressure(2e4)
	for platens, friction in ((None, 0.7), (0.0, 0.0)):
		scene.setFriction(0.3, 0.3, Config.of({**TINY, "contacts": PAIRS}, tmp_path).contacts.frictions(platens))
		O.run(100, True)
		scene.exportContacts()
		found = {}
		for contact in O.interactions:
			pair = tuple(sorted(O.bodies[i].material.label for i in (contact.id1, contact.id2)))
			found.setdefault(pair, []).append(contact)
		assert {round(c.phys.kn, 4) for c in found["grain", "platen"]} == {4e5} and {round(c.phys.ks, 4) for c in found["grain", "platen"]} == {2e5}
		assert {round(c.phys.tangensOfFrictionAngle, 12) for c in found["grain", "platen"]} == {friction}
		assert {round(c.phys.tangensOfFrictionAngle, 12) for c in found["grain", "grain"]} == {0.3}
		if boundary == "membrane":
			assert {round(c.phys.kn, 4) for c in found["grain", "membrane"]} == {3e5} and {c.phys.tangensOfFrictionAngle for c in found["grain", "membrane"]} == {0}
		else:
			for contact in found["grain", "wall"]:
				radius = next(O.bodies[i].shape.radius for i in (contact.id1, contact.id2) if O.bodies[i].material.label == "grain")
				assert contact.phys.kn == pytest.approx(math.pi * 5e7 * radius, rel=1e-12) and contact.phys.tangensOfFrictionAngle == pytest.approx(0.6)


def test_fromState(O, tmp_path, runHere):
	"""Frictions are applied; a stiffness is taken over, or refused where it is given otherwise."""
	wall = {"boundary": "wall", "consolidation": LOOSE["consolidation"], "shear": {"strain": 0.002}, "output": {"records": 2}}
	code, _, errors = runHere(configure(tmp_path, contacts=PAIRS, **wall), "--out", tmp_path / "out", "--until", "consolidation")
	assert code == 0, errors
	state = tmp_path / "out" / "consolidated.yade.gz"
	assert O.materials["grain"].pairs()["platen"]["friction"] == 0.7 and O.materials["grain"].pairs()["wall"]["friction"] == 0.6
	file = configure(tmp_path, contacts={"grainPlaten": {"friction": 0.4}}, **wall)
	code, said, errors = runHere(file, "--out", tmp_path / "shear", "--from", state)
	assert code == 0, errors
	assert "contacts.grainPlaten.kn = 400000.0" in said and "contacts.grainWall.emod = 50000000.0" in said
	assert O.materials["grain"].pairs() == {
		"platen": {"kn": 4e5, "ks": 2e5, "friction": 0.4}, "wall": {"emod": 5e7, "kratio": 2.0}, "membrane": {"kn": 3e5, "ks": 1e5},
	}  # fmt: skip
	file = configure(tmp_path, contacts={"grainPlaten": {"kn": 5e5, "ks": 2e5}}, **wall)
	code, _, errors = runHere(file, "--out", tmp_path / "other", "--from", state)
	assert code == 2 and "contacts.grainPlaten.kn = 500000.0: the state was made with 400000.0" in errors
	(tmp_path / "out" / "config.yaml").rename(tmp_path / "away.yaml")
	code, _, errors = runHere(file, "--out", tmp_path / "other", "--from", state)
	assert code == 2 and "contacts.grainPlaten.kn = 500000.0: the state has 400000.0" in errors
