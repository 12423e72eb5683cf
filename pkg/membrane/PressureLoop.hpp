// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Check.hpp"
#include "kernels/base/IntegralController.hpp"

#include <core/Scene.hpp>

#include <functional>

namespace yade {

/*! Closed loop of an engine that presses on a membrane: an integral controller of the factor on its pressure, T df/dt = (target - transmitted)/target.
 * Its speed is the time constant T alone, whatever the time step and the size of the membrane's particles are. */
struct PressureLoop {
	const string who;
	const Real timeConstant; //!< T (s), infinite: open
	const Real low, high;    //!< limits of the factor
	Real &factor, &transmitted;
	bool& saturated;
	Real& lastTime; //!< of the last correction (s), NaN: none yet

	//! Corrections within a time constant.
	static constexpr Real corrections = 20;

	bool closed() const { return timeConstant < std::numeric_limits<Real>::infinity(); }

	void require(Real dt) const
	{
		if (!(timeConstant > 0)) hexmembrane::reject(who + ".timeConstant", timeConstant, "must be positive", "a time in s, or inf for an open loop");
		if (closed() && dt > 0.5 * timeConstant)
			hexmembrane::reject(who + ".timeConstant", timeConstant, "is shorter than two time steps",
			                    "a longer one, 1000 steps of " + hexmembrane::formatNumber(dt) + " s, say");
	}

	//! Corrects the factor when a correction is due.
	void close(const Scene& scene, Real target, const std::function<Real()>& measure) const
	{
		if (!closed()) return;
		const Real elapsed = scene.time - lastTime;
		if (elapsed >= 0 && elapsed < timeConstant / corrections * (1 - 1e-9)) return;
		lastTime = scene.time;
		transmitted = measure();
		if (!(elapsed >= 0)) return; // the first step, or the clock was set back: it counts from here
		factor = hexmembrane::correctedFactor(factor, elapsed / timeConstant, target, transmitted, low, high, saturated);
	}
};

} // namespace yade
