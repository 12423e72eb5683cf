# SPDX-License-Identifier: GPL-2.0-or-later
"""What the membrane itself carries, and the deviatoric stress of the soil without it.

**Axial.** Cut the upper half free: soil and membrane between the horizontal plane at mid-height and one just inside the O-ring rows. Along
the axis act, upward positive: the soil below, N; the membrane below, -T_mid (tension pulls down); the platen, -F; the membrane above,
+T_end; the applied forces of the confining pressure, -P. The membrane has no friction on the platen's side; what it presses on the
platen's edge is in F. At rest

	N = F + P + T_mid - T_end,	axial stress of the soil = N/Am

F, P and T_end are the means over both halves; Am is the mean area V/h, as in the raw q. P is read from the forces that the pressure
engine applies. On a surface that is Am wide at mid-height and Ae at the platen it would be sigma3 (Am - Ae), which is what the raw q
has; but the rows beside the platens take horizontal forces only, and it is there that a sagging membrane draws in from the platen's
radius: in a consolidated specimen of 1,000 grains (examples/paper/schemes.md) sigma3 (Am - Ae) is -14.7 N, P -1.4 N, of F = 125 N.
With P the balance closes to 0.02 N of 120 N against the contacts that cross the plane, in three such states at rest; in shear inertia
is left, up to 2 %. N counts a contact of membrane and grain across the plane whole; a mean stress of the soil alone
(:mod:`hexmembrane.measure.profile`) counts it to the contact point and lies 3 % lower for R/r = 0.8.

F is what the soil presses on the platen: the O-rings are held on their own, so that a pull that runs unchanged from one O-ring to the
other (T_mid = T_end) is not in F and takes nothing off. A laboratory's load cell has the O-rings' pull in it and would show F - T_end;
against that reading the axial correction is -T_mid/Am.

**Radial.** The membrane's own tension presses on the soil beside the applied pressure: ``sigma3_membrane``, the sheet's forces on the
main body's particles towards the axis over the area that the transmitted pressure is counted on. At rest transmitted = applied +
membrane.

	q_corrected = N/Am - (sigma3_applied + sigma3_membrane)

The correction that is usually quoted, 4 E t eps1/D (taken off a laboratory's q), is -T_mid/Am of a membrane that is glued to the soil,
stays straight and is strained uniaxially. Ours sags between the grains, which stretches it, is held by the O-rings and slides on the
soil: at eps1 = 6 % of the specimen above (E t = 600 N/m, D = 39 mm) the usual formula gives +3.7 kPa, and -T_mid/Am is -5.3 kPa: the
membrane still pulls. Its share in the pressure, sigma3_membrane, is +3.2 kPa. The usual formula does not describe such a membrane.

A rigid wall has no membrane: the terms are zero and q_corrected is q; friction on the wall is not corrected.
"""

from hexmembrane.scene.membrane_loads import MembraneLoads


def columns(loads: MembraneLoads):
	"""The loads as columns of the records."""
	return {
		"pressure_axial": loads.axialPush,
		"membrane_axial_mid": loads.axialPullMiddle,
		"membrane_axial_end": loads.axialPullEnd,
		"sigma3_membrane": loads.radialPressure,
	}


def correctedStress(force, pressure, area, loads: MembraneLoads):
	"""q_corrected [Pa].

	:param force: F, mean of the platens' forces [N].
	:param pressure: sigma3 applied [Pa].
	:param area: Am [m2].
	:param loads: what the membrane carries; all 0 without one.
	"""
	soil = force + loads.axialPush + loads.axialPullMiddle - loads.axialPullEnd
	return soil / area - (pressure + loads.radialPressure)
