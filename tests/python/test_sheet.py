# SPDX-License-Identifier: GPL-2.0-or-later
"""The membrane's own mechanics, from the keys of a configuration to the engines and the time step of either tier."""

import math

import pytest
from hexmembrane import configuration
from hexmembrane.measure import energy
from hexmembrane.scene import specimen
from hexmembrane.scene.builder import build
from tinyTest import configure

#: So stiff that the bending sets the time step.
STIFF = 2.0


@pytest.fixture(scope="module")
def packing(tmp_path_factory):
	return specimen.make(configuration.load(configure(tmp_path_factory.mktemp("packing"))), lambda text: None)


@pytest.fixture
def built(O, packing, tmp_path):
	"""``built(tier, **keys of the membrane)``: the scene, its engines by class name, and what the log says."""

	def make(tier, **membrane):
		O.reset()
		said = []
		scene = build(configuration.load(configure(tmp_path, tier=tier, membrane=membrane)), packing, said.append)
		inner = scene.loop.engines if scene.loop else O.engines
		return scene, {type(engine).__name__: engine for engine in inner}, "\n".join(said)

	return make


def test_offMakesNothing(built, tier):
	scene, engines, _ = built(tier, bendingStiffness=0.0, facets=False)
	assert "MembraneBonds" in engines and not {"MembraneBending", "MembraneSelfContact", "MembraneFacetContact"} & set(engines)
	assert scene.lateralBoundary.facets is None
	assert scene.lateralBoundary.sheet == [engines["MembraneBonds"]]
	assert engines["MembraneBonds"].tensileStrength == math.inf and engines["MembraneBonds"].shearStrength == math.inf


def test_bendingArrives(O, built, tier):
	built(tier, bendingStiffness=0.0)
	step = O.dt
	scene, engines, said = built(tier, bendingStiffness=STIFF)
	bending = engines["MembraneBending"]
	assert bending.stiffness == STIFF and bending in scene.lateralBoundary.sheet
	assert "D = 2 N m" in said
	assert O.dt < 0.5 * step and O.dt < bending.criticalTimeStep()
	scene.setPressure(1e4)
	O.step()
	assert scene.criticalTimeStep() <= bending.criticalTimeStep() * 1.01
	O.step()
	assert dict(O.energy.items())["elastBending"] > 0
	assert energy.current()["membrane"] == pytest.approx(dict(O.energy.items())["elastBending"] + dict(O.energy.items())["elastMembrane"], rel=1e-12)


def test_selfContactArrives(O, built, tier):
	built(tier)
	step = O.dt
	scene, engines, _ = built(tier, selfContact=True, bendingStiffness=0.0)
	contact = engines["MembraneSelfContact"]
	assert scene.lateralBoundary.sheet == [engines["MembraneBonds"], contact]
	assert O.dt == step  # an open sheet touches nothing
	radius = contact.membrane.sphereRadius
	assert contact.normalStiffness == pytest.approx(math.pi * O.materials["membrane"].emod * radius / 2, rel=1e-12)
	scene.setPressure(1e4)
	O.step()
	assert contact.pairs == [] and contact.criticalTimeStep() == math.inf


def test_facetsArrive(O, built, tier):
	"""Here so thick that grains touch them in a sheet that is not stretched."""
	scene, engines, _ = built(tier, bendingStiffness=0.0)
	facets = engines["MembraneFacetContact"]
	assert scene.lateralBoundary.facets is facets and facets.bonds is engines["MembraneBonds"]
	scene.setPressure(1e4)
	facets.offset = 0.89 * facets.membrane.sphereRadius
	O.run(300, True)
	assert facets.grains
	assert scene.criticalTimeStep() <= 1.25 * facets.criticalTimeStep()  # which is a lower bound where a grain reaches several triangles
	tracked = dict(O.energy.items())
	assert tracked["elastFacet"] > 0
	assert energy.current()["membrane"] == pytest.approx(tracked["elastFacet"] + tracked["elastMembrane"], rel=1e-12)


def test_strengthsArrive(built, tier):
	_, engines, _ = built(tier, tensileStrength=2.0, shearStrength=3.0, poisson=0.2)
	assert (engines["MembraneBonds"].tensileStrength, engines["MembraneBonds"].shearStrength) == (2.0, 3.0)


def test_aTornMembraneIsToldAsThat(tmp_path, runHere):
	"""Bonds that are far too weak: whatever stops the test, its first words are of the membrane."""
	path = configure(tmp_path, membrane={"tensileStrength": 1e-3}, consolidation={"unbalanced": 1e-3})
	code, _, errors = runHere(path, "--out", tmp_path / "out")
	assert code == 1 and "the membrane is torn, " in errors and "bonds are broken (membrane.tensileStrength" in errors, errors


def test_aWeakSheetIsToldBeforeTheRun(built):
	"""Only one that both stretches and bends too easily; never the default."""
	weak = dict(young=1e5, thickness=3e-4)
	assert "WARNING: pressure times grain radius is " not in built("compact")[2]
	assert "WARNING: pressure" not in built("compact", **weak)[2]
	assert "WARNING: pressure" not in built("compact", bendingStiffness=0.0, young=1e7, thickness=5e-3)[2]
	said = built("compact", bendingStiffness=0.0, **weak)[2]
	assert "of E t (limit 0.25), and it has no bending stiffness" in said and "fix: leave membrane.bendingStiffness out" in said
	assert "lets it sag by " in built("compact", bendingStiffness=1e-5, **weak)[2]


def test_aSlitGivenAtTheStartCarriesNoTension(O, built):
	scene, engines, _ = built("reference", bendingStiffness=0.0, facets=False)
	scene.setPressure(1e4)
	bonds = engines["MembraneBonds"]
	count = len(bonds.membrane.bonds)
	bonds.broken = [2] * count
	with pytest.raises(ValueError, match="MembraneBonds.broken = 2: is neither whole nor broken; fix: 0 or 1 for each of HexMembrane.bonds"):
		O.step()
	bonds.broken = [k % 2 for k in range(count)]
	for i in bonds.membrane.ids:  # all bonds stretched
		O.bodies[i].state.pos = tuple(1.01 * x for x in O.bodies[i].state.pos)
	O.step()
	forces = bonds.normalForces()
	assert bonds.brokenCount == count // 2 and max(forces[1::2]) <= 0 < min(forces[::2])
