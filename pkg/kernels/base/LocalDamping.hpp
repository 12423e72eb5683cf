// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Lanes.hpp"

namespace hexmembrane {

/// Velocity component after a step of leapfrog with YADE's second-order form of Cundall's local damping, which is judged by the velocity in the middle of the
/// step to come: v + dt a (1 - damping sign(a (v + dt a/2))), a = load/mass. One component, or several side by side.
template <typename V>
HEXMEMBRANE_INLINE V dampedStep(V v, V load, V inverseMass, double dt, double damping)
{
	const V a = load * inverseMass, power = a * (v + 0.5 * dt * a), none = power - power;
	const V lessened = (1 - damping) * a, raised = (1 + damping) * a;
	return v + dt * (power > none ? lessened : (power < none ? raised : a));
}

} // namespace hexmembrane
