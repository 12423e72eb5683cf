// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/PaddedRings.hpp"

#include <array>
#include <vector>

namespace hexmembrane {

/// Contact of a hexagonal tube with itself: particles of radius R that are no bonded neighbours and whose centres are nearer than 2R push each other apart
/// with kn (2R - d), without friction or damping. Centres that coincide have no direction: their force is 0.
///
/// Pairs come from a list of all that are nearer than 2R + skin. It is made anew before any particle has moved half a skin; in an open sheet, whose second
/// neighbours are 3.46 R apart, it is empty. Touching pairs are summed in the order of their indices: bits depend on the positions alone, neither on when
/// the list was made nor on the number of threads.
class SelfContact {
public:
	SelfContact() = default;
	/// \param radius R of the particles (m), > 0 \param stiffness kn (N/m), > 0 \throws std::invalid_argument
	SelfContact(const HexStencil& stencil, double radius, double stiffness);

	/// Forces (N) at these positions, whose rows are wrapped. \throws FieldError for one that is not finite
	void compute(const PaddedRings& position);

	/// Touching pairs at the last compute(), the lower index first, sorted.
	struct Pair {
		int i, j;
		Vec3 branch; ///< from i to j (m)
	};
	const std::vector<Pair>& touching() const { return pairs; }
	/// Rings that touching particles are of, first and last; first > last: none touches, and no row of `force` was written.
	int firstRing() const { return first; }
	int lastRing() const { return last; }
	/// At the last compute() (J).
	double energy() const;
	/// Most contacts of one particle at the last compute().
	int mostOfOne() const;
	/// Times that the list was made so far.
	long listsMade() const { return made; }

	PaddedRings force; ///< zero where nothing touches

private:
	void makeList(const PaddedRings& x);
	bool bonded(int i, int j) const;

	HexStencil stencil;
	double radius = 0, kn = 0, skin = 0;
	PaddedRings listed; ///< positions at which the list was made
	std::vector<std::array<int, 2>> near;
	std::vector<Pair> pairs;
	int first = 0, last = -1;
	long made = 0;
};

} // namespace hexmembrane
