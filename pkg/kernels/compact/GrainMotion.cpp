// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/GrainMotion.hpp"

#include "kernels/base/LocalDamping.hpp"

#include <algorithm>

namespace hexmembrane {

namespace {

inline double absoluteDot(const Vec3& a, const Vec3& b) { return a.cwiseAbs().dot(b.cwiseAbs()); }

/// Before the step.
inline void addEnergies(GrainMotion& s, int i)
{
	const Motion& motion = s.motions[i];
	const Load& load = s.loads[i];
	s.kinetic += 0.5 * s.mass[i] * motion.velocity.squaredNorm() + 0.5 * s.inertia[i] * motion.spin.squaredNorm();
	if (!s.fixed[i]) s.dampedWork += s.damping * s.dt * (absoluteDot(motion.velocity, load.force) + absoluteDot(motion.spin, load.torque));
}

HEXMEMBRANE_WIDEST void moveWidest(GrainMotion& s)
{
	for (int i = s.from; i < s.to; ++i) {
		if (s.energies) addEnergies(s, i);
		// velocity and the first component of the spin lie together, then the other two
		double* const motion = s.motions[i].velocity.data();
		Four low = load<Four>(motion);
		Two high = load<Two>(motion + 4);
		if (!s.fixed[i]) {
			const double* const acting = s.loads[i].force.data();
			const Two inverse = 1 / Two{s.mass[i], s.inertia[i]};
			low = dampedStep(low, load<Four>(acting), __builtin_shufflevector(inverse, inverse, 0, 0, 0, 1), s.dt, s.damping);
			high = dampedStep(high, load<Two>(acting + 4), __builtin_shufflevector(inverse, inverse, 1, 1), s.dt, s.damping);
			store(motion, low);
			store(motion + 4, high);
		}
		double* const place = s.places[i].centre.data();
		const Four noTurn = __builtin_shufflevector(low, Four{}, 0, 1, 2, 4); // the radius stays
		store(place, load<Four>(place) + s.dt * noTurn);
		double* const turned = s.turned[i].data();
		turned[0] += s.dt * low[3];
		turned[1] += s.dt * high[0];
		turned[2] += s.dt * high[1];
		const double speed2 = low[0] * low[0] + low[1] * low[1] + low[2] * low[2], spins = low[3] + high[0] + high[1];
		if (!(speed2 < s.limit2) || !(spins - spins == 0)) s.lost = std::min(s.lost, i);
		s.fastest2 = std::max(s.fastest2, speed2);
	}
}

} // namespace

void moveGrains(GrainMotion& step)
{
	step.lost = step.to;
	step.fastest2 = step.kinetic = step.dampedWork = 0;
	moveWidest(step);
}

} // namespace hexmembrane
