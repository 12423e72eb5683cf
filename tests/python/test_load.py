# SPDX-License-Identifier: GPL-2.0-or-later
"""Which plugin is loaded: the build that is asked for, or an error."""

import os

import pytest
from hexmembrane import _load


def test_loadedOnce():
	"""Importing again finds the library of this build and leaves it alone."""
	assert os.path.samefile(_load.loadedLibrary(), os.path.join(os.environ["HEXMEMBRANE_BUILD"], "libhexmembrane.so"))
	_load.load()


def test_anotherBuildIsRefused(monkeypatch, tmp_path):
	monkeypatch.setenv("HEXMEMBRANE_BUILD", str(tmp_path))
	with pytest.raises(ImportError, match="asks for another"):
		_load.load()


def test_noBuildNamed(monkeypatch):
	"""An installed plugin needs no variable: what is loaded is used."""
	monkeypatch.delenv("HEXMEMBRANE_BUILD")
	_load.load()


@pytest.mark.parametrize("folder, message", [(None, "HEXMEMBRANE_BUILD does not name"), ("/nowhere", "there is no libhexmembrane.so in it")])
def test_notLoaded(monkeypatch, folder, message):
	"""Before it is loaded: where to get the library from is said."""
	monkeypatch.setattr(_load, "_MARK", "NoSuchClass")
	if folder:
		monkeypatch.setenv("HEXMEMBRANE_BUILD", folder)
	else:
		monkeypatch.delenv("HEXMEMBRANE_BUILD")
	with pytest.raises(ImportError, match=message):
		_load.load()
