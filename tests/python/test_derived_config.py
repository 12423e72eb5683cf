# SPDX-License-Identifier: GPL-2.0-or-later
"""Configurations made from others: a file with a base, and changes in Python."""

import pathlib

import pytest
from hexmembrane import configuration
from hexmembrane.configuration import ConfigError, toDict

PAPER = pathlib.Path(__file__).parents[2] / "examples" / "paper"
BASE = "specimen: {radius: 0.02, height: 0.08, gradation: sand.csv, grains: 100}\nconsolidation: {pressure: 1.0e+5, friction: 0.1}\n"


@pytest.fixture
def folder(tmp_path):
	(tmp_path / "lower").mkdir()
	(tmp_path / "lower" / "sand.csv").write_text("diameter (m), percent passing\n0.001, 0\n0.002, 100\n")
	(tmp_path / "lower" / "base.yaml").write_text(BASE)
	return tmp_path


def write(folder, text, name="test.yaml"):
	(folder / name).write_text(text)
	return folder / name


def test_fileWithABase(folder):
	"""Changes go key by key, paths of the base count from its folder, and a base may have a base."""
	middle = write(folder, "base: lower/base.yaml\nboundary: wall\nspecimen: {grains: 200}\n", "middle.yaml")
	made = configuration.load(write(folder, f"base: {middle.name}\nconsolidation: {{pressure: 5.0e+4}}\n"))
	assert (made.boundary, made.specimen.grains, made.specimen.radius) == ("wall", 200, 0.02)
	assert (made.consolidation.pressure, made.consolidation.friction) == (5e4, 0.1)
	assert made.specimen.gradation == str((folder / "lower" / "sand.csv").resolve())
	configuration.save(made, folder / "resolved.yaml")
	assert toDict(configuration.load(folder / "resolved.yaml")) == toDict(made)


@pytest.mark.parametrize(
	"text, message",
	[
		("base: gone.yaml\n", "cannot be read"),
		("base: test.yaml\n", "base = 'test.yaml': is its own base; fix: "),
		("base: 5\n", "base = 5: is not text; fix: "),
		("base: list.yaml\n", "is not a mapping of keys; fix: "),
		("base: lower/base.yaml\nspecimen: 5\n", "specimen = 5: is not a mapping"),
		("base: lower/base.yaml\nspecimen: {raduis: 1}\n", "did you mean 'radius'"),
	],
)
def test_badBase(folder, text, message):
	write(folder, "[1, 2]", "list.yaml")
	with pytest.raises(ConfigError, match=".*") as caught:
		configuration.load(write(folder, text))
	assert message in str(caught.value)


def test_derivedInPython(folder):
	base = configuration.load(folder / "lower" / "base.yaml")
	made = configuration.derived(base, {"boundary": "wall", "shear": {"strain": 0.01}})
	assert (made.boundary, made.shear.strain, made.specimen) == ("wall", 0.01, base.specimen)
	assert (base.boundary, base.shear.strain) == ("membrane", 0.12)
	with pytest.raises(ConfigError, match="boundary = 'glass': is not one of the choices"):
		configuration.derived(base, {"boundary": "glass"})


def test_studyIsOneKeywordApart():
	"""Flexible and rigid at one pressure differ in the boundary (and their titles) alone, the pressures in the pressure."""
	reference = toDict(configuration.load(PAPER / "flexible-100.yaml"))
	for pressure in (50, 100, 150):
		for name, boundary in (("flexible", "membrane"), ("rigid", "wall")):
			found = toDict(configuration.load(PAPER / f"{name}-{pressure}.yaml"))
			assert f"{pressure} kPa" in found["title"]
			changes = {"title": found["title"], "boundary": boundary, "consolidation": {"pressure": 1e3 * pressure}}
			assert found == configuration.merged(reference, changes)
