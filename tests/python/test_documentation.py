# SPDX-License-Identifier: GPL-2.0-or-later
"""The documentation's tables say what the code says."""

import pathlib

import pytest
import yade
from exampleFiles import configurations
from hexmembrane import configuration
from hexmembrane.configuration import Config
from hexmembrane.configuration.schema import markdown
from hexmembrane.measure.local import FIELDS
from hexmembrane.output import inside, records, tables
from hexmembrane.scene import specimen, timestep

ROOT = pathlib.Path(__file__).parents[2]
README = ROOT / "examples" / "README.md"


def test_tableOfKeys():
	"""Fix: paste what ``hexmembrane.configuration.schema.markdown(hexmembrane.configuration.Config)`` gives."""
	assert markdown(Config) in README.read_text(encoding="utf-8")


def test_tableOfColumns():
	"""Fix: paste what ``hexmembrane.output.records.markdown()`` gives."""
	text = README.read_text(encoding="utf-8")
	assert records.markdown() in text
	assert all(f"| `{column.name}` |" in text for column in records.COLUMNS)


def contractTable():
	"""The compact tier's reading contract as a table; an attribute of C++ or Python is set as code, a phrase is not."""

	def cell(attribute):
		names = attribute.split(", ")
		return attribute if any(" " in name for name in names) else ", ".join(f"`{name}`" for name in names)

	rows = [f"| {of} | {cell(attribute)} | {treatment} | {what} |" for of, attribute, treatment, what in yade.CompactLoop.contract()]
	return "\n".join(["| of | attribute | treatment | what |", "| --- | --- | --- | --- |", *rows])


def test_tableOfTheReadingContract():
	"""Fix: paste the table that the message shows between the markers."""
	text = (ROOT / "pkg" / "compact" / "README.md").read_text(encoding="utf-8")
	between = text.partition("<!-- CompactLoop.contract() -->")[2].partition("<!-- end -->")[0].strip()
	assert between == contractTable(), "fix: paste this table:\n" + contractTable()


def test_tablesOfWhatIsMeasuredInside():
	"""Fix: paste what ``hexmembrane.output.tables.markdown`` gives of each of ``hexmembrane.output.inside``."""
	text = (ROOT / "examples" / "inside.md").read_text(encoding="utf-8")
	assert all(tables.markdown(columns) in text for columns in (inside.REGIONS, inside.BANDS, inside.PROFILE))
	assert all(f"| `{name}` | {unit} | {meaning} |" in text for name, (unit, meaning) in FIELDS.items())


def test_tableOfModules():
	folder = ROOT / "py" / "hexmembrane"
	text = (folder / "README.md").read_text(encoding="utf-8")
	missing = [path.stem for path in folder.rglob("*.py") if path.stem != "__init__" and f"`{path.stem}`" not in text]
	assert missing == []


@pytest.mark.parametrize("path", configurations(), ids=lambda path: path.stem)
def test_examplesAreSound(path):
	"""Every example's configuration passes all checks, is listed in the README, and its grains can be drawn."""
	config = configuration.load(path)
	assert path.name in README.read_text(encoding="utf-8")
	if config.specimen.gradation:
		sizes = specimen.radii(config.specimen, config.specimen.radius, config.specimen.height)
		assert len(sizes) == (config.specimen.grains or len(sizes)) and sizes.min() > 0


def test_quickExampleIsQuasiStatic():
	config = configuration.load(ROOT / "examples" / "quick.yaml")
	diameter = 2 * (specimen.radii(config.specimen, config.specimen.radius, config.specimen.height) ** 3).mean() ** (1 / 3)
	inertial = config.shear.velocity / config.specimen.height * diameter * (config.specimen.density / config.consolidation.pressure) ** 0.5
	assert inertial < 1e-3 and config.shear.strain >= 0.10
	assert timestep.stiffnessLevel(config.specimen.emod, config.consolidation.pressure) >= 300


@pytest.mark.parametrize("path", [*sorted((ROOT / "examples" / "sweep").glob("*.yaml")), ROOT / "examples" / "paper" / "study" / "study.yaml"], ids=lambda path: path.stem)
def test_studiesAreSound(path, monkeypatch):
	"""Every study passes all checks and is in its folder's README; all keys are in that of examples/sweep."""
	monkeypatch.syspath_prepend(str(ROOT / "scripts" / "sweep.d"))
	import studyfile

	text = (path.parent / "README.md").read_text(encoding="utf-8")
	assert studyfile.load(path).runs and path.name in text
	keys = (ROOT / "examples" / "sweep" / "README.md").read_text(encoding="utf-8")
	assert all(f"| `{key}` |" in keys for key in studyfile.KEYS)
