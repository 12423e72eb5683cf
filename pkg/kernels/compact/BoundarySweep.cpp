// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/BoundarySweep.hpp"

#include "kernels/compact/FourContacts.hpp"

#include <algorithm>

namespace hexmembrane {

namespace {

/// Contacts that touch, or did.
struct Touching {
	static constexpr int look = 64; ///< contacts looked at together

	int count = 0;
	int contact[look + 4];
	Vec3 arm1[look + 4], arm2[look + 4]; ///< from the centres to the contact point
	// Four numbers each, read as rows
	alignas(32) double normal[look + 4][4]; ///< and the overlap
	alignas(32) double velocity[look + 4][4];
	alignas(32) double spinSum[look + 4][4];
	alignas(32) double spinDifference[look + 4][4];
	Four fours[look / 4 + 1];
};

inline Motion motionOf(const FlatBoundary& boundary) { return {boundary.velocity, boundary.spin}; }

inline void act(const BoundarySweep& s, int c, const Vec3& arm1, const Vec3& arm2, const Vec3& force, const Vec3& moment, double normalForce,
                BoundaryLoad& received)
{
	s.loads[s.spheres[c]] += {force, arm2.cross(force) + moment};
	received.load += {-force, -arm1.cross(force) - moment};
	received.normalForce += normalForce;
	received.normalStiffness += s.store->contacts[c].kn;
}

/// One contact, by the law's own formulas.
void sweepOne(const BoundarySweep& s, int c, BoundaryLoad& received)
{
	const int i = s.spheres[c];
	const FlatBoundary::Touch touch = s.boundary.touch(s.places[i]);
	const Vec3 arm1 = touch.point - s.boundary.solid.centre, arm2 = touch.point - s.places[i].centre;
	Vec3 force;
	ContactMemory memory = s.store->get(c);
	unsigned char bits = s.store->bits[c];
	const bool closed = advanceMemory(memory, bits, touch.u, touch.normal, motionOf(s.boundary), arm1, s.motions[i], arm2, s.dt, force, received.sums);
	s.store->put(c, memory, bits);
	if (closed) act(s, c, arm1, arm2, force, memory.moment, memory.law.kn * touch.u, received);
}

/// Adds those of the contacts c .. end - 1 that touch, or did, without a bond.
HEXMEMBRANE_INLINE void pick(const BoundarySweep& s, int c, int end, Touching& found, BoundaryLoad& received)
{
	const Motion own = motionOf(s.boundary);
	for (; c < end; ++c) {
		if (s.store->bits[c] & contactBonded) {
			sweepOne(s, c, received);
			continue;
		}
		const int i = s.spheres[c];
		const FlatBoundary::Touch touch = s.boundary.touch(s.places[i]);
		if (touch.u < 0 && !s.store->bits[c]) continue;
		const int n = found.count++;
		const Motion& motion = s.motions[i];
		const Vec3 arm1 = touch.point - s.boundary.solid.centre, arm2 = touch.point - s.places[i].centre;
		const Vec3 velocity = relativeVelocity(own.velocity, own.spin, arm1, motion.velocity, motion.spin, arm2);
		found.contact[n] = c;
		found.arm1[n] = arm1;
		found.arm2[n] = arm2;
		for (int a = 0; a < 3; ++a) {
			found.normal[n][a] = touch.normal[a];
			found.velocity[n][a] = velocity[a];
			found.spinSum[n][a] = motion.spin[a] + own.spin[a];
			found.spinDifference[n][a] = motion.spin[a] - own.spin[a];
		}
		found.normal[n][3] = touch.u;
	}
}

HEXMEMBRANE_INLINE Lanes3 columns(const double (*rows)[4], Lanes& fourth)
{
	Lanes3 v{load4(rows[0]), load4(rows[1]), load4(rows[2])};
	fourth = load4(rows[3]);
	transpose(v.x, v.y, v.z, fourth);
	return v;
}

HEXMEMBRANE_INLINE void actFour(const BoundarySweep& s, const Touching& found, int at, const Four& four, BoundaryLoad& received)
{
	const Lanes3 force = four.normalForce * four.normal + four.shear;
	for (int k = 0; k < 4; ++k) {
		if (!s.store->bits[found.contact[at + k]]) continue; // has opened
		act(s, found.contact[at + k], found.arm1[at + k], found.arm2[at + k], {force.x[k], force.y[k], force.z[k]},
		    {four.moment.x[k], four.moment.y[k], four.moment.z[k]}, four.normalForce[k], received);
	}
}

HEXMEMBRANE_WIDEST void sweepWidest(const BoundarySweep& s, FourSums& sumsOfFours, BoundaryLoad& received)
{
	Touching found;
	for (int c = s.begin; c < s.end; c += Touching::look) {
		found.count = 0;
		pick(s, c, std::min(s.end, c + Touching::look), found, received);
		const int fours = found.count / 4;
		for (int f = 0; f < fours; ++f) {
			Four& four = found.fours[f];
			Lanes unused;
			four.normal = columns(found.normal + 4 * f, four.overlap);
			four.path = contactPath(four.normal, columns(found.velocity + 4 * f, unused), columns(found.spinSum + 4 * f, unused),
			                        columns(found.spinDifference + 4 * f, unused), s.dt);
		}
		for (int f = 0; f < fours; ++f) advance(*s.store, found.contact + 4 * f, found.fours[f], sumsOfFours);
		for (int f = 0; f < fours; ++f) actFour(s, found, 4 * f, found.fours[f], received);
		for (int n = 4 * fours; n < found.count; ++n) sweepOne(s, found.contact[n], received);
	}
}

} // namespace

void sweepBoundary(const BoundarySweep& sweep, BoundaryLoad& received)
{
	FourSums sums;
	sweepWidest(sweep, sums, received);
	sums.addTo(received.sums);
}

} // namespace hexmembrane
