// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/ContactStore.hpp"
#include "kernels/boundary/CylinderContact.hpp"
#include "kernels/boundary/PlatenContact.hpp"

#include <functional>
#include <vector>

namespace hexmembrane {

/// A boundary of the compact tier: a platen or the inside of an upright cylinder, moving as told.
struct FlatBoundary {
	enum class Kind { platen, cylinder };
	Kind kind;
	SolidCylinder solid; ///< a platen; of a cylinder: centre, radius and half height
	Vec3 velocity, spin;
	int material; ///< index in the table of materials

	struct Touch {
		double u; ///< overlap, negative: gap
		Vec3 normal, point;
	};
	Touch touch(const Place& sphere) const
	{
		if (kind == Kind::platen) {
			const PlatenContact found = platenContact(solid, sphere.centre, sphere.radius);
			return {found.penetration, found.normal, found.point};
		}
		const CylinderContact found = cylinderContact(solid.centre, solid.radius, sphere.centre, sphere.radius);
		// a sphere beyond the wall's end, or on its axis, meets nothing
		const bool beside = std::abs(sphere.centre[2] - solid.centre[2]) <= solid.halfHeight && found.normal != Vec3::Zero();
		return {beside ? found.penetration : -sphere.radius, found.normal, found.point};
	}
	/// Whether the sphere can touch within the next `gap` of relative motion.
	bool near(const Place& sphere, double gap) const
	{
		Place grown = sphere;
		grown.radius += gap;
		if (kind == Kind::platen) return touch(grown).u >= 0;
		return cylinderContact(solid.centre, solid.radius, sphere.centre, grown.radius).penetration >= 0 &&
		       std::abs(sphere.centre[2] - solid.centre[2]) <= solid.halfHeight + gap;
	}
};

/// What a boundary receives in a step: load about its centre, summed normal forces (N) and normal stiffnesses (N/m) of its contacts.
struct alignas(64) BoundaryLoad {
	Load load = noLoad();
	double normalForce = 0, normalStiffness = 0;
	SweepSums sums;

	BoundaryLoad& operator+=(const BoundaryLoad& other)
	{
		load += other.load;
		normalForce += other.normalForce;
		normalStiffness += other.normalStiffness;
		sums += other.sums;
		return *this;
	}
};

/// Contacts of one boundary with the spheres near it, by the full law. The boundary is body 1.
class BoundaryContacts {
public:
	using LawOfSphere = std::function<LawOfKind(int)>;

	/// New list of spheres that are near; memories of the old one move over, see PairContacts::rebuild.
	void rebuild(std::vector<int> near, const std::vector<int>& newIndex, const std::vector<Frictions>& frictions, const LawOfSphere& law);

	/// One step of the spheres from .. to - 1: their loads are added, what the boundary receives is added to `received`.
	void sweep(int from, int to, const FlatBoundary& boundary, const std::vector<Place>& places, const std::vector<Motion>& motions,
	           std::vector<Load>& loads, double dt, BoundaryLoad& received);

	/// Summed stiffness along a unit vector: sum of kn c^2 + ks (1 - c^2), c the cosine between normal and vector (N/m).
	double stiffness(const Vec3& along) const;
	double energy(const FlatBoundary& boundary, const std::vector<Place>& places) const;

	template <typename Visit>
	void forEachTouching(Visit&& visit) const
	{
		for (std::size_t c = 0; c < spheres.size(); ++c)
			if (store.bits[c]) visit(spheres[c], store.get(int(c)), store.bits[c]);
	}
	/// Calls visit(sphere) for every listed one.
	template <typename Visit>
	void forEachNear(Visit&& visit) const
	{
		for (int i : spheres) visit(i);
	}
	bool restore(int sphere, const ContactMemory& memory, unsigned char bit);
	int size() const { return int(spheres.size()); }

private:
	std::vector<int> spheres; ///< ascending
	ContactStore store;
};

} // namespace hexmembrane
