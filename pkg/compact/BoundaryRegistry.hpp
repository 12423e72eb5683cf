// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/boundary/BoundaryShape.hpp"

#include <core/Body.hpp>
#include <core/Shape.hpp>

#include <algorithm>
#include <functional>
#include <typeindex>
#include <unordered_map>

namespace yade {

/*! Shapes of boundaries that the compact tier knows, each with what makes a kernel's boundary of a body. */
class BoundaryRegistry {
public:
	using Make = std::function<std::shared_ptr<const hexmembrane::BoundaryShape>(const Shape&, const State&)>;
	struct Entry {
		string attributes;            //!< that are read in every step
		std::function<string()> name; //!< of the class
		Make make;
	};
	//! None for a shape that is no boundary of the compact tier.
	static const Make* find(const Shape& shape)
	{
		const auto found = all().find(typeid(shape));
		return found == all().end() ? nullptr : &found->second.make;
	}
	static std::unordered_map<std::type_index, Entry>& all()
	{
		static std::unordered_map<std::type_index, Entry> entries;
		return entries;
	}
	static vector<const Entry*> byName()
	{
		vector<const Entry*> sorted;
		for (const auto& entry : all()) sorted.push_back(&entry.second);
		std::sort(sorted.begin(), sorted.end(), [](const Entry* a, const Entry* b) { return a->name() < b->name(); });
		return sorted;
	}
	//! "CylinderWall, Platen"
	static string names()
	{
		string list;
		for (const Entry* entry : byName()) list += (list.empty() ? "" : ", ") + entry->name();
		return list;
	}
};

/*! Tells the compact tier of a shape, once, beside the shape's class, with the attributes that are read in every step:
 *
 *   const CompactBoundary<Platen> known("radius, height", [](const Platen& shape, const State& state) { return boundaryShape(...); });
 *
 * The function checks that the shape is complete. */
template <class ShapeType>
struct CompactBoundary {
	template <class Make>
	CompactBoundary(const string& attributes, Make make)
	{
		const auto makeOf = [make](const Shape& shape, const State& state) {
			return std::shared_ptr<const hexmembrane::BoundaryShape>(make(static_cast<const ShapeType&>(shape), state));
		};
		BoundaryRegistry::all()[typeid(ShapeType)] = {attributes, [] { return ShapeType().getClassName(); }, makeOf};
	}
};

} // namespace yade
