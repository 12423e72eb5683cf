// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/ContactStore.hpp"

namespace hexmembrane {

/// The arrays of a sweep over pairs of spheres, see PairContacts::sweep.
struct PairSweep {
	const int *first, *second; ///< spheres of each pair
	ContactStore* store;
	const Place* places;
	const Motion* motions;
	Load* loads;
	Load* spill; ///< for spheres `to` and above
	int to;
	int begin, end; ///< pairs
	double dt;
};

/// One step of the pairs begin .. end - 1. Those that touch are picked out first, without branches that the processor would have to guess, and then
/// taken by as many as a register has lanes; a few at the end of a run, and bonds, one at a time.
SweepSums sweepPairs(const PairSweep& sweep);

} // namespace hexmembrane
