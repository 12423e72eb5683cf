// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
// Cost of the membrane kernels, in ns a membrane particle and step (counter perParticle), fast against reference.
#include "kernels/membrane/BendingForce.hpp"
#include "kernels/membrane/BondForce.hpp"
#include "kernels/membrane/FacetContact.hpp"
#include "kernels/membrane/HexLattice.hpp"
#include "kernels/membrane/PressureForce.hpp"
#include "kernels/membrane/SelfContact.hpp"
#include "tests/kernels/oracle/BendingForceReference.hpp"
#include "tests/kernels/oracle/BondForceReference.hpp"
#include "tests/kernels/oracle/PressureForceReference.hpp"

#include <benchmark/benchmark.h>

using namespace hexmembrane;

namespace {

/// The study's membrane; range(0) is the particle radius in micrometres: 500 (12,726 particles), 250 (50,702).
HexLattice membrane(const benchmark::State& state) { return makeHexLattice({0.020, 0.080, state.range(0) * 1e-6, Placement::centred, 2, 2}); }

void perParticle(benchmark::State& state, size_t particles)
{
	state.counters["perParticle"] =
	        benchmark::Counter(static_cast<double>(particles), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
	state.counters["particles"] = static_cast<double>(particles);
}

BondForce loaded(const HexLattice& l, const BondLaw& law, reference::Memory& bonds)
{
	BondForce kernel(l, law);
	for (int k = 0; k < l.rings; ++k) {
		for (int i = 0; i < l.perRing; ++i) {
			kernel.position.set(k, i, l.positions[l.at(k, i)] * (1 + 1e-4 * std::sin(i + 3. * k)));
			if (law.ks > 0) {
				kernel.velocity.set(k, i, Vec3(std::sin(i), std::cos(k), 0.1));
				kernel.spin.set(k, i, Vec3(1, std::sin(i), std::cos(k)));
			}
		}
		kernel.position.wrap(k);
		if (law.ks > 0) {
			kernel.velocity.wrap(k);
			kernel.spin.wrap(k);
		}
	}
	bonds.restLength.assign(l.bondCount(), 2 * l.sphereRadius);
	return kernel;
}

BondLaw law(double ks)
{
	BondLaw l;
	l.kn = 346;
	l.ks = ks;
	return l;
}

void bondsCentral(benchmark::State& state)
{
	const HexLattice l = membrane(state);
	reference::Memory bonds;
	BondForce kernel = loaded(l, law(0), bonds);
	for (auto _ : state) {
		kernel.compute(bonds.state(), 1e-6);
		benchmark::DoNotOptimize(kernel.force.row(0, 0));
	}
	perParticle(state, l.particles());
}

void bondsWithShear(benchmark::State& state)
{
	const HexLattice l = membrane(state);
	reference::Memory bonds;
	BondForce kernel = loaded(l, law(346), bonds);
	for (auto _ : state) {
		kernel.compute(bonds.state(), 1e-9);
		benchmark::DoNotOptimize(kernel.force.row(0, 0));
	}
	perParticle(state, l.particles());
}

void bondsReference(benchmark::State& state)
{
	const HexLattice l = membrane(state);
	reference::Memory bonds;
	reference::Particles p;
	p.position = l.positions;
	bonds.restLength.assign(l.bondCount(), 2 * l.sphereRadius);
	for (auto _ : state) {
		reference::bondForces(l.bonds, law(0), bonds, p, 1e-6);
		benchmark::DoNotOptimize(p.force.data());
	}
	perParticle(state, l.particles());
}

void bending(benchmark::State& state)
{
	const HexLattice l = membrane(state);
	reference::Memory bonds;
	const BondForce placed = loaded(l, law(0), bonds);
	BendingForce kernel(l, 100, BendingForce::restOfTube(l.perRing, l.centreRadius));
	for (auto _ : state) {
		kernel.compute(placed.position);
		benchmark::DoNotOptimize(kernel.force.row(0, 0));
	}
	perParticle(state, l.particles());
}

void bendingReference(benchmark::State& state)
{
	const HexLattice l = membrane(state);
	for (auto _ : state) benchmark::DoNotOptimize(reference::bendingForces(l.bonds, 100, l.positions, l.positions));
	perParticle(state, l.particles());
}

/// An open sheet: nothing touches.
void selfContact(benchmark::State& state)
{
	const HexLattice l = membrane(state);
	reference::Memory bonds;
	const BondForce placed = loaded(l, law(0), bonds);
	SelfContact kernel(l, l.sphereRadius, 1e4);
	for (auto _ : state) {
		kernel.compute(placed.position);
		benchmark::DoNotOptimize(kernel.touching().size());
	}
	perParticle(state, l.particles());
}

/// A sheet that is not stretched: no triangle acts.
void facetContact(benchmark::State& state)
{
	const HexLattice l = membrane(state);
	reference::Memory bonds;
	const BondForce placed = loaded(l, law(0), bonds);
	FacetContact kernel(l, l.sphereRadius, 0.25 * l.sphereRadius, 1e4);
	const Place grain{Vec3::Zero(), l.sphereRadius};
	const int id = 0;
	for (auto _ : state) {
		kernel.compute(placed.position, [&] { return SphereRows{&grain, &id, 1}; });
		benchmark::DoNotOptimize(kernel.touching().size());
	}
	perParticle(state, l.particles());
}

void pressure(benchmark::State& state, bool inner)
{
	const HexLattice l = membrane(state);
	PressureForce kernel(TriangleMesh(l.particles(), l.triangles), inner ? l.sphereRadius : 0);
	std::vector<Vec3> force;
	for (auto _ : state) {
		kernel.compute(1e5, l.positions, force);
		benchmark::DoNotOptimize(force.data());
	}
	perParticle(state, l.particles());
}

void pressureReference(benchmark::State& state)
{
	const HexLattice l = membrane(state);
	for (auto _ : state) benchmark::DoNotOptimize(reference::pressureForces(l.triangles, 1e5, l.positions, l.sphereRadius));
	perParticle(state, l.particles());
}

} // namespace

BENCHMARK(bondsCentral)->Arg(500)->Arg(250);
BENCHMARK(bondsWithShear)->Arg(500)->Arg(250);
BENCHMARK(bondsReference)->Arg(500);
BENCHMARK(bending)->Arg(500)->Arg(250);
BENCHMARK(bendingReference)->Arg(500);
BENCHMARK(selfContact)->Arg(500)->Arg(250);
BENCHMARK(facetContact)->Arg(500)->Arg(250);
BENCHMARK_CAPTURE(pressure, inner, true)->Arg(500)->Arg(250);
BENCHMARK_CAPTURE(pressure, centre, false)->Arg(500)->Arg(250);
BENCHMARK(pressureReference)->Arg(500);
