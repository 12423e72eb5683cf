# SPDX-License-Identifier: GPL-2.0-or-later
"""``measure`` of a configuration: what it leaves in the folder, killed and resumed, in both boundaries and tiers; clouds and curves made from it."""

import math
import signal
import subprocess
import time

import numpy as np
import pytest
from hexmembrane.configuration import ConfigError, load
from hexmembrane.measure.local import FIELDS
from hexmembrane.output import clouds, fields, groups, tables, vtk
from hexmembrane.output.inside import BANDS, PROFILE, REGIONS
from PIL import Image
from tinyTest import command, configure, environment, runOutside

MEASURE = {"bands": True, "step": 0.005, "strains": [0, 0.01, 0.02], "spacing": 0.007, "radius": 0.008, "centres": [[0, 0, 0.025]], "slices": 4, "every": 3}
FILES = {"regions": (REGIONS, ()), "profile": (PROFILE, ()), "bands": (BANDS, ("verdict",))}


def sheared(folder, **changes):
	said = runOutside(configure(folder, **{"measure": MEASURE, **changes}), "--out", folder / "out")
	assert said.returncode == 0, said.stdout + said.stderr
	return folder / "out"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
	return sheared(tmp_path_factory.mktemp("inside"))


def table(out, name):
	return tables.read(out / f"{name}.csv", FILES[name][1])


def test_tables(whole):
	for name, (columns, _) in FILES.items():
		assert (whole / f"{name}.csv").read_text().split("\n")[0] == ",".join(column.header for column in columns)
	regions = table(whole, "regions")
	assert len(set(regions["step"])) == 5 and regions["region"][0] == 0  # rows 0, 3, 6, 9, 12
	first = regions["step"] == regions["step"][0]
	assert (regions["deviatoric_strain"][first] == 0).all() and regions["grains"][0] > 4 and 0.3 < regions["porosity"][0] < 0.6
	middle = regions["region"] == 0
	assert regions["axial_strain_region"][middle][-1] == pytest.approx(0.02, rel=0.5) and regions["q"][middle][-1] > 2e4
	assert (np.diff(regions["deviatoric_strain"][middle]) > 0).all()
	assert regions["z"][0] == 0.025 and regions["z"][middle][-1] == pytest.approx(0.025, abs=1e-3)
	assert regions["z"][middle][-1] != 0.025  # carried

	profile = table(whole, "profile")
	assert list(profile["slice"][:4]) == [0, 1, 2, 3] and len(set(profile["step"])) == 5
	assert profile["radius"] == pytest.approx(0.02, rel=0.1) and (profile["axial"] > 5e4).all()

	found = table(whole, "bands")
	assert len(set(found["axial_strain"])) == 4 and found["increment"] == pytest.approx(0.005, rel=0.01)
	assert set(found["verdict"]) <= {"band", "pair", "barrel", "none"} and np.isnan(found["dip_low"]).all()
	assert (found["friction_angle"] > 5).all() and found["dip_coulomb"] == pytest.approx(45 + found["friction_angle"] / 2)


def test_fields(whole):
	with fields.opened(whole / "fields.h5") as file:
		assert [float(file[name].attrs["axial_strain"]) for name in fields.states(file)] == pytest.approx([0, 0.01, 0.02], abs=1e-4)
	test, start = fields.read(whole / "fields.h5", 0)
	assert test["boundary"] == "membrane" and test["pressure"] == 1e5 and set(start) == {"ids", "radii", *FIELDS}
	assert np.abs(start["displacement"]).max() == 0 and start["deviatoric_sum"].max() == 0 and start["volume"].sum() > 0
	test, end = fields.read(whole / "fields.h5")
	assert test["axial_strain"] == pytest.approx(0.02, abs=1e-4) and test["increment"] == pytest.approx(0.005, rel=0.01)
	assert end["displacement"] == pytest.approx(end["position"] - start["position"], abs=1e-15)
	volume = end["volume"]
	assert 0.01 < volume @ end["deviatoric_sum"] / volume.sum() < 0.06 and (end["deviatoric_sum"] >= end["deviatoric"] - 1e-12).all()
	with pytest.raises(ValueError, match=r"strain = 0.015: is not in .*, which has 0.0000, 0.0100, 0.0200; fix: "):
		fields.read(whole / "fields.h5", 0.015)
	with pytest.raises(ValueError, match="is no HDF5 file"):
		fields.read(whole / "records.csv")


def test_frames(whole):
	points, _, data, _ = vtk.read(whole / "vtk" / "grains-0002.vtp")
	_, end = fields.read(whole / "fields.h5")
	assert data["deviatoric_sum"] == pytest.approx(end["deviatoric_sum"], rel=1e-5) and (data["mean_stress"] > 0).mean() > 0.8
	assert data["rotation"].shape == (len(points), 3)
	_, _, _, cells = vtk.read(whole / "vtk" / "membrane-0002.vtp")
	main = cells["group"] == 3
	assert (np.abs(cells["hoop_strain"][main]) < 0.3).all() and set(cells) == {"group", "pressure", "hoop_strain", "axial_strain", "hoop_tension", "axial_tension"}


def same(out, expected):
	for name in FILES:
		assert (out / f"{name}.csv").read_bytes() == (expected / f"{name}.csv").read_bytes(), name
	for strain in MEASURE["strains"]:
		(_, found), (_, wanted) = (fields.read(folder / "fields.h5", strain) for folder in (out, expected))
		for name, values in wanted.items():
			assert np.array_equal(found[name], values, equal_nan=True), (strain, name)


def test_killedAndResumed(whole, tmp_path):
	"""Rows after the checkpoint are made again, from the states that strain counts from: the files are those of a test that was never stopped."""
	out = tmp_path / "out"
	with subprocess.Popen(command(configure(tmp_path, measure=MEASURE), "--out", out), env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as test:
		deadline = time.monotonic() + 120
		while time.monotonic() < deadline and test.poll() is None:
			if (out / "records.csv").is_file() and (out / "records.csv").read_text().count("shear,") >= 7:
				break
			time.sleep(0.02)
		assert test.poll() is None, "it ended before it was killed"
		test.send_signal(signal.SIGKILL)
	said = runOutside(tmp_path / "tiny.yaml", "--out", out, "--resume")
	assert said.returncode == 0, said.stdout + said.stderr
	assert "resumed in shear" in said.stdout
	same(out, whole)


def test_rigidWall(tmp_path):
	out = sheared(tmp_path, boundary="wall", shear={"strain": 0.01}, output={"records": 6}, measure={**MEASURE, "strains": [0.01]})
	test, end = fields.read(out / "fields.h5")
	last = tables.read(out / "records.csv", ("stage",))
	assert test["boundary"] == "wall" and end["volume"].sum() == pytest.approx(last["volume"][-1], rel=1e-10)
	assert end["volume"] @ end["stress"][:, 2, 2] / end["volume"].sum() == pytest.approx(last["soil_axial"][-1], rel=1e-9)
	profile = table(out, "profile")
	assert profile["radius"][-1] == pytest.approx(last["mean_radius"][-1], rel=1e-12)
	assert len(table(out, "regions")["step"]) > 10


def test_referenceTier(tmp_path):
	"""There the scene is loaded anew after each checkpoint: strain goes on counting."""
	out = sheared(tmp_path, tier="reference", shear={"strain": 0.01}, output={"records": 6}, measure={**MEASURE, "strains": [0.01]})
	_, end = fields.read(out / "fields.h5")
	assert 0.004 < end["volume"] @ end["deviatoric_sum"] / end["volume"].sum() < 0.04
	assert end["displacement"][:, 2].min() < -3e-4


# From what a test has left


def test_clouds(whole, tmp_path):
	files = clouds.draw([whole, whole], tmp_path / "clouds", (0.0, 0.02), clouds.Section(30.0))
	assert {path.suffix for path in files} == {".png", ".vtp"}
	for name in clouds.QUANTITIES:
		image = np.asarray(Image.open(tmp_path / "clouds" / f"{name}.png").convert("L"))
		assert image.std() > 10
	points, triangles, data, _ = vtk.read(tmp_path / "clouds" / "out-2.vtp")
	assert set(data) == set(clouds.QUANTITIES) and triangles.shape[1] == 3
	assert np.abs(points @ [-0.5, math.sqrt(0.75), 0]).max() < 1e-9  # in the section through the axis
	one = clouds.cloud(whole / "fields.h5", 0.02, clouds.Section())
	seen = {name: values[np.isfinite(values)] for name, values in one.values.items()}
	assert 0.25 < seen["porosity"].mean() < 0.6 and 2 < seen["coordination"].mean() < 9 and 0.005 < seen["shear"].mean() < 0.06
	assert 0 < seen["displacement"].max() < 1.5
	assert clouds.bandSection(tmp_path) is None
	assert [f"{strain:g}" for strain in clouds.strainsOf(whole)] == ["0", "0.01", "0.02"]


def test_cloudsOfAKnownField(tmp_path):
	"""A field that is linear in space is that field again away from the edge; the sign of a rotation about the section's normal."""
	random = np.random.default_rng(1)
	x = random.uniform((-0.02, -0.02, 0.01), (0.02, 0.02, 0.05), (4000, 3))
	n = len(x)
	made = fields.FieldsFile(tmp_path / "fields.h5", {"d50": 0.003, "title": "", "boundary": "wall", "pressure": 1e5}, FIELDS)
	zero, rotation = np.zeros(n), np.tile([0, 0.1, 0], (n, 1))
	arrays = {name: zero for name in FIELDS}
	arrays.update(position=x, displacement=0 * x, rotation=rotation, rotation_sum=rotation, stress=np.zeros((n, 3, 3)))
	arrays.update(volume=np.full(n, 1e-8), deviatoric_sum=x[:, 2] - 0.01, coordination=np.full(n, 5))
	made.add({"row": 0, "step": 1, "axial_strain": 0.0, "increment": 0.0, "bottom": 0.01, "top": 0.05, "radius": 0.028}, np.arange(n), np.full(n, 1e-3), arrays)
	one = clouds.cloud(tmp_path / "fields.h5", None, clouds.Section(0.0))
	core = np.abs(one.along)[None, :] < 0.01
	core = core & (np.abs(one.height - 0.02) < 0.01)[:, None]
	seen = core & np.isfinite(one.values["shear"])  # grains at random leave pores, which are outside
	assert seen.sum() > 0.8 * core.sum()
	core = seen
	assert np.abs(one.values["shear"] - one.height[:, None])[core].max() < 1e-3
	assert one.values["rotation"][core] == pytest.approx(math.degrees(0.1)) and one.values["coordination"][core] == pytest.approx(5)
	assert one.values["porosity"][core] == pytest.approx(1 - 4 / 3 * math.pi * 1e-9 / 1e-8)
	with pytest.raises(ValueError, match=r"section.offset = 0.03 m: misses the specimen of radius 0.028 m; fix: "):
		clouds.cloud(tmp_path / "fields.h5", None, clouds.Section(0.0, 0.03))
	with pytest.raises(ValueError, match=r"quantities = \['heat'\]: are not known; fix: "):
		clouds.cloud(tmp_path / "fields.h5", None, clouds.Section(), ("heat",))


def test_cloudsCommand(whole, tmp_path, capsys):
	assert clouds.main([str(whole), "--out", str(tmp_path), "--strains", "0.02", "--quantities", "shear"]) == 0
	assert (tmp_path / "shear.png").is_file() and "shear.png" in capsys.readouterr().out
	with pytest.raises(SystemExit):
		clouds.main([str(whole), "--out", str(tmp_path), "--offset", "0.001"])
	assert "--offset = 0.001: of which section is not said; fix: " in capsys.readouterr().err


def test_curves(whole, tmp_path):
	strain, found = groups.curves(whole, {"inside": [0], "outside": [1, 2]})
	assert len(strain) == 5 and strain[-1] == pytest.approx(0.02, abs=1e-4)
	regions = table(whole, "regions")
	assert found["inside"]["q"] == pytest.approx(regions["q"][regions["region"] == 0])
	assert found["outside"]["porosity"][0] == pytest.approx(regions["porosity"][[1, 2]].mean())
	groups.plot(whole, tmp_path / "curves.png", {"inside": [0], "outside": [1, 2]})
	assert np.asarray(Image.open(tmp_path / "curves.png").convert("L")).std() > 10
	with pytest.raises(ValueError, match=r"regions inside = \[999\]: not all are regions of .*; fix: "):
		groups.curves(whole, {"inside": [999]})


def test_groupsFromTheBand(tmp_path):
	band = dict.fromkeys((column.name for column in BANDS), 0.0)
	region = dict.fromkeys((column.name for column in REGIONS), 0.0)
	with tables.Table(tmp_path / "bands.csv", BANDS) as made:
		made.append({**band, "step": 10, "verdict": "band", "dip": 45.0, "azimuth": 0.0, "thickness": 0.01, "height": 0.04})
		made.append({**band, "step": 20, "verdict": "none"})
	with tables.Table(tmp_path / "regions.csv", REGIONS) as made:
		for k, (x, z) in enumerate(((0, 0.04), (0.01, 0.03), (0, 0.06), (0, 0.049))):
			made.append({**region, "step": 10, "region": k, "x": x, "z": z, "radius": 0.005})
	assert groups.fromBand(tmp_path) == ([0, 1], [2])  # the last one is beside the slab
	assert clouds.bandSection(tmp_path).azimuth == 0
	(tmp_path / "bands.csv").unlink()
	with pytest.raises(ValueError, match=r"bands = .*: tells of no band; fix: "):
		groups.fromBand(tmp_path)


# What is refused


@pytest.mark.parametrize(
	"measure, message",
	[
		({"centres": [[0.03, 0, 0.02]]}, r"measure.centres\[0\] = \[0.03, 0.0, 0.02\]: is outside the specimen of radius 0.02 m and height 0.05 m; fix: "),
		({"centres": [[0, 0]]}, r"measure.centres\[0\] = \[0.0, 0.0\]: is not a place; fix: "),
		({"centres": []}, r"measure.centres = \[\]: are no regions; fix: "),
		({"spacing": 0.05}, r"measure.spacing = 0.05: is more than the specimen's diameter; fix: "),
		({"spacing": 0.01, "radius": 0.03}, r"measure.radius = 0.03: is more than the specimen's radius .*; fix: "),
		({"strains": [0, 0.05]}, r"measure.strains = \[0.0, 0.05\]: go beyond shear.strain = 0.02; fix: "),
		({"strains": [0.01, 0]}, r"measure.strains = \[0.01, 0.0\]: do not rise; fix: "),
		({"bands": True, "step": 0.05}, r"measure.step = 0.05: is more than shear.strain = 0.02; fix: "),
		({"band": True}, r"measure.band = True: unknown key; fix: did you mean 'bands'"),
	],
)
def test_refusedKeys(tmp_path, measure, message):
	with pytest.raises(ConfigError, match=message):
		load(configure(tmp_path, measure=measure))
