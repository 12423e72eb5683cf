// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/BoundaryContacts.hpp"

namespace hexmembrane {

/// The arrays of a sweep over the spheres near a boundary, see BoundaryContacts::sweep.
struct BoundarySweep {
	const Boundary& boundary;
	const int* spheres;
	ContactStore* store;
	const Place* places;
	const Motion* motions;
	Load* loads;
	int begin, end; ///< contacts
	double dt;
};

/// One step of the contacts begin .. end - 1, see Sweep.hpp; what the boundary receives is added to `received`.
void sweepBoundary(const BoundarySweep& sweep, BoundaryLoad& received);

} // namespace hexmembrane
