# SPDX-License-Identifier: GPL-2.0-or-later
"""The documentation's tables say what the code says."""

import pathlib

from hexmembrane.config import Config
from hexmembrane.records import COLUMNS
from hexmembrane.schema import markdown

README = pathlib.Path(__file__).parents[2] / "examples" / "README.md"


def test_tableOfKeys():
	"""Fix: paste what ``hexmembrane.schema.markdown(hexmembrane.config.Config)`` gives."""
	assert markdown(Config) in README.read_text(encoding="utf-8")


def test_tableOfColumns():
	"""Fix: paste what ``hexmembrane.records.markdown()`` gives."""
	from hexmembrane.records import markdown as columns

	text = README.read_text(encoding="utf-8")
	assert columns() in text
	assert all(f"| `{column.name}` |" in text for column in COLUMNS)
