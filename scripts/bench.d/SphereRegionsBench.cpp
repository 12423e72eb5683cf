// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
// Cost of 10,000 measurement regions in the study's 7,045 grains, one thread, time a call.
#include "kernels/base/Random.hpp"
#include "kernels/measure/SphereRegions.hpp"
#include "kernels/packing/SpherePacking.hpp"

#include <benchmark/benchmark.h>

using namespace hexmembrane;

namespace {

const double cylinderRadius = 0.02, height = 0.08;

SpherePacking packing()
{
	Random random(1);
	SpherePackingSpec spec{cylinderRadius, height, {}, 0.40};
	for (int i = 0; i < 7045; ++i) spec.radii.push_back(random.uniform(0.7e-3, 1.3e-3));
	return packSpheres(spec);
}

/// The packing with its contacts, as if it were swollen by 1 %.
SphereRegions specimen(int& contactCount)
{
	static const SpherePacking packed = packing();
	const auto& x = packed.centres;
	std::vector<double> radii;
	for (const double r : packed.radii) radii.push_back(1.01 * r);
	Random random(2);
	std::vector<MeasuredGrain> grains;
	for (std::size_t i = 0; i < x.size(); ++i) grains.push_back({x[i], radii[i], Vec3(random.uniform(), random.uniform(), random.uniform())});
	std::vector<MeasuredContact> contacts;
	const Vec3 corner(cylinderRadius, cylinderRadius, 0);
	const NearPairs pairs = findNearPairs(x, radii, 0, -corner, corner + Vec3(0, 0, height));
	for (int i = 0; i < int(x.size()); ++i)
		for (int p = pairs.start[i]; p < pairs.start[i + 1]; ++p) {
			const int j = pairs.other[p];
			contacts.push_back({i, j, x[i], x[j], 0.5 * (x[i] + x[j]), x[j] - x[i], (x[j] - x[i]).norm(), 0.4});
		}
	contactCount = int(contacts.size());
	return {grains, contacts};
}

/// range(0): radius of the regions in mm; the grains' mean diameter is about 2.5 mm.
void sphereRegions(benchmark::State& state)
{
	int contacts;
	const SphereRegions regions = specimen(contacts);
	const double radius = 1e-3 * double(state.range(0));
	Random random(3);
	std::vector<Vec3> centres;
	while (centres.size() < 10000) {
		const Vec3 x(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, height));
		if (x.head<2>().norm() < 1) centres.emplace_back(cylinderRadius * x[0], cylinderRadius * x[1], x[2]);
	}
	const std::vector<double> radii(centres.size(), radius);
	double grains = 0;
	for (auto _ : state) {
		const RegionMeasures found = regions.measure(centres, radii);
		grains = 0;
		for (const int count : found.grains) grains += count;
	}
	state.counters["contacts"] = contacts;
	state.counters["grainsInside"] = grains / double(centres.size());
}
BENCHMARK(sphereRegions)->ArgName("mm")->Arg(6)->Arg(10)->Unit(benchmark::kMillisecond);

void gatherRegions(benchmark::State& state)
{
	int contacts;
	for (auto _ : state) benchmark::DoNotOptimize(specimen(contacts));
}
BENCHMARK(gatherRegions)->Unit(benchmark::kMillisecond);

} // namespace
