// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/boundary/OverlappingRamps.hpp"

#include <lib/base/Math.hpp>

namespace yade {

/* The pressure of an engine on its way to the one that is asked for: every change takes `duration` (s), as a cosine. `target` is what was asked for at the last
 * step (Pa), 0 before the first. */

//! Once a step, before the pressure is used: lets `dt` pass and notices a change.
inline void followPressure(Real wanted, Real duration, Real dt, Real& target, vector<Vector3r>& ramps)
{
	hexmembrane::advanceRamps(ramps, dt);
	hexmembrane::addRamp(ramps, wanted - target, duration);
	target = wanted;
}

//! The pressure of the last step (Pa); without ramps what is asked for, also between steps.
inline Real rampedPressure(Real wanted, Real duration, Real target, const vector<Vector3r>& ramps)
{
	return (duration > 0 || !ramps.empty() ? target : wanted) - hexmembrane::stillToCome(ramps, 0);
}

} // namespace yade
