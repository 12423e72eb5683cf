// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/BodyContainer.hpp>
#include <core/Scene.hpp>

namespace yade {

//! The body, or nothing when it was erased. Reads the container's own list: its members are calls into another library, which cost as much as the rest.
inline const Body* livingBody(const BodyContainer& bodies, Body::id_t id)
{
	return id >= 0 && id < static_cast<Body::id_t>(bodies.body.size()) ? bodies.body[id].get() : nullptr;
}

//! Asks the memory for what a gather over `ids` reads some particles after `i`. A body's position lies behind two pointers, each a cache miss in a
//! large scene: asking for them ahead, one after the other, makes the loop wait for neither.
inline void prefetchAhead(const BodyContainer& bodies, const vector<Body::id_t>& ids, size_t i)
{
	constexpr size_t farAhead = 32, ahead = 16;
	if (i + farAhead >= ids.size()) return;
	if (const Body* b = livingBody(bodies, ids[i + farAhead])) __builtin_prefetch(&b->state);
	if (const Body* b = livingBody(bodies, ids[i + ahead])) __builtin_prefetch(&b->state->se3.position);
}

//! What ``O`` is in Python.
inline Scene& currentScene() { return *Omega::instance().getScene(); }

//! Calls take(i, state) for the body of every id, in parallel. Returns an index whose body is gone, -1: none; exceptions must not leave a parallel loop.
template <typename Take>
int forEachState(const BodyContainer& bodies, const vector<Body::id_t>& ids, Take&& take)
{
	const int count = static_cast<int>(ids.size());
	int missing = -1;
#pragma omp parallel for schedule(static) reduction(max : missing)
	for (int i = 0; i < count; ++i) {
		prefetchAhead(bodies, ids, i);
		if (const Body* b = livingBody(bodies, ids[i]))
			take(i, static_cast<const State&>(*b->state));
		else
			missing = std::max(missing, i);
	}
	return missing;
}

//! One comparison for three components: false for NaN and infinity, and for squares that overflow, which no force in a scene does.
inline bool isFinite(const Vector3r& v) { return v.squaredNorm() < std::numeric_limits<Real>::infinity(); }

[[noreturn]] inline void throwNotFinite(const string& what, Body::id_t id, const Scene& scene)
{
	throw std::runtime_error(what + " on body " + std::to_string(id) + " is not finite at iteration " + std::to_string(scene.iter) +
	                         ": the run has lost its stability; fix: load the last checkpoint and use a shorter time step");
}

} // namespace yade
