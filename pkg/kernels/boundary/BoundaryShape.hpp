// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Place.hpp"

#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

namespace hexmembrane {

/// Where a boundary and a sphere meet.
struct BoundaryTouch {
	double overlap; ///< (m), negative: gap
	Vec3 normal;    ///< unit vector from the boundary to the sphere
	Vec3 point;     ///< half way through the overlap
};

/// Shape and place of a rigid boundary, as the compact tier sees it. It does not change: a boundary that moves gets a new one.
class BoundaryShape {
public:
	virtual ~BoundaryShape() = default;
	virtual BoundaryTouch touch(const Place& sphere) const = 0;
	/// The same of several spheres.
	virtual void touch(const int* spheres, int count, const Place* places, BoundaryTouch* found) const = 0;
	/// Whether the sphere can touch within the next `gap` (m) of relative motion.
	virtual bool near(const Place& sphere, double gap) const = 0;
	/// Bound from above of the way (m) of every point of its surface since it was `then`, of the same class.
	virtual double wayFrom(const BoundaryShape& then) const = 0;
	/// All that it is, and one of the same class from that: for a saved state.
	virtual std::vector<double> numbers() const = 0;
	virtual std::shared_ptr<const BoundaryShape> from(const std::vector<double>& numbers) const = 0;
};

/// A boundary from a plain struct of doubles with touch(sphere), near(sphere, gap) and wayFrom(then).
template <class Shape>
class BoundaryOf : public BoundaryShape {
public:
	explicit BoundaryOf(const Shape& s) : shape(s) {}
	BoundaryTouch touch(const Place& sphere) const override { return shape.touch(sphere); }
	void touch(const int* spheres, int count, const Place* places, BoundaryTouch* found) const override
	{
		for (int k = 0; k < count; ++k) found[k] = shape.touch(places[spheres[k]]);
	}
	bool near(const Place& sphere, double gap) const override { return shape.near(sphere, gap); }
	double wayFrom(const BoundaryShape& then) const override { return shape.wayFrom(static_cast<const BoundaryOf&>(then).shape); }
	std::vector<double> numbers() const override
	{
		std::vector<double> all(sizeof(Shape) / sizeof(double));
		std::memcpy(all.data(), static_cast<const void*>(&shape), sizeof(Shape));
		return all;
	}
	std::shared_ptr<const BoundaryShape> from(const std::vector<double>& all) const override
	{
		if (all.size() * sizeof(double) != sizeof(Shape)) return nullptr;
		Shape other = shape;
		std::memcpy(static_cast<void*>(&other), all.data(), sizeof(Shape));
		return std::make_shared<BoundaryOf>(other);
	}

private:
	static_assert(sizeof(Shape) % sizeof(double) == 0, "a shape is its numbers");
	Shape shape;
};

template <class Shape>
std::shared_ptr<const BoundaryShape> boundaryShape(const Shape& shape)
{
	return std::make_shared<BoundaryOf<Shape>>(shape);
}

} // namespace hexmembrane
