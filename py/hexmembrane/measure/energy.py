# SPDX-License-Identifier: GPL-2.0-or-later
"""The energies of a scene with ``O.trackEnergy``: what is stored, what was dissipated, what the boundaries have put in, and whether it adds up.

Positions, contact forces and the energies made of them belong to one instant. The kinetic energy, and the velocity with which YADE books the
local damping of a whole step, belong to half a step before. What is left of the balance is of first order in the step and small where
little is kinetic.
"""

from yade import O

#: YADE's names of the work that comes in, with a minus sign there, as YADE has it with gravity.
WORK = ("platenWork", "pressureWork", "radialServoWork", "oRingWork", "wallWork")
#: YADE's names of what the membrane stores: in its bonds, by bending, where a fold meets itself, and where grains press on the sheet between its spheres.
MEMBRANE = ("elastMembrane", "elastBending", "elastSelfContact", "elastFacet")
#: YADE's names of what the soil stores: in contacts, and in the bonds of its cement.
SOIL = ("elastPotential", "elastGrainBonds")
#: YADE's names of what contacts dissipate: sliding, rolling, and the elastic energy that breaking bonds set free.
CONTACT_DISSIPATION = ("plastDissip", "rollDissip", "bondDissip")


def current():
	"""Energies [J]: stored elastic, membrane and kinetic; dissipated by contacts and by damping, and work done on the specimen, so far.

	Zeros before the first step that tracked them.
	"""
	tracked = dict(O.energy.items())

	def total(*names):
		return sum(tracked.get(name, 0.0) for name in names)

	return {
		"elastic": total(*SOIL),
		"membrane": total(*MEMBRANE),
		"kinetic": total("kinetic"),
		"friction": total(*CONTACT_DISSIPATION),
		"damping": total("nonviscDamp"),
		"work": -total(*WORK),
	}


def balance(now, start):
	"""(work - change of the stored energy - dissipated energy) since ``start``, over the larger of that work and the energy stored now."""
	since = {name: now[name] - start[name] for name in now}
	scale = max(abs(since["work"]), now["elastic"] + now["membrane"] + now["kinetic"])
	return (2 * since["work"] - sum(since.values())) / scale if scale > 0 else 0.0
