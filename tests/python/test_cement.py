# SPDX-License-Identifier: GPL-2.0-or-later
"""The section ``cement``: given wrongly, PFC's names, and a test of cemented sand through its stages, with resume and ``--from``."""

import copy
import math
import pathlib

import numpy
import pytest
from hexmembrane import configuration
from hexmembrane.configuration import Config, ConfigError, toDict
from hexmembrane.output import records
from tinyTest import TINY, configure

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"
CEMENT = {"emod": 2e7, "kratio": 3, "tensileStrength": 4e4, "cohesion": 6e4, "frictionAngle": 30}
ROUGH = {"consolidation": {"friction": 0.2, "unbalanced": 0.05, "tolerance": 0.3}}


def made(folder, **cement):
	configure(folder)
	return Config.of({**copy.deepcopy(TINY), "cement": cement}, folder)


@pytest.mark.parametrize(
	"changes, message",
	[
		({"kratio": None}, "cement.kratio = None: the stiffness is given in half"),
		({"kn": 1e12, "ks": 1e12}, "cement.kn = 1000000000000.0: the stiffness is given twice"),
		({"emod": None, "kratio": None}, "cement.tensileStrength = 40000.0: there is no cement without a stiffness"),
		({"cohesion": None}, "cement.cohesion = None: is missing"),
		({"tensileStrength": -1.0}, "cement.tensileStrength = -1.0: is out of range"),
		({"frictionAngle": 90}, "cement.frictionAngle = 90: is out of range"),
		({"momentFactor": 1.1}, "cement.momentFactor = 1.1: is out of range"),
		({"when": "later"}, "cement.when = 'later'"),
		({"pb_ten": 1e5}, "cement.pb_ten = 100000.0: is PFC's name; fix: here it is tensileStrength"),
		({"pb_fa": 1e5}, "cement.pb_fa = .*: is PFC's name; fix: here it is frictionAngle"),
	],
)
def test_givenWrongly(tmp_path, changes, message):
	with pytest.raises(ConfigError, match=f"^{message}"):
		made(tmp_path, **{name: value for name, value in {**CEMENT, **changes}.items() if value is not None or name == "cohesion"})


def test_whatAnEngineGets(tmp_path):
	assert not made(tmp_path).cement.given and made(tmp_path, **CEMENT).cement.given
	config = made(tmp_path, kn=1e12, ks=4e11, tensileStrength=math.inf, cohesion=1e6, frictionAngle=45)
	assert toDict(Config.of(toDict(config), tmp_path)) == toDict(config)
	assert config.cement.properties() == {
		"kn": 1e12, "ks": 4e11, "tensileStrength": math.inf, "cohesion": 1e6, "radiusMultiplier": 1.0, "momentFactor": 1.0, "frictionAngle": pytest.approx(math.pi / 4),
	}  # fmt: skip
	with pytest.raises(ConfigError, match="^specimen.pb_coh = 1: is PFC's name; fix: here it is cement.cohesion"):
		Config.of({**TINY, "specimen": {**TINY["specimen"], "pb_coh": 1}}, tmp_path)


def test_example():
	"""What examples/cement.yaml changes of quick.yaml is the section alone."""
	plain, cemented = (toDict(configuration.load(EXAMPLES / name)) for name in ("quick.yaml", "cement.yaml"))
	assert {name for name in plain if plain[name] != cemented[name]} == {"title", "cement"}


def test_cementedSand(O, tmp_path, runHere):
	"""From one consolidated state, in either tier: cement raises the peak, breaks, and is in the energies' balance; a resumed test has its columns."""
	wall = {"boundary": "wall", "shear": {"strain": 0.012}, "output": {"records": 6, "checkpointEvery": 3, "vtkEvery": 0}, **ROUGH}
	code, _, errors = runHere(configure(tmp_path, **wall), "--out", tmp_path / "plain")
	assert code == 0, errors
	plain = records.read(tmp_path / "plain" / "records.csv")
	assert "cement_bonds" not in plain
	for tier in ("compact", "reference"):
		file = configure(tmp_path, cement=CEMENT, tier=tier, **wall)
		code, said, errors = runHere(file, "--out", tmp_path / tier, "--from", tmp_path / "plain" / "consolidated.yade.gz")
		assert code == 0, errors
		assert " bonds between 200 grains" in said and "time step lowered" in said and " bonds hold, " in errors
		found = records.read(tmp_path / tier / "records.csv")
		bonds, broken = found["cement_bonds"], found["cement_broken_tension"] + found["cement_broken_shear"]
		assert broken[0] == 0 and 0 < broken[-1] < bonds[0] and (bonds + broken == bonds[0]).all()
		assert max(found["q"]) > 1.1 * max(plain["q"][numpy.array(plain["stage"]) == "shear"])
		assert abs(found["energy_error"]).max() < 0.02
		moving = abs(found["inertia_axial"]).max()  # what is fast is seen half a step apart: without cement the sums meet as closely to what moves
		for name in ("axial", "radial"):
			assert abs(found[f"soil_{name}"] - found[f"boundary_{name}"] - found[f"inertia_{name}"]).max() < 1e-4 * moving
	before = (tmp_path / tier / "records.csv").read_text()
	code, _, errors = runHere(file, "--out", tmp_path / tier, "--resume")
	assert code == 0 and (tmp_path / tier / "records.csv").read_text() == before, errors


def test_packedAndTakenOver(O, tmp_path, runHere):
	"""Cement before the consolidation; a state that has it goes on with it, and refuses another."""
	wall = {"boundary": "wall", "shear": {"strain": 0.002}, "output": {"records": 2, "vtkEvery": 0}, **ROUGH}
	strong = {**CEMENT, "tensileStrength": 1e9, "cohesion": 1e9, "when": "packed", "gap": 3e-4}
	code, said, errors = runHere(configure(tmp_path, cement=strong, **wall), "--out", tmp_path / "out", "--until", "consolidation")
	assert code == 0, errors
	state = tmp_path / "out" / "consolidated.yade.gz"
	code, said, errors = runHere(configure(tmp_path, **wall), "--out", tmp_path / "shear", "--from", state)
	assert code == 0 and "cement.emod = 20000000.0" in said, errors
	found = records.read(tmp_path / "shear" / "records.csv")
	assert found["cement_bonds"][-1] > 200 and found["cement_broken_tension"][-1] == 0
	file = configure(tmp_path, cement={**strong, "cohesion": 2e5}, **wall)
	code, _, errors = runHere(file, "--out", tmp_path / "other", "--from", state)
	assert code == 2 and "cement.cohesion = 200000.0: the state was made with 1000000000.0" in errors
	(tmp_path / "out" / "config.yaml").rename(tmp_path / "away.yaml")
	code, _, errors = runHere(file, "--out", tmp_path / "other", "--from", state)
	assert code == 2 and "cement.cohesion = 200000.0: the state has 1000000000.0" in errors


def test_nothingToBond(O, tmp_path, runHere):
	"""Grains of a free packing touch nothing before the consolidation."""
	file = configure(tmp_path, boundary="wall", cement={**CEMENT, "when": "packed"})
	code, _, errors = runHere(file, "--out", tmp_path / "out", "--until", "consolidation")
	assert code == 1 and "cement.gap = 0 m: no two grains are nearer; fix: a larger gap" in errors
