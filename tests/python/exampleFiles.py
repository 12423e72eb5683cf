# SPDX-License-Identifier: GPL-2.0-or-later
"""The files below examples/ that are configurations of a test: all but studies and calibrations, which have keys of their own."""

import pathlib

import yaml

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"
#: Keys that only a study or a calibration has; one of them is compulsory there.
_OTHERS = {"axes", "sets", "seeds", "curves"}


def configurations():
	return sorted(path for path in EXAMPLES.rglob("*.yaml") if not _OTHERS & set(yaml.safe_load(path.read_text(encoding="utf-8"))))
