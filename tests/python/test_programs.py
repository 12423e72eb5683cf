# SPDX-License-Identifier: GPL-2.0-or-later
"""Programs as users: the JSON Schema of the configuration, a check that makes nothing, errors as JSON."""

import json
import pathlib

import pytest
from exampleFiles import configurations
from hexmembrane.configuration.config import Config
from hexmembrane.configuration.files import resolved
from hexmembrane.configuration.json_schema import jsonSchema
from hexmembrane.configuration.reader import read
from hexmembrane.configuration.schema import table
from tinyTest import TINY, configure

jsonschema = pytest.importorskip("jsonschema")
ROOT = pathlib.Path(__file__).parents[2]


def faults(values):
	return [error.message for error in jsonschema.Draft202012Validator(jsonSchema()).iter_errors(values)]


def test_schemaIsSound(runHere):
	code, said, _ = runHere("--schema")
	assert code == 0 and json.loads(said) == json.loads(json.dumps(jsonSchema()))
	jsonschema.Draft202012Validator.check_schema(json.loads(said))


@pytest.mark.parametrize("path", configurations(), ids=lambda path: path.stem)
def test_examplesAreValid(path):
	assert faults(read(path)) == []


def test_everyKeyIsInIt(tmp_path):
	"""What a test writes back is valid, with every key that there is."""
	configure(tmp_path)
	values = json.loads(json.dumps(resolved(Config.of({**TINY, "stages": [{"kind": "consolidation"}, {"kind": "shear", "strain": 0.1}]}, tmp_path))))
	assert faults(values) == []
	properties = jsonSchema()["properties"]
	for name, *_ in table(Config):
		at, *inner = name.split(".")
		place = properties[at]
		for at in inner:
			place = place["anyOf"][0]["properties"][at]
		assert place["description"], name


@pytest.mark.parametrize(
	"section, keys, message",
	[
		("specimen", {"radius": -1}, "-1 is less than or equal to the minimum of 0"),
		("specimen", {"raduis": 1}, "'raduis' was unexpected"),
		("specimen", {"grains": "many"}, "'many' does not match"),
		("membrane", {"placement": "inside"}, "'inside' is not one of"),
		("output", {"energy": "yes"}, "'yes' is not of type 'boolean'"),
		("consolidation", {"pressure": None}, "None is not of type"),
	],
)
def test_wrongValues(section, keys, message):
	values = {**TINY, section: {**TINY.get(section, {}), **keys}}
	validator = jsonschema.Draft202012Validator(jsonSchema())
	deep = [leaf for error in validator.iter_errors(values) for leaf in _leaves(error)]
	assert any(message in text for text in deep), deep


def _leaves(error):
	return [error.message] if not error.context else [text for inner in error.context for text in _leaves(inner)]


def test_missingSections():
	assert faults({"specimen": {}}) and faults({"base": "other.yaml", "specimen": {"seed": 2}}) == [] and faults({**TINY, "specimen": {**TINY["specimen"], "emod": "2e7"}}) == []


def test_checkMakesNothing(tmp_path, runHere):
	stages = [{"kind": "consolidation"}, {"kind": "shear", "strain": 0.01}, {"kind": "unloading", "q": 0}, {"kind": "hold", "time": 1e-3}]
	code, said, errors = runHere(configure(tmp_path, stages=stages), "--out", tmp_path / "deep" / "out", "--check")
	assert code == 0 and not (tmp_path / "deep").exists(), errors
	for text in (
		"specimen: 200 grains of radius 2.908 to 4.35 mm in 40 x 50 mm, porosity 0.45 asked for",
		"consolidation: from 0 to 100 kPa, until rest",
		"shear: to 1 % at 0.08 m/s, 12 rows",
		"unloading: to q = 0 kPa at 0.08 m/s, rows at strain steps of",
		"hold: at 100 kPa in 0.001 s, 10 rows",
		"nothing was made",
	):
		assert text in said, text
	code, said, errors = runHere(configure(tmp_path, stages=None, platens={"thickness": 1e-4}), "--out", tmp_path / "out", "--check")
	assert code == 2 and "platens.thickness = 0.0001: is no more than" in errors
	(tmp_path / "used").mkdir()
	(tmp_path / "used" / "records.csv").write_text("mine")
	path = configure(tmp_path)
	code, said, errors = runHere(path, "--out", tmp_path / "used", "--check")
	assert code == 2 and "has a file records.csv already" in errors


def test_errorsAsJson(tmp_path, runHere):
	code, _, errors = runHere(configure(tmp_path, specimen={"radius": -1}), "--out", tmp_path / "out", "--json")
	found = json.loads(errors)["error"]
	assert code == found["exit"] == 2 and (found["kind"], found["key"], found["value"]) == ("ConfigError", "specimen.radius", -1)
	assert found["wrong"].startswith("is out of range") and found["fix"].startswith("give a number in m") and found["message"].startswith("specimen.radius = -1: ")
	code, _, errors = runHere(configure(tmp_path, numerics={"dt": 1.0}), "--out", tmp_path / "out", "--json")
	found = json.loads(errors)["error"]
	assert code == found["exit"] == 1 and found["kind"] == "ValueError" and found["fix"] == "lower it or leave it out" and "key" not in found
	code, _, errors = runHere(tmp_path / "gone.yaml", "--json")
	assert code == 2 and json.loads(errors)["error"]["fix"] == "correct the path"


def test_withoutAConfiguration(runHere, capsys):
	for arguments, message in ((["--check"], "CONFIG is missing"), (["a.yaml", "--check", "--resume"], "give one of them")):
		with pytest.raises(SystemExit) as ended:
			runHere(*arguments)
		assert ended.value.code == 2 and message in capsys.readouterr().err
