# SPDX-License-Identifier: GPL-2.0-or-later
"""Every GoogleTest case of the kernels as a test of its own."""

import os
import subprocess

import pytest

_BINARY = os.path.join(os.environ.get("HEXMEMBRANE_BUILD", ""), "kernel_tests")


def _cases():
	if not os.path.isfile(_BINARY):
		return []
	listing = subprocess.run([_BINARY, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout
	cases, suite = [], ""
	for line in listing.splitlines():
		name = line.split("#")[0].rstrip()
		if not name or name.startswith("Running main"):
			continue
		if name.startswith("  "):
			cases.append(suite + name.strip())
		else:
			suite = name
	return cases


def test_kernelTestsWereBuilt():
	assert _cases(), "no kernel_tests with any test in HEXMEMBRANE_BUILD = %r" % os.environ.get("HEXMEMBRANE_BUILD")


@pytest.mark.parametrize("case", _cases())
def test_kernel(case):
	run = subprocess.run([_BINARY, "--gtest_filter=" + case, "--gtest_brief=1"], capture_output=True, text=True, timeout=600)
	assert run.returncode == 0, run.stdout + run.stderr
	# A filter that matches nothing succeeds as well.
	assert "1 test from 1 test suite ran" in run.stdout, run.stdout
