// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/BoundarySweep.hpp"

#include "kernels/compact/Sweep.hpp"

namespace hexmembrane {

namespace {

/// A boundary and the spheres near it as what meets; the boundary is body 1.
struct BoundaryGeometry {
	const BoundarySweep& s;
	BoundaryLoad& received;
	const Motion own;

	struct Batch {
		int count = 0;
		int contact[sweepStretch + 4];
		Vec3 arm1[sweepStretch + 4], arm2[sweepStretch + 4]; ///< from the centres to the contact point
		// four numbers each, read as rows
		alignas(32) double normal[sweepStretch + 4][4]; ///< and the overlap
		alignas(32) double velocity[sweepStretch + 4][4];
		alignas(32) double spinSum[sweepStretch + 4][4];
		alignas(32) double spinDifference[sweepStretch + 4][4];
		FourPassing fours[sweepStretch / 4 + 1];

		HEXMEMBRANE_INLINE void move(int from, int to)
		{
			contact[to] = contact[from];
			arm1[to] = arm1[from];
			arm2[to] = arm2[from];
			for (auto* rows : {normal, velocity, spinSum, spinDifference}) store4(rows[to], load4(rows[from]));
		}
	};

	Meeting meet(const BoundaryTouch& touch, int c) const
	{
		const int i = s.spheres[c];
		return {touch.normal, touch.overlap, own, s.motions[i], touch.point - s.boundary.centre, touch.point - s.places[i].centre};
	}
	Meeting meet(int c) const { return meet(s.boundary.shape->touch(s.places[s.spheres[c]]), c); }

	void act(int c, const Vec3& arm1, const Vec3& arm2, const Vec3& force, const Vec3& moment, double normalForce) const
	{
		s.loads[s.spheres[c]] += {force, arm2.cross(force) + moment};
		received.load += {-force, -arm1.cross(force) - moment};
		received.normalForce += normalForce;
		++received.count;
		received.normalStiffness += s.store->contacts[c].springs.kn;
	}
	void act(int c, const Meeting& m, const ContactStep& step, const Contact& contact) const
	{
		act(c, m.arm1, m.arm2, step.normal * m.normal + contact.memory.shear, momentOf(contact.memory), step.normal);
	}

	HEXMEMBRANE_INLINE bool pick(int c, int end, Batch& batch) const
	{
		BoundaryTouch touches[sweepStretch];
		s.boundary.shape->touch(s.spheres + c, end - c, s.places, touches);
		unsigned char any = 0;
		for (const BoundaryTouch* touch = touches; c < end; ++c, ++touch) {
			any |= s.store->bits[c];
			if ((s.store->bits[c] & contactBonded) || (touch->overlap < 0 && !s.store->bits[c])) continue;
			const int n = batch.count++;
			const Meeting m = meet(*touch, c);
			const PairMotion<double> motion = m.motion();
			batch.contact[n] = c;
			batch.arm1[n] = m.arm1;
			batch.arm2[n] = m.arm2;
			for (int a = 0; a < 3; ++a) {
				batch.normal[n][a] = m.normal[a];
				batch.velocity[n][a] = motion.velocity[a];
				batch.spinSum[n][a] = motion.spinSum[a];
				batch.spinDifference[n][a] = motion.spinDifference[a];
			}
			batch.normal[n][3] = m.overlap;
			batch.velocity[n][3] = batch.spinSum[n][3] = batch.spinDifference[n][3] = 0;
		}
		return any & contactBonded;
	}

	HEXMEMBRANE_INLINE static Lanes3 columns(const double (*rows)[4], Lanes& fourth)
	{
		Lanes3 v{load4(rows[0]), load4(rows[1]), load4(rows[2])};
		fourth = load4(rows[3]);
		transpose(v.x, v.y, v.z, fourth);
		return v;
	}
	HEXMEMBRANE_INLINE void measure(Batch& batch, int f) const { batch.fours[f].normal = columns(batch.normal + 4 * f, batch.fours[f].overlap); }
	HEXMEMBRANE_INLINE void follow(Batch& batch, int f) const
	{
		Lanes unused;
		PairMotion<Lanes>& motion = batch.fours[f].motion;
		motion.velocity = columns(batch.velocity + 4 * f, unused);
		motion.spinSum = columns(batch.spinSum + 4 * f, unused);
		motion.spinDifference = columns(batch.spinDifference + 4 * f, unused);
	}
	HEXMEMBRANE_INLINE void act(const Batch& batch, int f) const
	{
		const FourPassing& four = batch.fours[f];
		const Lanes3 force = four.normalForce * four.normal + four.shear;
		for (int k = 0; k < 4; ++k) {
			const int c = batch.contact[4 * f + k];
			if (!s.store->bits[c]) continue; // has opened
			act(c, batch.arm1[4 * f + k], batch.arm2[4 * f + k], {force.x[k], force.y[k], force.z[k]},
			    {four.moment.x[k], four.moment.y[k], four.moment.z[k]}, four.normalForce[k]);
		}
	}
};

HEXMEMBRANE_WIDEST void sweepWidest(const BoundarySweep& sweep, BoundaryLoad& received)
{
	BoundaryGeometry geometry{sweep, received, {sweep.boundary.velocity, sweep.boundary.spin}};
	sweepContacts(geometry, *sweep.store, sweep.begin, sweep.end, sweep.dt, received.sums);
}

} // namespace

void sweepBoundary(const BoundarySweep& sweep, BoundaryLoad& received) { sweepWidest(sweep, received); }

} // namespace hexmembrane
