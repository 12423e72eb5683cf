# SPDX-License-Identifier: GPL-2.0-or-later
"""What a test is: its keys, checked, from YAML or Python. Everything that users need of it is importable from here."""

from hexmembrane.configuration.config import Config
from hexmembrane.configuration.files import derived, load, merged, resolved, save
from hexmembrane.configuration.schema import ConfigError, toDict

__all__ = ["Config", "ConfigError", "derived", "load", "merged", "resolved", "save", "toDict"]
