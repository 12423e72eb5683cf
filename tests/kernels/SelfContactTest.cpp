// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/SelfContact.hpp"
#include "tests/kernels/oracle/SelfContactReference.hpp"

#include <omp.h>

using namespace hexmembrane;
using support::rowsOf;

namespace {

constexpr double kn = 2e4;

/// A tube squeezed flat, its opposite sides driven into each other, and shaken: hundreds of contacts of every kind.
HexLattice squeezed(unsigned seed)
{
	HexLattice tube = support::smallTube();
	for (Vec3& x : tube.positions) x[0] *= 0.08;
	support::shake(tube.positions, 4e-4, seed);
	return tube;
}

SelfContact ofTube(const HexLattice& tube) { return {tube, tube.sphereRadius, kn}; }

} // namespace

TEST(SelfContact, equalsTheOracle)
{
	for (unsigned seed = 1; seed < 4; ++seed) {
		const HexLattice tube = squeezed(seed);
		SelfContact fast = ofTube(tube);
		fast.compute(rowsOf(tube, tube.positions));
		const auto slow = reference::selfContacts(tube.bonds, tube.sphereRadius, kn, tube.positions);
		ASSERT_GT(slow.pairs.size(), 200u);
		ASSERT_EQ(fast.touching().size(), slow.pairs.size());
		for (size_t p = 0; p < slow.pairs.size(); ++p) EXPECT_EQ((std::array<int, 2>{fast.touching()[p].i, fast.touching()[p].j}), slow.pairs[p]);
		EXPECT_LT(support::relativeDifference(fast.force.vectors(), slow.force), 1e-13);
		EXPECT_NEAR(fast.energy() / slow.energy, 1, 1e-13);
		std::vector<int> contacts(tube.particles(), 0);
		for (const auto& pair : slow.pairs)
			for (const int v : pair) ++contacts[v];
		EXPECT_EQ(fast.mostOfOne(), *std::max_element(contacts.begin(), contacts.end()));
	}
}

TEST(SelfContact, isMinusTheGradientOfItsEnergyAndAddsUpToNothing)
{
	const HexLattice tube = squeezed(5);
	SelfContact kernel = ofTube(tube);
	kernel.compute(rowsOf(tube, tube.positions));
	const std::vector<Vec3> force = kernel.force.vectors();
	Vec3 total = Vec3::Zero(), moment = Vec3::Zero();
	double size = 0;
	for (size_t i = 0; i < force.size(); ++i) {
		total += force[i];
		moment += tube.positions[i].cross(force[i]);
		size += force[i].norm();
	}
	EXPECT_LT(total.norm(), 1e-13 * size);
	EXPECT_LT(moment.norm(), 1e-13 * size * tube.centreRadius);
	const double step = 1e-9;
	const auto& pair = kernel.touching()[kernel.touching().size() / 2];
	for (const int v : {pair.i, pair.j})
		for (int a = 0; a < 3; ++a) {
			double energy[2];
			for (int side = 0; side < 2; ++side) {
				std::vector<Vec3> moved = tube.positions;
				moved[v][a] += side ? step : -step;
				SelfContact other = ofTube(tube);
				other.compute(rowsOf(tube, moved));
				energy[side] = other.energy();
			}
			EXPECT_NEAR(force[v][a], -(energy[1] - energy[0]) / (2 * step), 1e-5 * force[v].norm());
		}
}

TEST(SelfContact, openSheetTouchesNothingAndItsListIsMadeOnce)
{
	HexLattice tube = support::smallTube();
	SelfContact kernel = ofTube(tube);
	for (int step = 0; step < 20; ++step) {
		support::shake(tube.positions, 1e-5, 10 + step);
		kernel.compute(rowsOf(tube, tube.positions));
		EXPECT_TRUE(kernel.touching().empty());
		EXPECT_GT(kernel.firstRing(), kernel.lastRing());
	}
	EXPECT_EQ(kernel.listsMade(), 1);
	EXPECT_EQ(kernel.energy(), 0);
	EXPECT_EQ(kernel.mostOfOne(), 0);
}

TEST(SelfContact, bitsDoNotDependOnWhenTheListWasMade)
{
	// closed step by step: lists are made on the way; a kernel that sees the end alone makes its own
	const HexLattice open = support::smallTube(), shut = squeezed(6);
	SelfContact onTheWay = ofTube(open);
	const int steps = 400;
	for (int step = 0; step <= steps; ++step) {
		std::vector<Vec3> x(open.positions);
		for (size_t i = 0; i < x.size(); ++i) x[i] += double(step) / steps * (shut.positions[i] - x[i]);
		onTheWay.compute(rowsOf(open, x));
		if (step % 80 != 0) continue;
		SelfContact fresh = ofTube(open);
		fresh.compute(rowsOf(open, x));
		EXPECT_EQ(onTheWay.force.vectors(), fresh.force.vectors()) << "step " << step;
		EXPECT_EQ(onTheWay.touching().size(), fresh.touching().size());
	}
	EXPECT_FALSE(onTheWay.touching().empty());
	EXPECT_GT(onTheWay.listsMade(), 5);
	EXPECT_LT(onTheWay.listsMade(), steps / 4);
	// and open again: no force stays behind
	onTheWay.compute(rowsOf(open, open.positions));
	for (const Vec3& f : onTheWay.force.vectors()) EXPECT_EQ(f, Vec3::Zero());
}

TEST(SelfContact, sameBitsForAnyNumberOfThreads)
{
	const HexLattice tube = squeezed(1);
	SelfContact one = ofTube(tube), three = one;
	const int before = omp_get_max_threads();
	omp_set_num_threads(1);
	one.compute(rowsOf(tube, tube.positions));
	omp_set_num_threads(3);
	three.compute(rowsOf(tube, tube.positions));
	omp_set_num_threads(before);
	EXPECT_EQ(one.force.vectors(), three.force.vectors());
}

TEST(SelfContact, centresThatCoincideHaveNoForce)
{
	HexLattice tube = support::smallTube();
	const int a = tube.at(2, 0), b = tube.at(2, tube.perRing / 2);
	tube.positions[b] = tube.positions[a];
	SelfContact kernel = ofTube(tube);
	kernel.compute(rowsOf(tube, tube.positions));
	for (const Vec3& f : kernel.force.vectors()) ASSERT_TRUE(f.allFinite());
	EXPECT_NEAR(kernel.energy(), reference::selfContacts(tube.bonds, tube.sphereRadius, kn, tube.positions).energy, 1e-9 * kernel.energy());
}

TEST(SelfContact, refusesWhatIsNoSphereOrPlace)
{
	HexLattice tube = support::smallTube();
	EXPECT_COMPLAINT(SelfContact(tube, 0, kn), "radius = 0");
	EXPECT_COMPLAINT(SelfContact(tube, 1, -1), "kn = -1");
	tube.positions[7][1] = std::numeric_limits<double>::quiet_NaN();
	SelfContact kernel = ofTube(tube);
	EXPECT_COMPLAINT(kernel.compute(rowsOf(tube, tube.positions)), "nan");
}
