// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
// What a parallel region costs before it does anything: a step of the compact tier has a few of them, and barriers inside.
#include <benchmark/benchmark.h>
#include <omp.h>

namespace {

// Barriers in one region, so that the region's own start is lost in them.
void barrier(benchmark::State& state)
{
	const int threads = int(state.range(0)), barriers = 1000;
	for (auto _ : state) {
#pragma omp parallel num_threads(threads)
		for (int k = 0; k < barriers; ++k) {
#pragma omp barrier
		}
	}
	state.counters["perBarrier"] = benchmark::Counter(barriers, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void region(benchmark::State& state)
{
	const int threads = int(state.range(0));
	for (auto _ : state) {
#pragma omp parallel num_threads(threads)
		benchmark::ClobberMemory();
	}
}

void counts(benchmark::internal::Benchmark* benchmark)
{
	for (int threads = 1; threads <= omp_get_num_procs(); threads *= 2) benchmark->Arg(threads);
	benchmark->UseRealTime();
}

BENCHMARK(barrier)->Apply(counts);
BENCHMARK(region)->Apply(counts);

} // namespace
