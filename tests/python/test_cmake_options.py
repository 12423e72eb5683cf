# SPDX-License-Identifier: GPL-2.0-or-later
"""CMake's options do what they say, and refuse what they cannot do."""

import json
import os
import pathlib
import re
import shutil
import subprocess

import hexmembrane
import pytest

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
MODULES = CHECKOUT / "scripts" / "cmake"


def cache(build):
	"""CMake's variables of a build folder."""
	return dict(re.findall(r"^(\w+):\w+=(.*)$", (pathlib.Path(build) / "CMakeCache.txt").read_text(), re.MULTILINE))


@pytest.fixture(scope="module")
def commands(tmp_path_factory):
	"""The compiler's command of each file, for kernels alone with warnings as errors and the set v3: [(object, command)]."""
	build = tmp_path_factory.mktemp("build")
	options = ["-DHEXMEMBRANE_PLUGIN=OFF", "-DHEXMEMBRANE_WERROR=ON", "-DHEXMEMBRANE_SIMD=v3"]
	subprocess.run(["cmake", "-S", str(CHECKOUT), "-B", str(build), "-G", "Ninja", *options], check=True, capture_output=True, timeout=300)
	return [(entry["output"], entry["command"]) for entry in json.loads((build / "compile_commands.json").read_text())]


def test_oneVersion():
	"""CMake's is that of the Python package, which states it."""
	assert cache(os.environ["HEXMEMBRANE_BUILD"])["CMAKE_PROJECT_VERSION"] == hexmembrane.__version__


def test_warningsAreErrorsWhenAsked(commands):
	assert commands and all("-Werror" in command for _, command in commands)
	assert cache(os.environ["HEXMEMBRANE_BUILD"])["HEXMEMBRANE_WERROR"] == ("ON" if os.environ.get("CI") == "true" else "OFF")


def test_kernelsAloneNeedNoYade(commands):
	assert commands and not any("hexmembrane.dir" in output or "-DYADE" in command for output, command in commands)


def test_markedFilesAreCompiledForEachSet(commands):
	"""The plugin's set is v3, which is one of the tests' sets as well: three objects of each marked file, one of each other."""
	for source in CHECKOUT.glob("pkg/kernels/*/*.cpp"):
		objects = {output: command for output, command in commands if output.endswith("%s.o" % source.relative_to(CHECKOUT))}
		sets = sorted(name for command in objects.values() for name in re.findall(r"-DHEXMEMBRANE_SIMD_(\w+)", command))
		marked = "HEXMEMBRANE_WIDEST" in source.read_text()
		assert (len(objects), sets) == ((3, ["DEFAULT", "V3", "V4"]) if marked else (1, [])), source


@pytest.mark.parametrize(
	"module, options, wanted",
	[
		("InstructionSets", {"HEXMEMBRANE_SIMD": "v5"}, "HEXMEMBRANE_SIMD = v5: no such instruction set; fix: auto, default, v3 or v4"),
		("Sanitizers", {"HEXMEMBRANE_SANITIZE": "thread", "HEXMEMBRANE_PLUGIN": "ON"}, "HEXMEMBRANE_SANITIZE = thread: YADE, built without it"),
	],
)
def test_refused(module, options, wanted):
	definitions = ["-D%s=%s" % option for option in options.items()]
	# as a script, for which the checks come early enough
	result = subprocess.run([shutil.which("cmake"), *definitions, "-P", str(MODULES / (module + ".cmake"))], capture_output=True, text=True, timeout=60)
	assert result.returncode != 0 and wanted in " ".join(result.stderr.split())
