# SPDX-License-Identifier: GPL-2.0-or-later
"""Run by test_threads.py inside YADE with a number of threads: writes the motion and the forces of a specimen after 300 steps, by tier, scene and threads."""

import os
import sys

import hexmembrane  # noqa: F401
import numpy as np
from specimenScene import build
from tiers import forces, loop, run, state
from yade import O

SCENES = {
	"membrane": dict(),
	"membrane with shear": dict(poisson=0.2),
	"rough membrane": dict(membraneFriction=0.3, poisson=0.2, servoTime=4e-4, pressureTime=4e-4),
	"wall": dict(lateral="wall"),
}
HALF = 150


def motion(tier, scene, threads=0, savedTo=None):
	"""State and forces after 2 HALF steps; saved and loaded in the middle when a file is given."""
	O.reset()
	build(tier, spin=0.02, velocity=0.05, substeps=50, **SCENES[scene])
	if tier == "compact":
		loop().ompThreads = threads or -1
	run(HALF)
	if savedTo:
		O.save(savedTo, quiet=True)
		O.reset()
		O.load(savedTo, quiet=True)
	run(HALF)
	return np.hstack([state(), forces()])


if __name__ == "__main__":
	file, found = sys.argv[-1], {}
	for scene in SCENES:
		for threads in range(1, O.numThreads + 1):
			for again in ("", " again"):
				found["compact %s %d%s" % (scene, threads, again)] = motion("compact", scene, threads)
		found["compact %s loaded" % scene] = motion("compact", scene, 1, savedTo=file + ".yade.gz")
	for scene in ("membrane", "rough membrane"):
		found["reference %s" % scene] = motion("reference", scene)
	os.remove(file + ".yade.gz")
	np.savez(file, **found)
