// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/packing/GrainAssembly.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

namespace {

/// Reach of the neighbour list beyond contact, in largest radii.
constexpr double skinRatio = 0.1;

/// Cundall's local damping, component by component.
void damp(Vec3& force, const Vec3& velocity, double share)
{
	for (int axis = 0; axis < 3; ++axis) force[axis] *= force[axis] * velocity[axis] > 0 ? 1 - share : 1 + share;
}

/// Adds to a spring's load, keeps it in the contact plane and below its limit. \return whether it was above
bool load(Vec3& spring, const Vec3& increment, const Vec3& normal, double limit)
{
	spring += increment;
	spring -= spring.dot(normal) * normal;
	const double square = spring.squaredNorm();
	if (!(square > limit * limit)) return false;
	spring *= limit / std::sqrt(square);
	return true;
}

} // namespace

GrainAssembly::GrainAssembly(std::vector<Vec3> centres, std::vector<double> radii, double factor, double radius, double height, const GrainLaw& grainLaw)
    : x(std::move(centres)), v(x.size(), Vec3::Zero()), w(x.size(), Vec3::Zero()), f(x.size(), Vec3::Zero()), t(x.size(), Vec3::Zero()), base(std::move(radii)),
      r(base), touching(x.size(), 0), size(factor), cylinderRadius(radius), cylinderHeight(height), largest(*std::max_element(base.begin(), base.end())),
      skin(skinRatio * largest), law(grainLaw)
{
}

void GrainAssembly::refreshPairs()
{
	const double grown = 2 * largest * std::abs(size - listedSize);
	if (listedSize > 0 && grown < skin) {
		const double free = 0.5 * (skin - grown);
		bool valid = true;
		for (std::size_t i = 0; i < x.size() && valid; ++i) valid = (x[i] - listed[i]).squaredNorm() < free * free;
		if (valid) return;
	}
	NearPairs found = findNearPairs(x, r, skin, Vec3(-cylinderRadius, -cylinderRadius, 0), Vec3(cylinderRadius, cylinderRadius, cylinderHeight));
	// both lists are sorted: springs move over by a merge
	std::vector<Vec3> moved(found.other.size(), Vec3::Zero()), movedMoment = moved;
	for (std::size_t i = 0; i + 1 < pairs.start.size(); ++i) {
		int old = pairs.start[i];
		for (int k = found.start[i]; k < found.start[i + 1]; ++k) {
			while (old < pairs.start[i + 1] && pairs.other[old] < found.other[k]) ++old;
			if (old == pairs.start[i + 1] || pairs.other[old] != found.other[k]) continue;
			moved[k] = shear[old];
			movedMoment[k] = moment[old];
		}
	}
	shear.swap(moved);
	moment.swap(movedMoment);
	pairs = std::move(found);
	listed = x;
	listedSize = size;
}

void GrainAssembly::addWalls(std::size_t i)
{
	const auto push = [&](double overlap, const Vec3& inwards, double& total) {
		if (overlap <= 0) return;
		const double force = law.modulus * r[i] * overlap;
		f[i] += force * inwards;
		total += force;
		sumForce += force;
		++wallCount;
		++touching[i];
	};
	push(r[i] - x[i][2], Vec3(0, 0, 1), endForce);
	push(x[i][2] + r[i] - cylinderHeight, Vec3(0, 0, -1), endForce);
	const double limit = cylinderRadius - r[i];
	const double out2 = x[i][0] * x[i][0] + x[i][1] * x[i][1];
	if (out2 > limit * limit) {
		const double out = std::sqrt(out2);
		push(out - limit, Vec3(-x[i][0] / out, -x[i][1] / out, 0), sideForce);
	}
}

void GrainAssembly::computeForces()
{
	refreshPairs();
	std::fill(f.begin(), f.end(), Vec3::Zero());
	std::fill(t.begin(), t.end(), Vec3::Zero());
	std::fill(touching.begin(), touching.end(), 0);
	sideForce = endForce = sumForce = 0;
	contactCount = slidingCount = wallCount = 0;
	for (std::size_t i = 0; i < x.size(); ++i) {
		for (int k = pairs.start[i]; k < pairs.start[i + 1]; ++k) {
			const int j = pairs.other[k];
			const Vec3 d = x[j] - x[i];
			const double reach = r[i] + r[j];
			const double dist2 = d.squaredNorm();
			if (dist2 >= reach * reach) {
				shear[k] = moment[k] = Vec3::Zero();
				continue;
			}
			const double dist = std::sqrt(dist2);
			const Vec3 n = d / dist;
			const double kn = 2 * law.modulus * r[i] * r[j] / reach;
			const double normal = kn * (reach - dist);
			const double armI = dist * r[i] / reach, armJ = dist - armI;
			// velocity of j's side of the contact against i's
			const Vec3 slip = v[j] - v[i] - (armI * w[i] + armJ * w[j]).cross(n);
			const double ks = kn / law.stiffnessRatio;
			Vec3& s = shear[k];
			if (load(s, (ks * timeStep) * slip, n, law.friction * normal)) ++slidingCount;
			if (law.rollingFriction > 0) {
				const double lever = r[i] * r[j] / reach;
				load(moment[k], (ks * lever * lever * timeStep) * (w[j] - w[i]), n, law.rollingFriction * lever * normal);
				t[i] += moment[k];
				t[j] -= moment[k];
			}
			const Vec3 onI = s - normal * n;
			f[i] += onI;
			f[j] -= onI;
			const Vec3 turn = n.cross(s);
			t[i] += armI * turn;
			t[j] += armJ * turn;
			sumForce += normal;
			++contactCount;
			++touching[i];
			++touching[j];
		}
		addWalls(i);
	}
}

void GrainAssembly::step(double growth)
{
	size *= 1 + growth;
	for (std::size_t i = 0; i < r.size(); ++i) r[i] = base[i] * size;
	computeForces();
	for (std::size_t i = 0; i < x.size(); ++i) {
		const double mass = law.modulus * base[i];
		Vec3 force = f[i], torque = t[i];
		damp(force, v[i], law.damping);
		damp(torque, w[i], law.damping);
		v[i] += (timeStep / mass) * force;
		w[i] += (timeStep / (0.4 * mass * base[i] * base[i])) * torque;
		x[i] += timeStep * v[i];
	}
}

double GrainAssembly::unbalancedRatio() const
{
	if (contactCount + wallCount == 0) return 0;
	double net = 0;
	for (const Vec3& force : f) net += force.norm();
	return (net / double(f.size())) / (sumForce / (contactCount + wallCount));
}

int GrainAssembly::rattlers() const { return int(std::count(touching.begin(), touching.end(), 0)); }

} // namespace hexmembrane
