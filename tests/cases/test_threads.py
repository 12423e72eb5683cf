# SPDX-License-Identifier: GPL-2.0-or-later
"""One against several threads on the same scene. YADE's own number is fixed at its start: a YADE with one thread and one with three write their runs."""

import os
import subprocess
import sys

import numpy as np
import pytest
from threadsScene import SCENES

SCENE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "threadsScene.py")


def started(folder, threads):
	"""What the scene writes in a YADE with this many threads: an array for each run by its name."""
	file = str(folder / ("%d.npz" % threads))
	tests = os.path.dirname(os.path.dirname(SCENE))
	launcher = os.path.join(os.path.dirname(tests), "scripts", "setup.d", "launch.py")
	folders = os.path.join(os.path.dirname(tests), "py"), os.path.join(tests, "engines")
	# more threads than cores must not spin
	environment = dict(os.environ, PYTHONPATH=os.pathsep.join(folders), OMP_WAIT_POLICY="passive")
	done = subprocess.run([sys.executable, launcher, str(threads), SCENE, file], env=environment, capture_output=True, text=True, timeout=300)
	assert os.path.isfile(file), done.stdout + done.stderr
	return np.load(file)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
	folder = tmp_path_factory.mktemp("threads")
	return {threads: started(folder, threads) for threads in (1, 3)}


def assertSameToRounding(a, b):
	"""Positions, velocities, spins, forces and torques to 1e-9: rounding of 1e-16 in the order of sums, grown in 300 steps of collisions."""
	for columns in np.split(np.arange(a.shape[1]), 5):
		assert np.isfinite(a[:, columns]).all() and np.abs(a[:, columns]).max() > 0
		assert np.abs(b[:, columns] - a[:, columns]).max() <= 1e-9 * np.abs(a[:, columns]).max()


@pytest.mark.parametrize("scene", ["membrane", "rough membrane"])
def test_referenceTierAgrees(runs, scene):
	"""Every force of the membrane is the same to the last bit for any number of threads; YADE then adds a body's forces from the threads in their order."""
	assertSameToRounding(runs[1]["reference " + scene], runs[3]["reference " + scene])


@pytest.mark.parametrize("scene", SCENES)
def test_compactTierAgrees(runs, scene):
	one, two, three = (runs[3]["compact %s %d" % (scene, threads)] for threads in (1, 2, 3))
	assertSameToRounding(one, two)
	assertSameToRounding(one, three)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("threads", [1, 2, 3])
def test_compactTierRepeatsToTheLastBit(runs, scene, threads):
	name = "compact %s %d" % (scene, threads)
	assert (runs[3][name] == runs[3][name + " again"]).all()


@pytest.mark.parametrize("scene", SCENES)
def test_compactTierGoesOnFromASavedState(runs, scene):
	"""On one thread, to the last bit; it is the one thread of a YADE that has one."""
	assert (runs[3]["compact %s loaded" % scene] == runs[3]["compact %s 1" % scene]).all()
	assert (runs[1]["compact %s 1" % scene] == runs[3]["compact %s 1" % scene]).all()
