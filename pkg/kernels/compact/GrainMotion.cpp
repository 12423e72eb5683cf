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

HEXMEMBRANE_INLINE Four firstFour(const Two* parts) { return joined(parts[0], parts[1]); }
HEXMEMBRANE_INLINE Four firstFour(const Four* parts) { return parts[0]; }

/// A record of velocity and spin is six numbers side by side, taken by two or four; what fills the record up goes along. By eight it takes three times as long.
template <class V>
HEXMEMBRANE_INLINE void moveBy(GrainMotion& s)
{
	constexpr int width = laneCount<V>, count = (6 + width - 1) / width;
	static_assert(count * width * sizeof(double) <= sizeof(Motion) && sizeof(Motion) == sizeof(Load), "whole records");
	for (int i = s.from; i < s.to; ++i) {
		if (s.energies) addEnergies(s, i);
		double* const motion = s.motions[i].velocity.data();
		V parts[count];
		for (int part = 0; part < count; ++part) parts[part] = load<V>(motion + part * width);
		if (!s.fixed[i]) {
			const double* const acting = s.loads[i].force.data();
			const Two inverse = 1 / Two{s.mass[i], s.inertia[i]};
			for (int part = 0; part < count; ++part) {
				V inverseMass{};
				for (int k = 0; k < width; ++k) inverseMass[k] = inverse[part * width + k >= 3];
				parts[part] = dampedStep(parts[part], load<V>(acting + part * width), inverseMass, s.dt, s.damping);
				store(motion + part * width, parts[part]);
			}
		}
		const auto number = [&](int k) __attribute__((always_inline)) { return parts[k / width][k % width]; };
		double* const place = s.places[i].centre.data();
		store(place, load<Four>(place) + s.dt * __builtin_shufflevector(firstFour(parts), Four{}, 0, 1, 2, 4)); // the radius stays
		double* const turned = s.turned[i].data();
		for (int a = 0; a < 3; ++a) turned[a] += s.dt * number(3 + a);
		const double speed2 = number(0) * number(0) + number(1) * number(1) + number(2) * number(2), spins = number(3) + number(4) + number(5);
		if (!(speed2 < s.limit2) || !(spins - spins == 0)) s.lost = std::min(s.lost, i);
		s.fastest2 = std::max(s.fastest2, speed2);
	}
}

HEXMEMBRANE_WIDEST_LANES(void moveWidest(GrainMotion& s), moveBy<Lanes<std::min(width, 4)>>(s))

} // namespace

void moveGrains(GrainMotion& step)
{
	step.lost = step.to;
	step.fastest2 = step.kinetic = step.dampedWork = 0;
	moveWidest(step);
}

} // namespace hexmembrane
