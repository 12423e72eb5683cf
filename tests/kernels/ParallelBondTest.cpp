// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/Check.hpp"
#include "kernels/contact/ParallelBond.hpp"

#include "kernels/compact/BondTable.hpp"
#include "kernels/compact/CriticalStep.hpp"

#include "Support.hpp"
#include "oracle/ParallelBondReference.hpp"

#include <map>

namespace {

using namespace hexmembrane;

constexpr double inf = std::numeric_limits<double>::infinity(), pi = 3.14159265358979323846;
const ParallelStrength unbreakable{inf, inf, 0, 1};

/// Two spheres that move as told, with a bond along z; the second one stands higher.
struct BondedPair {
	double r1 = 1e-3, r2 = 1.5e-3, radius = 0.8e-3, kn = 2e12, ks = 5e11, dt = 1e-6;
	std::vector<Place> places{{{1e-3, 2e-3, 3e-3}, r1}, {{1e-3, 2e-3, 3e-3 + 2.6e-3}, r2}};
	std::vector<Motion> motions{{Vec3::Zero(), Vec3::Zero()}, {Vec3::Zero(), Vec3::Zero()}};
	BondTable table;

	BondedPair()
	{
		table.bonds.push_back(BondTable::between(7, 3, places[0], places[1], radius, kn, ks));
		const int ids[] = {7, 3};
		table.locate(ids, 2);
		table.step(places.data(), motions.data(), dt, unbreakable); // nothing has moved since it was made
	}
	double area() const { return pi * radius * radius; }
	double inertia() const { return pi * std::pow(radius, 4) / 4; }
	/// Moves the second sphere in one step (m, rad).
	void move(const Vec3& way, const Vec3& turn, const ParallelStrength& strength = unbreakable)
	{
		motions[1] = {way / dt, turn / dt};
		places[1].centre += way;
		table.step(places.data(), motions.data(), dt, strength);
	}
	std::vector<Load> loads() const
	{
		std::vector<Load> all(2, noLoad());
		table.forEachLoad([&](int row, const Load& load) { all[row] = load; });
		return all;
	}
};

void expectNear(const Vec3& found, const Vec3& wanted, double scale)
{
	for (int a = 0; a < 3; ++a) EXPECT_NEAR(found[a], wanted[a], 1e-12 * scale) << "component " << a;
}

TEST(ParallelBond, TensionAndCompression)
{
	for (const double way : {1e-6, -2e-6}) {
		BondedPair pair;
		pair.move({0, 0, way}, Vec3::Zero());
		const double force = pair.kn * pair.area() * way;
		// the way itself is the difference of two distances a thousand times as long
		EXPECT_NEAR(pair.loads()[0].force[2], force, 1e-12 * std::abs(force) * 2.6e-3 / std::abs(way));
		expectNear(pair.loads()[0].force, -pair.loads()[1].force, std::abs(force));
		expectNear(pair.loads()[0].torque, Vec3::Zero(), std::abs(force) * pair.r1);
		EXPECT_NEAR(pair.table.energy(), 0.5 * force * way, 1e-8 * force * way);
	}
}

TEST(ParallelBond, Torsion)
{
	BondedPair pair;
	const double angle = 1e-3, moment = pair.ks * 2 * pair.inertia() * angle;
	pair.move(Vec3::Zero(), {0, 0, angle});
	expectNear(pair.loads()[1].torque, {0, 0, -moment}, moment);
	expectNear(pair.loads()[0].torque, {0, 0, moment}, moment);
	EXPECT_NEAR(pair.table.energy(), 0.5 * moment * angle, 1e-12 * moment * angle);
}

TEST(ParallelBond, BendingAboutTheContactPoint)
{
	BondedPair pair;
	const double angle = 1e-9, moment = pair.kn * pair.inertia() * angle, arm = BondTable::armsOf(pair.table.bonds[0], 2.6e-3).second;
	// the second sphere turns about the contact point, which then does not move
	pair.move({-arm * angle, 0, 0}, {0, angle, 0});
	EXPECT_NEAR(pair.loads()[1].torque[1], -moment, 1e-6 * moment); // the step turns the contact by 1e-9 too
	EXPECT_NEAR(pair.loads()[0].torque[1], moment, 1e-6 * moment);
	EXPECT_NEAR(pair.table.bonds[0].loads.bending[1], -moment, 1e-12 * moment);
	EXPECT_LT(pair.table.bonds[0].loads.shear.norm(), 1e-6 * moment / pair.radius);
}

TEST(ParallelBond, ShearAndItsLevers)
{
	BondedPair pair;
	const double way = 1e-10, force = pair.ks * pair.area() * way, overlap = pair.r1 + pair.r2 - 2.6e-3;
	pair.move({way, 0, 0}, Vec3::Zero());
	const auto loads = pair.loads();
	EXPECT_NEAR(loads[1].force[0], -force, 1e-7 * force);
	EXPECT_NEAR(pair.table.bonds[0].loads.shear[0], -force, 1e-12 * force);
	EXPECT_NEAR(loads[1].torque[1], force * (pair.r2 - 0.5 * overlap), 1e-7 * force * pair.r2);
	EXPECT_NEAR(loads[0].torque[1], force * (pair.r1 - 0.5 * overlap), 1e-7 * force * pair.r1);
	// no moment of the whole
	const Vec3 about = loads[0].torque + loads[1].torque + (pair.places[1].centre - pair.places[0].centre).cross(loads[1].force);
	EXPECT_LT(about.norm(), 1e-12 * force * pair.r1);
}

// A small displacement and rotation at once, in any direction, against springs that are summed one by one.
TEST(ParallelBond, IsADiscOfSprings)
{
	std::mt19937_64 random(5);
	std::uniform_real_distribution<double> u(-1, 1);
	for (int i = 0; i < 20; ++i) {
		const ParallelBond<double> bond{1e-3 * (1.2 + u(random)), 1e12 * (1.5 + u(random)), 1e12 * (1.1 + u(random)), 1e-2};
		const Vec3 normal = Vec3(u(random), u(random), u(random)).normalized(), way = 1e-6 * Vec3(u(random), u(random), u(random)),
		           turn = 1e-3 * Vec3(u(random), u(random), u(random));
		ParallelLoads<double> loads{0, 0, Vec3::Zero(), Vec3::Zero(), normal};
		advanceParallel<double>(bond, bond.rest + way.dot(normal), normal, {way, Vec3::Zero(), turn}, 1, loads);
		const auto disc = reference::SpringDisc{bond.radius, bond.kn, bond.ks, normal}.displaced(way, turn);
		const double force = disc.force.norm(), moment = disc.moment.norm();
		// 1e-12 of the forces, but for the distance, whose sum with the way is rounded
		EXPECT_LT((loads.normal * normal + loads.shear - disc.force).norm(), 1e-12 * force + 1e-17 * bond.kn * bond.area());
		EXPECT_LT((loads.bending + loads.twist * normal - disc.moment).norm(), 1e-12 * moment);
		EXPECT_NEAR(bondEnergy(bond, loads), disc.energy, 1e-10 * disc.energy);
		EXPECT_NEAR(stressOf<double>(bond, loads, 1).tension, disc.tension, 1e-7 * std::abs(disc.tension) + 1e-7 * bond.kn * bond.radius * turn.norm());
	}
}

TEST(ParallelBond, StressesAreThoseOfABeam)
{
	const ParallelBond<double> bond{2e-3, 1e12, 1e12, 1e-2};
	const double area = pi * 4e-6, modulus = pi * 8e-9 / 4; // of bending: I/R
	const ParallelLoads<double> loads{-3, -4e-3, {0, 6, 0}, {0, 5e-3, 0}, {1, 0, 0}};
	for (const double factor : {0., 0.3, 1.}) {
		const auto stress = stressOf<double>(bond, loads, factor);
		EXPECT_DOUBLE_EQ(stress.mean, 3 / area);
		EXPECT_DOUBLE_EQ(stress.tension, 3 / area + factor * 5e-3 / modulus);
		EXPECT_DOUBLE_EQ(stress.shear, 6 / area + factor * 4e-3 / (2 * modulus));
	}
}

TEST(ParallelBond, BreaksInTensionFirstThenInShear)
{
	const ParallelStrength strength{1e6, 2e6, 0.5, 1};
	EXPECT_EQ(bondBreak(strength, {1e6, 1e6, 1e6}), BondBreak::none) << "strengths are reached, not exceeded";
	EXPECT_EQ(bondBreak(strength, {1.0001e6, 9e6, 1e6}), BondBreak::tension);
	EXPECT_EQ(bondBreak(strength, {0.9e6, 1.6e6, 0.9e6}), BondBreak::shear) << "tension takes some of the shear strength";
	EXPECT_EQ(bondBreak(strength, {-3e6, 3.49e6, -3e6}), BondBreak::none) << "pressure adds to it";
	EXPECT_EQ(bondBreak(strength, {-3e6, 3.51e6, -3e6}), BondBreak::shear);
	EXPECT_EQ(bondBreak({inf, inf, 0.5, 1}, {1e30, 1e30, 0}), BondBreak::none);
	EXPECT_EQ(bondBreak({0, 0, 0, 1}, {0, 0, 0}), BondBreak::none);
}

TEST(ParallelBond, ABreakTakesAllLoadsAndSetsTheEnergyFree)
{
	BondedPair pair;
	const double way = 1e-6, stress = pair.kn * way;
	pair.move({0, 0, way}, Vec3::Zero(), {1.01 * stress, inf, 0, 1});
	EXPECT_EQ(pair.table.bonds.size(), 1u);
	const double held = pair.table.energy();
	pair.move(Vec3::Zero(), Vec3::Zero(), {0.99 * stress, inf, 0, 1});
	EXPECT_TRUE(pair.table.bonds.empty());
	EXPECT_EQ(pair.table.tensileBreaks, 1);
	EXPECT_EQ(pair.table.shearBreaks, 0);
	EXPECT_NEAR(pair.table.freed, held, 1e-12 * held);
	EXPECT_EQ(pair.table.energy(), 0);
	for (const Load& load : pair.loads()) EXPECT_TRUE(load.force.isZero(0) && load.torque.isZero(0));
	pair.move({0, 0, way}, Vec3::Zero());
	EXPECT_EQ(pair.table.tensileBreaks, 0);
	int loaded = 0;
	pair.table.forEachLoad([&](int, const Load&) { ++loaded; });
	EXPECT_EQ(loaded, 0);
}

// Bending alone counts by the moment factor: without it the same bond holds.
TEST(ParallelBond, TheMomentFactorDecides)
{
	for (const double factor : {1., 0.}) {
		BondedPair pair;
		const double angle = 1e-6, stress = pair.kn * angle * pair.radius;
		pair.move(Vec3::Zero(), {angle, 0, 0}, {0.9 * stress, inf, 0, factor});
		EXPECT_EQ(pair.table.bonds.size(), factor > 0 ? 0u : 1u);
	}
}

// A pair that turns as one body, once round: loads turn along, with an error of the step's order, and no load comes of it.
TEST(ParallelBond, TurnsWithItsBodies)
{
	double last = 0;
	for (const int steps : {1000, 2000}) {
		BondedPair pair;
		pair.move({1e-9, 0, 2e-9}, {0, 1e-6, 2e-6});
		const ParallelLoads<double> before = pair.table.bonds[0].loads;
		const Vec3 spin = 2 * pi / (steps * pair.dt) * Vec3(1, -2, 0.5).normalized(), middle = pair.places[0].centre,
		           branch = pair.places[1].centre - middle;
		for (int i = 1; i <= steps; ++i) {
			const auto turned = [&](double step) { return Vec3(Eigen::AngleAxisd(step * pair.dt * spin.norm(), spin.normalized()) * branch); };
			pair.places[1].centre = middle + turned(i);
			// as leapfrog moves it: velocity times step is the way of the step
			pair.motions = {{Vec3::Zero(), spin}, {(turned(i) - turned(i - 1)) / pair.dt, spin}};
			pair.table.step(pair.places.data(), pair.motions.data(), pair.dt, unbreakable);
		}
		const ParallelLoads<double>& after = pair.table.bonds[0].loads;
		EXPECT_NEAR(after.twist, before.twist, 1e-9 * std::abs(before.twist));
		const double error = (after.bending - before.bending).norm() / before.bending.norm();
		EXPECT_LT(error, 4 * pi * pi / steps);
		if (last > 0) {
			EXPECT_NEAR(error / last, 0.5, 0.02);
		}
		last = error;
	}
}

// Work done by the bodies = gain in elastic energy, by the trapezoid rule, whatever the path.
TEST(ParallelBond, WorkIsElastic)
{
	std::mt19937_64 random(11);
	std::uniform_real_distribution<double> u(-1, 1);
	BondedPair pair;
	double work = 0;
	std::vector<Load> before = pair.loads();
	for (int i = 0; i < 500; ++i) {
		const Vec3 way = 1e-11 * Vec3(u(random), u(random), u(random)), turn = 1e-8 * Vec3(u(random), u(random), u(random));
		pair.move(way, turn);
		const std::vector<Load> after = pair.loads();
		work -= 0.5 * (before[1].force + after[1].force).dot(way) + 0.5 * (before[1].torque + after[1].torque).dot(turn);
		before = after;
	}
	EXPECT_GT(pair.table.energy(), 0);
	EXPECT_NEAR(work, pair.table.energy(), 1e-4 * pair.table.energy());
}

/// A beam of n equal spheres that touch, bonded, the first one held, with a force along x on the last.
struct Cantilever {
	int n;
	double r = 1e-3, radius = 1e-3, kn = 1e12, ks = 4e11, force = 1e-7, dt = 1e-6;
	double area() const { return pi * radius * radius; }
	double inertia() const { return pi * std::pow(radius, 4) / 4; }
	double moment(int bond) const { return force * r * (2 * (n - 1 - bond) - 1); } ///< about its contact point
	/// Deflection of the last centre by virtual work (m): springs of shear and bending alone.
	double deflection() const
	{
		double sum = 0;
		for (int b = 0; b + 1 < n; ++b) sum += force / (ks * area()) + moment(b) * moment(b) / force / (kn * inertia());
		return sum;
	}
	/// The same of Timoshenko's beam with the modulus kn 2r, whose shear stiffness G A kappa is ks A 2r.
	double beam() const
	{
		const double length = 2 * r * (n - 1);
		return force * std::pow(length, 3) / (3 * kn * 2 * r * inertia()) + force * length / (ks * area() * 2 * r);
	}
};

// Displaced in one step by the closed form, each sphere but the held one is in balance.
TEST(ParallelBond, CantileverIsABeamOfSprings)
{
	for (const int n : {2, 3, 11, 41}) {
		const Cantilever beam{n};
		std::vector<Place> places;
		std::vector<Motion> motions(n, {Vec3::Zero(), Vec3::Zero()});
		std::vector<int> ids;
		for (int k = 0; k < n; ++k) {
			places.push_back({{0, 0, 2 * beam.r * k}, beam.r});
			ids.push_back(k);
		}
		BondTable table;
		for (int k = 0; k + 1 < n; ++k) table.bonds.push_back(BondTable::between(k, k + 1, places[k], places[k + 1], beam.radius, beam.kn, beam.ks));
		table.locate(ids.data(), n);
		table.step(places.data(), motions.data(), beam.dt, unbreakable);
		double way = 0, slope = 0;
		for (int k = 1; k < n; ++k) {
			const double before = slope;
			slope += beam.moment(k - 1) / (beam.kn * beam.inertia());
			way += beam.r * (before + slope) + beam.force / (beam.ks * beam.area());
			motions[k] = {Vec3(way / beam.dt, 0, 0), Vec3(0, slope / beam.dt, 0)};
			places[k].centre[0] += way;
		}
		EXPECT_NEAR(way, beam.deflection(), 1e-12 * way);
		table.step(places.data(), motions.data(), beam.dt, unbreakable);
		std::vector<Load> loads(n, noLoad());
		table.forEachLoad([&](int row, const Load& load) { loads[row] = load; });
		loads.back().force[0] += beam.force;
		for (int k = 1; k < n; ++k) {
			EXPECT_LT(Vec3(loads[k].force[0], loads[k].force[1], 0).norm(), 1e-5 * beam.force) << k << " of " << n;
			EXPECT_LT(std::abs(loads[k].force[2]), 1e-15 * beam.kn * beam.area() * 2 * beam.r * n) << "distances are rounded";
			EXPECT_LT(loads[k].torque.norm(), 1e-5 * beam.force * beam.r * n) << k << " of " << n;
		}
		EXPECT_NEAR(loads[0].torque[1], beam.force * 2 * beam.r * (n - 1), 1e-5 * beam.force * beam.r * n);
	}
}

TEST(ParallelBond, LongCantileversAreTimoshenkos)
{
	double last = 0;
	for (const int n : {6, 11, 21, 41}) {
		const Cantilever beam{n};
		const double error = std::abs(beam.deflection() / beam.beam() - 1);
		if (last > 0) {
			EXPECT_NEAR(last / error, 4, 0.3) << "second order in the number of spheres";
		}
		last = error;
	}
	EXPECT_LT(last, 2e-4);
}

// Of a pair without contacts: the fastest of the four springs alone, where they are not coupled.
TEST(ParallelBond, CriticalStepOfEachSpring)
{
	const double m = 1e-5, r = 1e-3, inertia = 0.4 * m * r * r;
	const auto square = [&](const LinearLaw<double>& law, double twist) {
		SphereAssembly flat;
		flat.setSkin(1e-4);
		flat.setSpheres({{0, {{0, 0, 0}, r}, {Vec3::Zero(), Vec3::Zero()}, m, inertia, 0, false},
		                 {1, {{0, 0, 2.1e-3}, r}, {Vec3::Zero(), Vec3::Zero()}, m, inertia, 0, false}},
		                2);
		CriticalStep step(flat);
		step.addJoint(0, 1, {0, 0, 1}, 1.05e-3, 1.05e-3, law, twist);
		return std::pow(2 / step.compute(1e-9, 100000), 2);
	};
	EXPECT_NEAR(square({3e4, 0, 0, 0, 0}, 0), 2 * 3e4 / m, 1e-6 * 3e4 / m);
	EXPECT_NEAR(square({1, 3e4, 0, 0, 0}, 0), 2 * 3e4 * (1 / m + 1.05e-3 * 1.05e-3 / inertia), 1e-5 * 3e4 / m);
	EXPECT_NEAR(square({1, 0, 0, 0.3, 0}, 0), 2 * 0.3 / inertia, 1e-6 * 0.3 / inertia);
	EXPECT_NEAR(square({1, 0, 0, 0, 0}, 0.3), 2 * 0.3 / inertia, 1e-6 * 0.3 / inertia);
}

// A bond that is made with the loads of another one goes on as that one, bit by bit but for the rest length's rounding.
TEST(BondTable, GoesOnFromLoads)
{
	BondedPair pair, taken;
	pair.move({3e-7, 1e-7, 2e-7}, {1e-4, -2e-4, 3e-4});
	const BondTable::Bond& old = pair.table.bonds[0];
	taken.places = pair.places;
	const BondTable::Bond bare = BondTable::between(7, 3, pair.places[0], pair.places[1], pair.radius, pair.kn, pair.ks);
	taken.table.bonds[0] =
	        BondTable::loaded(bare, old.loads.normal * old.loads.axis + old.loads.shear, old.loads.bending + old.loads.twist * old.loads.axis);
	EXPECT_NEAR(taken.table.bonds[0].made.rest, old.made.rest, 1e-15 * pair.r1);
	EXPECT_NEAR(BondTable::distanceOf(taken.table.bonds[0]), (pair.places[1].centre - pair.places[0].centre).norm(), 1e-15);
	taken.table.step(taken.places.data(), taken.motions.data(), pair.dt, unbreakable); // nothing has moved
	for (BondedPair* each : {&pair, &taken}) each->move({-1e-7, 2e-7, 1e-7}, {2e-4, 1e-4, -1e-4});
	for (int row = 0; row < 2; ++row) {
		expectNear(taken.loads()[row].force, pair.loads()[row].force, 1e4 * pair.loads()[row].force.norm());
		expectNear(taken.loads()[row].torque, pair.loads()[row].torque, 1e4 * pair.loads()[row].torque.norm());
	}
}

// Rows in another order, bonds in another order: the same loads.
TEST(BondTable, FindsItsSpheresInAnyOrder)
{
	std::vector<Place> places{{{0, 0, 0}, 1e-3}, {{0, 0, 2e-3}, 1e-3}, {{2e-3, 0, 0}, 1e-3}};
	std::vector<Motion> motions(3, {Vec3::Zero(), Vec3::Zero()});
	const int ids[] = {4, 9, 2}, turned[] = {2, 4, 9};
	BondTable table;
	table.bonds.push_back(BondTable::between(4, 2, places[0], places[2], 1e-3, 1e12, 1e12));
	table.bonds.push_back(BondTable::between(9, 4, places[1], places[0], 1e-3, 1e12, 1e12));
	table.locate(ids, 3);
	EXPECT_EQ(table.bonds[0].id1, 9) << "sorted by the rows";
	table.step(places.data(), motions.data(), 1e-6, unbreakable);
	places[1].centre[2] += 1e-8;
	places[2].centre[0] -= 1e-8;
	table.step(places.data(), motions.data(), 1e-6, unbreakable);
	std::map<int, Vec3> first, second;
	table.forEachLoad([&](int row, const Load& load) { first[ids[row]] = load.force; });
	EXPECT_GT(first[4][2], 0);
	EXPECT_LT(first[4][0], 0);
	table.locate(turned, 3);
	const std::vector<Place> moved{places[2], places[0], places[1]};
	table.step(moved.data(), motions.data(), 1e-6, unbreakable);
	table.forEachLoad([&](int row, const Load& load) { second[turned[row]] = load.force; });
	EXPECT_EQ(first, second);
	const int lacking[] = {4, 9};
	EXPECT_THROW(table.locate(lacking, 2), FieldError);
}

} // namespace
