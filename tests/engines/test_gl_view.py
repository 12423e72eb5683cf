# SPDX-License-Identifier: GPL-2.0-or-later
"""The 3D view draws our shapes, also when it was opened before the plugin was loaded.

Without a screen: YADE's own renderer runs over a library that starts GLUT without a display and keeps the corners that are drawn.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest
import yade
from yade import GlShapeDispatcher

HERE = pathlib.Path(__file__).resolve().parent
LAUNCHER = HERE.parents[1] / "scripts" / "setup.d" / "launch.py"

#: Run beside YADE, where no plugin of ours is loaded yet. Prints the corners of the bodies that are no spheres, drawn solid and as wire.
SCRIPT = """
import ctypes, json, os, sys, types
import yade
from yade import Body, FrictMat, O, Quaternion, utils

renderer = yade.OpenGLRenderer(intrGeom=True, intrPhys=True)
if VIEW_FIRST:
	sys.modules["yade.qt._GLViewer"] = types.SimpleNamespace(Renderer=lambda: renderer)
	renderer.render()  # YADE's import of yade.qt makes the tables of functors, as this does
	assert not hasattr(yade, "Platen")
import hexmembrane
from hexmembrane.scene.platens import platen

O.materials.append(yade.LinearMat(density=2600, friction=0.4, kn=1e4, ks=1e4, label="grain"))
O.bodies.append(utils.sphere((0, 0, 0.0029), 0.003, material="grain"))
O.bodies.append(utils.sphere((0.0058, 0, 0.0029), 0.003, material="grain"))
O.bodies.append([platen((0, 0, 0), 0.02, 0.005, +1), platen((0, 0, 0.03), 0.02, 0.005, -1)])
wall = Body()
wall.shape = yade.CylinderWall(radius=0.022, height=0.04)
wall.state.pos, wall.state.ori, wall.dynamic, wall.material = (0, 0, 0.015), Quaternion((1, 0, 0), 0.5), False, O.materials[0]
O.bodies.append(wall)
membrane = yade.HexMembrane(specimenRadius=0.02, specimenHeight=0.03, particleRadius=0.002)
membrane.generate()
O.engines = [
	yade.ForceResetter(),
	yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb(), yade.Bo1_CylinderWall_Aabb()]),
	yade.InteractionLoop(
		[yade.Ig2_Sphere_Sphere_ScGeom(), yade.Ig2_Platen_Sphere_ScGeom(), yade.Ig2_CylinderWall_Sphere_ScGeom()],
		[yade.Ip2_LinearMat_LinearMat_LinearPhys()],
		[yade.Law2_ScGeom_LinearPhys_Linear()],
	),
	yade.NewtonIntegrator(),
]
O.dt = 1e-7
O.run(2, True)
assert any(i.isReal and isinstance(i.phys, yade.LinearPhys) for i in O.interactions)

recorder = ctypes.CDLL(os.environ["LD_PRELOAD"])
recorder.recordedCorner.restype = ctypes.c_double
seen = []
for wire in (False, True):
	first = recorder.recordedCorners()
	renderer.wire = wire
	renderer.render()
	corners = {}
	for i in range(first, recorder.recordedCorners()):
		body = O.bodies[int(recorder.recordedCorner(i, 0))]
		corners.setdefault(type(body.shape).__name__ + str(body.id), []).append([recorder.recordedCorner(i, k) for k in (1, 2, 3)])
	seen.append({name: found for name, found in corners.items() if not name.startswith("Sphere")})
print("drawn " + json.dumps(seen))
"""


def test_everyShapeHasItsFunctor(O):
	functors = [getattr(yade, name)() for name in dir(yade) if name.startswith("Gl1_") and issubclass(getattr(yade, name), yade.GlShapeFunctor)]
	table = GlShapeDispatcher(functors)
	assert isinstance(table.dispFunctor(yade.Platen()), yade.Gl1_Platen)
	assert isinstance(table.dispFunctor(yade.CylinderWall()), yade.Gl1_CylinderWall)


@pytest.fixture(scope="module")
def recorder(tmp_path_factory):
	library = tmp_path_factory.mktemp("gl") / "glRecorder.so"
	compiler = shutil.which("g++")
	assert compiler, "g++ was not found: run the tests with scripts/test"
	subprocess.run([compiler, "-std=c++17", "-O1", "-shared", "-fPIC", "-o", str(library), str(HERE / "glRecorder.cpp")], check=True)
	return library


def drawn(recorder, folder, viewFirst):
	"""Drawn solid and as wire: the corners, in each body's own axes, by the name of the shape and the body's number."""
	script = folder / "draw.py"
	script.write_text(SCRIPT.replace("VIEW_FIRST", str(viewFirst)))
	environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
	environment["LD_PRELOAD"] = str(recorder)
	ran = subprocess.run([sys.executable, str(LAUNCHER), "1", str(script)], env=environment, capture_output=True, text=True, timeout=300)
	assert ran.returncode == 0, ran.stdout + ran.stderr
	(line,) = [line for line in ran.stdout.splitlines() if line.startswith("drawn ")]
	return json.loads(line[len("drawn ") :])


@pytest.mark.parametrize("viewFirst", [False, True])
def test_viewDrawsPlatensAndWall(recorder, tmp_path, viewFirst):
	"""viewFirst: as in YADE started with a display, the tables of functors are older than the plugin; else as with an installed plugin."""
	for corners in drawn(recorder, tmp_path, viewFirst):
		assert sorted(corners) == ["CylinderWall4", "Platen2", "Platen3"]
		for name in ("Platen2", "Platen3"):
			assert max(z for _, _, z in corners[name]) == pytest.approx(0.0025) and min(z for _, _, z in corners[name]) == pytest.approx(-0.0025)
			assert max((x * x + y * y) ** 0.5 for x, y, _ in corners[name]) == pytest.approx(0.02)
		# The wall is upright though its body is turned by 0.5 about x: turned back, all corners lie on the cylinder.
		upright = [yade.Quaternion((1, 0, 0), 0.5) * yade.Vector3(*corner) for corner in corners["CylinderWall4"]]
		assert all((p[0] ** 2 + p[1] ** 2) ** 0.5 == pytest.approx(0.022) for p in upright)
		assert max(p[2] for p in upright) == pytest.approx(0.02) and min(p[2] for p in upright) == pytest.approx(-0.02)
