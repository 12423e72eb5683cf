# SPDX-License-Identifier: GPL-2.0-or-later
"""The documentation's tables say what the code says."""

import pathlib

import pytest
from hexmembrane import config, specimen, timestep
from hexmembrane.config import Config
from hexmembrane.records import COLUMNS
from hexmembrane.schema import markdown

ROOT = pathlib.Path(__file__).parents[2]
README = ROOT / "examples" / "README.md"


def test_tableOfKeys():
	"""Fix: paste what ``hexmembrane.schema.markdown(hexmembrane.config.Config)`` gives."""
	assert markdown(Config) in README.read_text(encoding="utf-8")


def test_tableOfColumns():
	"""Fix: paste what ``hexmembrane.records.markdown()`` gives."""
	from hexmembrane.records import markdown as columns

	text = README.read_text(encoding="utf-8")
	assert columns() in text
	assert all(f"| `{column.name}` |" in text for column in COLUMNS)


def test_tableOfModules():
	folder = ROOT / "py" / "hexmembrane"
	text = (folder / "README.md").read_text(encoding="utf-8")
	missing = [path.stem for path in folder.glob("*.py") if path.stem != "__init__" and f"`{path.stem}`" not in text]
	assert missing == []


@pytest.mark.parametrize("path", sorted((ROOT / "examples").rglob("*.yaml")), ids=lambda path: path.stem)
def test_examplesAreSound(path):
	"""Every example's configuration passes all checks, is listed in the README, and its grains can be drawn."""
	made = config.load(path)
	assert path.name in README.read_text(encoding="utf-8")
	if made.specimen.gradation:
		sizes = specimen.radii(made.specimen, made.specimen.radius, made.specimen.height)
		assert len(sizes) == (made.specimen.grains or len(sizes)) and sizes.min() > 0


def test_quickExampleIsQuasiStatic():
	made = config.load(ROOT / "examples" / "quick.yaml")
	diameter = 2 * (specimen.radii(made.specimen, made.specimen.radius, made.specimen.height) ** 3).mean() ** (1 / 3)
	inertial = made.shear.velocity / made.specimen.height * diameter * (made.specimen.density / made.consolidation.pressure) ** 0.5
	assert inertial < 1e-3 and made.shear.strain >= 0.10
	assert timestep.stiffnessLevel(made.specimen.emod, made.consolidation.pressure) >= 300
