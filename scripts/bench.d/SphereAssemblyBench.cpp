// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
// Cost of the compact tier's contacts, motion and lists in a dense packing, in ns a touching contact or a sphere.
#include "kernels/base/Random.hpp"
#include "kernels/packing/SpherePacking.hpp"
#include "kernels/boundary/CylinderContact.hpp"
#include "kernels/boundary/PlatenContact.hpp"
#include "kernels/compact/SphereAssembly.hpp"

#include <benchmark/benchmark.h>

using namespace hexmembrane;

namespace {

/// 7,000 spheres, swollen by 1 % so that they overlap, at random slow speeds, in a cylinder and on a platen.
SphereAssembly packed(double friction, double rollingFriction)
{
	static const SpherePacking packing = [] {
		Random random(1);
		SpherePackingSpec spec{0.02, 0.08, {}, 0.40};
		for (int i = 0; i < 7000; ++i) spec.radii.push_back(random.uniform(0.7e-3, 1.3e-3));
		return packSpheres(spec);
	}();
	Random random(2);
	const auto anywhere = [&](double size) {
		Vec3 v;
		for (int a = 0; a < 3; ++a) v[a] = random.uniform(-size, size);
		return v;
	};
	std::vector<SphereAssembly::Sphere> spheres;
	for (int i = 0; i < int(packing.radii.size()); ++i) {
		const double r = 1.01 * packing.radii[i], mass = 4. / 3 * M_PI * r * r * r * 2650;
		spheres.push_back({i, {packing.centres[i], r}, {anywhere(1e-3), anywhere(1)}, mass, 0.4 * mass * r * r, 0, false});
	}
	SphereAssembly flat;
	const Vec3 below(0, 0, -1e-3), middle(0, 0, 0.04);
	flat.boundaries.push_back({boundaryShape(PlatenBoundary{{below, Vec3::UnitZ(), 0.03, 1e-3}}), below, Vec3::Zero(), Vec3::Zero(), 0});
	flat.boundaries.push_back({boundaryShape(CylinderBoundary{middle, 0.02, 0.05}), middle, Vec3::Zero(), Vec3::Zero(), 0});
	flat.setSpheres(spheres, int(spheres.size()));
	flat.setSkin(0.3 * 0.7e-3);
	ContactMaterial sand;
	sand.emod = 1e8;
	sand.kratio = 3;
	sand.friction = friction;
	sand.rollingFriction = rollingFriction;
	flat.setMaterials({sand});
	flat.makeLists();
	return flat;
}

void perItem(benchmark::State& state, const char* name, double count)
{
	state.counters[name] = benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Loads of all contacts; spheres stand still, so that every step is the same.
void contacts(benchmark::State& state, double friction, double rollingFriction)
{
	SphereAssembly flat = packed(friction, rollingFriction);
	for (auto _ : state) {
		flat.computeLoads(1e-7, 1);
		benchmark::DoNotOptimize(flat.loads.data());
	}
	int touching = 0;
	flat.contacts.forEachTouching([&](int, int, const Contact&) { ++touching; });
	for (const BoundaryContacts& boundary : flat.boundaryContacts) boundary.forEachTouching([&](int, const Contact&) { ++touching; });
	state.counters["contacts"] = touching;
	state.counters["listed"] = flat.contacts.size();
	perItem(state, "perContact", touching);
}
void linear(benchmark::State& state) { contacts(state, 0.4, 0); }
void rollingResistance(benchmark::State& state) { contacts(state, 0.4, 0.5); }

void motion(benchmark::State& state)
{
	SphereAssembly flat = packed(0.4, 0.5);
	flat.computeLoads(1e-7, 1);
	for (auto _ : state) benchmark::DoNotOptimize(flat.moveGrains(1e-12, 0.2, false, 1));
	perItem(state, "perSphere", flat.grains());
}

void lists(benchmark::State& state)
{
	SphereAssembly flat = packed(0.4, 0.5);
	flat.computeLoads(1e-7, 1);
	for (auto _ : state) flat.makeLists();
	perItem(state, "perSphere", flat.grains());
}

/// Whole steps of a face-centred lattice of range(0)^3 cells, four spheres each, that overlap a little and hardly move.
void size(benchmark::State& state)
{
	const int n = int(state.range(0));
	const double spacing = 1e-3 * std::sqrt(2) * 1.998, mass = 4. / 3 * M_PI * 1e-9 * 2650;
	const Vec3 shifts[4] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
	Random random(1);
	std::vector<SphereAssembly::Sphere> spheres;
	for (const Vec3& shift : shifts)
		for (int x = 0; x < n; ++x)
			for (int y = 0; y < n; ++y)
				for (int z = 0; z < n; ++z) {
					const Vec3 velocity(random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3));
					spheres.push_back({int(spheres.size()),
					                   {spacing * (Vec3(x, y, z) + shift), 1e-3},
					                   {velocity, Vec3::Zero()},
					                   mass,
					                   0.4e-6 * mass,
					                   0,
					                   false});
				}
	SphereAssembly flat;
	flat.setSpheres(spheres, int(spheres.size()));
	flat.setSkin(3e-4);
	ContactMaterial sand;
	sand.emod = 6e7;
	sand.kratio = 3;
	sand.friction = 0.4;
	sand.rollingFriction = 0.5;
	flat.setMaterials({sand});
	flat.makeLists();
	for (auto _ : state) {
		flat.computeLoads(1e-9, 1);
		benchmark::DoNotOptimize(flat.moveGrains(1e-9, 0.2, false, 1));
	}
	state.counters["spheres"] = double(spheres.size());
	state.counters["listed"] = flat.contacts.size();
	perItem(state, "perSphere", double(spheres.size()));
}

BENCHMARK(size)->Arg(12)->Arg(20)->Arg(29)->Arg(42)->Arg(63);
BENCHMARK(linear);
BENCHMARK(rollingResistance);
BENCHMARK(motion);
BENCHMARK(lists);

} // namespace
