// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
/* OpenMP's runtime for the kernel tests under the thread sanitizer, which cannot see how libgomp waits and would report every loop. Here a parallel
 * region starts threads, a barrier is one of pthreads and the end joins: all that the sanitizer knows, so what it reports is a race of the kernels.
 * Slow, and only what the kernels use: a construct that needs another entry point does not link. Its entry points are those that GCC calls. */
#include <omp.h>
#include <pthread.h>

#include <cstdlib>
#include <thread>
#include <vector>

namespace {

thread_local int threadNumber = 0;
thread_local int teamSize = 1;
thread_local pthread_barrier_t* teamBarrier = nullptr;

int maxThreadsAtStart()
{
	const char* wanted = std::getenv("OMP_NUM_THREADS");
	return wanted ? std::atoi(wanted) : int(std::thread::hardware_concurrency());
}

// Set and read by the thread that starts the teams.
int maxThreads = maxThreadsAtStart();

} // namespace

extern "C" {

void GOMP_parallel(void (*body)(void*), void* data, unsigned threads, unsigned)
{
	const bool nested = teamBarrier != nullptr; // one thread, as with libgomp
	const int size = nested ? 1 : threads > 0 ? int(threads) : maxThreads;
	const int outerNumber = threadNumber, outerSize = teamSize;
	pthread_barrier_t* const outerBarrier = teamBarrier;
	pthread_barrier_t barrier;
	pthread_barrier_init(&barrier, nullptr, unsigned(size));
	const auto work = [&](int number) {
		threadNumber = number;
		teamSize = size;
		teamBarrier = &barrier;
		body(data);
	};
	std::vector<std::thread> others;
	for (int number = 1; number < size; ++number) others.emplace_back(work, number);
	work(0);
	for (std::thread& other : others) other.join();
	pthread_barrier_destroy(&barrier);
	threadNumber = outerNumber;
	teamSize = outerSize;
	teamBarrier = outerBarrier;
}

void GOMP_barrier()
{
	if (teamBarrier) pthread_barrier_wait(teamBarrier);
}

int omp_get_thread_num() { return threadNumber; }
int omp_get_num_threads() { return teamSize; }
int omp_get_max_threads() { return maxThreads; }
void omp_set_num_threads(int threads) { maxThreads = threads; }
}
