# SPDX-License-Identifier: GPL-2.0-or-later
"""Which plugin is loaded: the build that is asked for and of the package's version, or an error."""

import os
import pathlib
import shutil
import subprocess
import sys

import hexmembrane
import pytest
from hexmembrane import _load

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
LIBRARY = os.path.join(os.environ["HEXMEMBRANE_BUILD"], "libhexmembrane.so")


def test_loadedOnce():
	"""Importing again finds the library of this build and leaves it alone."""
	assert os.path.samefile(_load.loadedLibrary(), LIBRARY)
	_load.load()


def test_anotherBuildIsRefused(monkeypatch, tmp_path):
	monkeypatch.setenv("HEXMEMBRANE_BUILD", str(tmp_path))
	with pytest.raises(ImportError, match="HEXMEMBRANE_BUILD = .*it can hold one only; fix: remove"):
		_load.load()


def test_noBuildNamed(monkeypatch):
	"""An installed plugin needs no variable: what is loaded is used."""
	monkeypatch.delenv("HEXMEMBRANE_BUILD")
	_load.load()


@pytest.mark.parametrize("folder, message", [(None, "HEXMEMBRANE_BUILD does not name"), ("/nowhere", "there is no libhexmembrane.so in it")])
def test_notLoaded(monkeypatch, folder, message):
	"""Before it is loaded: where to get the library from is said."""
	monkeypatch.setattr(_load, "_CLASS", "NoSuchClass")
	if folder:
		monkeypatch.setenv("HEXMEMBRANE_BUILD", folder)
	else:
		monkeypatch.delenv("HEXMEMBRANE_BUILD")
	with pytest.raises(ImportError, match=message):
		_load.load()


def test_anotherVersionIsRefused(monkeypatch):
	"""Package and plugin of two versions: both are named, with the plugin's path and what to do."""
	assert _load.versionOf(LIBRARY) == hexmembrane.__version__
	monkeypatch.setattr(hexmembrane, "__version__", "9.8.7")
	with pytest.raises(ImportError) as refused:
		_load.load()
	for part in (LIBRARY, _load.versionOf(LIBRARY), "9.8.7", os.path.join("py", "hexmembrane"), "fix: "):
		assert part in str(refused.value)


def test_libraryWithoutAVersion():
	"""A plugin from before it stated one is of no known version."""
	assert _load.versionOf("libm.so.6") is None


@pytest.fixture
def installed(tmp_path):
	"""A YADE with the plugin installed, made of links to the real one: runs code in it, returns (exit code, stdout, stderr)."""
	import yade.config

	prefix = pathlib.Path(yade.config.prefix)
	folder = pathlib.Path(yade.config.libDir)
	plugins = tmp_path / folder.relative_to(prefix)
	plugins.mkdir(parents=True)
	for file in folder.iterdir():
		(plugins / file.name).symlink_to(file)
	shutil.copy(LIBRARY, plugins)

	def run(code, version):
		package = tmp_path / "package"
		shutil.copytree(CHECKOUT / "py", package)
		init = package / "hexmembrane" / "__init__.py"
		init.write_text(init.read_text().replace('"%s"' % hexmembrane.__version__, '"%s"' % version))
		script = tmp_path / "script.py"
		script.write_text(code)
		environment = {**os.environ, "YADE_PREFIX": str(tmp_path), "PYTHONPATH": str(package)}
		del environment["HEXMEMBRANE_BUILD"]
		command = [sys.executable, str(CHECKOUT / "scripts" / "setup.d" / "launch.py"), "1", str(script)]
		result = subprocess.run(command, capture_output=True, text=True, timeout=120, env=environment)
		return result.returncode, result.stdout, result.stderr

	return run


@pytest.mark.parametrize("version, exitCode, wanted", [(hexmembrane.__version__, 0, "HexMembrane"), ("9.8.7", 1, "version 9.8.7")])
def test_installedPlugin(installed, tmp_path, version, exitCode, wanted):
	"""YADE loads an installed plugin itself, without initialising the module: it is found, and its version is checked all the same."""
	code = "from hexmembrane import _load\nimport yade.wrapper\nprint(_load.loadedLibrary(), yade.wrapper.HexMembrane.__name__)"
	status, said, error = installed(code, version)
	assert status == exitCode and wanted in said + error, error
	assert str(tmp_path) in said + error
