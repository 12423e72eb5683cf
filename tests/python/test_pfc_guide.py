# SPDX-License-Identifier: GPL-2.0-or-later
"""The guide for those who come from PFC3D: what stands on its pages runs, and its numbers are those of the plugin."""

import pathlib
import re
import runpy

import numpy
import pytest
import yaml
from hexmembrane.configuration import load
from hexmembrane.exchange import scenes
from hexmembrane.output import histories, records
from hexmembrane.scene.builder import interactionLoop
from tinyTest import configure
from yade import utils

ROOT = pathlib.Path(__file__).parents[2]
STUDY = ROOT / "examples" / "pfc" / "study.yaml"
GUIDE, STATES = ((ROOT / "examples" / "pfc" / name).read_text(encoding="utf-8") for name in ("guide.md", "states.md"))
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def leaves(values, path=()):
	"""The keys of a configuration with their values, by path."""
	if isinstance(values, dict):
		return {found: value for name, below in values.items() for found, value in leaves(below, (*path, name)).items()}
	return {path: values}


def test_theStudyIsWhatTheGuideSays():
	"""The guide's parts are the study's configuration, all of it but its title; that is checked and takes the table."""
	parts = {}
	for language, code in FENCE.findall(GUIDE):
		if language == "yaml":
			parts |= leaves(yaml.safe_load(code))
	study = leaves(yaml.safe_load(STUDY.read_text(encoding="utf-8")))
	assert parts == {path: value for path, value in study.items() if path != ("title",)}
	config = load(STUDY)
	young, thickness = config.membrane.young, config.membrane.thickness
	assert young * thickness / 3**0.5 == pytest.approx(1e4, rel=1e-6) and len(config.stages) == 4


def test_twoBalls(O, capsys):
	"""The table of the guide is what the script prints, and that are the closed forms."""
	runpy.run_path(str(ROOT / "examples" / "pfc" / "two_balls.py"))
	rows = [line.split() for line in capsys.readouterr().out.splitlines()[1:]]
	assert all("| " + " | ".join(row) + " |" in GUIDE for row in rows)
	found = {(name, int(cycle)): tuple(map(float, values)) for name, cycle, *values in rows}
	assert found["load", 100][0] == pytest.approx(5e5 * 1e-5)
	assert found["slip", 50][1] == pytest.approx(2.5e5 * 5e-6, rel=1e-4) and found["slip", 150][1] == pytest.approx(0.5 * found["slip", 150][0], rel=1e-6)
	lever = 1e-3 * 2e-3 / 3e-3
	assert found["roll", 100][2] == pytest.approx(2.5e5 * lever**2 * 20 * 100e-6, rel=1e-5)
	assert found["roll", 200][2] == pytest.approx(0.1 * lever * 5, rel=1e-5)
	assert found["bond", 40][0] == pytest.approx(-2) and found["bond", 41][0] == 0


def test_scriptOfAState(O, tmp_path, monkeypatch, capsys):
	"""The script on the page of states goes on from a folder of tables."""
	from yade import LinearMat

	O.materials.append(LinearMat(kn=1e6, ks=5e5, friction=0.5, density=2650, label="grain"))
	O.bodies.append([utils.sphere((0, 0, 2e-3 * k), 1.005e-3) for k in range(2)])
	O.engines = [interactionLoop()]
	utils.createInteraction(0, 1)
	O.dt = 1e-6
	O.step()
	(tmp_path / "state").mkdir()
	scenes.write(tmp_path / "state")
	for name in ("balls", "contacts"):  # PFC's numbers begin with 1
		path = tmp_path / "state" / f"{name}.csv"
		path.write_text(re.sub(r"^(0|1)(?=,-?\d+\.\d+(?:e-\d+)?,)", lambda match: str(int(match[1]) + 1), path.read_text(), flags=re.MULTILINE).replace("ball-ball,0,1", "ball-ball,1,2"))
	O.reset()
	monkeypatch.chdir(tmp_path)
	(code,) = [code for language, code in FENCE.findall(STATES) if language == "python"]
	exec(compile(code, "states.md", "exec"), {})
	assert capsys.readouterr().out.endswith(") 1\n")
	assert O.bodies[1].state.vel[2] > 0 > O.bodies[0].state.vel[2]


def test_histories(tmp_path, capsys):
	"""PFC's names and signs, from the records' columns; the table is the guide's."""
	assert histories.markdown() in GUIDE
	names = [column.name for column in records.COLUMNS]
	table = {name: numpy.array([k + 1.0, k + 2.0]) for k, name in enumerate(names)}
	header = ",".join(column.name + (f" [{column.unit}]" if column.unit else "") for column in records.COLUMNS)
	rows = [",".join("shear" if name == "stage" else repr(float(values[k])) for name, values in table.items()) for k in range(2)]
	(tmp_path / "records.csv").write_text("\n".join([header, *rows]) + "\n")
	assert histories.main([str(tmp_path)]) == 0
	lines = [line.split(",") for line in (tmp_path / "histories.csv").read_text().splitlines()]
	found = dict(zip(lines[0], lines[2]))
	value = {name: values[1] for name, values in table.items()}
	force = (value["platen_force_bottom"] + value["platen_force_top"]) / 2
	assert found["stage"] == "shear" and float(found["wezz"]) == -value["axial_strain"] and float(found["wevol"]) == value["volumetric_strain_volume"]
	assert float(found["wszz"]) == pytest.approx(-force * value["height"] / value["volume"])
	assert float(found["wall.force.contact.z.bottom"]) == -value["platen_force_bottom"] and float(found["measure.stress.zz"]) == -value["soil_axial"]
	capsys.readouterr()
	assert histories.main([str(tmp_path / "none")]) == 2 and "fix: give the output folder of a test" in capsys.readouterr().err
	assert histories.main([str(tmp_path), "--out", str(tmp_path / "no" / "file")]) == 1 and "cannot be written" in capsys.readouterr().err


def test_parameterOfAPfcProperty(tmp_path):
	"""What the guide says of PFC's names in a configuration."""
	path = configure(tmp_path)
	given = yaml.safe_load(path.read_text())
	given["specimen"]["rr_fric"] = 0.1
	path.write_text(yaml.safe_dump(given))
	with pytest.raises(ValueError, match="specimen.rr_fric = 0.1: .*specimen.rollingFriction"):
		load(path)
