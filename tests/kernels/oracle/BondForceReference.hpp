// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/BondForce.hpp"

#include <array>
#include <cmath>

namespace hexmembrane {
namespace reference {

/// Positions and motions of all particles, and the forces on them.
struct Particles {
	std::vector<Vec3> position, velocity, spin, force, torque;
};

/// What bonds remember, in one place.
struct Memory {
	std::vector<double> restLength;
	std::vector<Vec3> shear;
	std::vector<int> broken;

	BondState state() { return {restLength, shear, broken}; }
};

/// The bond law of BondForce.hpp, one bond after the other over an index list, with nothing clever: the oracle of the fast kernel.
inline void bondForces(const std::vector<std::array<int, 2>>& bonds, const BondLaw& law, Memory& state, Particles& p, double dt)
{
	p.force.assign(p.position.size(), Vec3::Zero());
	p.torque.assign(p.position.size(), Vec3::Zero());
	for (size_t b = 0; b < bonds.size(); ++b) {
		const int i = bonds[b][0], j = bonds[b][1];
		const Vec3 branch = p.position[j] - p.position[i];
		const double distance = branch.norm();
		if (distance == 0) continue;
		const Vec3 n = branch / distance;

		// normal force on i: toward j when the bond is longer than it was made
		double normal = law.kn * (distance - state.restLength[b]);
		if (law.tensionOnly && normal < 0) normal = 0;

		Vec3 shear = Vec3::Zero();
		if (law.ks > 0) {
			const Vec3 old = state.shear[b];
			const Vec3 flat = old - n * n.dot(old);
			const Vec3 carried = flat.norm() > 0 ? Vec3(flat.normalized() * old.norm()) : Vec3::Zero();
			const Vec3 twist = 0.5 * (p.spin[i] + p.spin[j]);
			const double turn = twist.dot(n) * dt;
			// contact point at mid-bond, moving with either body, in the middle of the step
			const Vec3 half = 0.5 * (branch - 0.5 * dt * (p.velocity[j] - p.velocity[i]));
			const Vec3 vi = p.velocity[i] + p.spin[i].cross(half);
			const Vec3 vj = p.velocity[j] + p.spin[j].cross(-half);
			const Vec3 slide = (vj - vi) - n * n.dot(vj - vi);
			shear = Eigen::AngleAxisd(turn, n) * carried + law.ks * slide * dt;
		}

		bool broken = !state.broken.empty() && state.broken[b];
		if (!broken && normal > law.tensileStrength) broken = true;
		if (!broken && shear.norm() > law.shearStrength) broken = true;
		if (broken) {
			if (state.broken.empty()) state.broken.assign(bonds.size(), 0);
			state.broken[b] = 1;
			if (normal >= 0) {
				normal = 0;
				shear.setZero();
			} else if (shear.norm() > law.friction * -normal) {
				shear = shear.normalized() * (law.friction * -normal);
			}
		}

		const Vec3 onI = normal * n + shear;
		p.force[i] += onI;
		p.force[j] -= onI;
		p.torque[i] += (0.5 * distance * n).cross(shear);
		p.torque[j] += (-0.5 * distance * n).cross(-shear);
		if (law.ks > 0) state.shear[b] = shear;
	}
}

} // namespace reference
} // namespace hexmembrane
