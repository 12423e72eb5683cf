# SPDX-License-Identifier: GPL-2.0-or-later
"""A test run: its stages, checkpoints and progress, and all of it from one configuration."""

from hexmembrane.run.pipeline import run

__all__ = ["run"]
