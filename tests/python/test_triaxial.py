# SPDX-License-Identifier: GPL-2.0-or-later
"""A whole small test from its configuration, as a user runs it: killed half-way and resumed, and every way to ask wrongly."""

import math
import signal
import subprocess
import time

import numpy
import pytest
import yaml
from hexmembrane.measure import profile
from hexmembrane.output import records, vtk
from hexmembrane.run import states
from hexmembrane.scene.handles import Scene
from PIL import Image
from tinyTest import command, configure, environment, runOutside


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
	"""A test that ran through in one go: (folder, what it printed)."""
	folder = tmp_path_factory.mktemp("whole")
	said = runOutside(configure(folder), "--out", folder / "out")
	assert said.returncode == 0, said.stdout + said.stderr
	return folder / "out", said.stdout + said.stderr


def rowsWithoutClock(path):
	table = records.read(path)
	del table["elapsed"]
	return table


def test_records(whole):
	out, _ = whole
	table = records.read(out / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	strain = table["axial_strain"][shear]
	assert abs(strain - numpy.linspace(0, 0.02, 13)).max() < 1e-4
	assert (numpy.diff(table["step"]) >= 0).all() and (numpy.diff(table["elapsed"]) >= 0).all()
	assert (table["sigma3_target"][shear] == 1e5).all()
	assert abs(table["q"][shear][0]) < 1e4 and table["q"][shear][-1] > 3e4
	assert abs(table["sigma3_transmitted_group3"][shear] / 1e5 - 1).max() < 0.1
	assert (table["bonds_broken"] == 0).all()
	# Both volumetric strains agree, and both are small in a small test.
	difference = table["volumetric_strain_radius"][shear] - table["volumetric_strain_volume"][shear]
	assert abs(difference).max() < 2e-3 and abs(table["volumetric_strain_volume"][shear]).max() < 0.02
	# 1 - n is the solid volume over V.
	solid = (1 - table["porosity"]) * table["volume"]
	assert abs(solid / solid[0] - 1).max() < 1e-12


def test_whatTheMembraneCarries(whole):
	table = records.read(whole[0] / "records.csv")
	inside = table["sigma3_applied"] + table["sigma3_membrane"]
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	# A stiff membrane round a specimen that has become thinner: it carries some of the pressure, and the rest is what arrives.
	assert (table["sigma3_membrane"][shear] < -500).all()
	assert abs(table["sigma3_transmitted_group3"] / inside - 1)[shear].max() < 0.02
	assert abs(table["membrane_axial_mid"][shear]).min() > 0 and abs(table["membrane_axial_end"][shear]).min() > 0


def test_stressAlongTheHeight(whole, O):
	out, _ = whole
	last = {name: column[-1] for name, column in records.read(out / "records.csv").items()}
	states.load(out / "sheared.yade.gz")
	O.step()
	handles = Scene()
	found, one = (profile.measure(handles, count) for count in (6, 1))
	assert found.edges[0] == 0 and found.edges[-1] == pytest.approx(found.height) and len(found.middle) == 6
	for name in ("axial", "radial"):
		assert (getattr(found, name) * found.volume).sum() == pytest.approx(float(getattr(one, name)[0] * one.volume[0]), rel=1e-9)
	# At mid-height the soil carries what the balance of forces on half the specimen says, but for contacts of the membrane across the cut.
	force = (last["platen_force_bottom"] + last["platen_force_top"]) / 2 + last["pressure_axial"] + last["membrane_axial_mid"] - last["membrane_axial_end"]
	assert found.axial[2:4].mean() == pytest.approx(force * last["height"] / last["volume"], rel=0.1)
	assert (found.axial * found.volume).sum() / found.volume.sum() == pytest.approx(last["soil_axial"], rel=0.05)
	for name in ("axial", "radial"):
		assert last[f"boundary_{name}"] + last[f"inertia_{name}"] == pytest.approx(last[f"soil_{name}"], rel=1e-5)
	assert abs(last["inertia_axial"]) < 0.05 * last["soil_axial"]  # 2.5 % in a test as fast as this one
	main = numpy.array(handles.lateralBoundary.membrane.groups)[:: handles.lateralBoundary.membrane.perRing] == 3
	assert found.rowPressure[main].mean() == pytest.approx(last["sigma3_transmitted_group3"], rel=0.02)
	assert found.radial[1:5].mean() == pytest.approx(last["sigma3_transmitted_group3"], rel=0.15)
	with pytest.raises(ValueError, match="SoilMeasure.profile: slabs = 0"):
		profile.measure(handles, 0)


def test_forcesThroughMidHeight(whole, O):
	"""F + P + T_mid - T_end, as recorded, is the sum of the contact forces through the cut: that of the specimen at rest after consolidation."""
	states.load(whole[0] / "consolidated.yade.gz")
	for drive in Scene().bottomDrive, Scene().topDrive:
		drive.velocity = 0
	O.run(3000, True)
	handles = Scene()
	handles.exportContacts()
	bottom, top = handles.faces()
	middle, platens = (bottom + top) / 2, {handles.bottomDrive.platen, handles.topDrive.platen}
	cut = 0
	for contact in O.interactions:
		z = [O.bodies[i].state.pos[2] for i in (contact.id1, contact.id2)]
		if not platens & {contact.id1, contact.id2} and (z[0] < middle) != (z[1] < middle):
			force = (contact.phys.normalForce + contact.phys.shearForce)[2]  # on the second
			cut += force if z[0] < middle else -force
	loads = handles.lateralBoundary.ownLoads(bottom, top)
	force = (handles.bottomDrive.force + handles.topDrive.force) / 2
	assert cut == pytest.approx(force + loads.axialPush + loads.axialPullMiddle - loads.axialPullEnd, rel=1e-2)


def test_energyBalance(whole):
	"""What platens, pressure and O-rings put in is stored or dissipated: through shear to 1e-4 of the larger of work and stored energy.

	Left is half a step between positions and the velocity that local damping is booked with, of first order in the step. It shows most where
	the membrane meets the grains: there damping takes half of the work; of all consolidation it is below 5e-3.
	"""
	table = records.read(whole[0] / "records.csv")
	first = table["stage"].index("shear")
	assert abs(table["energy_error"][first:]).max() < 1e-4 and abs(table["energy_error"][first - 1]) < 5e-3
	for name in ("elastic", "membrane", "kinetic"):
		assert (table[f"energy_{name}"] > 0).all(), name
	assert table["work_boundary"][-1] > 0.1 and table["energy_friction"][-1] > 0.01


def test_output(whole):
	out, said = whole
	assert {"config.yaml", "records.csv", "test.png", "consolidated.yade.gz", "sheared.yade.gz", "vtk"} <= {p.name for p in out.iterdir()}
	assert not list(out.rglob("*.part")) and not list(out.glob("part-*"))
	made = yaml.safe_load((out / "config.yaml").read_text())["made"]
	assert made["threads"] == 1 and made["yade"] and made["hexmembrane"]
	assert min(Image.open(out / "test.png").size) > 800
	for word in ("inertial number", "time step", "kn/(p d)", "consolidated after", "sheared to", "left"):
		assert word in said, word
	assert "\r" not in said


def test_vtkFrames(whole):
	out, _ = whole
	frames = sorted((out / "vtk").glob("grains-*.vtp"))
	assert len(frames) == 3
	points, _, data, _ = vtk.read(frames[-1])
	assert len(points) == 200 and data["radius"].min() > 0 and data["coordination"].max() > 3
	assert abs(data["displacement"]).max() > 1e-4
	x, triangles, data, cells = vtk.read(out / "vtk" / "membrane-0002.vtp")
	assert set(data["group"]) == {1, 2, 3} and set(cells["group"]) == {1, 2, 3} and triangles.max() == len(x) - 1
	# what is on the membrane, not what was asked for: the loops bring the transmitted pressure to that
	applied = records.read(out / "records.csv")["sigma3_applied"][-1]
	assert set(data["pressure"][data["group"] == 3]) == {applied} and set(data["pressure"][data["group"] == 1]) == {0.0}
	ends, lines, data, cells = vtk.read(out / "vtk" / "contacts-0002.vtp")
	assert len(ends) == 2 * len(lines) > 800 and set(cells["kind"]) == {0, 1, 2, 3} and data["normal_force"].min() >= 0 and cells["shear_force"].max() > 0
	assert (out / "vtk" / "contacts.pvd").read_text().count("contacts-") == 3
	# No grain is outside the membrane.
	assert numpy.hypot(*points[:, :2].T).max() < numpy.hypot(*x[:, :2].T).max()


def test_killedAndResumed(whole, tmp_path):
	"""Killed in shear past a checkpoint and resumed, a test on one thread has the very rows of one that was never stopped."""
	out = tmp_path / "out"
	with subprocess.Popen(command(configure(tmp_path), "--out", out), env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as test:
		deadline = time.monotonic() + 120
		while time.monotonic() < deadline and test.poll() is None:
			if (out / "records.csv").is_file() and (out / "records.csv").read_text().count("shear,") >= 7:
				break
			time.sleep(0.02)
		assert test.poll() is None, "it ended before it was killed"
		test.send_signal(signal.SIGKILL)
	before = records.read(out / "records.csv")["stage"].count("shear")
	assert 6 <= before < 13
	said = runOutside(tmp_path / "tiny.yaml", "--out", out, "--resume")
	assert said.returncode == 0, said.stdout + said.stderr
	assert "resumed in shear after 4 rows" in said.stdout or "resumed in shear after 8 rows" in said.stdout
	expected, found = rowsWithoutClock(whole[0] / "records.csv"), rowsWithoutClock(out / "records.csv")
	for name, values in expected.items():
		assert list(found[name]) == list(values), name
	assert (out / "vtk" / "grains.pvd").read_text() == (whole[0] / "vtk" / "grains.pvd").read_text()


def test_shearFromConsolidatedState(whole, tmp_path, runHere):
	"""A consolidated state is a file that can be sheared again, elsewhere, to the same curve (to rounding, on any number of threads)."""
	path = configure(tmp_path, shear={"strain": 0.005}, output={"records": 3})
	code, _, errors = runHere(path, "--out", tmp_path / "out", "--from", whole[0] / "consolidated.yade.gz")
	assert code == 0, errors
	table, reference = records.read(tmp_path / "out" / "records.csv"), records.read(whole[0] / "records.csv")
	assert set(table["stage"]) == {"shear"} and len(table["step"]) == 4
	start = reference["stage"].index("shear")
	for name in ("q", "volume", "porosity"):
		assert table[name][-1] == pytest.approx(reference[name][start + 3], rel=1e-6, abs=1.0 if name == "q" else 0), name


def test_stateOfAnotherPressure(whole, tmp_path, runHere):
	path = configure(tmp_path, consolidation={"pressure": 5e4})
	code, _, errors = runHere(path, "--out", tmp_path / "out", "--from", whole[0] / "consolidated.yade.gz")
	assert code == 2 and "consolidation.pressure = 50000.0: the state was consolidated at 100000.0 Pa; fix: " in errors


def test_packingIsAFile(whole, tmp_path, runHere):
	"""The specimen made by one test is the input of another, which must be of the same size."""
	packing = str(whole[0] / "packing.txt")
	path = configure(tmp_path, specimen={"gradation": None, "grains": None, "packing": packing})
	code, said, errors = runHere(path, "--out", tmp_path / "out", "--until", "boundary")
	assert code == 0, errors
	assert "200 grains from" in said and (tmp_path / "out" / "generated.yade.gz").is_file()
	path = configure(tmp_path, specimen={"gradation": None, "grains": None, "packing": packing, "height": 0.06})
	code, _, errors = runHere(path, "--out", tmp_path / "other")
	assert code == 2 and "has height 0.05 m, this specimen needs 0.06 m; fix: " in errors


def test_specimenAlone(whole, tmp_path, runHere):
	code, _, errors = runHere(configure(tmp_path), "--out", tmp_path / "out", "--until", "specimen")
	assert code == 0, errors
	assert (tmp_path / "out" / "packing.txt").read_bytes() == (whole[0] / "packing.txt").read_bytes()


def test_notAtRest(tmp_path, runHere):
	"""Consolidation that cannot get there stops with the reason and a checkpoint, and can be resumed with more steps.

	Without the tracking of energies their columns are nan, and the others are there.
	"""
	strict = {"unbalanced": 1e-12, "maxSteps": 400}
	quick = {"energy": False}
	code, _, errors = runHere(configure(tmp_path, consolidation=strict, output=quick), "--out", tmp_path / "out")
	assert code == 1
	assert "consolidation.maxSteps = 400: not at rest after 400 steps" in errors and "; fix: " in errors
	assert (tmp_path / "out" / "manifest.json").is_file()
	path = configure(tmp_path, consolidation={**strict, "maxSteps": 600}, output=quick)
	code, said, errors = runHere(path, "--out", tmp_path / "out", "--resume")
	assert code == 1 and "not at rest after 600 steps" in errors and "resumed in consolidation" in said
	table = records.read(tmp_path / "out" / "records.csv")
	energies = {name for name in table if name.startswith("energy_")} | {"work_boundary"}
	assert len(energies) == 7 and all(numpy.isnan(table[name]).all() for name in energies)
	assert all(numpy.isfinite(table[name]).all() for name in set(table) - energies - {"stage"})


BAD = [
	({}, ["nowhere.yaml"], 2, "cannot be read"),
	({"specimen": {"radius": -1}}, [], 2, "specimen.radius = -1: is out of range"),
	({"specimen": {"raduis": 1}}, [], 2, "did you mean 'radius'"),
	({"specimen": {"gradation": "gone.csv"}}, [], 2, "no such file"),
	({"specimen": {"gradation": "tiny.yaml"}}, [], 2, "is no gradation"),
	({"specimen": {"gradation": None, "grains": None, "packing": "sand.csv"}}, [], 2, "is no packing"),
	({"specimen": {"porosity": 0.36}}, [], 1, "CylinderPacking.porosity = 0.36"),
	({"membrane": {"sizeRatio": None}}, [], 2, "membrane.sizeRatio = None: has no value"),
	({"membrane": {"particleRadius": 0.03, "platenRows": 0}}, [], 1, "HexMembrane.particleRadius = "),
	({"membrane": {"oRingRows": 2, "platenRows": 7}}, [], 1, "HexMembrane.platenRows = "),
	({"numerics": {"dt": 1.0}}, [], 1, "numerics.dt = 1 s: is above the critical time step"),
	({}, ["--resume"], 2, "there is none"),
	({}, ["--from", "gone.yade.gz"], 2, "no such file"),
	({}, ["--resume", "--from", "gone.yade.gz"], 2, "leave out one"),
]


@pytest.mark.parametrize("changes, arguments, code, message", BAD, ids=[row[3] for row in BAD])
def test_badInput(tmp_path, runHere, changes, arguments, code, message):
	"""Exit code, the message with a fix and no traceback; no records are begun."""
	path = configure(tmp_path, **changes)
	if arguments[:1] == ["nowhere.yaml"]:
		path, arguments = tmp_path / "nowhere.yaml", []
	found, _, errors = runHere(path, "--out", tmp_path / "out", *arguments)
	assert found == code, errors
	assert message in errors and "fix: " in errors and "Traceback" not in errors
	assert not (tmp_path / "out" / "records.csv").exists()


def test_damagedState(tmp_path, runHere):
	(tmp_path / "bad.yade.gz").write_bytes(b"no state of YADE")
	code, _, errors = runHere(configure(tmp_path), "--out", tmp_path / "out", "--from", tmp_path / "bad.yade.gz")
	assert code == 2 and "bad.yade.gz': is damaged" in errors and "fix: " in errors


def test_folderInUse(whole, runHere):
	"""A test is never written over; another configuration is never resumed into it."""
	out = whole[0]
	before = (out / "records.csv").read_bytes()
	code, _, errors = runHere(out.parent / "tiny.yaml", "--out", out)
	assert code == 2 and "holds a test already" in errors
	given = yaml.safe_load((out.parent / "tiny.yaml").read_text())
	given["shear"]["velocity"] = 0.5
	(out.parent / "other.yaml").write_text(yaml.safe_dump(given))
	code, _, errors = runHere(out.parent / "other.yaml", "--out", out, "--resume")
	assert code == 2 and "other values of shear.velocity" in errors
	assert (out / "records.csv").read_bytes() == before


def test_finishedTestIsLeftAsItIs(whole, runHere):
	"""Resuming a test that has ended adds nothing."""
	out = whole[0]
	before = rowsWithoutClock(out / "records.csv")
	code, _, errors = runHere(out.parent / "tiny.yaml", "--out", out, "--resume", "--quiet")
	assert (code, errors) == (0, "")
	after = rowsWithoutClock(out / "records.csv")
	assert all(list(before[name]) == list(after[name]) for name in before)


def test_grainOutsideIsSeen(whole, O):
	"""A grain put outside the membrane, or behind a platen, is named."""
	from hexmembrane.measure import rows

	states.load(whole[0] / "sheared.yade.gz")
	handles = Scene()
	grains = rows.Grains.of(handles.grainIds())
	assert rows.escaped(handles, grains) is None
	lost = grains.ids[7]
	for place in ((0.03, 0, 0.025), (0, 0, 0.06), (0, 0, -0.01)):
		O.bodies[lost].state.pos = place
		assert rows.escaped(handles, grains) == lost


def test_frictionAfterConsolidation(whole, O):
	"""Contacts made with the consolidation's friction have the test's own in shear, those of the membrane have none; all are PFC's by modulus."""
	from yade import Sphere

	states.load(whole[0] / "consolidated.yade.gz")
	O.step()
	handles = Scene()
	handles.exportContacts()
	grains, membrane = set(handles.grainIds()), set(handles.lateralBoundary.membrane.ids)
	found = {"grains": set(), "membrane": set(), "platens": set()}
	for contact in O.interactions:
		ids = {contact.id1, contact.id2}
		kind = "grains" if ids <= grains else "membrane" if ids & membrane else "platens"
		found[kind].add(round(contact.phys.tangensOfFrictionAngle, 12))
		r = [O.bodies[i].shape.radius for i in ids if isinstance(O.bodies[i].shape, Sphere)]
		kn = math.pi * 2e7 * (min(r) ** 2 / sum(r) if len(r) == 2 else r[0])
		assert contact.phys.kn == pytest.approx(kn, rel=1e-12) and contact.phys.ks == pytest.approx(kn / 3, rel=1e-12)
	assert found == {"grains": {0.5}, "membrane": {0.0}, "platens": {0.3}}
	handles.setFriction(0.1, 0.1)
	assert {round(c.phys.tangensOfFrictionAngle, 12) for c in O.interactions} == {0.1, 0.0}


def test_emptySceneIsWanted(O):
	"""The builder does not wipe a scene that somebody else made."""
	from hexmembrane.scene.builder import build
	from yade import utils

	O.bodies.append(utils.sphere((0, 0, 0), 1))
	with pytest.raises(RuntimeError, match="an empty scene is needed; fix: "):
		build(None, None)
	assert len(O.bodies) == 1


def test_sceneOfAnotherKind(O):
	with pytest.raises(RuntimeError, match="MembraneBonds: 1 expected"):
		Scene()
