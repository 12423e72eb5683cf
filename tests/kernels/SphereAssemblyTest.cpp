// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/compact/CriticalStep.hpp"
#include "kernels/boundary/CylinderContact.hpp"
#include "kernels/boundary/PlatenContact.hpp"
#include "kernels/compact/SphereAssembly.hpp"

#include <algorithm>
#include <cmath>
#include <map>

using namespace hexmembrane;

namespace {

constexpr double emod = 1e5, dt = 1e-6; // soft: spheres at random overlap deeply

ContactMaterial sand()
{
	ContactMaterial material;
	material.emod = emod;
	material.kratio = 3;
	material.friction = 0.4;
	material.rollingFriction = 0.3;
	return material;
}

ContactMaterial smoothMaterial()
{
	ContactMaterial material = sand();
	material.friction = 0;
	material.rollingFriction = 0;
	return material;
}

/// Grains and, behind them, smooth particles at random in a box that makes most of them touch; a platen below, a cylinder round it.
SphereAssembly randomScene(int grains, int particles, unsigned seed = 1)
{
	Random random(seed);
	std::vector<SphereAssembly::Sphere> spheres;
	const double box = 2.2e-3 * std::cbrt(grains + 0.3 * particles);
	const auto anywhere = [&](double size) {
		Vec3 v;
		for (int a = 0; a < 3; ++a) v[a] = random.uniform(-size, size);
		return v;
	};
	for (int i = 0; i < grains + particles; ++i) {
		const double r = i < grains ? random.uniform(1e-3, 1.6e-3) : 0.7e-3;
		const double mass = 4. / 3 * M_PI * r * r * r * 2650;
		spheres.push_back({100 + i, {anywhere(0.5 * box), r}, {anywhere(1), anywhere(500)}, mass, 0.4 * mass * r * r, i < grains ? 0 : 1, false});
	}
	SphereAssembly flat;
	const Vec3 below(0, 0, -0.5 * box - 1e-3);
	flat.boundaries.push_back({boundaryShape(PlatenBoundary{{below, Vec3::UnitZ(), box, 1e-3}}), below, Vec3(0, 0, 0.1), Vec3::Zero(), 0});
	flat.boundaries.push_back({boundaryShape(CylinderBoundary{Vec3::Zero(), 0.6 * box, box}), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), 0});
	flat.setSpheres(spheres, grains);
	flat.setSkin(1e-4);
	flat.setMaterials({sand(), smoothMaterial()});
	return flat;
}

/// Loads by body, whatever the order of the arrays.
std::map<int, Load> byId(const SphereAssembly& flat)
{
	std::map<int, Load> loads;
	for (int i = 0; i < flat.spheres(); ++i) {
		loads[flat.id[i]] = flat.loads[i];
		if (i >= flat.grains()) loads[flat.id[i]].force += flat.onParticle[i - flat.grains()].force;
	}
	return loads;
}

double largestDifference(const std::map<int, Load>& a, const std::map<int, Load>& b)
{
	double worst = 0, size = 0;
	for (const auto& [id, load] : a) {
		worst = std::max(worst, (load.force - b.at(id).force).norm() + 1e3 * (load.torque - b.at(id).torque).norm());
		size = std::max(size, load.force.norm());
	}
	return worst / size;
}

/// Forces of first contacts by trying every pair: kn u along the normal and ks dt v_t across it, cut by friction.
std::map<int, Load> bruteForce(const SphereAssembly& flat)
{
	std::map<int, Load> loads;
	for (int i = 0; i < flat.spheres(); ++i) loads[flat.id[i]] = noLoad();
	for (int i = 0; i < flat.grains(); ++i)
		for (int j = i + 1; j < flat.spheres(); ++j) {
			const Vec3 branch = flat.places[j].centre - flat.places[i].centre;
			const double u = flat.places[i].radius + flat.places[j].radius - branch.norm();
			if (u < 0) continue;
			const ContactLaw law = flat.lawOf(i, j);
			const Vec3 n = branch.normalized(), arm1 = (flat.places[i].radius - u / 2) * n, arm2 = -(flat.places[j].radius - u / 2) * n;
			const Vec3 v =
			        flat.motions[j].velocity + flat.motions[j].spin.cross(arm2) - flat.motions[i].velocity - flat.motions[i].spin.cross(arm1);
			const Vec3 shear = cutTo(-law.ks * dt * acrossNormal(v, n), law.friction * law.kn * u);
			const Vec3 moment = cutTo(-law.kr * dt * acrossNormal(flat.motions[j].spin - flat.motions[i].spin, n), law.rollingArm * law.kn * u);
			const Vec3 force = law.kn * u * n + shear;
			loads[flat.id[i]] += {-force, -arm1.cross(force) - moment};
			loads[flat.id[j]] += {force, arm2.cross(force) + moment};
		}
	for (const Boundary& boundary : flat.boundaries)
		for (int i = 0; i < flat.spheres(); ++i) {
			const auto touch = boundary.shape->touch(flat.places[i]);
			if (touch.overlap < 0 || !(flat.mask[i] & boundary.mask)) continue;
			const ContactLaw law = boundaryLaw(flat.materialOf(boundary.material), flat.materialOf(flat.material[i]), flat.places[i].radius);
			const Vec3 arm = touch.point - flat.places[i].centre, armB = touch.point - boundary.centre;
			const Vec3 v = flat.motions[i].velocity + flat.motions[i].spin.cross(arm) - boundary.velocity - boundary.spin.cross(armB);
			const Vec3 shear = cutTo(-law.ks * dt * acrossNormal(v, touch.normal), law.friction * law.kn * touch.overlap);
			const Vec3 moment =
			        cutTo(-law.kr * dt * acrossNormal(flat.motions[i].spin - boundary.spin, touch.normal), law.rollingArm * law.kn * touch.overlap);
			const Vec3 force = law.kn * touch.overlap * touch.normal + shear;
			loads[flat.id[i]] += {force, arm.cross(force) + moment};
		}
	return loads;
}

/// One step of everything: grains by the class, particles freely.
void step(SphereAssembly& flat, int threads)
{
	if (!flat.listsHold()) flat.makeLists();
	flat.computeLoads(dt, threads);
	ASSERT_EQ(flat.moveGrains(dt, 0.2, true, threads), -1);
	for (int i = flat.grains(); i < flat.spheres(); ++i) flat.places[i].centre += dt * flat.motions[i].velocity;
	flat.noteWay(2 * dt);
	flat.endStep();
}

} // namespace

TEST(SphereAssembly, loadsAreThoseOfEveryPair)
{
	for (unsigned seed = 1; seed < 4; ++seed) {
		SphereAssembly flat = randomScene(200, 300, seed);
		flat.makeLists();
		flat.computeLoads(dt, 1);
		EXPECT_LT(largestDifference(bruteForce(flat), byId(flat)), 1e-13);
		EXPECT_GT(flat.contacts.size(), 100);
		EXPECT_GT(flat.smooth.size(), 50);
	}
}

// Grains meet both boundaries, particles the cylinder alone; the order of the grains changes on the way.
TEST(SphereAssembly, boundariesMeetThoseOfTheirMask)
{
	SphereAssembly flat = randomScene(200, 300);
	for (int i = 0; i < flat.spheres(); ++i) flat.mask[i] = i < flat.grains() ? 1 | 4 : 1 | 2;
	flat.mask[7] = 1; // one grain that the platen does not meet either
	flat.boundaries[0].mask = 4;
	flat.makeLists();
	flat.computeLoads(dt, 1);
	EXPECT_LT(largestDifference(bruteForce(flat), byId(flat)), 1e-13);
	const auto meets = [&](int b) {
		int grains = 0, particles = 0;
		flat.boundaryContacts[b].forEachNear([&](int i) {
			(i < flat.grains() ? grains : particles) += 1;
			EXPECT_FALSE(b == 0 && flat.id[i] == 107);
		});
		return std::make_pair(grains, particles);
	};
	EXPECT_GT(meets(0).first, 5);
	EXPECT_EQ(meets(0).second, 0);
	EXPECT_GT(meets(1).second, 5);
}

TEST(SphereAssembly, listsMissNothingAndMemoriesMoveOver)
{
	// the same scene with lists that are hardly ever made and with lists made in every step
	SphereAssembly seldom = randomScene(200, 300), often = seldom;
	seldom.setSkin(1e-3);
	for (int s = 0; s < 300; ++s) {
		step(seldom, 1);
		often.makeLists();
		step(often, 1);
	}
	EXPECT_LT(seldom.listsMade(), 5);
	EXPECT_GE(often.listsMade(), 300);
	EXPECT_LT(largestDifference(byId(seldom), byId(often)), 1e-9);
	int remembered = 0;
	seldom.contacts.forEachTouching([&](int, int, const Contact& contact) { remembered += contact.memory.moment.norm() > 0; });
	EXPECT_GT(remembered, 50);
}

TEST(SphereAssembly, travelBoundsEveryWayUntilTheOrderChanges)
{
	SphereAssembly flat = randomScene(200, 300);
	flat.setSkin(1e-3);
	flat.makeLists();
	const Travel start = flat.travel();
	const std::vector<Place> then = flat.places;
	for (int s = 0; s < 20; ++s) step(flat, 1);
	ASSERT_EQ(flat.listsMade(), 1);
	EXPECT_EQ(flat.travel().order, start.order);
	double furthest = 0;
	for (int i = 0; i < flat.spheres(); ++i) furthest = std::max(furthest, (flat.places[i].centre - then[i].centre).norm());
	EXPECT_GT(furthest, 0);
	EXPECT_LE(furthest, (flat.travel().way - start.way) * (1 + 1e-12));
	flat.makeLists();
	EXPECT_NE(flat.travel().order, start.order);
	EXPECT_NE(randomScene(200, 300).travel().order, flat.travel().order);
}

TEST(SphereAssembly, threadsAgreeAndRepeat)
{
	SphereAssembly one = randomScene(300, 300), three = one, again = one;
	for (int s = 0; s < 50; ++s) {
		step(one, 1);
		step(three, 3);
		step(again, 3);
	}
	EXPECT_LT(largestDifference(byId(one), byId(three)), 1e-9);
	EXPECT_EQ(largestDifference(byId(again), byId(three)), 0);
	EXPECT_NEAR(one.sums.works.slip, three.sums.works.slip, 1e-9 * one.sums.works.slip);
	EXPECT_NEAR(one.kinetic, three.kinetic, 1e-9 * one.kinetic);
}

TEST(SphereAssembly, materialsActAtOnce)
{
	SphereAssembly flat = randomScene(100, 0);
	flat.makeLists();
	flat.computeLoads(dt, 1);
	ContactMaterial slippery = sand();
	slippery.friction = slippery.rollingFriction = 0;
	flat.setMaterials({slippery, smoothMaterial()});
	flat.computeLoads(dt, 1);
	flat.contacts.forEachTouching([](int, int, const Contact& contact) {
		EXPECT_EQ(contact.memory.shear.norm(), 0);
		EXPECT_EQ(contact.memory.moment.norm(), 0);
	});
}

TEST(SphereAssembly, pairsOfMaterialsHaveTheirOwn)
{
	SphereAssembly flat = randomScene(100, 30);
	flat.makeLists();
	PairProperties own;
	own.kn = 3e4;
	own.ks = 1e4;
	own.friction = 0.6; // above either's: smooth particles get a memory of their contacts
	flat.setMaterials({sand(), smoothMaterial()}, {{1, 0, own}});
	flat.computeLoads(dt, 1);
	int ofPair = 0, ofGrains = 0;
	flat.contacts.forEachTouching([&](int i, int j, const Contact& contact) {
		const bool mixed = flat.material[i] != flat.material[j];
		(mixed ? ofPair : ofGrains) += 1;
		const ContactLaw law = sphereLaw(sand(), sand(), flat.places[i].radius, flat.places[j].radius);
		EXPECT_DOUBLE_EQ(contact.law.kn, mixed ? 3e4 : law.kn);
		EXPECT_DOUBLE_EQ(contact.law.ks, mixed ? 1e4 : law.ks);
		EXPECT_DOUBLE_EQ(contact.law.friction, mixed ? 0.6 : law.friction);
		EXPECT_DOUBLE_EQ(flat.lawOf(i, j).kn, contact.law.kn);
	});
	EXPECT_GT(ofPair, 10);
	EXPECT_GT(ofGrains, 10);
	own = {};
	own.emod = 4e6;
	own.kratio = 2;
	flat.setMaterials({sand(), smoothMaterial()}, {{0, 1, own}});
	EXPECT_NEAR(flat.lawOf(0, flat.grains()).kn, 4e6 * contactShape(flat.places[0].radius, 0.7e-3), 1e-9 * 4e6);
	EXPECT_TRUE(flat.isSmooth(0, flat.grains()));
	flat.setMaterials({sand(), smoothMaterial()});
	EXPECT_EQ(flat.lawOf(0, flat.grains()).kn, sphereLaw(sand(), smoothMaterial(), flat.places[0].radius, 0.7e-3).kn);
}

TEST(SphereAssembly, otherFrictionLeavesListsAndMemories)
{
	// against one whose lists are made anew
	SphereAssembly stays = randomScene(100, 0);
	for (int s = 0; s < 50; ++s) step(stays, 1);
	SphereAssembly anew = stays;
	ContactMaterial slippery = sand();
	slippery.friction *= 0.2;
	const long made = stays.listsMade();
	stays.setMaterials({slippery, smoothMaterial()});
	EXPECT_TRUE(stays.listsHold());
	EXPECT_EQ(stays.listsMade(), made);
	anew.setMaterials({slippery, smoothMaterial()});
	anew.makeLists();
	const double before = stays.sums.works.slip;
	stays.computeLoads(dt, 1);
	anew.computeLoads(dt, 1);
	EXPECT_GT(stays.sums.works.slip, before) << "nothing slides";
	EXPECT_NEAR(stays.sums.works.slip, anew.sums.works.slip, 1e-12 * stays.sums.works.slip);
	EXPECT_LT(largestDifference(byId(stays), byId(anew)), 1e-12);
}

TEST(SphereAssembly, tooManyMaterialsAreRefused)
{
	SphereAssembly flat = randomScene(50, 0);
	flat.makeLists();
	EXPECT_COMPLAINT(flat.setMaterials(std::vector<ContactMaterial>(256, smoothMaterial())), "materials = 256");
	EXPECT_EQ(flat.materialOf(0).friction, sand().friction) << "nothing has changed";
}

TEST(SphereAssembly, lostGrainIsNamed)
{
	SphereAssembly flat = randomScene(50, 0);
	flat.makeLists();
	flat.computeLoads(dt, 1);
	const int at = int(std::find(flat.id.begin(), flat.id.end(), 107) - flat.id.begin());
	flat.motions[at].velocity = Vec3(60, 0, 0); // more than half a skin in a step
	EXPECT_EQ(flat.moveGrains(dt, 0, false, 1), 107);
	flat.motions[at].velocity = Vec3(0, std::nan(""), 0);
	EXPECT_EQ(flat.moveGrains(dt, 0, false, 2), 107);
}

namespace {

/// A row of equal smooth spheres in touch along x.
SphereAssembly chain(int count, double& mass, double& kn)
{
	const double r = 1e-3;
	mass = 1e-5;
	std::vector<SphereAssembly::Sphere> spheres;
	for (int i = 0; i < count; ++i) spheres.push_back({i, {Vec3(1.99e-3 * i, 0, 0), r}, {Vec3::Zero(), Vec3::Zero()}, mass, 1, 0, false});
	SphereAssembly flat;
	flat.setSpheres(spheres, count);
	flat.setSkin(1e-5);
	flat.setMaterials({smoothMaterial()});
	flat.makeLists();
	flat.computeLoads(dt, 1);
	kn = flat.lawOf(0, 1).kn;
	return flat;
}

} // namespace

TEST(CriticalStep, ofAChain)
{
	// free ends: omega^2 = 4 kn/m sin^2(pi (n-1)/(2n)), highest mode
	for (const int count : {2, 3, 8}) {
		double mass, kn;
		const SphereAssembly flat = chain(count, mass, kn);
		const double omega = 2 * std::sqrt(kn / mass) * std::sin(M_PI * (count - 1) / (2. * count));
		EXPECT_NEAR(CriticalStep(flat).compute() / (2 / omega), 1, 1e-3);
	}
}

TEST(CriticalStep, ofAGrainOnAParticle)
{
	// two masses on a spring: omega^2 = k (1/m + 1/M)
	const double mass = 1e-5, other = 3e-5, kn = 1e4;
	SphereAssembly flat;
	const auto sphere = [](int id, double z, double m) {
		return SphereAssembly::Sphere{id, {Vec3(0, 0, z), 1e-3}, {Vec3::Zero(), Vec3::Zero()}, m, 1, 0, false};
	};
	flat.setSpheres({sphere(0, 0, mass), sphere(1, 1, other)}, 1);
	flat.setSkin(1e-5);
	flat.setMaterials({smoothMaterial()});
	flat.makeLists();
	CriticalStep step(flat);
	step.addSupport(0, 0, Vec3::UnitX(), kn);
	EXPECT_NEAR(step.compute() / (2 / std::sqrt(kn * (1 / mass + 1 / other))), 1, 1e-3);
}

TEST(CriticalStep, ofASphereThatRollsOnAPlaten)
{
	// m x'' = -ks (x - r w), I w'' = r ks (x - r w) with kr: the larger root of the two by two problem
	SphereAssembly flat;
	const double r = 1e-3, mass = 1e-5, inertia = 0.4 * mass * r * r;
	ContactMaterial material = sand();
	const Vec3 below(0, 0, -1e-3);
	flat.boundaries.push_back({boundaryShape(PlatenBoundary{{below, Vec3::UnitZ(), 1e-2, 1e-3}}), below, Vec3::Zero(), Vec3::Zero(), 0});
	flat.setSpheres({{0, {Vec3(0, 0, 0.99 * r), r}, {Vec3::Zero(), Vec3::Zero()}, mass, inertia, 0, false}}, 1);
	flat.setSkin(1e-5);
	flat.setMaterials({material});
	flat.makeLists();
	flat.computeLoads(dt, 1);
	const ContactLaw law = boundaryLaw(material, material, r);
	const double arm = 0.995 * r; // to the middle of the overlap
	const double a = law.ks / mass, d = (law.ks * arm * arm + law.kr) / inertia, b = law.ks * arm / std::sqrt(mass * inertia);
	const double largest = 0.5 * (a + d) + std::sqrt(0.25 * (a - d) * (a - d) + b * b);
	EXPECT_NEAR(CriticalStep(flat).compute() / (2 / std::sqrt(std::max(largest, law.kn / mass))), 1, 1e-3);
}

TEST(CriticalStep, withoutSpringsThereIsNone)
{
	SphereAssembly flat;
	flat.setSpheres({{0, {Vec3::Zero(), 1e-3}, {Vec3::Zero(), Vec3::Zero()}, 1, 1, 0, false}}, 1);
	flat.setSkin(1e-5);
	flat.setMaterials({sand()});
	flat.makeLists();
	EXPECT_TRUE(std::isinf(CriticalStep(flat).compute()));
}
