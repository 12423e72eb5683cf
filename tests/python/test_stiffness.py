# SPDX-License-Identifier: GPL-2.0-or-later
"""Stiffness given directly or by PFC's deformability, of grains, platens, wall and membrane; PFC's names of properties."""

import math

import numpy
import pytest
from hexmembrane.configuration import Config, ConfigError, derived, toDict
from hexmembrane.configuration.stiffness import Springs
from hexmembrane.run import estimate
from hexmembrane.scene import accuracy, timestep
from tinyTest import TINY, configure

DIRECT = {"kn": 2e5, "ks": 1e5, "emod": None}


def made(folder, **changes):
	configure(folder)
	given = {**TINY, "specimen": {name: value for name, value in TINY["specimen"].items() if name != "emod"}}
	return Config.of({**given, **{name: {**given.get(name, {}), **part} for name, part in changes.items()}}, folder)


@pytest.mark.parametrize(
	"section, name, here",
	[
		("specimen", "fric", "specimen.friction"),
		("specimen", "rr_fric", "specimen.rollingFriction"),
		("platens", "fric", "platens.friction"),
		("specimen", "damp", "numerics.damping"),
		("numerics", "damp", "numerics.damping"),
		("membrane", "cb_tenf", "membrane.tensileStrength"),
		("membrane", "kn", "membrane.contactKn"),
		("specimen", "cb-shearf", "LinearMat.cbTensile"),
		("wall", "fric", "wall.friction"),
		("consolidation", "kn", "specimen.kn, platens.kn or wall.kn"),
	],
)
def test_pfcsNames(tmp_path, section, name, here):
	with pytest.raises(ConfigError, match=rf"{section}.{name} = 0.5: is PFC's name; fix: here it is .*{here}"):
		made(tmp_path, **{section: {name: 0.5}})


@pytest.mark.parametrize(
	"section, keys, message",
	[
		("specimen", {"kn": 1e6}, "specimen.ks = None: the stiffness is given in half"),
		("specimen", {"ks": 1e6}, "specimen.kn = None: the stiffness is given in half"),
		("specimen", {"kn": 1e6, "ks": 1e6, "emod": 1e7, "kratio": 2}, r"specimen.kn = 1000000.0: the stiffness is given twice, emod = 1e\+07 Pa too"),
		("specimen", {"emod": None, "kratio": None}, "specimen.emod = None: the grains have no stiffness"),
		("platens", {"emod": 1e8}, "platens.kratio = None: the stiffness is given in half"),
		("wall", {"kn": 1e8, "ks": 1e7, "emod": 1e8, "kratio": 1}, "wall.kn = 100000000.0: the stiffness is given twice"),
		("membrane", {"contactKs": 1e4}, "membrane.contactKn = None: the stiffness is given in half"),
		("specimen", {"kn": 1e40, "ks": 1}, "specimen.kn = 1e.40: is beyond what a test can have"),
	],
)
def test_givenWrongly(tmp_path, section, keys, message):
	with pytest.raises(ConfigError, match=f"^{message}.*; fix: "):
		made(tmp_path, **{section: keys})


def test_whatIsWrittenBack(tmp_path):
	"""With kn the resolved configuration has no modulus, and is read again."""
	config = made(tmp_path, specimen={"kn": 2e5, "ks": 1e5})
	assert (config.specimen.emod, config.specimen.kratio) == (None, None)
	assert toDict(Config.of(toDict(config))) == toDict(config)
	other = derived(made(tmp_path), {"specimen": {"kn": 2e5, "ks": 1e5, "emod": None, "kratio": None}})
	assert other.specimen.springs == Springs(2e5, 1e5) and other.specimen.stiffnessKey == "specimen.kn"


def test_springsInSeries():
	sand, steel = Springs(emod=4e7, kratio=3), Springs(kn=1e7, ks=1e7)
	assert timestep.pairStiffness(sand, sand, 1e-3, 3e-3) == pytest.approx(timestep.contactStiffness(4e7, 1e-3, 3e-3), rel=1e-14)
	assert timestep.pairStiffness(steel, steel, 1e-3, 3e-3) == pytest.approx(5e6)
	assert timestep.levelOf(steel, 1e-3, 1e5) == pytest.approx(5e6 / (1e5 * 2e-3)) and timestep.levelOf(sand, 1e-3, 1e5) == timestep.stiffnessLevel(4e7, 1e5)


def test_massesOfADirectStiffness():
	"""All grains then have the largest's mass, and its step."""
	radii = numpy.array([1e-3, 1.5e-3, 3e-3])
	assert (timestep.sphereMass(radii, 2650) * timestep.massFactors(radii, True)) == pytest.approx(timestep.sphereMass(3e-3, 2650), rel=1e-12)


def test_softSpringsAreRefused(tmp_path):
	config = made(tmp_path, specimen={"kn": 100, "ks": 100})
	with pytest.raises(ConfigError, match=r"specimen.kn = 100.0: gives kn/\(p d\) = 0.1 at .*; fix: at least 1e\+04 N/m, 3e\+05 N/m for small"):
		estimate.requireStiffness(config, 2.5e-3)


def test_accuracyLeavesADirectStiffness(tmp_path):
	config = made(tmp_path, specimen={"kn": 2e5, "ks": 1e5})
	assert "specimen.emod" not in accuracy.openKeys(config)
	key, value, level, _ = next(part for part in accuracy.budget(config, numpy.full(1200, 2.5e-3)).parts if part[0].startswith("specimen."))
	assert (key, value) == ("specimen.kn", 2e5) and level == pytest.approx(1e5 / (1e5 * 5e-3))


@pytest.mark.parametrize("name, boundary", [("compact", "wall"), ("reference", "membrane")])
def test_contactsInTheScene(O, tmp_path, runHere, name, boundary):
	"""Each pair of groups has its own springs in series, and the critical step is that of what is there."""
	from hexmembrane.scene.handles import Scene

	platens, wall = {"kn": 1e7, "ks": 5e6}, {"emod": 1e9, "kratio": 2}
	file = configure(tmp_path, tier=name, boundary=boundary, specimen={**DIRECT, "stress": 5e4, "friction": 0.3, "porosity": 0.43}, platens=platens, wall=wall, membrane={"contactKn": 1e4})
	code, said, errors = runHere(file, "--out", tmp_path / "out", "--until", "boundary")
	assert code == 0, errors
	assert "WARNING: below 300" in said and "raise specimen.kn" in said
	first, scene = O.dt, Scene()
	scene.lateralBoundary.setMaxVelocity(0.05)
	scene.setPressure(2e4)
	O.run(200, True)
	scene.exportContacts()
	found = {}
	for contact in O.interactions:
		pair = tuple(sorted(O.bodies[i].material.label for i in (contact.id1, contact.id2)))
		if contact.phys.kn > 0:
			found.setdefault(pair, []).append((contact, contact.phys.kn, contact.phys.ks))
	assert {kn for _, kn, _ in found["grain", "grain"]} == {1e5} and {ks for *_, ks in found["grain", "grain"]} == {5e4}
	assert {round(kn) for _, kn, _ in found["grain", "platen"]} == {round(1 / (1 / 2e5 + 1e-7))}
	if boundary == "membrane":
		assert {round(kn, 6) for _, kn, _ in found["grain", "membrane"]} == {round(1 / (1 / 2e5 + 1e-4), 6)}
	else:
		for contact, kn, _ in found["grain", "wall"]:
			radius = next(O.bodies[i].shape.radius for i in (contact.id1, contact.id2) if hasattr(O.bodies[i].shape, "radius") and O.bodies[i].material.label == "grain")
			assert kn == pytest.approx(1 / (1 / 2e5 + 1 / (2 * math.pi * 1e9 * radius)), rel=1e-9)
	# half of the critical step of eight equal neighbours: a direct stiffness makes the smallest grain's step go with the root of its mass
	smallest = min(O.bodies[i].shape.radius for i in scene.grainIds())
	expected = 0.5 * 2 / math.sqrt(2 * 8 / 3 * 1e5 * (2 / 2 / 0.4) / timestep.sphereMass(smallest, 2650))
	assert first <= expected * (1 + 1e-9) and (boundary == "membrane" or first == pytest.approx(expected, rel=1e-9))
