// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/compact/FrictionlessContacts.hpp"

#include <algorithm>
#include <cmath>

using namespace hexmembrane;

namespace {

constexpr int grains = 23, particles = 17;

/// Grains and particles in a box, so dense that many overlap. Grain 5 has no partner, the others 1 to 17.
struct Scene {
	std::vector<Place> places;
	FrictionlessContacts contacts;
	std::vector<FrictionlessContacts::Pair> listed;

	explicit Scene(unsigned seed = 1)
	{
		const auto x = support::randomVectors(grains + particles, 1, seed);
		Random random(seed);
		for (int i = 0; i < grains + particles; ++i) places.push_back({x[i], random.uniform(0.2, 0.5)});
		for (int m = grains; m < grains + particles; ++m)
			for (int i = 0; i < grains; ++i)
				if (i != 5 && random.uniform() < 0.1 + 0.04 * i) listed.push_back({i, m});
		contacts.rebuild(listed, grains, particles, stiffness);
	}

	static double stiffness(int i, int m) { return 100 + i + 0.1 * m; }

	/// Pair by pair in the words of the law: kn u along the line of centres, where they overlap.
	Vec3 forceOn(int sphere, double* energy = nullptr) const
	{
		Vec3 sum = Vec3::Zero();
		for (const auto& pair : listed) {
			if (pair.grain != sphere && pair.particle != sphere) continue;
			const Place &own = places[sphere], &other = places[pair.grain == sphere ? pair.particle : pair.grain];
			const double overlap = own.radius + other.radius - (own.centre - other.centre).norm();
			if (overlap <= 0) continue;
			const double kn = stiffness(pair.grain, pair.particle);
			sum += kn * overlap * (own.centre - other.centre).normalized();
			if (energy) *energy += 0.5 * kn * overlap * overlap;
		}
		return sum;
	}

	/// Loads on grains and forces on particles, swept and gathered in parts that end at the given spheres.
	void run(const std::vector<int>& ends, std::vector<Load>& loads, std::vector<PaddedForce>& onParticle)
	{
		loads.assign(grains + particles, noLoad());
		onParticle.assign(particles, {Vec3::Constant(NAN), NAN});
		for (std::size_t e = 0; e < ends.size(); ++e) contacts.sweep(e == 0 ? 0 : ends[e - 1], ends[e], places, loads);
		for (std::size_t e = 0; e < ends.size(); ++e) contacts.gather(e == 0 ? 0 : ends[e - 1], ends[e], onParticle);
	}
};

} // namespace

TEST(FrictionlessContacts, equalThePlainSumOverPairs)
{
	for (const unsigned seed : {1u, 2u, 3u}) {
		Scene scene(seed);
		std::vector<Load> loads;
		std::vector<PaddedForce> onParticle;
		scene.run({grains + particles}, loads, onParticle);
		double energyTwice = 0;
		Vec3 sum = Vec3::Zero();
		for (int i = 0; i < grains; ++i) {
			EXPECT_LT((loads[i].force - scene.forceOn(i, &energyTwice)).norm(), 1e-12) << i;
			EXPECT_EQ(loads[i].torque.norm(), 0);
			sum += loads[i].force;
		}
		for (int m = 0; m < particles; ++m) {
			EXPECT_LT((onParticle[m].force - scene.forceOn(grains + m, &energyTwice)).norm(), 1e-12) << m;
			EXPECT_EQ(loads[grains + m].force.norm(), 0) << "those of particles are gathered apart";
			sum += onParticle[m].force;
		}
		EXPECT_EQ(loads[5].force.norm(), 0);
		EXPECT_LT(sum.norm(), 1e-12) << "action and reaction";
		EXPECT_NEAR(scene.contacts.energy(scene.places) / (0.5 * energyTwice), 1, 1e-12);
		EXPECT_GT(energyTwice, 10);
	}
}

TEST(FrictionlessContacts, partsOfTheWorkGiveTheSameBits)
{
	Scene scene;
	std::vector<Load> whole, parts;
	std::vector<PaddedForce> onWhole, onParts;
	scene.run({grains + particles}, whole, onWhole);
	scene.run({7, 8, grains + 3, grains + particles}, parts, onParts);
	for (int i = 0; i < grains; ++i) EXPECT_EQ((whole[i].force - parts[i].force).norm(), 0);
	for (int m = 0; m < particles; ++m) EXPECT_EQ((onWhole[m].force - onParts[m].force).norm(), 0);
}

TEST(FrictionlessContacts, aSweepAddsToWhatIsThere)
{
	Scene scene;
	std::vector<Load> loads(grains + particles, {Vec3(1, 2, 3), Vec3(4, 5, 6)});
	scene.contacts.sweep(0, grains, scene.places, loads);
	for (int i = 0; i < grains; ++i) {
		EXPECT_LT((loads[i].force - Vec3(1, 2, 3) - scene.forceOn(i)).norm(), 1e-12);
		EXPECT_EQ((loads[i].torque - Vec3(4, 5, 6)).norm(), 0);
	}
}

TEST(FrictionlessContacts, visitsWhatTouches)
{
	Scene scene;
	int touching = 0;
	for (const auto& pair : scene.listed)
		touching += (scene.places[pair.grain].centre - scene.places[pair.particle].centre).norm() <
		            scene.places[pair.grain].radius + scene.places[pair.particle].radius;
	int visits = 0;
	scene.contacts.forEachTouching(scene.places, [&](int i, int m, double kn, double overlap, const Vec3& normal) {
		++visits;
		EXPECT_EQ(kn, Scene::stiffness(i, m));
		const Vec3 branch = scene.places[m].centre - scene.places[i].centre;
		EXPECT_NEAR(overlap, scene.places[i].radius + scene.places[m].radius - branch.norm(), 1e-15);
		EXPECT_LT((normal - branch.normalized()).norm(), 1e-15) << "from grain to particle";
	});
	EXPECT_EQ(visits, touching);
	EXPECT_LT(touching, scene.contacts.size());
	EXPECT_EQ(scene.contacts.size(), int(scene.listed.size()));
}

TEST(FrictionlessContacts, anEmptyListDoesNothing)
{
	Scene scene;
	scene.contacts.rebuild({}, grains, particles, Scene::stiffness);
	scene.listed.clear();
	std::vector<Load> loads;
	std::vector<PaddedForce> onParticle;
	scene.run({grains + particles}, loads, onParticle);
	for (const Load& load : loads) EXPECT_EQ(load.force.norm(), 0);
	for (const PaddedForce& force : onParticle) EXPECT_EQ(force.force.norm(), 0) << "written, not left";
}
