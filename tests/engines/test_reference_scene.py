# SPDX-License-Identifier: GPL-2.0-or-later
"""A scene of the reference tier in which an engine would act wrongly without a word is refused; and contacts for YADE's tools in the compact one."""

import pytest
import yade
from contactScene import floor, pair, springs
from membraneScene import makeMembrane
from tiers import engines
from yade import MembraneBonds, PlatenDrive


def contactEngines(bound=True, geometry=True, mask=2):
	"""Collider and interaction loop, with or without the platen's functors."""
	shapes = [yade.Bo1_Sphere_Aabb(), *([yade.Bo1_Platen_Aabb()] if bound else [])]
	pairs = [yade.Ig2_Sphere_Sphere_LinearScGeom(), *([yade.Ig2_Platen_Sphere_ScGeom()] if geometry else [])]
	law = [yade.Ip2_LinearMat_LinearMat_LinearPhys()], [yade.Law2_ScGeom_LinearPhys_Linear()]
	return [yade.InsertionSortCollider(shapes, avoidSelfInteractionMask=mask), yade.InteractionLoop(pairs, *law)]


def stepped(O, engine, **contacts):
	"""A step with the engine first, so that it looks at the scene before the others act."""
	O.engines = [yade.ForceResetter(), engine, *contactEngines(**contacts), yade.NewtonIntegrator()]
	O.dt = 1e-7
	O.step()


@pytest.mark.parametrize("missing, says", [("bound", "no bound functor for a Platen"), ("geometry", "no geometry functor for a Platen")])
def test_aPlatenNeedsItsFunctors(O, missing, says):
	springs()
	drive = PlatenDrive(platen=floor(), direction=(0, 0, 1), velocity=0)
	with pytest.raises(RuntimeError, match="PlatenDrive: .*" + says + ".*; fix: add"):
		stepped(O, drive, **{missing: False})
	stepped(O, drive)


@pytest.mark.parametrize("missing, says", [("bound", "no bound functor for a CylinderWall"), ("geometry", "no geometry functor for a CylinderWall")])
def test_aWallNeedsItsFunctors(O, missing, says):
	springs()
	wall = yade.Body()
	wall.shape, wall.material, wall.dynamic = yade.CylinderWall(radius=0.02, height=0.04), O.materials[0], False
	servo = yade.RadialWallServo(wall=O.bodies.append(wall), stress=1e5, height=0.04, maxVelocity=1e-3)
	whole = contactEngines()
	whole[0].boundDispatcher.functors += [yade.Bo1_CylinderWall_Aabb()] if missing == "geometry" else []
	whole[1].geomDispatcher.functors += [yade.Ig2_CylinderWall_Sphere_ScGeom()] if missing == "bound" else []
	O.engines = [yade.ForceResetter(), servo, *whole, yade.NewtonIntegrator()]
	O.dt = 1e-7
	with pytest.raises(RuntimeError, match="RadialWallServo: .*" + says + ".*; fix: add"):
		O.step()


def test_whoReadsContactsThatAreNotThereIsTold(O, capfd, tmp_path):
	springs()
	pair(1e-3, 1e-3, 1e-6)
	O.engines = [*engines("compact"), yade.VTKRecorder(fileName=str(tmp_path / "frame"), recorders=["spheres"], iterPeriod=1000)]
	O.engines[1].exportPeriod = 1
	O.dt = 1e-9
	O.step()
	assert "VTKRecorder" not in capfd.readouterr().err
	O.engines[1].exportPeriod = 0
	O.step()
	O.step()
	assert capfd.readouterr().err.count("contacts are not in O.interactions, which VTKRecorder reads; fix: CompactLoop.exportPeriod = 1") == 1


def test_aMembraneNeedsTheCollidersMask(O):
	bonds = MembraneBonds(membrane=makeMembrane(mask=3), kn=1e4)
	with pytest.raises(RuntimeError, match="MembraneBonds: .*collide with each other; fix: Collider.avoidSelfInteractionMask"):
		stepped(O, bonds, mask=0)
	stepped(O, bonds, mask=2)


@pytest.mark.parametrize("period, there", [(0, (0, 0, 0, 0)), (2, (0, 1, 0, 1))])
def test_contactsAreExportedEverySoManyIterations(O, period, there):
	springs()
	pair(1e-3, 1e-3, 1e-6)
	O.engines = engines("compact")
	O.engines[1].exportPeriod = period
	O.dt = 1e-9
	for expected in there:
		O.step()
		assert O.interactions.countReal() == expected
	O.engines[1].exportPeriod = -1
	with pytest.raises(ValueError, match="CompactLoop.exportPeriod = -1.*; fix: "):
		O.step()
