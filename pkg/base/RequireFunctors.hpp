// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Scene.hpp>

namespace yade {

//! Refuses a scene whose collider or InteractionLoop has no functor for bodies of this shape: they would meet nothing, without a word.
//! \throws std::runtime_error
void requireFunctors(const Scene& scene, const std::string& shape, const std::string& who);

} // namespace yade
