// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/ContactStore.hpp"
#include "kernels/boundary/BoundaryShape.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

namespace hexmembrane {

/// A rigid boundary that moves as told.
struct Boundary {
	std::shared_ptr<const BoundaryShape> shape;
	Vec3 centre;         ///< about which its torque counts (m)
	Vec3 velocity, spin; ///< of its surface (m/s, rad/s about the centre)
	int material;        ///< index in the table of materials
	int mask = ~0;       ///< it meets spheres that have a bit of it
};

/// What a boundary receives in a step: load about its centre, summed normal forces (N) and normal stiffnesses (N/m) of its contacts.
struct alignas(64) BoundaryLoad {
	Load load = noLoad();
	double normalForce = 0, normalStiffness = 0;
	int count = 0; ///< of contacts
	SweepSums sums;

	BoundaryLoad& operator+=(const BoundaryLoad& other)
	{
		load += other.load;
		normalForce += other.normalForce;
		normalStiffness += other.normalStiffness;
		count += other.count;
		sums += other.sums;
		return *this;
	}
};

/// Contacts of one boundary with the spheres near it, by the full law. The boundary is body 1.
class BoundaryContacts {
public:
	using OfSphere = std::function<SpringsOfKind(int)>;

	/// New list of spheres that are near; memories of the old one move over, see PairContacts::rebuild.
	ContactWorks rebuild(std::vector<int> near, const std::vector<int>& newIndex, const std::vector<PairKind<double>>& kinds, const OfSphere& springs);

	/// Other parameters by kind, with friction and rolling resistance where they were.
	void setKinds(const std::vector<PairKind<double>>& kinds) { store.table = kinds; }

	/// One step of the spheres from .. to - 1: their loads are added, what the boundary receives is added to `received`.
	void sweep(int from, int to, const Boundary& boundary, const std::vector<Place>& places, const std::vector<Motion>& motions, std::vector<Load>& loads,
	           double dt, BoundaryLoad& received);

	/// Summed stiffness along a unit vector: sum of kn c^2 + ks (1 - c^2), c the cosine between normal and vector (N/m).
	double stiffness(const Vec3& along) const;
	double energy(const Boundary& boundary, const std::vector<Place>& places) const;

	template <typename Visit>
	void forEachTouching(Visit&& visit) const
	{
		for (std::size_t c = 0; c < spheres.size(); ++c)
			if (store.bits[c]) visit(spheres[c], store.get(int(c)));
	}
	/// Calls visit(sphere) for every listed one.
	template <typename Visit>
	void forEachNear(Visit&& visit) const
	{
		for (int i : spheres) visit(i);
	}
	bool restore(int sphere, const Contact& contact);
	bool has(int sphere) const { return std::binary_search(spheres.begin(), spheres.end(), sphere); }
	int size() const { return int(spheres.size()); }

private:
	std::vector<int> spheres; ///< ascending
	ContactStore store;
};

} // namespace hexmembrane
