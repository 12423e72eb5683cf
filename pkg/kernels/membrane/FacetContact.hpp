// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Place.hpp"
#include "kernels/membrane/PaddedRings.hpp"

#include <array>
#include <functional>
#include <vector>

namespace hexmembrane {

/// Contact of grains with the sheet between the particles of a hexagonal tube: the triangles of their centres, thickened by an offset h. A grain of radius r at
/// c overlaps a triangle whose nearest point P_i is at the distance d_i by o_i = r + h - d_i, and all that it reaches by O = (sum o_i^4)^(1/4). The energy is
/// kn O^2/2, the force of triangle i kn O (o_i/O)^3 along c - P_i, without friction or damping. The three corners take the reaction by P_i's barycentric
/// weights: forces and moments balance, and the forces are minus the gradient of the energy. The nearest triangle alone, O = max o_i, would leave a grain in a
/// hollow between two triangles on a ridge of the force: it would be thrown from one to the other in each step, for ever. Where the centre comes nearer than
/// 2 h to the sheet, O fades to that of the nearest triangle alone, which it is at h: further in a side counts.
///
/// The side counts only for a centre that is past the sheet by less than h, where its nearest point has triangles that act all round: there d is negative,
/// and the grain is pushed back inwards. Further out a grain is outside, and the sheet keeps it there: it has leaked, or was put there.
///
/// A triangle acts while its longest edge is above actingLength(), and beside no broken bond. Lists hold what is nearer than a skin and are made anew before
/// anything has moved half of it; how far things have gone is looked at when `travel` leaves room for it. Contacts are summed in the order of the grains' ids:
/// bits depend on the places alone, not on when the lists were made.
class FacetContact {
public:
	FacetContact() = default;
	/// \param radius R of the particles (m), > 0 \param offset h (m), > 0 and below 0.9 R \param stiffness kn (N/m), > 0 \throws FieldError
	FacetContact(const HexStencil& stencil, double radius, double offset, double stiffness);

	/// By bond, in the order of bondList(): 1 where it is broken. Empty: none is. \throws FieldError when it does not fit the tube
	void setBroken(const std::vector<int>& broken);

	/// Forces (N) at these positions, whose rows are wrapped. `grains` is asked when lists are made, and while a triangle is long enough to act.
	/// \throws FieldError for a grain that is nowhere
	void compute(const PaddedRings& position, const std::function<SphereRows()>& grains, const Travel& travel = {});

	/// A grain and a triangle that touch, at the last compute().
	struct Contact {
		int grain, id;                ///< the grain's index in the rows, its id
		std::array<int, 3> corners;   ///< particles
		std::array<double, 3> shares; ///< of the reaction, by corner; they add up to 1
		std::array<Vec3, 3> places;   ///< of the corners (m)
		Vec3 centre;                  ///< of the grain (m)
		Vec3 point;                   ///< half way through o_i (m)
		Vec3 normal;                  ///< unit vector towards the grain
		double overlap;               ///< force over kn (m)
		double squared;               ///< O^2 (m2) in the first contact of a grain, 0 in its others
		double stiffness;             ///< at most, along the normal, over kn
	};
	/// By the grains' ids, ascending, then by the corners.
	const std::vector<Contact>& touching() const { return contacts; }
	/// Rings that touched corners are of, first and last; first > last: none, and no row of `force` was written.
	int firstRing() const { return first; }
	int lastRing() const { return last; }
	/// At the last compute() (J).
	double energy() const;
	/// Largest sum of shares times stiffness of one particle at the last compute().
	double largestShare() const;
	/// Times that the lists were made so far.
	long listsMade() const { return made; }

	/// Length (m) of the longest edge from which on a triangle acts: sqrt(3 ((R' + r)^2 - (r + h)^2)), R' = 0.9 R and r the smallest grain's radius. No
	/// point of a triangle is further than longest edge/sqrt(3) from its nearest corner. So below this length no sphere of that radius or a larger one
	/// touches, unless it is driven into a particle by more than R/10, and nothing jumps when a triangle begins to act. With R' = R it is the length at which
	/// spheres that just touch reach the facet.
	static double actingLength(double radius, double offset, double grain);

	PaddedRings force; ///< zero where nothing touches

private:
	using Triangle = std::array<int, 3>;
	struct Near {
		int grain, triangle;
	};
	struct Foot; ///< nearest point of a triangle
	struct Part; ///< what a triangle carries of a grain

	Vec3 at(int particle) const { return x->get(particle / stencil.perRing, particle % stencil.perRing); }
	double longestSquared(const Triangle& t) const;
	bool planeReaches(const Triangle& t, const Place& grain) const;
	bool acts(int triangle) const { return !torn[triangle] && longestSquared(triangles[triangle]) > limit * limit; }
	Vec3 inwards(const Triangle& t) const;
	Foot footOn(int triangle, const Vec3& centre) const;
	bool surrounded(const Foot& foot, Vec3& normal) const;
	void touch(int grain, const SphereRows& rows, const std::vector<Foot>& feet);
	void add(int grain, const SphereRows& rows, const Foot& foot, const Vec3& normal, double overlap, const Part& part);
	bool grainsHold(const SphereRows& rows) const;
	void keepLists(const std::function<SphereRows()>& grains, const Travel& travel);
	void makeLists(const SphereRows& rows);

	HexStencil stencil;
	double radius = 0, h = 0, kn = 0, skin = 0;
	std::vector<Triangle> triangles;
	std::vector<std::vector<int>> trianglesOf; ///< by particle
	std::vector<char> torn;                    ///< by triangle

	const PaddedRings* x = nullptr; ///< of compute(), while it runs
	PaddedRings listed;             ///< positions at which the lists were made
	std::vector<Vec3> listedGrains; ///< likewise; empty while no triangle is long enough to act
	Travel sure;                    ///< nothing has moved half a skin before half a skin has been travelled from here
	double limit = 0;               ///< length from which on triangles act
	bool anyLong = false;           ///< whether there are such triangles, or may be before the lists are made anew
	std::vector<Near> near;         ///< by grain
	std::vector<Contact> contacts;
	int first = 0, last = -1;
	long made = 0;
};

} // namespace hexmembrane
