// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "RequireFunctors.hpp"

#include <core/InteractionLoop.hpp>
#include <core/Scene.hpp>
#include <pkg/common/Collider.hpp>

namespace yade {

namespace {

template <typename Functors>
bool knows(const Functors& functors, const string& shape)
{
	for (const auto& functor : functors)
		for (const string& type : functor->getFunctorTypes())
			if (type == shape) return true;
	return false;
}

} // namespace

void requireFunctors(const Scene& scene, const string& shape, const string& who)
{
	for (const auto& engine : scene.engines) {
		const auto* collider = dynamic_cast<const Collider*>(engine.get());
		if (collider && !knows(collider->boundDispatcher->functors, shape))
			throw std::runtime_error(who + ": the collider has no bound functor for a " + shape + ", which would meet nothing; fix: add Bo1_" +
			                         shape + "_Aabb()");
		const auto* loop = dynamic_cast<const InteractionLoop*>(engine.get());
		if (loop && !knows(loop->geomDispatcher->functors, shape))
			throw std::runtime_error(who + ": InteractionLoop has no geometry functor for a " + shape +
			                         ", which would meet nothing; fix: add Ig2_" + shape + "_Sphere_ScGeom()");
	}
}

} // namespace yade
