// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/BodyContainer.hpp>
#include <core/Scene.hpp>

namespace yade {

//! The body, or nothing when it was erased.
inline const Body* livingBody(const BodyContainer& bodies, Body::id_t id)
{
	return id >= 0 && id < static_cast<Body::id_t>(bodies.size()) ? bodies[id].get() : nullptr;
}

//! One comparison for three components: false for NaN and infinity, and for squares that overflow, which no force in a scene does.
inline bool isFinite(const Vector3r& v) { return v.squaredNorm() < std::numeric_limits<Real>::infinity(); }

[[noreturn]] inline void throwNotFinite(const string& what, Body::id_t id, const Scene& scene)
{
	throw std::runtime_error(what + " on body " + std::to_string(id) + " is not finite at iteration " + std::to_string(scene.iter) +
	                         ": the run has lost its stability; fix: load the last checkpoint and use a shorter time step");
}

} // namespace yade
