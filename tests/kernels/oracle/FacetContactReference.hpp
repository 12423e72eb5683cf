// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Place.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace hexmembrane {
namespace reference {

/// Contacts of all grains with all triangles that are long enough, tried one after the other.
struct FacetContacts {
	std::vector<Vec3> onParticle, onGrain; ///< N
	double energy = 0;                     ///< J
	std::vector<int> grains;               ///< that touch
	int pushedBack = 0;                    ///< of them, those whose centre is past the sheet
};

struct FacetRule {
	double offset, kn, limit; ///< h (m), stiffness (N/m), length from which on a triangle acts (m)
};

inline Vec3 nearestOfSegment(const Vec3& c, const Vec3& a, const Vec3& b)
{
	const double t = (c - a).dot(b - a) / (b - a).squaredNorm();
	return a + std::clamp(t, 0., 1.) * (b - a);
}

/// Nearest point of a triangle: the foot of the perpendicular where it lies inside, or the nearest of its edges' points.
inline Vec3 nearestOfTriangle(const Vec3& c, const std::array<Vec3, 3>& p)
{
	const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized(), foot = c - normal * normal.dot(c - p[0]);
	bool inside = true;
	for (int e = 0; e < 3; ++e) inside = inside && (p[(e + 1) % 3] - p[e]).cross(foot - p[e]).dot(normal) > 0;
	if (inside) return foot;
	Vec3 best = p[0];
	for (int e = 0; e < 3; ++e) {
		const Vec3 q = nearestOfSegment(c, p[e], p[(e + 1) % 3]);
		if ((c - q).norm() < (c - best).norm()) best = q;
	}
	return best;
}

/// `closed`: triangles that act are all round every point that a grain is near to, so that each has two sides.
inline FacetContacts facetContacts(const std::vector<std::array<int, 3>>& triangles, const std::vector<Vec3>& x, const std::vector<Place>& grains,
                                   const FacetRule& rule, bool closed)
{
	FacetContacts found;
	found.onParticle.assign(x.size(), Vec3::Zero());
	found.onGrain.assign(grains.size(), Vec3::Zero());
	for (std::size_t g = 0; g < grains.size(); ++g) {
		const Vec3 c = grains[g].centre;
		double least = 1e300;
		Vec3 foot, inwards = Vec3::Zero();
		std::array<int, 3> nearest{};
		struct Reached {
			std::array<int, 3> triangle;
			Vec3 foot;
			double overlap;
		};
		std::vector<Reached> reached;
		for (const auto& t : triangles) {
			const std::array<Vec3, 3> p{x[t[0]], x[t[1]], x[t[2]]};
			if (!(std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()}) > rule.limit)) continue;
			const Vec3 q = nearestOfTriangle(c, p), normal = -(p[1] - p[0]).cross(p[2] - p[0]).normalized();
			const double d = (c - q).norm();
			if (d < grains[g].radius + rule.offset) reached.push_back({t, q, grains[g].radius + rule.offset - d});
			if (d < least * (1 - 1e-9)) {
				least = d;
				foot = q;
				inwards = normal;
				nearest = t;
			} else if (d < least * (1 + 1e-9))
				inwards += normal; // on an edge: that of both
		}
		const bool past = closed && least < rule.offset && (c - foot).dot(inwards) < 0;
		const double overlap = grains[g].radius + rule.offset - (past ? -least : least);
		if (!(overlap > 0) || !(least < grains[g].radius + rule.offset)) continue;
		found.grains.push_back(int(g));
		found.pushedBack += past;
		const auto push = [&](const std::array<int, 3>& t, const Vec3& at, const Vec3& force) {
			found.onGrain[g] += force;
			// what replaces a force by forces at three points
			Eigen::Matrix3d corners;
			corners << x[t[0]], x[t[1]], x[t[2]];
			const Vec3 weights = corners.fullPivLu().solve(at);
			for (int v = 0; v < 3; ++v) found.onParticle[t[v]] -= weights[v] * force;
		};
		if (least <= rule.offset) {
			found.energy += 0.5 * rule.kn * overlap * overlap;
			push(nearest, foot, rule.kn * overlap * (c - foot) / (past ? -least : least));
			continue;
		}
		// O of the energy kn O^2/2 as a function of all overlaps, and its slopes by differences of that function
		const auto whole = [&](const std::vector<Reached>& all) {
			double sum = 0, most = 0;
			for (const Reached& one : all) {
				sum += std::pow(one.overlap, 4);
				most = std::max(most, one.overlap);
			}
			const double t = std::clamp((grains[g].radius + rule.offset - most - rule.offset) / rule.offset, 0., 1.);
			return most + t * t * (3 - 2 * t) * (std::pow(sum, 0.25) - most);
		};
		const double all = whole(reached);
		found.energy += 0.5 * rule.kn * all * all;
		for (std::size_t k = 0; k < reached.size(); ++k) {
			const double step = 1e-6 * rule.offset;
			auto more = reached, less = reached;
			more[k].overlap += step;
			less[k].overlap -= step;
			const double slope = (whole(more) - whole(less)) / (2 * step);
			push(reached[k].triangle, reached[k].foot, rule.kn * all * slope * (c - reached[k].foot).normalized());
		}
	}
	return found;
}

} // namespace reference
} // namespace hexmembrane
