// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/packing/SphereRelaxation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hexmembrane {

namespace {

/// FIRE's numbers are those of its authors, the time step is bounded by the stiffest mode of a sphere with about 12 contacts of unit stiffness.
struct Fire {
	static constexpr double firstStep = 0.1, largestStep = 0.4, grow = 1.1, shrink = 0.5, firstMix = 0.1, mixDecay = 0.99;
	static constexpr int patience = 5;
};

/// Net force over contact force below which overlaps are carried, not on their way out.
constexpr double equilibrium = 1e-3;
/// How often equilibrium is looked for (steps).
constexpr int checkEvery = 20;
/// Reach of the neighbour list beyond contact, in mean radii.
constexpr double skinRatio = 0.2;

} // namespace

SphereRelaxation::SphereRelaxation(std::vector<Vec3> centres, std::vector<double> radii, double radius, double height)
    : x(std::move(centres)), v(x.size(), Vec3::Zero()), f(x.size(), Vec3::Zero()), r(std::move(radii)), scaled(r), cylinderRadius(radius),
      cylinderHeight(height), meanRadius(std::accumulate(r.begin(), r.end(), 0.0) / double(r.size())), largestRadius(*std::max_element(r.begin(), r.end())),
      skin(skinRatio * meanRadius)
{
}

double SphereRelaxation::unbalancedRatio() const
{
	if (contacts == 0) return 0;
	double net = 0;
	for (const Vec3& force : f) net += force.norm();
	return (net / double(f.size())) / meanOverlap();
}

void SphereRelaxation::refreshPairs()
{
	const double grown = 2 * largestRadius * std::abs(factor - listedFactor);
	if (listedFactor > 0 && grown < skin) {
		const double free = 0.5 * (skin - grown);
		bool valid = true;
		for (std::size_t i = 0; i < x.size() && valid; ++i) valid = (x[i] - listed[i]).squaredNorm() < free * free;
		if (valid) return;
	}
	pairs = findNearPairs(x, scaled, skin, Vec3(-cylinderRadius, -cylinderRadius, 0), Vec3(cylinderRadius, cylinderRadius, cylinderHeight));
	listed = x;
	listedFactor = factor;
}

void SphereRelaxation::addWalls(std::size_t i)
{
	const auto push = [&](double overlap, const Vec3& inwards) {
		if (overlap <= 0) return;
		f[i] += overlap * inwards;
		maxOverlap = std::max(maxOverlap, overlap);
		sumOverlap += overlap;
		++contacts;
	};
	push(scaled[i] - x[i][2], Vec3(0, 0, 1));
	push(x[i][2] + scaled[i] - cylinderHeight, Vec3(0, 0, -1));
	const double limit = cylinderRadius - scaled[i];
	const double out2 = x[i][0] * x[i][0] + x[i][1] * x[i][1];
	if (out2 > limit * limit) {
		const double out = std::sqrt(out2);
		push(out - limit, Vec3(-x[i][0] / out, -x[i][1] / out, 0));
	}
}

void SphereRelaxation::computeForces()
{
	refreshPairs();
	std::fill(f.begin(), f.end(), Vec3::Zero());
	maxOverlap = sumOverlap = 0;
	contacts = 0;
	for (std::size_t i = 0; i < x.size(); ++i) {
		const Vec3 xi = x[i];
		const double ri = scaled[i];
		Vec3 fi = Vec3::Zero();
		for (int k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
			const int j = pairs.other[k];
			const Vec3 d = xi - x[j];
			const double reach = ri + scaled[j];
			const double dist2 = d.squaredNorm();
			if (dist2 >= reach * reach) continue;
			const double dist = std::sqrt(dist2);
			const double overlap = reach - dist;
			// two centres in one place have no direction: any one parts them
			const Vec3 force = dist > 0 ? Vec3(d * (overlap / dist)) : Vec3(overlap, 0, 0);
			fi += force;
			f[j] -= force;
			maxOverlap = std::max(maxOverlap, overlap);
			sumOverlap += overlap;
			++contacts;
		}
		f[i] += fi;
		addWalls(i);
	}
}

SphereRelaxation::Outcome SphereRelaxation::relax(double newFactor, double tolerance, int maxSteps)
{
	factor = newFactor;
	for (std::size_t i = 0; i < r.size(); ++i) scaled[i] = r[i] * factor;
	std::fill(v.begin(), v.end(), Vec3::Zero());
	double dt = Fire::firstStep, mix = Fire::firstMix;
	int downhill = 0;
	for (int step = 0; step < maxSteps; ++step, ++totalSteps) {
		computeForces();
		if (maxOverlap <= tolerance) return Outcome::separated;
		if (step % checkEvery == checkEvery - 1 && unbalancedRatio() < equilibrium) return Outcome::jammed;

		double power = 0, vv = 0, ff = 0;
		for (std::size_t i = 0; i < x.size(); ++i) {
			power += f[i].dot(v[i]);
			vv += v[i].squaredNorm();
			ff += f[i].squaredNorm();
		}
		double keep = 1, steer = 0;
		if (power > 0 || step == 0) {
			keep = 1 - mix;
			steer = ff > 0 ? mix * std::sqrt(vv / ff) : 0;
			if (++downhill > Fire::patience) {
				dt = std::min(dt * Fire::grow, Fire::largestStep);
				mix *= Fire::mixDecay;
			}
		} else {
			downhill = 0;
			dt *= Fire::shrink;
			mix = Fire::firstMix;
			keep = 0;
		}
		// no sphere jumps further than a fifth of its kind in one step: deep random overlaps would throw them through their neighbours
		const double longest = 0.2 * meanRadius;
		for (std::size_t i = 0; i < x.size(); ++i) {
			v[i] = keep * v[i] + (steer + dt) * f[i];
			Vec3 move = dt * v[i];
			const double len2 = move.squaredNorm();
			if (len2 > longest * longest) {
				const double cut = longest / std::sqrt(len2);
				move *= cut;
				v[i] *= cut;
			}
			x[i] += move;
		}
	}
	return Outcome::exhausted;
}

void SphereRelaxation::shake(double amplitude, Random& random)
{
	for (std::size_t i = 0; i < x.size(); ++i) {
		for (int axis = 0; axis < 3; ++axis) x[i][axis] += random.uniform(-amplitude, amplitude);
		x[i][2] = std::clamp(x[i][2], scaled[i], cylinderHeight - scaled[i]);
		const double limit = cylinderRadius - scaled[i];
		const double out = std::sqrt(x[i][0] * x[i][0] + x[i][1] * x[i][1]);
		if (out > limit) {
			x[i][0] *= limit / out;
			x[i][1] *= limit / out;
		}
	}
}

} // namespace hexmembrane
