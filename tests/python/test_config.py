# SPDX-License-Identifier: GPL-2.0-or-later
"""Configuration: everything wrong is refused before anything is made, with key path, value and fix; what is right round-trips."""

import copy
import math

import numpy
import pytest
import yaml
from hexmembrane import configuration
from hexmembrane.configuration import Config
from hexmembrane.configuration.schema import ConfigError, freeKeys, paths, table, toDict

GOOD = {
	"specimen": {"radius": 0.02, "height": 0.08, "gradation": "sand.csv", "grains": 100},
	"consolidation": {"pressure": 1e5},
}


@pytest.fixture
def folder(tmp_path):
	(tmp_path / "sand.csv").write_text("diameter (m), percent passing\n0.001, 0\n0.002, 100\n")
	return tmp_path


def changed(path, value):
	given = copy.deepcopy(GOOD)
	*sections, name = path.split(".")
	place = given
	for part in sections:
		place = place.setdefault(part, {})
	place[name] = value
	return given


def test_defaultsAndUnits(folder):
	made = Config.of(GOOD, folder)
	assert (made.specimen.radius, made.consolidation.pressure, made.membrane.placement) == (0.02, 1e5, "outside")
	assert made.specimen.gradation == str(folder / "sand.csv")


@pytest.mark.parametrize("text, value", [("1e5", 1e5), ("1E5", 1e5), ("100000", 1e5), ("1.0e+5", 1e5), (" 1e5 ", 1e5), ("1_000e2", 1e5)])
def test_numbersThatYamlReadsAsText(folder, text, value):
	(folder / "test.yaml").write_text(yaml.safe_dump(changed("consolidation.pressure", text)))
	assert configuration.load(folder / "test.yaml").consolidation.pressure == value


def test_yamlWritten1e5IsText():
	"""The reason for the test above: YAML 1.1 as PyYAML reads it."""
	assert yaml.safe_load("a: 1e5") == {"a": "1e5"}


def test_numpyNumbers(folder):
	given = changed("specimen.radius", numpy.float32(0.25))
	given["specimen"]["grains"] = numpy.int64(200)
	made = Config.of(given, folder)
	assert (made.specimen.radius, made.specimen.grains) == (0.25, 200)
	assert type(made.specimen.radius) is float and type(made.specimen.grains) is int


BAD = [
	("specimen.radius", -0.02, "out of range", "> 0"),
	("specimen.radius", 0, "out of range", "> 0"),
	("specimen.radius", math.nan, "not finite", "number in m"),
	("specimen.radius", "nan", "not finite", "number in m"),
	("specimen.radius", math.inf, "not finite", "number in m"),
	("specimen.radius", "20 mm", "is not a number in m", "> 0"),
	("specimen.radius", True, "is not a number", "m"),
	("specimen.radius", [0.02], "is not a number", "m"),
	("specimen.radius", None, "is missing", "give radius of the specimen (m)"),
	("specimen.height", "", "is not a number", "m"),
	("specimen.raduis", 0.02, "unknown key", "did you mean 'radius'"),
	("speciman", {}, "unknown key", "did you mean 'specimen'"),
	("qwertz", 1, "unknown key", "known keys are title, accuracy, tier, boundary, stages, specimen"),
	("specimen", 5, "is not a mapping", "key: value"),
	("specimen", [1], "is not a mapping", "key: value"),
	("specimen.grains", 100.5, "is not a whole number", "whole number"),
	("specimen.grains", 3, "out of range", ">= 20"),
	("specimen.seed", -1, "out of range", ">= 0"),
	("specimen.porosity", 1.5, "out of range", "<= 0.6"),
	("specimen.scale", 5, "number of grains is wished too", "remove one"),
	("specimen.packing", "packing.txt", "one source", "exactly one"),
	("specimen.gradation", None, "one source", "exactly one"),
	("specimen.gradation", "nowhere.csv", "no such file", "correct the path"),
	("specimen.gradation", 7, "is not text", "give text"),
	("membrane.placement", "inside", "not one of the choices", "'outside' or 'centred'"),
	("membrane.placement", "outsid", "not one of the choices", "did you mean 'outside'"),
	("membrane.oRingRows", 0, "out of range", ">= 1"),
	("membrane.poisson", 0.5, "out of range", "<= 0.333333"),
	("membrane.tensionOnly", "yes please", "neither true nor false", "true or false"),
	("membrane.tensionOnly", 1, "neither true nor false", "true or false"),
	("membrane.bendingStiffness", -1e-5, "out of range", ">= 0"),
	("membrane.bendingStiffness", math.inf, "not finite", "N m"),
	("membrane.tensileStrength", 0, "out of range", "> 0"),
	("membrane.shearStrength", 0.5, "carry no shear force", "lower poisson"),
	("membrane.placement", "centred", "particle's radius", "membrane.particleRadius"),
	("consolidation.pressure", -1e5, "out of range", "> 0"),
	("consolidation.pressure", math.nan, "not finite", "Pa"),
	("shear.strain", 0, "out of range", "> 0"),
	("numerics.damping", 1, "out of range", "< 1"),
	("numerics.threads", 0, "out of range", ">= 1"),
	("output.records", 0, "out of range", ">= 1"),
]


@pytest.mark.parametrize("path, value, wrong, fix", BAD, ids=[f"{path}={value!r}" for path, value, *_ in BAD])
def test_badValue(folder, path, value, wrong, fix):
	"""The message starts with the key's path and value, then says what is wrong and the fix."""
	with pytest.raises(ConfigError) as caught:
		Config.of(changed(path, value), folder)
	message = str(caught.value)
	assert wrong in message and message.count("; fix: ") == 1 and fix in message
	assert message.startswith(f"{path} = ") or caught.value.path.startswith(path.split(".")[0])


@pytest.mark.parametrize("path", ["specimen.radius", "specimen.height", "consolidation.pressure"])
def test_missingKey(folder, path):
	given = copy.deepcopy(GOOD)
	section, name = path.split(".")
	del given[section][name]
	with pytest.raises(ConfigError, match=rf"^{path} = None: is missing; fix: give .*\((m|Pa)\)"):
		Config.of(given, folder)


@pytest.mark.parametrize(
	"text, message",
	[
		("specimen: [", "is not YAML"),
		("a: b: c", "line 1.*is not YAML"),
		("- 1\n- 2", "is not a mapping"),
		("just text", "is not a mapping"),
		("", "specimen.radius.* is missing"),
	],
)
def test_badFile(folder, text, message):
	(folder / "test.yaml").write_text(text)
	with pytest.raises(ConfigError, match=message):
		configuration.load(folder / "test.yaml")


def test_missingAndUnreadableFile(folder):
	with pytest.raises(ConfigError, match="cannot be read.*correct the path"):
		configuration.load(folder / "nowhere.yaml")
	with pytest.raises(ConfigError, match="cannot be read"):
		configuration.load(folder)
	(folder / "binary.yaml").write_bytes(b"\xff\xfe\x00")
	with pytest.raises(ConfigError, match="UTF-8"):
		configuration.load(folder / "binary.yaml")


def test_tensionOnlyNeedsCentralBonds(folder):
	given = changed("membrane.tensionOnly", True)
	assert Config.of(given, folder).membrane.tensionOnly
	given["membrane"]["poisson"] = 0.2
	with pytest.raises(ConfigError, match="membrane.tensionOnly = True: needs central bonds.*fix: leave poisson"):
		Config.of(given, folder)


@pytest.mark.parametrize("text, central", [("0.333333", True), ("0.33333333", True), ("0.3333", False), ("0.25", False)])
def test_aThirdAsItIsWritten(folder, text, central):
	"""A third with six digits or more means bonds without shear, whose stiffness then is exactly 0."""
	membrane = Config.of(changed("membrane.poisson", text), folder).membrane
	assert membrane.centralBonds == central and membrane.poisson == (1 / 3 if central else float(text))


def test_freeKeys():
	"""Keys that may differ on resume: names, output, limits and places of files; nothing that changes a step."""
	assert set(freeKeys(Config)) == {
		"title",
		"tier",
		"specimen.packing",
		"specimen.gradation",
		"specimen.balls",
		"consolidation.unbalanced",
		"consolidation.tolerance",
		"consolidation.maxSteps",
		"consolidation.timeLimit",
		"shear.pressureTolerance",
		"shear.stopOutsideTolerance",
		"numerics.threads",
		"output.vtkEvery",
		"output.checkpointEvery",
		"output.contacts",
		"output.report",
		*(f"lab.{name}" for name in ("file", "strain", "stress_ratio", "q", "volumetric_strain", "volumetric", "units")),
	}


def test_pythonObjectIsCheckedToo(folder):
	made = Config.of(GOOD, folder)
	made.shear.strain = math.nan
	with pytest.raises(ConfigError, match="shear.strain = nan"):
		Config.of(made)


def test_resolvedRoundTrip(folder):
	"""What is written back holds every key, runs again, and says seed, versions and threads."""
	given = changed("specimen.seed", 77)
	given["numerics"] = {"dt": 1.2345678901234567e-6}
	made = Config.of(given, folder)
	configuration.save(made, folder / "resolved.yaml")
	text = yaml.safe_load((folder / "resolved.yaml").read_text())
	assert text["specimen"]["seed"] == 77
	assert {"date", "hexmembrane", "commit", "yade", "python", "numpy", "threads"} <= set(text["made"])
	assert text["made"]["yade"] and text["made"]["threads"] >= 1
	keys = {row[0] for row in table(Config)}
	assert keys == set(paths({name: part for name, part in text.items() if name != "made"}))
	assert toDict(configuration.load(folder / "resolved.yaml")) == toDict(made)
	assert not list(folder.glob("*.part"))


def test_everyKeyIsDocumented():
	for name, kind, unit, default, allowed, doc in table(Config):
		assert len(doc) > 15, name
		if kind.startswith("number") and not unit:
			assert allowed, f"{name}: a number without a unit needs a range"
