# SPDX-License-Identifier: GPL-2.0-or-later
"""What the membrane itself carries, and the deviatoric stress of the soil without it.

**Axial.** Cut the upper half free: soil and membrane between the horizontal plane at mid-height and one just inside the O-ring rows. Along
the axis act, upward positive: the soil below, N; the membrane below, -T_mid (tension pulls down); the platen, -F; the membrane above,
+T_end; the confining pressure on a surface that is Am wide at mid-height and Ae at the platen, -sigma3 (Am - Ae). The membrane has no
friction on the platen's side, and the forces on its rows beside the platen are horizontal. At rest

	N = F + sigma3 (Am - Ae) + T_mid - T_end,	axial stress of the soil = N/Am

F and T_end are the means over both ends, that is over both halves; Am is the mean area V/h, as in the raw q. N/Am is the record's
``axial_stress`` plus (T_mid - T_end)/Am. F is what the soil presses on the platen: the O-rings are held on their own, so that a pull
that runs unchanged from one O-ring to the other (T_mid = T_end) is not in F and takes nothing off. A laboratory's load cell has the
O-rings' pull in it and would show F - T_end; against that reading the axial correction is -T_mid/Am.

**Radial.** The membrane's own tension presses on the soil beside the applied pressure: ``sigma3_membrane``, the bonds' forces on the
main body's particles towards the axis over the area that the transmitted pressure is counted on. At rest transmitted = applied +
membrane.

	q_corrected = axial stress of the soil - (sigma3_applied + sigma3_membrane)

The correction that is usually quoted, 4 E t eps1/D (taken off a laboratory's q), is -T_mid/Am of a membrane that is glued to the soil,
stays straight and is strained uniaxially. Ours is held by the O-rings, bulges with the soil and slides on it without friction.

A rigid wall has no membrane: the terms are zero and q_corrected is q; friction on the wall is not corrected.
"""

import numpy

#: Values of the columns where there is no membrane.
NONE = {"membrane_axial_mid": 0.0, "membrane_axial_end": 0.0, "sigma3_membrane": 0.0}


def endHeights(membrane):
	"""Heights [m] of the planes midway between the innermost O-ring row and the row inside it, at the lower and the upper end."""
	rows = numpy.array(membrane.positions)[:, 2].reshape(membrane.rings, membrane.perRing).mean(axis=1)
	k = membrane.oRingRows
	return 0.5 * float(rows[k - 1] + rows[k]), 0.5 * float(rows[-k] + rows[-k - 1])


def terms(membrane, bonds, bottom, top):
	"""The membrane's axial tension [N] at mid-height and at the O-rings, and its share [Pa] of the pressure on the soil, as a dict of columns.

	:param membrane: a HexMembrane with O-ring rows. :param bonds: its MembraneBonds, a step run. :param bottom: height of the bottom
	platen's face [m]. :param top: of the top platen's [m].
	"""
	return {
		"membrane_axial_mid": bonds.axialTension(0.5 * (bottom + top)),
		"membrane_axial_end": sum(bonds.axialTension(z) for z in endHeights(membrane)) / 2,
		"sigma3_membrane": bonds.radialShare(3),
	}


def corrected(axialStress, pressure, area, found):
	"""q_corrected [Pa].

	:param axialStress: raw, from the platens' force [Pa]. :param pressure: sigma3 applied [Pa]. :param area: Am [m2].
	:param found: the columns of :func:`terms`, or NONE.
	"""
	pull = (found["membrane_axial_mid"] - found["membrane_axial_end"]) / area
	return axialStress + pull - (pressure + found["sigma3_membrane"])
