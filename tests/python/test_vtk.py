# SPDX-License-Identifier: GPL-2.0-or-later
"""VTK files are read back by VTK's own reader (ParaView's) and compared exactly."""

import xml.etree.ElementTree

import numpy
import pytest
from hexmembrane.output import vtk

POINTS = numpy.random.default_rng(3).normal(size=(7, 3))
TRIANGLES = numpy.array([(0, 1, 2), (2, 3, 4), (4, 5, 6), (6, 0, 3)])


def test_grainsReadBack(tmp_path):
	arrays = {"id": numpy.arange(7), "radius": POINTS[:, 0] ** 2, "velocity": 2 * POINTS, "coordination": numpy.arange(7, dtype=numpy.int32)}
	vtk.write(tmp_path / "g.vtp", POINTS, pointData=arrays)
	points, cells, found, _ = vtk.read(tmp_path / "g.vtp")
	assert (points == POINTS).all() and (cells[:, 0] == numpy.arange(7)).all()
	assert set(found) == set(arrays) and all((found[name] == arrays[name]).all() for name in arrays)
	assert found["velocity"].shape == (7, 3)


def test_surfaceReadsBack(tmp_path):
	vtk.write(tmp_path / "m.vtp", POINTS, TRIANGLES, {"group": numpy.arange(7)}, {"side": numpy.arange(4) / 3})
	points, cells, pointData, cellData = vtk.read(tmp_path / "m.vtp")
	assert (points == POINTS).all() and (cells == TRIANGLES).all()
	assert (pointData["group"] == numpy.arange(7)).all() and (cellData["side"] == numpy.arange(4) / 3).all()


def test_linesReadBack(tmp_path):
	lines = numpy.array([(0, 1), (2, 3), (4, 5)])
	vtk.write(tmp_path / "c.vtp", POINTS.astype(numpy.float32), lines, {"normal_force": numpy.arange(7.0)}, {"kind": numpy.arange(3, dtype=numpy.uint8)})
	points, cells, pointData, cellData = vtk.read(tmp_path / "c.vtp")
	assert points.dtype == numpy.float32 and abs(points - POINTS).max() < 1e-6 and (cells == lines).all()
	assert (pointData["normal_force"] == numpy.arange(7)).all() and (cellData["kind"] == numpy.arange(3)).all()


def test_wrongLength(tmp_path):
	with pytest.raises(ValueError, match=r"points\['radius'\] = 3 values: there are 7"):
		vtk.write(tmp_path / "g.vtp", POINTS, pointData={"radius": [1.0, 2.0, 3.0]})
	with pytest.raises(ValueError, match=r"cells\['side'\] = 3 values: there are 4"):
		vtk.write(tmp_path / "g.vtp", POINTS, TRIANGLES, cellData={"side": [1, 2, 3]})
	assert not list(tmp_path.iterdir())


def test_badPlaces(tmp_path):
	"""VTK gives no reason, the system does."""
	path = tmp_path / "nowhere" / "g.vtp"
	with pytest.raises(FileNotFoundError) as caught:
		vtk.write(path, POINTS)
	assert caught.value.filename == str(path)
	(tmp_path / "g.vtp.part").mkdir()
	with pytest.raises(IsADirectoryError):
		vtk.write(tmp_path / "g.vtp", POINTS)
	with pytest.raises(FileNotFoundError, match="no such file"):
		vtk.read(tmp_path / "nowhere.vtp")


def test_series(tmp_path):
	vtk.series(tmp_path / "g.pvd", [(0.0, "g-0.vtp"), (0.1, "g-1.vtp")])
	root = xml.etree.ElementTree.parse(tmp_path / "g.pvd").getroot()
	found = [(float(d.get("timestep")), d.get("file")) for d in root.iter("DataSet")]
	assert root.get("type") == "Collection" and found == [(0.0, "g-0.vtp"), (0.1, "g-1.vtp")]
