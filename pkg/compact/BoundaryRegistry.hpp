// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/boundary/BoundaryShape.hpp"

#include <core/Body.hpp>
#include <core/Shape.hpp>

#include <functional>
#include <typeindex>
#include <unordered_map>

namespace yade {

/*! Shapes of boundaries that the compact tier knows, each with what makes a kernel's boundary of a body. */
class BoundaryRegistry {
public:
	using Make = std::function<std::shared_ptr<const hexmembrane::BoundaryShape>(const Shape&, const State&)>;
	//! None for a shape that is no boundary of the compact tier.
	static const Make* find(const Shape& shape)
	{
		const auto found = all().find(typeid(shape));
		return found == all().end() ? nullptr : &found->second;
	}
	static std::unordered_map<std::type_index, Make>& all()
	{
		static std::unordered_map<std::type_index, Make> makers;
		return makers;
	}
};

/*! Tells the compact tier of a shape, once, beside the shape's class:
 *
 *   const CompactBoundary<Platen> known([](const Platen& shape, const State& state) { return boundaryShape(...); });
 *
 * The function checks that the shape is complete. */
template <class ShapeType>
struct CompactBoundary {
	template <class Make>
	explicit CompactBoundary(Make make)
	{
		BoundaryRegistry::all()[typeid(ShapeType)] = [make](const Shape& shape, const State& state) {
			return std::shared_ptr<const hexmembrane::BoundaryShape>(make(static_cast<const ShapeType&>(shape), state));
		};
	}
};

} // namespace yade
