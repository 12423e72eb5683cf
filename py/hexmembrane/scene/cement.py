# SPDX-License-Identifier: GPL-2.0-or-later
"""Cement between the grains of a test's scene: the engine of bonds, and the moment at which they are made."""

import yade
from yade import O

from hexmembrane.scene import builder


def bondGrains(config, scene, say):
	"""Bond the grains as the section ``cement`` says, once, and lower the time step where the bonds ask for it; nothing without cement.

	:param scene: the :class:`hexmembrane.scene.handles.Scene`. :param say: takes lines of the log.
	:returns: whether bonds were made.
	:raises ValueError: no two grains are near enough, or ``numerics.dt`` is above the critical step with bonds.
	"""
	keys = config.cement
	if not keys.given or scene.cement is not None:
		return False
	cement = yade.GrainBonds(**keys.properties())
	made = cement.bond(scene.grainIds(), keys.gap)
	if made == 0:
		raise ValueError(f"cement.gap = {keys.gap:g} m: no two grains are nearer; fix: a larger gap, or cement.when: consolidated, or a packing under specimen.stress")
	scene.addCement(cement)
	say(f"cement: {made} bonds between {len(scene.grainIds())} grains")
	if O.iter > 0:  # before the first step there are no contacts, and the loop knows no bodies
		builder.checkTimeStep(config, scene, say)
	return True
