# SPDX-License-Identifier: GPL-2.0-or-later
"""The test of 200 grains in the rigid wall instead of the membrane: one keyword, the same packing, records and ways to go on."""

import math

import numpy
import pytest
from hexmembrane.output import records, vtk
from hexmembrane.scene import geometry
from hexmembrane.scene.packing_file import Packing, save
from tinyTest import configure, runOutside


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
	"""A test that ran through in one go on one thread: (folder, what it printed)."""
	folder = tmp_path_factory.mktemp("wall")
	said = runOutside(configure(folder, boundary="wall"), "--out", folder / "out")
	assert said.returncode == 0, said.stdout + said.stderr
	return folder / "out", said.stdout + said.stderr


def test_records(whole):
	table = records.read(whole[0] / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	assert abs(table["axial_strain"][shear] - numpy.linspace(0, 0.02, 13)).max() < 1e-4
	assert (table["sigma3_target"][shear] == 1e5).all() and (table["sigma3_applied"] == table["sigma3_target"]).all()
	assert table["q"][shear][-1] > 3e4 and abs(table["q"][shear][0]) < 1e4
	# The servo holds the mean radial stress while the wall has to follow a fast test.
	assert abs(table["sigma3_transmitted_all"][shear] / 1e5 - 1).max() < 0.01
	for name in ("group2", "group3"):
		assert (table[f"sigma3_transmitted_{name}"] == table["sigma3_transmitted_all"]).all()
	r, h = table["mean_radius"], table["height"]
	assert table["volume"] == pytest.approx(math.pi * r**2 * h, rel=1e-12)
	assert table["membrane_area"] == pytest.approx(2 * math.pi * r * h, rel=1e-12)
	assert (table["bonds_broken"] == 0).all() and (table["energy_membrane"] == 0).all()
	assert all((table[name] == 0).all() for name in ("pressure_axial", "membrane_axial_mid", "membrane_axial_end", "sigma3_membrane"))
	# The definition of q_cell: mean platen force over the wall's section, less the target.
	mean = (table["platen_force_bottom"] + table["platen_force_top"]) / 2
	assert table["q_cell"] == pytest.approx(mean / (math.pi * r**2) - table["sigma3_applied"], rel=1e-9, abs=1e-3)
	# The soil's own stress: by its definitions, and the same from the boundary and the grains' inertia.
	assert table["q"] == pytest.approx(table["soil_axial"] - table["soil_radial"], rel=1e-12, abs=1e-6)
	assert table["p"] == pytest.approx((table["soil_axial"] + 2 * table["soil_radial"]) / 3, rel=1e-12)
	for name in ("axial", "radial"):
		assert (table[f"boundary_{name}"] + table[f"inertia_{name}"])[shear] == pytest.approx(table[f"soil_{name}"][shear], rel=1e-5)
		assert abs(table[f"inertia_{name}"][shear]).max() < 0.05 * table["soil_axial"][shear].min()  # 2 % in a test as fast as this one
	assert table["soil_axial"][shear] == pytest.approx((mean / (math.pi * r**2))[shear], rel=0.05)


def test_energyBalance(whole):
	"""What platens and wall put in is stored or dissipated, all through shear to 1e-4 of the larger of work and stored energy.

	Left is half a step between positions and the velocity that the local damping is booked with, of first order in the step. It shows at the
	first touch of platen and grains, which lie free of stress; at the end of consolidation it is below 1e-4 as well.
	"""
	table = records.read(whole[0] / "records.csv")
	assert abs(table["energy_error"][-14:]).max() < 1e-4
	for name in ("elastic", "kinetic"):
		assert (table[f"energy_{name}"] > 0).all(), name
	assert table["work_boundary"][-1] > 0.1


def test_stiffGrainsShearedFast(tmp_path, runHere):
	"""The wall follows where a hundredth of the target a step is too slow: grains of kn/(p d) = 3000 at an inertial number near 1e-3."""
	path = configure(tmp_path, boundary="wall", specimen={"emod": 4e8}, shear={"strain": 0.03, "velocity": 0.1}, output={"vtkEvery": 0})
	code, _, errors = runHere(path, "--out", tmp_path / "out")
	assert code == 0, errors
	table = records.read(tmp_path / "out" / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	assert abs(table["sigma3_distance"][shear]).max() < 0.05 and (table["loops_saturated"][shear] == 0).all()
	assert table["q"][shear].max() < 1e6


def test_samePackingAsWithAMembrane(whole, tmp_path, runHere):
	code, _, errors = runHere(configure(tmp_path), "--out", tmp_path / "out", "--until", "specimen")
	assert code == 0, errors
	assert (tmp_path / "out" / "packing.txt").read_bytes() == (whole[0] / "packing.txt").read_bytes()


def test_frames(whole):
	frames = sorted((whole[0] / "vtk").glob("wall-*.vtp"))
	assert len(frames) == 3 and (whole[0] / "vtk" / "wall.pvd").is_file()
	radius = records.read(whole[0] / "records.csv")["mean_radius"]
	x, triangles, data, _ = vtk.read(frames[-1])
	assert numpy.hypot(x[:, 0], x[:, 1]) == pytest.approx(numpy.full(len(x), radius[-1]), rel=1e-12)
	assert set(triangles.ravel()) == set(range(len(x))) and set(data["pressure"]) == {1e5}
	# Outward by what the radius has grown since the last row of consolidation, and triangles that look outward.
	assert data["normal_displacement"] == pytest.approx(numpy.full(len(x), radius[-1] - radius[-14]), rel=1e-9)
	assert (geometry.normals(x, triangles)[:, :2] * x[:, :2]).sum(axis=1).min() > 0


def test_shearFromConsolidatedState(whole, tmp_path, runHere):
	"""The saved state has all of the wall and its servo: sheared again it gives the same curve, to rounding on any number of threads."""
	path = configure(tmp_path, boundary="wall", shear={"strain": 0.005}, output={"records": 3})
	code, _, errors = runHere(path, "--out", tmp_path / "out", "--from", whole[0] / "consolidated.yade.gz")
	assert code == 0, errors
	table, reference = records.read(tmp_path / "out" / "records.csv"), records.read(whole[0] / "records.csv")
	row = reference["stage"].index("shear") + 3
	for name in ("q", "mean_radius", "sigma3_transmitted_all", "energy_elastic", "work_boundary"):
		assert table[name][-1] == pytest.approx(reference[name][row], rel=1e-6), name


def test_bothPlatensMove(whole, tmp_path, runHere, O):
	"""``moving: both`` shares the way between them; the strain is the same."""
	from hexmembrane.scene.handles import Scene

	path = configure(tmp_path, boundary="wall", shear={"strain": 0.005, "moving": "both"}, output={"records": 2, "vtkEvery": 0})
	code, _, errors = runHere(path, "--out", tmp_path / "out", "--from", whole[0] / "consolidated.yade.gz")
	assert code == 0, errors
	handles = Scene()
	ways = [abs(O.bodies[drive.platen].state.pos[2] - O.bodies[drive.platen].state.refPos[2]) for drive in (handles.bottomDrive, handles.topDrive)]
	table = records.read(tmp_path / "out" / "records.csv")
	assert table["axial_strain"][-1] == pytest.approx(0.005, rel=1e-2) and ways[0] > 0
	assert ways[0] == pytest.approx(ways[1], rel=0.05)


def test_stateOfAnotherBoundary(whole, tmp_path, runHere):
	code, _, errors = runHere(configure(tmp_path), "--out", tmp_path / "out", "--from", whole[0] / "consolidated.yade.gz")
	assert code == 2 and "boundary = 'membrane': the state has a wall; fix: give boundary: wall" in errors


def test_contactsAndEscape(whole, O):
	"""The grains' contacts are PFC's by modulus, those with the wall are smooth, and a grain beyond the wall is named."""
	from hexmembrane.measure import rows
	from hexmembrane.run import states
	from hexmembrane.scene.handles import Scene

	states.load(whole[0] / "sheared.yade.gz")
	O.step()
	handles = Scene()
	handles.exportContacts()
	grains, wall = set(handles.grainIds()), handles.lateralBoundary.servo.wall
	seen = set()
	for contact in O.interactions:
		ids = contact.id1, contact.id2
		r = [O.bodies[i].shape.radius for i in ids if i in grains]
		kn = math.pi * 2e7 * (min(r) ** 2 / sum(r) if len(r) == 2 else r[0])
		assert contact.phys.kn == pytest.approx(kn, rel=1e-12) and contact.phys.ks == pytest.approx(kn / 3, rel=1e-12)
		kind = "wall" if wall in ids else "grains" if len(r) == 2 else "platens"
		seen.add((kind, round(contact.phys.tangensOfFrictionAngle, 12)))
	assert seen == {("wall", 0.0), ("grains", 0.5), ("platens", 0.3)}
	members = rows.Grains.of(handles.grainIds())
	assert rows.escaped(handles, members) is None
	O.bodies[members.ids[7]].state.pos = (0, 0.0205, 0.025)
	assert rows.escaped(handles, members) == members.ids[7]


def loose(folder):
	"""A packing file with thirty grains that fill nothing."""
	angle = 2.4 * numpy.arange(30)
	centres = numpy.column_stack([0.012 * numpy.cos(angle), 0.012 * numpy.sin(angle), numpy.linspace(0.005, 0.045, 30)])
	save(Packing(centres, numpy.full(30, 0.002), 0.02, 0.05), folder / "loose.txt")
	return {"gradation": None, "grains": None, "packing": "loose.txt"}


@pytest.mark.parametrize("boundary, limit", [("wall", 2e-3), ("membrane", 5e-6)])
def test_targetOutOfReach(tmp_path, runHere, boundary, limit):
	"""A servo that does not get there, for want of a specimen or of time, stops the test with the reason and a state to resume from."""
	specimen = loose(tmp_path) if boundary == "wall" else {}
	path = configure(tmp_path, boundary=boundary, specimen=specimen, consolidation={"rampTime": 0.001, "timeLimit": limit})
	for arguments, first in (([], "generated"), (["--resume"], "resumed in consolidation")):
		code, said, errors = runHere(path, "--out", tmp_path / "out", *arguments)
		assert code == 1 and "YADE stopped before step" in errors and errors.count("fix: ") == 2
		assert f"SoilStressServo.timeLimit = {limit:g}: the soil's axial stress is " in errors
		assert first in said or first == "generated"
		assert (tmp_path / "out" / "manifest.json").is_file()
