// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/BoundarySweep.hpp"

#include "kernels/compact/Sweep.hpp"

namespace hexmembrane {

namespace {

/// A boundary and the spheres near it as what meets; the boundary is body 1.
template <class V>
struct BoundaryGeometry {
	static constexpr int width = laneCount<V>;
	const BoundarySweep& s;
	BoundaryLoad& received;
	const Motion own;

	struct Batch {
		int count = 0;
		int contact[sweepStretch + width];
		Vec3 arm1[sweepStretch + width], arm2[sweepStretch + width]; ///< from the centres to the contact point
		// four numbers each, read as rows
		alignas(32) double normal[sweepStretch + width][4]; ///< and the overlap
		alignas(32) double velocity[sweepStretch + width][4];
		alignas(32) double spinSum[sweepStretch + width][4];
		alignas(32) double spinDifference[sweepStretch + width][4];
		Passing<V> groups[sweepStretch / width + 1];

		HEXMEMBRANE_INLINE void move(int from, int to)
		{
			contact[to] = contact[from];
			arm1[to] = arm1[from];
			arm2[to] = arm2[from];
			for (auto* rows : {normal, velocity, spinSum, spinDifference}) store(rows[to], load<Four>(rows[from]));
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

	HEXMEMBRANE_INLINE static Lanes3<V> columns(const double (*rows)[4], V& fourth)
	{
		Lanes3<V> v;
		Rows<V>::loaded([&](int k) __attribute__((always_inline)) { return rows[k]; }).columns(v.x, v.y, v.z, fourth);
		return v;
	}
	HEXMEMBRANE_INLINE void measure(Batch& batch, int f) const { batch.groups[f].normal = columns(batch.normal + width * f, batch.groups[f].overlap); }
	HEXMEMBRANE_INLINE void follow(Batch& batch, int f) const
	{
		V unused;
		PairMotion<V>& motion = batch.groups[f].motion;
		motion.velocity = columns(batch.velocity + width * f, unused);
		motion.spinSum = columns(batch.spinSum + width * f, unused);
		motion.spinDifference = columns(batch.spinDifference + width * f, unused);
	}
	HEXMEMBRANE_INLINE void act(const Batch& batch, int f) const
	{
		const Passing<V>& group = batch.groups[f];
		const Lanes3<V> force = group.normalForce * group.normal + group.shear;
		for (int k = 0; k < width; ++k) {
			const int n = width * f + k, c = batch.contact[n];
			if (!s.store->bits[c]) continue; // has opened
			act(c, batch.arm1[n], batch.arm2[n], {force.x[k], force.y[k], force.z[k]}, {group.moment.x[k], group.moment.y[k], group.moment.z[k]},
			    group.normalForce[k]);
		}
	}
};

template <class V>
HEXMEMBRANE_INLINE void sweepBy(const BoundarySweep& sweep, BoundaryLoad& received)
{
	BoundaryGeometry<V> geometry{sweep, received, {sweep.boundary.velocity, sweep.boundary.spin}};
	sweepContacts<V>(geometry, *sweep.store, sweep.begin, sweep.end, sweep.dt, received.sums);
}

HEXMEMBRANE_WIDEST_LANES(void sweepWidest(const BoundarySweep& sweep, BoundaryLoad& received), sweepBy<Lanes<width>>(sweep, received))

} // namespace

void sweepBoundary(const BoundarySweep& sweep, BoundaryLoad& received) { sweepWidest(sweep, received); }

} // namespace hexmembrane
