// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/BondForce.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/base/Simd.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

bool BondLaw::central() const { return ks == 0 && std::isinf(tensileStrength) && std::isinf(shearStrength); }

void BondLaw::check() const
{
	requirePositive("kn", kn, "N/m");
	requireNonNegative("ks", ks, "N/m");
	requireNonNegative("friction", friction, "1");
	const auto strength = [](const char* name, double value) {
		if (!(value > 0)) reject(name, value, "must be positive", "a force in N, or inf for a bond that never breaks");
	};
	strength("tensileStrength", tensileStrength);
	strength("shearStrength", shearStrength);
	if (tensionOnly && ks > 0) reject("tensionOnly", 1, "is for central bonds: a wrinkled sheet has no shear to carry", "ks = 0 (Poisson's ratio 1/3)");
}

BondForce::BondForce(const HexStencil& s, const BondLaw& l) : position(s.perRing, s.rings), force(s.perRing, s.rings), stencil(s), law(l), bondForce(3)
{
	law.check();
	for (int family = 0; family < 3; ++family) bondForce[family] = PaddedRings(s.perRing, s.familyRows(family));
	if (law.ks > 0) {
		velocity = spin = torque = PaddedRings(s.perRing, s.rings);
		bondTorque = bondForce;
	}
}

std::vector<double> BondForce::lengths() const
{
	std::vector<double> all(stencil.bondCount());
	for (int family = 0; family < 3; ++family)
		for (int k = 0; k < stencil.familyRows(family); ++k) {
			const auto far = HexStencil::farEnd(family, k);
			for (int i = 0; i < stencil.perRing; ++i)
				all[stencil.familyStart(family) + k * stencil.perRing + i] = (position.get(k + far[0], i + far[1]) - position.get(k, i)).norm();
		}
	return all;
}

namespace {

/// Spring forces on the first particles of a row of bonds. A bond of zero length has no direction: its force is 0.
template <bool tensionOnly>
inline void springs(int n, const double* __restrict ax, const double* __restrict ay, const double* __restrict az, const double* __restrict bx,
                    const double* __restrict by, const double* __restrict bz, const double* __restrict rest, double kn, double* __restrict fx,
                    double* __restrict fy, double* __restrict fz)
{
#pragma omp simd
	for (int i = 0; i < n; ++i) {
		const double dx = bx[i] - ax[i], dy = by[i] - ay[i], dz = bz[i] - az[i];
		const double d = std::sqrt(dx * dx + dy * dy + dz * dz);
		const double extension = tensionOnly ? std::max(d - rest[i], 0.) : d - rest[i];
		const double c = d > 0 ? kn * extension / d : 0;
		fx[i] = c * dx;
		fy[i] = c * dy;
		fz[i] = c * dz;
	}
}

HEXMEMBRANE_WIDEST void springRow(bool tensionOnly, int n, const double* ax, const double* ay, const double* az, const double* bx, const double* by,
                                  const double* bz, const double* rest, double kn, double* fx, double* fy, double* fz)
{
	if (tensionOnly)
		springs<true>(n, ax, ay, az, bx, by, bz, rest, kn, fx, fy, fz);
	else
		springs<false>(n, ax, ay, az, bx, by, bz, rest, kn, fx, fy, fz);
}

/// out = own - sign-wise what arrives; six contributions of a particle whose ring has neighbours on both sides.
HEXMEMBRANE_WIDEST void gatherInside(int n, double sign, const double* along, const double* upLeft, const double* upRight, const double* fromRight,
                                     const double* fromLeft, double* __restrict out)
{
#pragma omp simd
	for (int i = 0; i < n; ++i) out[i] = (along[i] + upLeft[i] + upRight[i]) + sign * (along[i - 1] + fromRight[i] + fromLeft[i]);
}

} // namespace

void BondForce::centralRow(const BondState& state, int family, int k)
{
	const auto far = HexStencil::farEnd(family, k);
	const int upto = k + far[0], shift = far[1];
	PaddedRings& f = bondForce[family];
	springRow(law.tensionOnly, stencil.perRing, position.row(0, k), position.row(1, k), position.row(2, k), position.row(0, upto) + shift,
	          position.row(1, upto) + shift, position.row(2, upto) + shift, state.restLength.data() + stencil.familyStart(family) + k * stencil.perRing,
	          law.kn, f.row(0, k), f.row(1, k), f.row(2, k));
	f.wrap(k);
}

void BondForce::generalRow(BondState state, int family, int k, double dt)
{
	const auto far = HexStencil::farEnd(family, k);
	for (int i = 0; i < stencil.perRing; ++i) {
		const int b = stencil.familyStart(family) + k * stencil.perRing + i;
		const int k2 = k + far[0], i2 = i + far[1];
		const Vec3 branch = position.get(k2, i2) - position.get(k, i);
		const double d = branch.norm();
		const Vec3 n = d > 0 ? Vec3(branch / d) : Vec3::Zero();

		Vec3 shear = Vec3::Zero();
		if (law.ks > 0) {
			// carry the old force along: out of the direction of the new axis at unchanged size, then round the axis with the mean spin
			shear = state.shear[b];
			const double size = shear.norm();
			shear -= shear.dot(n) * n;
			const double left = shear.norm();
			if (left > 0) shear *= size / left;
			const Vec3 spins = spin.get(k, i) + spin.get(k2, i2);
			const double turn = 0.5 * dt * spins.dot(n);
			shear = std::cos(turn) * shear + std::sin(turn) * n.cross(shear);

			// velocities belong to the middle of the step: with the branch of that moment a rigid rotation by an angle a leaves an error of a^3 only
			Vec3 relative = velocity.get(k2, i2) - velocity.get(k, i);
			const Vec3 midBranch = branch - 0.5 * dt * relative;
			relative -= 0.5 * spins.cross(midBranch);
			relative -= relative.dot(n) * n;
			shear += law.ks * dt * relative;
		}

		double tension = law.kn * (d - state.restLength[b]);
		if (law.tensionOnly) tension = std::max(tension, 0.);
		int& broken = state.broken[b];
		if (!broken && (tension > law.tensileStrength || shear.norm() > law.shearStrength)) broken = 1;
		if (broken) {
			tension = std::min(tension, 0.);
			const double limit = law.friction * -tension, size = shear.norm();
			if (size > limit) shear *= limit / size;
		}

		bondForce[family].set(k, i, tension * n + shear);
		if (law.ks > 0) {
			state.shear[b] = shear;
			bondTorque[family].set(k, i, 0.5 * d * n.cross(shear));
		}
	}
	bondForce[family].wrap(k);
	if (law.ks > 0) bondTorque[family].wrap(k);
}

void BondForce::gather(const std::vector<PaddedRings>& bond, double sign, PaddedRings& out) const
{
	const int n = stencil.perRing;
	const std::vector<double> none(n, 0.);
#pragma omp parallel for schedule(static)
	for (int k = 0; k < stencil.rings; ++k)
		for (int a = 0; a < 3; ++a) {
			const bool below = k > 0, above = k + 1 < stencil.rings;
			// a bond that ends here began in the ring below, its shift further back
			const double* fromRight = below ? bond[1].row(a, k - 1) - HexStencil::left(k - 1) : none.data();
			const double* fromLeft = below ? bond[2].row(a, k - 1) - HexStencil::right(k - 1) : none.data();
			gatherInside(n, sign, bond[0].row(a, k), above ? bond[1].row(a, k) : none.data(), above ? bond[2].row(a, k) : none.data(), fromRight,
			             fromLeft, out.row(a, k));
		}
}

void BondForce::compute(BondState state, double dt)
{
	const bool central = law.central() && state.broken.empty();
	if (!central) {
		state.broken.resize(stencil.bondCount(), 0);
		if (law.ks > 0) state.shear.resize(stencil.bondCount(), Vec3::Zero());
	}
	// all rows are independent; ring by ring, so that a thread stays at the same height as in every other loop over rings
#pragma omp parallel for schedule(static)
	for (int k = 0; k < stencil.rings; ++k)
		for (int family = 0; family < (k + 1 < stencil.rings ? 3 : 1); ++family)
			if (central)
				centralRow(state, family, k);
			else
				generalRow(state, family, k, dt);
	gather(bondForce, -1., force);
	if (law.ks > 0) gather(bondTorque, 1., torque);
}

double BondForce::normalForce(const BondState& state, int bond) const
{
	const int family = bond < stencil.familyStart(1) ? 0 : bond < stencil.familyStart(2) ? 1 : 2;
	const int k = (bond - stencil.familyStart(family)) / stencil.perRing, i = (bond - stencil.familyStart(family)) % stencil.perRing;
	const auto far = HexStencil::farEnd(family, k);
	double tension = law.kn * ((position.get(k + far[0], i + far[1]) - position.get(k, i)).norm() - state.restLength[bond]);
	if (law.tensionOnly) tension = std::max(tension, 0.);
	return !state.broken.empty() && state.broken[bond] ? std::min(tension, 0.) : tension;
}

double BondForce::energy(const BondState& state) const
{
	double sum = 0;
	for (int b = 0; b < stencil.bondCount(); ++b) {
		const double normal = normalForce(state, b);
		sum += 0.5 * normal * normal / law.kn;
		if (!state.shear.empty()) sum += 0.5 * state.shear[b].squaredNorm() / law.ks;
	}
	return sum;
}

} // namespace hexmembrane
