// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/PairSweep.hpp"

#include "kernels/compact/FourContacts.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

namespace {

/// Pairs that touch, or did.
struct Touching {
	/// Pairs looked at together: what is found of them stays in the first cache.
	static constexpr int look = 64;

	int count = 0;
	int pair[look + 4], first[look + 4], second[look + 4];
	alignas(32) double branch[look + 4][4]; ///< from centre to centre, and the sum of the radii
	Four fours[look / 4 + 1];
	Lanes arm1[look / 4 + 1], arm2[look / 4 + 1]; ///< from the centres to the contact point
};

inline Load& loadOf(const PairSweep& s, int j) { return j < s.to ? s.loads[j] : s.spill[j - s.to]; }

/// One pair, by the law's own formulas.
void sweepOne(const PairSweep& s, int p, int i, int j, SweepSums& sums)
{
	const Place &a = s.places[i], &b = s.places[j];
	const Vec3 branch = b.centre - a.centre;
	const double distance = branch.norm(), u = a.radius + b.radius - distance;
	const Vec3 normal = branch / distance;
	const double arm1 = a.radius - 0.5 * u, arm2 = b.radius - 0.5 * u;
	Vec3 force;
	ContactMemory memory = s.store->get(p);
	unsigned char bits = s.store->bits[p];
	const bool closed = advanceMemory(memory, bits, u, normal, s.motions[i], arm1 * normal, s.motions[j], -arm2 * normal, s.dt, force, sums);
	s.store->put(p, memory, bits);
	if (!closed) return;
	const Vec3 turning = normal.cross(memory.shear);
	s.loads[i] += {-force, -arm1 * turning - memory.moment};
	loadOf(s, j) += {force, memory.moment - arm2 * turning};
}

/// Adds those of the pairs p .. end - 1 that touch, or did, without a bond. \return whether there are bonds
HEXMEMBRANE_INLINE bool pick(const PairSweep& s, int p, int end, Touching& found)
{
	const int *const first = s.first, *const second = s.second;
	const unsigned char* const bits = s.store->bits.data();
	const Place* const places = s.places;
	int count = found.count;
	unsigned char any = 0;
	for (; p < end; ++p) {
		const int i = first[p], j = second[p];
		// what later passes need of the second sphere; the first one was there for the pair before
		__builtin_prefetch(s.motions + j);
		__builtin_prefetch(&loadOf(s, j), 1);
		const Lanes a = load4(places[i].centre.data()), b = load4(places[j].centre.data());
		const Lanes branch = __builtin_shufflevector(b - a, b + a, 0, 1, 2, 7);
		store4(found.branch[count], branch);
		found.pair[count] = p;
		found.first[count] = i;
		found.second[count] = j;
		const double square = branch[0] * branch[0] + branch[1] * branch[1] + branch[2] * branch[2];
		count += (!(square > branch[3] * branch[3]) & (bits[p] < contactBonded)) | (bits[p] == contactTouching);
		any |= bits[p];
	}
	found.count = count;
	return any & contactBonded;
}

HEXMEMBRANE_INLINE Lanes gather(const Place* places, const int* index)
{
	return Lanes{places[index[0]].radius, places[index[1]].radius, places[index[2]].radius, places[index[3]].radius};
}

/// Normal, overlap and arms of four pairs.
HEXMEMBRANE_INLINE void measure(const PairSweep& s, Touching& found, int f)
{
	const int at = 4 * f;
	Four& four = found.fours[f];
	Lanes3 branch{load4(found.branch[at]), load4(found.branch[at + 1]), load4(found.branch[at + 2])};
	Lanes reach = load4(found.branch[at + 3]);
	transpose(branch.x, branch.y, branch.z, reach);
	const Lanes distance = squareRoot(dot(branch, branch));
	four.normal = (1 / distance) * branch;
	four.overlap = reach - distance;
	found.arm1[f] = gather(s.places, found.first + at) - 0.5 * four.overlap;
	found.arm2[f] = gather(s.places, found.second + at) - 0.5 * four.overlap;
}

/// How they moved.
HEXMEMBRANE_INLINE void follow(const PairSweep& s, Touching& found, int f)
{
	const int at = 4 * f;
	Four& four = found.fours[f];
	// velocity and the first component of the spin lie together, then the other two
	Lanes low[4], high[4], firstSpin[4];
	for (int k = 0; k < 4; ++k) {
		const double *one = s.motions[found.first[at + k]].velocity.data(), *two = s.motions[found.second[at + k]].velocity.data();
		const HalfLanes spin1 = load2(one + 4), spin2 = load2(two + 4);
		const Lanes low1 = load4(one), low2 = load4(two);
		low[k] = low2 - low1;
		firstSpin[k] = low1 + low2;
		high[k] = joined(spin2 - spin1, spin2 + spin1);
	}
	transpose(low[0], low[1], low[2], low[3]);
	transpose(firstSpin[0], firstSpin[1], firstSpin[2], firstSpin[3]);
	transpose(high[0], high[1], high[2], high[3]);
	const Lanes3 spinDifference{low[3], high[0], high[1]}, spinSum{firstSpin[3], high[2], high[3]};
	const Lanes3 lever =
	        (0.5 * (found.arm1[f] + found.arm2[f])) * spinSum + (0.5 * (found.arm2[f] - found.arm1[f])) * spinDifference; // arm1 spin1 + arm2 spin2
	const Lanes3 velocity = Lanes3{low[0], low[1], low[2]} - cross(lever, four.normal);
	four.path = contactPath(four.normal, velocity, spinSum, spinDifference, s.dt);
}

/// Loads on the spheres.
HEXMEMBRANE_INLINE void act(const PairSweep& s, const Touching& found, int f)
{
	const int at = 4 * f;
	const Four& four = found.fours[f];
	const Lanes3 force = four.normalForce * four.normal + four.shear, turning = cross(four.normal, four.shear);
	const Lanes3 torque1 = found.arm1[f] * turning + four.moment, torque2 = four.moment - found.arm2[f] * turning;
	Lanes low1[4] = {force.x, force.y, force.z, torque1.x}, low2[4] = {force.x, force.y, force.z, torque2.x};
	Lanes both[4] = {torque1.y, torque1.z, torque2.y, torque2.z};
	transpose(low1[0], low1[1], low1[2], low1[3]);
	transpose(low2[0], low2[1], low2[2], low2[3]);
	transpose(both[0], both[1], both[2], both[3]);
	for (int k = 0; k < 4; ++k) {
		double *one = s.loads[found.first[at + k]].force.data(), *two = loadOf(s, found.second[at + k]).force.data();
		store4(one, load4(one) - low1[k]);
		store2(one + 4, load2(one + 4) - lowHalf(both[k]));
		store4(two, load4(two) + low2[k]);
		store2(two + 4, load2(two + 4) + highHalf(both[k]));
	}
}

HEXMEMBRANE_WIDEST void sweepWidest(const PairSweep& s, FourSums& sumsOfFours, SweepSums& sums)
{
	Touching found;
	for (int p = s.begin; p < s.end; p += Touching::look) {
		const int border = std::min(s.end, p + Touching::look);
		if (pick(s, p, border, found))
			for (int b = p; b < border; ++b)
				if (s.store->bits[b] & contactBonded) sweepOne(s, b, s.first[b], s.second[b], sums);
		// one after the other: in short loops without a bond between turns the processor works at several turns at once
		const int fours = found.count / 4;
		for (int f = 0; f < fours; ++f) measure(s, found, f);
		for (int f = 0; f < fours; ++f) follow(s, found, f);
		for (int f = 0; f < fours; ++f) advance(*s.store, found.pair + 4 * f, found.fours[f], sumsOfFours);
		for (int f = 0; f < fours; ++f) act(s, found, f);
		const int at = 4 * fours;
		// what is left of the last four goes first next time
		const int left = found.count - at;
		for (int k = 0; k < left; ++k) {
			found.pair[k] = found.pair[at + k];
			found.first[k] = found.first[at + k];
			found.second[k] = found.second[at + k];
			store4(found.branch[k], load4(found.branch[at + k]));
		}
		found.count = left;
	}
	for (int k = 0; k < found.count; ++k) sweepOne(s, found.pair[k], found.first[k], found.second[k], sums);
}

} // namespace

SweepSums sweepPairs(const PairSweep& sweep)
{
	SweepSums sums;
	FourSums fours;
	sweepWidest(sweep, fours, sums);
	fours.addTo(sums);
	return sums;
}

} // namespace hexmembrane
