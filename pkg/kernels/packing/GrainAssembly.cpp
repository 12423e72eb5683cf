// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/packing/GrainAssembly.hpp"

#include "kernels/base/LocalDamping.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

namespace {

/// Reach of the neighbour list beyond contact, in largest radii.
constexpr double skinRatio = 0.1;

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
	std::vector<ContactMemory<double>> moved(found.other.size(), noMemory());
	for (std::size_t i = 0; i + 1 < pairs.start.size(); ++i) {
		int old = pairs.start[i];
		for (int k = found.start[i]; k < found.start[i + 1]; ++k) {
			while (old < pairs.start[i + 1] && pairs.other[old] < found.other[k]) ++old;
			if (old < pairs.start[i + 1] && pairs.other[old] == found.other[k]) moved[k] = memories[old];
		}
	}
	memories.swap(moved);
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

void GrainAssembly::setFriction(double friction, double rollingFriction)
{
	law.friction = friction;
	law.rollingFriction = rollingFriction;
	const LinearLaw<double> any = lawOf(1, 1); // which springs there are is the same for all contacts
	for (ContactMemory<double>& memory : memories) memory = withoutLostSprings(memory, any);
}

LinearLaw<double> GrainAssembly::lawOf(double r1, double r2) const
{
	const double lever = rollingRadius(r1, r2), kn = 2 * law.modulus * lever, ks = kn / law.stiffnessRatio;
	return {kn, ks, law.friction, law.rollingFriction > 0 ? ks * lever * lever : 0, law.rollingFriction * lever};
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
				memories[k] = noMemory();
				continue;
			}
			const double dist = std::sqrt(dist2), overlap = reach - dist, armI = dist * r[i] / reach, armJ = dist - armI;
			const Vec3 n = d / dist, velocity = v[j] - v[i] - (armI * w[i] + armJ * w[j]).cross(n);
			ContactMemory<double>& memory = memories[k];
			carry<double>(memory, n, w[i] + w[j], timeStep);
			const Vec3 slide = timeStep * acrossNormal(velocity, n);
			const UnbondedStep<double> step =
			        advanceUnbonded<double>(lawOf(r[i], r[j]), contactMotion<double>(overlap, slide, w[j] - w[i], n, timeStep), memory);
			if (step.slip > 0) ++slidingCount;
			const double normal = step.normal;
			const Vec3 onJ = normal * n + memory.shear, turn = n.cross(memory.shear), moment = momentOf(memory);
			f[i] -= onJ;
			f[j] += onJ;
			t[i] -= armI * turn + moment;
			t[j] -= armJ * turn - moment;
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
		const double perMass = 1 / (law.modulus * base[i]), perInertia = perMass / (0.4 * base[i] * base[i]);
		for (int a = 0; a < 3; ++a) {
			v[i][a] = dampedStep(v[i][a], f[i][a], perMass, timeStep, law.damping);
			w[i][a] = dampedStep(w[i][a], t[i][a], perInertia, timeStep, law.damping);
		}
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
