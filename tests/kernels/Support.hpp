// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/HexLattice.hpp"
#include "kernels/membrane/PaddedRings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace hexmembrane {
namespace support {

/// Largest difference of two lists of vectors over the largest vector of the second; NaN anywhere gives infinity, so that a comparison with it fails.
inline double relativeDifference(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
	const double inf = std::numeric_limits<double>::infinity();
	if (a.size() != b.size() || a.empty()) return inf;
	double size = 0, difference = 0;
	for (size_t i = 0; i < a.size(); ++i) {
		if (!a[i].allFinite() || !b[i].allFinite()) return inf;
		size = std::max(size, b[i].norm());
		difference = std::max(difference, (a[i] - b[i]).norm());
	}
	return size > 0 ? difference / size : difference;
}

/// Moves every point by a random vector of at most `size` in each component.
inline void shake(std::vector<Vec3>& points, double size, unsigned seed)
{
	std::mt19937_64 random(seed);
	std::uniform_real_distribution<double> u(-size, size);
	for (auto& p : points) p += Vec3(u(random), u(random), u(random));
}

inline std::vector<Vec3> randomVectors(size_t count, double size, unsigned seed)
{
	std::vector<Vec3> v(count, Vec3::Zero());
	shake(v, size, seed);
	return v;
}

/// A small membrane of the study's proportions.
inline HexLattice smallTube() { return makeHexLattice({0.020, 0.030, 0.002, Placement::outside, 1, 1}); }

/// Vectors of a tube's particles as wrapped rows.
inline void load(PaddedRings& field, const HexStencil& s, const std::vector<Vec3>& values)
{
	for (int k = 0; k < s.rings; ++k) {
		for (int i = 0; i < s.perRing; ++i) field.set(k, i, values[s.at(k, i)]);
		field.wrap(k);
	}
}

inline PaddedRings rowsOf(const HexStencil& s, const std::vector<Vec3>& values)
{
	PaddedRings field(s.perRing, s.rings);
	load(field, s, values);
	return field;
}

/// Adds the centres of both ends, so that the tube becomes a closed surface.
inline void closeTube(HexLattice& tube)
{
	for (const int k : {0, tube.rings - 1}) {
		Vec3 centre = Vec3::Zero();
		for (int i = 0; i < tube.perRing; ++i) centre += tube.positions[tube.at(k, i)] / tube.perRing;
		const int cap = static_cast<int>(tube.positions.size());
		tube.positions.push_back(centre);
		for (int i = 0; i < tube.perRing; ++i) {
			if (k == 0)
				tube.triangles.push_back({cap, tube.at(k, i + 1), tube.at(k, i)});
			else
				tube.triangles.push_back({cap, tube.at(k, i), tube.at(k, i + 1)});
		}
	}
}

/// Message of the std::invalid_argument that `call` throws; empty when it throws none.
template <typename Call>
std::string complaint(const Call& call)
{
	try {
		call();
	} catch (const std::invalid_argument& e) {
		return e.what();
	}
	return "";
}

#define EXPECT_COMPLAINT(statement, part) EXPECT_NE(hexmembrane::support::complaint([&] { statement; }).find(part), std::string::npos) << "wanted: " << part

} // namespace support
} // namespace hexmembrane
