# SPDX-License-Identifier: GPL-2.0-or-later
"""One against several threads on the same scene, each in a YADE of its own (its number of threads is fixed at start)."""

import os
import shutil
import subprocess

import numpy as np
import pytest

SCENE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "threadsScene.py")


def run(tmp_path, threads, kind, tag=""):
	file = str(tmp_path / ("%s%d%s.npy" % (kind, threads, tag)))
	program = os.environ.get("YADE_EXECUTABLE") or shutil.which("yade-double")
	tests = os.path.dirname(os.path.dirname(SCENE))
	folders = os.path.join(os.path.dirname(tests), "py"), os.path.join(tests, "engines")
	environment = dict(os.environ, PYTHONPATH=os.pathsep.join(folders))
	done = subprocess.run([program, "-n", "-x", "-j%d" % threads, SCENE, file, kind], env=environment, capture_output=True, text=True, timeout=300)
	assert os.path.isfile(file), done.stdout + done.stderr
	return np.load(file)


@pytest.mark.parametrize("kind", ["membrane", "grains"])
def test_threadsAgree(tmp_path, kind):
	"""Every force of the membrane is the same to the last bit for any number of threads; YADE then adds a body's forces from the threads in their order:
	a relative rounding of 1e-16 a step, grown by 300 steps of an elastic scene."""
	one, three = run(tmp_path, 1, kind), run(tmp_path, 3, kind)
	for columns in (slice(0, 3), slice(3, 6)):
		assert np.isfinite(one[:, columns]).all() and np.abs(one[:, columns]).max() > 0
		assert np.abs(three[:, columns] - one[:, columns]).max() <= 1e-9 * np.abs(one[:, columns]).max()


def test_oneThreadRepeatsExactly(tmp_path):
	assert (run(tmp_path, 1, "grains", "a") == run(tmp_path, 1, "grains", "b")).all()
