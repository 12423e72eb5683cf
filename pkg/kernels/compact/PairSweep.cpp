// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/PairSweep.hpp"

#include "kernels/compact/Sweep.hpp"

namespace hexmembrane {

namespace {

/// Pairs of spheres as what meets.
struct PairGeometry {
	const PairSweep& s;

	struct Batch {
		int count = 0;
		int contact[sweepStretch + 4], first[sweepStretch + 4], second[sweepStretch + 4];
		alignas(32) double branch[sweepStretch + 4][4]; ///< from centre to centre, and the sum of the radii
		FourPassing fours[sweepStretch / 4 + 1];
		Lanes arm1[sweepStretch / 4 + 1], arm2[sweepStretch / 4 + 1]; ///< from the centres to the contact point

		HEXMEMBRANE_INLINE void move(int from, int to)
		{
			contact[to] = contact[from];
			first[to] = first[from];
			second[to] = second[from];
			store4(branch[to], load4(branch[from]));
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

	HEXMEMBRANE_INLINE bool pick(int p, int end, Batch& batch) const
	{
		const int *const first = s.first, *const second = s.second;
		const unsigned char* const bits = s.store->bits.data();
		const Place* const places = s.places;
		int count = batch.count;
		unsigned char any = 0;
		for (; p < end; ++p) {
			const int i = first[p], j = second[p];
			// what later passes need of the second sphere; the first one was there for the pair before
			__builtin_prefetch(s.motions + j);
			__builtin_prefetch(&loadOf(j), 1);
			const Lanes a = load4(places[i].centre.data()), b = load4(places[j].centre.data());
			const Lanes branch = __builtin_shufflevector(b - a, b + a, 0, 1, 2, 7);
			store4(batch.branch[count], branch);
			batch.contact[count] = p;
			batch.first[count] = i;
			batch.second[count] = j;
			const double square = branch[0] * branch[0] + branch[1] * branch[1] + branch[2] * branch[2];
			count += (!(square > branch[3] * branch[3]) & (bits[p] < contactBonded)) | (bits[p] == contactTouching);
			any |= bits[p];
		}
		batch.count = count;
		return any & contactBonded;
	}

	HEXMEMBRANE_INLINE Lanes radii(const int* index) const
	{
		return Lanes{s.places[index[0]].radius, s.places[index[1]].radius, s.places[index[2]].radius, s.places[index[3]].radius};
	}

	HEXMEMBRANE_INLINE void measure(Batch& batch, int f) const
	{
		const int at = 4 * f;
		FourPassing& four = batch.fours[f];
		Lanes3 branch{load4(batch.branch[at]), load4(batch.branch[at + 1]), load4(batch.branch[at + 2])};
		Lanes reach = load4(batch.branch[at + 3]);
		transpose(branch.x, branch.y, branch.z, reach);
		const Lanes distance = squareRoot(dot(branch, branch));
		four.normal = (1 / distance) * branch;
		four.overlap = reach - distance;
		batch.arm1[f] = radii(batch.first + at) - 0.5 * four.overlap;
		batch.arm2[f] = radii(batch.second + at) - 0.5 * four.overlap;
	}

	HEXMEMBRANE_INLINE void follow(Batch& batch, int f) const
	{
		const int at = 4 * f;
		FourPassing& four = batch.fours[f];
		// velocity and the first component of the spin lie together, then the other two
		Lanes low[4], high[4], firstSpin[4];
		for (int k = 0; k < 4; ++k) {
			const double *one = s.motions[batch.first[at + k]].velocity.data(), *two = s.motions[batch.second[at + k]].velocity.data();
			const HalfLanes spin1 = load2(one + 4), spin2 = load2(two + 4);
			const Lanes low1 = load4(one), low2 = load4(two);
			low[k] = low2 - low1;
			firstSpin[k] = low1 + low2;
			high[k] = joined(spin2 - spin1, spin2 + spin1);
		}
		transpose(low[0], low[1], low[2], low[3]);
		transpose(firstSpin[0], firstSpin[1], firstSpin[2], firstSpin[3]);
		transpose(high[0], high[1], high[2], high[3]);
		four.motion.spinDifference = {low[3], high[0], high[1]};
		four.motion.spinSum = {firstSpin[3], high[2], high[3]};
		// arm1 spin1 + arm2 spin2
		const Lanes3 turning =
		        (0.5 * (batch.arm1[f] + batch.arm2[f])) * four.motion.spinSum + (0.5 * (batch.arm2[f] - batch.arm1[f])) * four.motion.spinDifference;
		four.motion.velocity = Lanes3{low[0], low[1], low[2]} - cross(turning, four.normal);
	}

	HEXMEMBRANE_INLINE void act(const Batch& batch, int f) const
	{
		const int at = 4 * f;
		const FourPassing& four = batch.fours[f];
		const Lanes3 force = four.normalForce * four.normal + four.shear, turning = cross(four.normal, four.shear);
		const Lanes3 torque1 = batch.arm1[f] * turning + four.moment, torque2 = four.moment - batch.arm2[f] * turning;
		Lanes low1[4] = {force.x, force.y, force.z, torque1.x}, low2[4] = {force.x, force.y, force.z, torque2.x};
		Lanes both[4] = {torque1.y, torque1.z, torque2.y, torque2.z};
		transpose(low1[0], low1[1], low1[2], low1[3]);
		transpose(low2[0], low2[1], low2[2], low2[3]);
		transpose(both[0], both[1], both[2], both[3]);
		for (int k = 0; k < 4; ++k) {
			double *one = s.loads[batch.first[at + k]].force.data(), *two = loadOf(batch.second[at + k]).force.data();
			store4(one, load4(one) - low1[k]);
			store2(one + 4, load2(one + 4) - lowHalf(both[k]));
			store4(two, load4(two) + low2[k]);
			store2(two + 4, load2(two + 4) + highHalf(both[k]));
		}
	}
};

HEXMEMBRANE_WIDEST void sweepWidest(const PairSweep& sweep, SweepSums& sums)
{
	PairGeometry geometry{sweep};
	sweepContacts(geometry, *sweep.store, sweep.begin, sweep.end, sweep.dt, sums);
}

} // namespace

SweepSums sweepPairs(const PairSweep& sweep)
{
	SweepSums sums;
	sweepWidest(sweep, sums);
	return sums;
}

} // namespace hexmembrane
