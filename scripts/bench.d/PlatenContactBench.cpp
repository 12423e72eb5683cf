// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
// Cost of a contact search between a platen and a sphere (time a call), by the part of the platen that is near.
#include "kernels/boundary/PlatenContact.hpp"

#include <benchmark/benchmark.h>

#include <vector>

using namespace hexmembrane;

namespace {

/// range(0): 0 face, 1 side, 2 rim.
void platenContactBench(benchmark::State& state)
{
	const SolidCylinder solid{Vec3(0.1, 0.2, 0.3), Vec3(0.6, 0, 0.8), 0.020, 0.0025};
	const Vec3 across(0.8, 0, -0.6);
	std::vector<Vec3> centres(1024);
	for (size_t i = 0; i < centres.size(); i++) {
		const double share = static_cast<double>(i) / static_cast<double>(centres.size());
		const double rho = state.range(0) == 0 ? 0.019 * share : 0.0209, z = state.range(0) == 1 ? 0.002 * share : 0.0034;
		centres[i] = solid.centre + rho * across + z * solid.axis;
	}
	size_t i = 0;
	for (auto _ : state) {
		benchmark::DoNotOptimize(platenContact(solid, centres[i % centres.size()], 0.001));
		i++;
	}
}
BENCHMARK(platenContactBench)->ArgName("part")->Arg(0)->Arg(1)->Arg(2);

} // namespace
