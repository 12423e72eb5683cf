# SPDX-License-Identifier: GPL-2.0-or-later
"""Every GoogleTest case of the kernels as a test of its own, over the plugin's kernels and over those of each instruction set.

The programs share the tests and differ in the set that the marked loops (Simd.hpp) are compiled for. A set that this processor
lacks is skipped.
"""

import os
import pathlib
import re
import subprocess

import pytest

_BUILD = os.environ.get("HEXMEMBRANE_BUILD", "")
_PLUGINS = "kernel_tests"
#: program: registers and instructions that its kernels use, and such that they must not use
_SETS = {
	"kernel_tests_default": (r"\bmulpd\b.*%xmm", r"%[yz]mm"),
	"kernel_tests_v3": (r"\bvfn?m(add|sub)[0-9]+pd\b.*%ymm", r"%zmm|%k[1-7]|%[xy]mm(1[6-9]|2[0-9]|3[01])"),
	"kernel_tests_v4": (r"%zmm|%k[1-7]|%[xy]mm(1[6-9]|2[0-9]|3[01])", None),
}


_CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
#: Suites of kernels without a marked loop, which are the same objects in all programs; the packer's take longer than all others together.
_PACKER = ("SpherePacking.", "StressedPacking.")


def _isTheSameInAllSets(case):
	return case.startswith(_PACKER) and not any("HEXMEMBRANE_WIDEST" in file.read_text() for file in _CHECKOUT.glob("pkg/kernels/packing/*"))


def _listing():
	"""(suite with its point, type of a typed suite, test) of all cases."""
	program = os.path.join(_BUILD, _PLUGINS)
	if not os.path.isfile(program):
		return
	suite, kind = "", ""
	for line in subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout.splitlines():
		name, _, remark = (part.rstrip() for part in line.partition("#"))
		if not name or name.startswith("Running main"):
			continue
		if name.startswith("  "):
			yield suite, kind, name.strip()
		else:
			suite, kind = name, remark.partition("TypeParam = ")[2]


def _cases():
	return [suite + test for suite, _, test in _listing()]


def _namesInCTest():
	"""CMake names the cases of a typed suite by the type, where GoogleTest numbers it."""
	return [f"{suite.split('/')[0]}.{test}<{kind}>" if kind else suite + test for suite, kind, test in _listing()]


def test_kernelTestsWereBuilt():
	assert _cases(), "no kernel_tests with any test in HEXMEMBRANE_BUILD = %r" % _BUILD


@pytest.mark.parametrize("program, case", [(p, c) for c in _cases() for p in (_PLUGINS, *_SETS) if p == _PLUGINS or not _isTheSameInAllSets(c)])
def test_kernel(program, case):
	run = subprocess.run([os.path.join(_BUILD, program), "--gtest_filter=" + case, "--gtest_brief=1"], capture_output=True, text=True, timeout=600)
	assert run.returncode == 0, run.stdout + run.stderr
	lacking = re.search("this processor lacks .*", run.stdout)
	if lacking:
		pytest.skip(lacking.group())
	# A filter that matches nothing succeeds as well.
	assert "1 test from 1 test suite ran" in run.stdout, run.stdout


@pytest.mark.parametrize("program", _SETS)
def test_kernelsAreOfTheSet(program):
	"""The sets' programs are not four copies of one."""
	code = subprocess.run(["objdump", "--disassemble", "--no-show-raw-insn", os.path.join(_BUILD, program)], capture_output=True, text=True, check=True).stdout
	wanted, unwanted = _SETS[program]
	assert re.search(wanted, code)
	assert not (unwanted and re.search(unwanted, code))


def test_ctestFindsTheCases():
	"""What a developer without pytest runs; a name has the program before it."""
	listing = subprocess.run(["ctest", "--test-dir", _BUILD, "--show-only"], capture_output=True, text=True, check=True).stdout
	named = set(re.findall(r"Test +#\d+: (.+)", listing))
	assert named == {"%s/%s" % (program, case) for program in [_PLUGINS, *_SETS] for case in _namesInCTest()}
