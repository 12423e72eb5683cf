# SPDX-License-Identifier: GPL-2.0-or-later
"""The plugin's C++ and YADE's own Python bindings see the same values in the same members.

Written in C++ and read through YADE's bindings, and the other way round. Were the plugin compiled with other definitions than
YADE, members would lie at other offsets. Values are compared exactly: nothing is computed on the way.
"""

import pytest
import yade
from yade import FrictMat, Matrix3, Quaternion, Vector3, Vector3i, utils

BASE = 100.0


def attributeOf(thing, dotted):
	for name in dotted.split("."):
		thing = getattr(thing, name)
	return thing


def same(a, b):
	"""Exact equality; NaN and any difference in kind fail."""
	if isinstance(a, (Vector3, Vector3i, Quaternion)):
		return len(a) == len(b) and all(a[i] == b[i] for i in range(len(a)))
	if isinstance(a, Matrix3):
		return all(a[i, j] == b[i, j] for i in range(3) for j in range(3))
	return a == b


def flattened(value):
	if isinstance(value, (Vector3, Vector3i)):
		return [float(component) for component in value]
	return [float(value)] if isinstance(value, (int, float)) and not isinstance(value, bool) else []


@pytest.fixture
def contact(O):
	"""Two overlapping spheres with a real frictional contact, after one step."""
	O.materials.append(FrictMat(young=1e7, poisson=0.3, frictionAngle=0.4, density=2600, label="grain"))
	O.bodies.append([utils.sphere((0, 0, 0), 0.5, material="grain"), utils.sphere((0, 0, 0.99), 0.5, material="grain")])
	O.engines = [
		yade.ForceResetter(),
		yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb()]),
		yade.InteractionLoop([yade.Ig2_Sphere_Sphere_ScGeom()], [yade.Ip2_FrictMat_FrictMat_FrictPhys()], [yade.Law2_ScGeom_FrictPhys_CundallStrack()]),
		yade.LayoutProbe(ids=[0, 1], label="layoutProbe"),
		yade.NewtonIntegrator(),
	]
	O.dt = 1e-5
	O.step()
	return O


def differences(owner, seen, skip=()):
	return [(name, value, attributeOf(owner, name)) for name, value in seen.items() if name not in skip and not same(value, attributeOf(owner, name))]


SCENE_ELSEWHERE = ("bodies.size", "intrs.size", "engines.size", "material.size", "cell.hSize", "cell.trsf")


def test_comparisonSeesDifferences():
	assert same(Vector3(1, 2, 3), Vector3(1, 2, 3))
	assert not same(Vector3(1, 2, 3), Vector3(1, 2, 3.0000000001))
	assert not same(float("nan"), float("nan"))
	assert not same(Vector3(1, 2, float("nan")), Vector3(1, 2, float("nan")))
	assert not same(Quaternion((0, 1, 0), 0.1), Quaternion((0, 1, 0), 0.2))
	assert not same(Matrix3.Identity, Matrix3(1, 0, 0, 0, 1, 0, 0, 1e-300, 1))


def test_writtenNumbersAreDifferent(contact):
	"""Members that were given one and the same number could be swapped unseen."""
	for seen in (yade.LayoutProbe().writeBody(0, BASE), yade.LayoutProbe().writeInteraction(0, 1, BASE)):
		numbers = [number for value in seen.values() for number in flattened(value) if number > BASE]
		reals = [number for number in numbers if number != int(number)]
		assert len(reals) > 5
		assert len(set(reals)) == len(reals)


def test_bodyWrittenInCpp(contact):
	body = contact.bodies[1]
	seen = yade.LayoutProbe().writeBody(1, BASE)
	assert len(seen) == 34
	assert differences(body, seen) == []
	assert body.mask == seen["groupMask"] and body.state.blockedDOFs == "yXZ" and body.isClumpMember


def test_bodyWrittenInPython(contact):
	body = contact.bodies[1]
	body.mask = 0b10110
	body.dynamic = False
	state = body.state
	state.pos, state.vel, state.angVel, state.angMom = (1.5, 2.5, 3.5), (4.5, 5.5, 6.5), (7.5, 8.5, 9.5), (10.5, 11.5, 12.5)
	state.ori, state.refOri = Quaternion((1, 0, 0), 0.25), Quaternion((0, 0, 1), 0.5)
	state.mass, state.inertia, state.refPos, state.densityScaling = 13.5, (14.5, 15.5, 16.5), (17.5, 18.5, 19.5), 20.5
	state.blockedDOFs, state.isDamped = "xzY", False
	body.shape.radius, body.shape.color, body.shape.wire, body.shape.highlight = 21.5, (0.25, 0.5, 0.75), True, True
	body.bound.color = (0.125, 0.375, 0.625)
	material = body.material
	material.density, material.young, material.poisson, material.frictionAngle, material.label = 22.5, 23.5, 24.5, 25.5, "set in Python"
	seen = yade.LayoutProbe().readBody(1)
	assert differences(body, seen) == []
	assert seen["groupMask"] == 0b10110 and seen["state.blockedDOFs"] == "xzY" and seen["state.mass"] == 13.5


def test_clumpId(O):
	clump, members = O.bodies.appendClumped([utils.sphere((0, 0, 0), 0.5), utils.sphere((0, 0, 0.5), 0.5)])
	O.engines = [yade.ForceResetter(), yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb()]), yade.InteractionLoop([], [], []), yade.NewtonIntegrator()]
	O.dt = 1e-5
	O.step()
	assert [yade.LayoutProbe().readBody(member)["clumpId"] for member in members] == [clump, clump]


def test_sceneWrittenInCpp(contact):
	periodic, tracked = contact.periodic, contact.trackEnergy
	seen = yade.LayoutProbe().writeScene(BASE)
	try:
		assert differences(contact, seen, skip=SCENE_ELSEWHERE + ("stopAtTime", "subStep", "periodic")) == []
		assert (contact.stopAtTime, contact.subStep) == (seen["stopAtTime"], seen["subStep"])
		assert contact.periodic == (not periodic) and contact.trackEnergy == (not tracked)
		assert same(contact.cell.hSize, seen["cell.hSize"]) and same(contact.cell.trsf, seen["cell.trsf"])
		assert contact.dt > BASE and contact.iter >= BASE
	finally:
		contact.reset()


def test_sceneWrittenInPython(contact):
	contact.dt, contact.stopAtIter, contact.stopAtTime, contact.trackEnergy = 0.0625, 77, 1.75, True
	contact.periodic = True
	contact.cell.hSize = Matrix3(2, 0, 0, 0, 3, 0, 0, 0, 4)
	contact.cell.trsf = Matrix3(1, 0.5, 0, 0, 1, 0, 0, 0, 1)
	seen = yade.LayoutProbe().readScene()
	assert (seen["dt"], seen["stopAtIter"], seen["stopAtTime"], seen["trackEnergy"], seen["periodic"]) == (0.0625, 77, 1.75, True, True)
	assert (seen["iter"], seen["time"]) == (contact.iter, contact.time) and contact.iter == 1
	assert same(seen["cell.hSize"], contact.cell.hSize) and same(seen["cell.trsf"], contact.cell.trsf)
	assert (seen["bodies.size"], seen["intrs.size"], seen["engines.size"], seen["material.size"]) == (2, len(contact.interactions), 5, 1)


def test_interactionWrittenInCpp(contact):
	seen = yade.LayoutProbe().writeInteraction(0, 1, BASE)
	assert len(seen) == 18
	assert differences(contact.interactions[0, 1], seen) == []


def test_interactionWrittenInPython(contact):
	interaction = contact.interactions[0, 1]
	interaction.phys.kn, interaction.phys.ks, interaction.phys.tangensOfFrictionAngle = 1.5, 2.5, 3.5
	interaction.phys.normalForce, interaction.phys.shearForce = (4.5, 5.5, 6.5), (7.5, 8.5, 9.5)
	seen = yade.LayoutProbe().readInteraction(0, 1)
	assert differences(interaction, seen) == []
	assert seen["isReal"] and seen["phys.kn"] == 1.5 and seen["geom.penetrationDepth"] > 0


def test_forcesBothWays(contact):
	"""The engine sees what YADE's law put on the two bodies, and they are in balance."""
	probe = contact.engines[3]
	force = contact.interactions[0, 1].phys.normalForce
	assert force.norm() > 0
	assert probe.resultant.norm() <= 1e-12 * force.norm()
	probe.ids = [1]
	contact.step()
	assert probe.resultant[2] > 0 and same(probe.resultant, contact.forces.f(1))


def test_engineMembers(O):
	probe = yade.LayoutProbe(ids=[3, 1, 2], dead=True, ompThreads=7, label="probeLabel", steps=11)
	assert probe.readSelf() == {"ids": [3, 1, 2], "dead": True, "ompThreads": 7, "label": "probeLabel", "steps": 11}
	seen = probe.writeSelf(BASE)
	assert {name: getattr(probe, name) for name in seen} == seen and probe.label == "writtenInCpp" and probe.ids[0] > BASE


def test_savedAndLoaded(contact, tmp_path):
	"""Saved and restored as one of YADE's own engines, and it goes on."""
	contact.save(str(tmp_path / "scene.yade.bz2"))
	contact.engines[3].steps = -5
	contact.reset()
	contact.load(str(tmp_path / "scene.yade.bz2"))
	probe = contact.engines[3]
	assert isinstance(probe, yade.LayoutProbe) and (probe.steps, probe.ids, probe.label) == (1, [0, 1], "layoutProbe")
	contact.step()
	assert probe.steps == 2


def test_knownToYadeAsItsOwn():
	"""YADE's own table of classes holds the plugin's, as it does for an installed one."""
	assert "LayoutProbe" in yade.system.childClasses("Engine") and yade.LayoutProbe.__mro__[1] is yade.PartialEngine


@pytest.mark.parametrize("call, message", [(lambda probe: probe.readBody(99), "no such body"), (lambda probe: probe.readInteraction(0, 99), "no such interaction")])
def test_badInput(contact, call, message):
	with pytest.raises(ValueError, match=message):
		call(yade.LayoutProbe())
