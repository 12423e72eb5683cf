# SPDX-License-Identifier: GPL-2.0-or-later
"""Cement between the grains of a test's scene: the engine of bonds, and the moment at which they are made."""

import yade


def bondGrains(config, scene, say):
	"""Bond the grains as the section ``cement`` says, once; nothing without cement.

	:param scene: the :class:`hexmembrane.scene.handles.Scene`. :param say: takes lines of the log.
	:returns: whether bonds were made.
	:raises ValueError: no two grains are near enough.
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
	return True
