// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"

namespace hexmembrane {

/// The arrays of a step of the grains' motion, see SphereAssembly::moveGrains.
struct GrainMotion {
	Place* places;
	Motion* motions;
	const Load* loads;
	const double *mass, *inertia;
	const unsigned char* fixed;
	Vec3* turned;
	int from, to;
	double dt, damping;
	double limit2; ///< square of the speed (m2/s2) that is too much
	bool energies;
	// Results
	int lost;          ///< index of the first grain that is too fast or not finite, `to`: none
	double fastest2;   ///< square of the largest speed
	double kinetic;    ///< by the velocities before the step (J), if `energies`
	double dampedWork; ///< taken by the damping (J), if `energies`
};

/// Leapfrog with local damping, see LocalDamping.hpp: v += dt a, x += dt v, a component at a time; spins the same with torques and inertia.
void moveGrains(GrainMotion& step);

} // namespace hexmembrane
