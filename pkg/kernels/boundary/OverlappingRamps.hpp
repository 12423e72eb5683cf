// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"
#include "kernels/boundary/PlatenServo.hpp"

#include <vector>

namespace hexmembrane {

/* A target that may change at any time and is followed smoothly: each change is a ramp of its own (rampWeight) from the moment that it is made, and ramps
 * that run together add up. So a single change is one cosine; the followed value and its slope have no jump whatever is asked for; and a target that moves
 * all the time is followed half a duration behind. Were a running ramp begun anew by each change, such a target would not be followed at all. */

/// A change of the target that is under way, as three numbers that the caller can save: its size, its age (s) and its duration (s, > 0).
using Ramp = Vec3;

/// What the running ramps keep the followed value from the target, `ahead` (s) from now: it is target - stillToCome.
inline double stillToCome(const std::vector<Ramp>& ramps, double ahead)
{
	double sum = 0;
	for (const Ramp& ramp : ramps) sum += ramp[0] * (1 - rampWeight(ramp[1] + ahead, ramp[2]));
	return sum;
}

/// Adds a change. One that follows another within a thousandth of the duration is counted as made with it: it misses 2.5e-6 of its ramp, and a target that
/// is set in every one of a million steps makes no million ramps. Without a duration the change is made at once.
inline void addRamp(std::vector<Ramp>& ramps, double size, double duration)
{
	if (!(duration > 0)) return;
	if (!ramps.empty() && ramps.back()[2] == duration && ramps.back()[1] < 1e-3 * duration)
		ramps.back()[0] += size;
	else
		ramps.emplace_back(size, 0, duration);
}

/// Lets the time dt (s) pass; ramps that have ended go.
inline void advanceRamps(std::vector<Ramp>& ramps, double dt)
{
	std::size_t running = 0;
	for (Ramp ramp : ramps) {
		ramp[1] += dt;
		if (ramp[1] < ramp[2]) ramps[running++] = ramp;
	}
	ramps.resize(running);
}

} // namespace hexmembrane
