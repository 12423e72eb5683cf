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
(:mod:`hexmembrane.profile`) counts it to the contact point and lies 3 % lower for R/r = 0.8.

F is what the soil presses on the platen: the O-rings are held on their own, so that a pull that runs unchanged from one O-ring to the
other (T_mid = T_end) is not in F and takes nothing off. A laboratory's load cell has the O-rings' pull in it and would show F - T_end;
against that reading the axial correction is -T_mid/Am.

**Radial.** The membrane's own tension presses on the soil beside the applied pressure: ``sigma3_membrane``, the bonds' forces on the
main body's particles towards the axis over the area that the transmitted pressure is counted on. At rest transmitted = applied +
membrane.

	q_corrected = N/Am - (sigma3_applied + sigma3_membrane)

The correction that is usually quoted, 4 E t eps1/D (taken off a laboratory's q), is -T_mid/Am of a membrane that is glued to the soil,
stays straight and is strained uniaxially. Ours sags between the grains, which stretches it, is held by the O-rings and slides on the
soil: at eps1 = 6 % of the specimen above (E t = 600 N/m, D = 39 mm) the usual formula gives +3.7 kPa, and -T_mid/Am is -5.3 kPa: the
membrane still pulls. Its share in the pressure, sigma3_membrane, is +3.2 kPa. The usual formula does not describe such a membrane.

A rigid wall has no membrane: the terms are zero and q_corrected is q; friction on the wall is not corrected.
"""

import numpy

#: Values of the columns where there is no membrane.
NONE = {"pressure_axial": 0.0, "membrane_axial_mid": 0.0, "membrane_axial_end": 0.0, "sigma3_membrane": 0.0}


def endHeights(membrane):
	"""Heights [m] of the planes midway between the innermost O-ring row and the row inside it, at the lower and the upper end."""
	rows = numpy.array(membrane.positions)[:, 2].reshape(membrane.rings, membrane.perRing).mean(axis=1)
	k = membrane.oRingRows
	return 0.5 * float(rows[k - 1] + rows[k]), 0.5 * float(rows[-k] + rows[-k - 1])


def axialPush(z, force, middle):
	"""P [N]: axial parts of applied forces towards mid-height, mean of both halves.

	:param z: heights of the loaded points [m]. :param force: axial parts of the forces on them [N]. :param middle: mid-height [m].
	"""
	return 0.5 * float(force[z < middle].sum() - force[z >= middle].sum())


def terms(membrane, bonds, pressing, bottom, top):
	"""P, the membrane's axial tension [N] at mid-height and at the O-rings, and its share [Pa] of the pressure on the soil, as a dict of columns.

	:param membrane: a HexMembrane with O-ring rows. :param bonds: its MembraneBonds, a step run. :param pressing: its MembranePressure.
	:param bottom: height of the bottom platen's face [m]. :param top: of the top platen's [m].
	"""
	middle = 0.5 * (bottom + top)
	applied = numpy.array([force[2] for force in pressing.forces()])
	return {
		"pressure_axial": axialPush(numpy.array(membrane.positions)[:, 2], applied, middle),
		"membrane_axial_mid": bonds.axialTension(middle),
		"membrane_axial_end": sum(bonds.axialTension(z) for z in endHeights(membrane)) / 2,
		"sigma3_membrane": bonds.radialShare(3),
	}


def corrected(force, pressure, area, found):
	"""q_corrected [Pa].

	:param force: F, mean of the platens' forces [N]. :param pressure: sigma3 applied [Pa]. :param area: Am [m2].
	:param found: the columns of :func:`terms`, or NONE.
	"""
	inSoil = force + found["pressure_axial"] + found["membrane_axial_mid"] - found["membrane_axial_end"]
	return inSoil / area - (pressure + found["sigma3_membrane"])
