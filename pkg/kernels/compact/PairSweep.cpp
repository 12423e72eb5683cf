// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/PairSweep.hpp"

#include "kernels/compact/Sweep.hpp"

namespace hexmembrane {

namespace {

/// Pairs of spheres as what meets.
template <class V>
struct PairGeometry {
	static constexpr int width = laneCount<V>;
	const PairSweep& s;

	struct Batch {
		int count = 0;
		int contact[sweepStretch + width], first[sweepStretch + width], second[sweepStretch + width];
		alignas(32) double branch[sweepStretch + width][4]; ///< from centre to centre, and the sum of the radii
		Passing<V> groups[sweepStretch / width + 1];
		V arm1[sweepStretch / width + 1], arm2[sweepStretch / width + 1]; ///< from the centres to the contact point

		HEXMEMBRANE_INLINE void move(int from, int to)
		{
			contact[to] = contact[from];
			first[to] = first[from];
			second[to] = second[from];
			store(branch[to], load<Four>(branch[from]));
		}
	};

	HEXMEMBRANE_INLINE Load& loadOf(int j) const { return j < s.to ? s.loads[j] : s.spill[j - s.to]; }

	Meeting meet(int p) const
	{
		const int i = s.first[p], j = s.second[p];
		const Place &a = s.places[i], &b = s.places[j];
		const Vec3 branch = b.centre - a.centre;
		const double distance = branch.norm(), u = a.radius + b.radius - distance;
		const Vec3 normal = branch / distance;
		return {normal, u, s.motions[i], s.motions[j], (a.radius - 0.5 * u) * normal, -(b.radius - 0.5 * u) * normal};
	}

	void act(int p, const Meeting& m, const ContactStep& step, const Contact& contact) const
	{
		const Vec3 force = step.normal * m.normal + contact.memory.shear;
		const Vec3 moment = momentOf(contact.memory);
		s.loads[s.first[p]] += {-force, -m.arm1.cross(contact.memory.shear) - moment};
		loadOf(s.second[p]) += {force, m.arm2.cross(contact.memory.shear) + moment};
	}

	/// Of the pairs p .. p + n - 1, n at most the width. \return the bits of all of them
	HEXMEMBRANE_INLINE unsigned char pickGroup(int p, int n, Batch& batch) const
	{
		const int *const first = s.first + p, *const second = s.second + p;
		const StoredContact<double>* const contacts = s.store->contacts.data() + p;
		const unsigned char* const bits = s.store->bits.data() + p;
		const auto placesOf = [&](const int* spheres) __attribute__((always_inline)) {
			return Rows<V>::loaded([&](int k) __attribute__((always_inline)) { return s.places[spheres[k < n ? k : 0]].centre.data(); });
		};
		const Rows<V> one = placesOf(first), two = placesOf(second), branch = (two - one).withFourth(two + one);
		Lanes3<V> between;
		V reach;
		branch.columns(between.x, between.y, between.z, reach);
		const LaneMask<V> near = dot(between, between) > reach * reach ? LaneMask<V>{} : LaneMask<V>{} + 1;
		unsigned char any = 0;
		int count = batch.count;
#pragma GCC unroll 8
		for (int k = 0; k < width; ++k) {
			if (k >= n) break;
			// what later passes need of the second sphere and of the contact; the first sphere was there for the pair before
			__builtin_prefetch(s.motions + second[k]);
			__builtin_prefetch(s.loads + second[k], 1);
			__builtin_prefetch(contacts + k, 1);
			__builtin_prefetch(&contacts[k].springs, 1);
			store(batch.branch[count], branch.row(k));
			batch.contact[count] = p + k;
			batch.first[count] = first[k];
			batch.second[count] = second[k];
			// those that touch, or did, and have no bond
			count += (int(near[k]) | bits[k]) & ~(bits[k] / contactBonded) & 1;
			any |= bits[k];
		}
		batch.count = count;
		return any;
	}

	HEXMEMBRANE_INLINE bool pick(int p, int end, Batch& batch) const
	{
		unsigned char any = 0;
		for (; p + width <= end; p += width) any |= pickGroup(p, width, batch);
		if (p < end) any |= pickGroup(p, end - p, batch);
		return any & contactBonded;
	}

	HEXMEMBRANE_INLINE void measure(Batch& batch, int f) const
	{
		const int at = width * f;
		Passing<V>& group = batch.groups[f];
		Lanes3<V> branch;
		V reach;
		Rows<V>::loaded([&](int k) __attribute__((always_inline)) { return batch.branch[at + k]; }).columns(branch.x, branch.y, branch.z, reach);
		const V distance = squareRoot(dot(branch, branch));
		group.normal = (1 / distance) * branch;
		group.overlap = reach - distance;
		V radius{};
		for (int k = 0; k < width; ++k) radius[k] = s.places[batch.first[at + k]].radius;
		batch.arm1[f] = radius - 0.5 * group.overlap;
		batch.arm2[f] = (reach - radius) - 0.5 * group.overlap;
	}

	HEXMEMBRANE_INLINE void follow(Batch& batch, int f) const
	{
		const int at = width * f;
		Passing<V>& group = batch.groups[f];
		// velocity and the first component of the spin lie together, then the other two
		const auto motionOf = [&](const int* spheres, int from) __attribute__((always_inline)) {
			return Rows<V>::loaded([&](int k) __attribute__((always_inline)) { return s.motions[spheres[at + k]].velocity.data() + from; });
		};
		const Rows<V> low1 = motionOf(batch.first, 0), low2 = motionOf(batch.second, 0), high1 = motionOf(batch.first, 4),
		              high2 = motionOf(batch.second, 4);
		Lanes3<V> velocity;
		PairMotion<V>& motion = group.motion;
		V unused[3];
		(low2 - low1).columns(velocity.x, velocity.y, velocity.z, motion.spinDifference.x);
		(low1 + low2).columns(unused[0], unused[1], unused[2], motion.spinSum.x);
		(high2 - high1).withFirstTwo(high2 + high1).columns(motion.spinDifference.y, motion.spinDifference.z, motion.spinSum.y, motion.spinSum.z);
		// arm1 spin1 + arm2 spin2
		const Lanes3<V> turning =
		        (0.5 * (batch.arm1[f] + batch.arm2[f])) * motion.spinSum + (0.5 * (batch.arm2[f] - batch.arm1[f])) * motion.spinDifference;
		motion.velocity = velocity - cross(turning, group.normal);
	}

	HEXMEMBRANE_INLINE void act(const Batch& batch, int f) const
	{
		const int at = width * f;
		const Passing<V>& group = batch.groups[f];
		const Lanes3<V> force = group.normalForce * group.normal + group.shear, turning = cross(group.normal, group.shear);
		const Lanes3<V> torque1 = batch.arm1[f] * turning + group.moment, torque2 = group.moment - batch.arm2[f] * turning;
		const auto low1 = Rows<V>::ofColumns(force.x, force.y, force.z, torque1.x), low2 = Rows<V>::ofColumns(force.x, force.y, force.z, torque2.x);
		const auto both = Rows<V>::ofColumns(torque1.y, torque1.z, torque2.y, torque2.z);
#pragma GCC unroll 8
		for (int k = 0; k < width; ++k) {
			double *one = s.loads[batch.first[at + k]].force.data(), *two = loadOf(batch.second[at + k]).force.data();
			store(one, load<Four>(one) - low1.row(k));
			store(one + 4, load<Two>(one + 4) - lowHalf(both.row(k)));
			store(two, load<Four>(two) + low2.row(k));
			store(two + 4, load<Two>(two + 4) + highHalf(both.row(k)));
		}
	}
};

template <class V>
HEXMEMBRANE_INLINE void sweepBy(const PairSweep& sweep, SweepSums& sums)
{
	PairGeometry<V> geometry{sweep};
	sweepContacts<V>(geometry, *sweep.store, sweep.begin, sweep.end, sweep.dt, sums);
}

HEXMEMBRANE_WIDEST_LANES(void sweepWidest(const PairSweep& sweep, SweepSums& sums), sweepBy<Lanes<width>>(sweep, sums))

} // namespace

SweepSums sweepPairs(const PairSweep& sweep)
{
	SweepSums sums;
	sweepWidest(sweep, sums);
	return sums;
}

} // namespace hexmembrane
