# SPDX-License-Identifier: GPL-2.0-or-later
"""CMake's search for YADE refuses what would load and then go wrong, and says what to do.

scripts/cmake/FindYADE.cmake is run as a script on a made-up program text and source tree: its checks come before anything is
looked for on the machine.
"""

import pathlib
import shutil
import subprocess

import pytest

MODULE = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "cmake" / "FindYADE.cmake"
PROGRAM = """#!{python}
prefix,suffix='{prefix}' if 'YADE_PREFIX' not in os.environ else os.environ['YADE_PREFIX'],'-own'
features,version,debugbuild=' {features}'.split(' '),'{version}',' '
if(True==True):
	mpmath.mp.dps=(int({digits})+1)
libPATH='lib'
"""
GOOD = dict(python="/usr/bin/python3", features="LOGGER OPENMP MPI LS_DEM", version="2025.2.0", digits="15")


@pytest.fixture
def configure(tmp_path):
	"""Runs the module on a program and a source tree that differ from good ones as asked; returns CMake's messages."""

	def run(release="2025.2.0", program=None, source=True, library=True, without=None, **changes):
		folder = tmp_path / "yade"
		executable = folder / "bin" / "yade-own"
		for file in ("core/Scene.hpp", "lib/serialization/Serializable.hpp", "pkg/dem/ScGeom.hpp"):
			(tmp_path / "source" / file).parent.mkdir(parents=True, exist_ok=True)
			(tmp_path / "source" / file).touch()
		(tmp_path / "source" / "RELEASE").write_text(release + "\n")
		if without:
			(tmp_path / "source" / without).unlink()
		executable.parent.mkdir(parents=True)
		executable.write_text(program or PROGRAM.format(prefix=folder, **{**GOOD, **changes}))
		if library:
			(folder / "lib" / "yade-own").mkdir(parents=True)
			(folder / "lib" / "yade-own" / "libyade.so").touch()
		arguments = ["-DYADE_EXECUTABLE=%s" % executable] + (["-DYADE_SOURCE_DIR=%s" % (tmp_path / "source")] if source else [])
		result = subprocess.run([shutil.which("cmake"), *arguments, "-P", str(MODULE)], capture_output=True, text=True, timeout=60)
		return " ".join(result.stderr.split())

	return run


REFUSED = "YADE_EXECUTABLE = "


def test_goodOnesPassTheChecks(configure):
	"""The oracle of the tests below: without a fault, what is reached is the search for packages, which a script cannot do."""
	message = configure()
	assert "find_package" in message and REFUSED not in message and "YADE_SOURCE_DIR" not in message


@pytest.mark.parametrize(
	"fault, wanted",
	[
		(dict(release="2025.1.0"), "is version 2025.1.0, but"),
		(dict(version="2026.1.0"), "give the sources of 2026.1.0"),
		(dict(digits="33"), "computes with 33 decimal digits; hexmembrane needs the double-precision build"),
		(dict(features="OPENMP MASK_ARBITRARY"), "ENABLE_MASK_ARBITRARY=OFF"),
		(dict(features="OPENMP VECTORIZE"), "VECTORIZE=OFF"),
		(dict(features="OPENMP ASAN"), "ENABLE_ASAN=OFF"),
		(dict(features="LOGGER"), "built without OPENMP"),
		(dict(features="OPENMP TELEPATHY"), "unknown feature TELEPATHY"),
		(dict(program="#!/bin/sh\necho yade\n"), "does not state its features"),
		(dict(library=False), "libyade.so, where this program loads"),
		(dict(source=False), "YADE_SOURCE_DIR is not given"),
	],
)
def test_faultIsRefused(configure, fault, wanted):
	assert wanted in configure(**fault)


@pytest.mark.parametrize("file", ["RELEASE", "core/Scene.hpp"])
def test_incompleteSource(configure, file):
	"""A folder that is no source tree of YADE is named together with what is missing in it."""
	assert "there is no %s in it" % file in configure(without=file)


def test_missingProgram(tmp_path):
	result = subprocess.run([shutil.which("cmake"), "-DYADE_EXECUTABLE=%s" % (tmp_path / "none"), "-P", str(MODULE)], capture_output=True, text=True, timeout=60)
	assert result.returncode != 0 and "there is no such file" in " ".join(result.stderr.split())
