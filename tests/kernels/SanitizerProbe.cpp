// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
/* sanitizer_probe FAULT: makes one fault, which the sanitizer it is built with must report. Without FAULT it does the like without a fault. */
#include <limits>
#include <string>
#include <vector>

namespace {

// Volatile: what the compiler can foresee it would leave out.
volatile int one = 1;
volatile double nan = std::numeric_limits<double>::quiet_NaN();

int sumOfThreads(bool racing)
{
	std::vector<int> counts(100, 0);
	int sum = 0;
#pragma omp parallel num_threads(2)
	{
#pragma omp for nowait
		for (int i = 0; i < 100; ++i) counts[std::size_t(i)] = one;
		if (!racing) {
#pragma omp barrier
		}
		// each thread reads what the other has written
#pragma omp for schedule(static) reduction(+ : sum)
		for (int i = 0; i < 100; ++i) sum += counts[std::size_t(99 - i)];
	}
	return sum;
}

} // namespace

int main(int count, char** arguments)
{
	const std::string fault = count > 1 ? arguments[1] : "";
	std::vector<int> numbers(4, int(one));
	if (fault == "overflow") return numbers.data()[3 + one];
	if (fault == "leak") return *new int(one) - one;
	if (fault == "undefined") return std::numeric_limits<int>::max() + one;
	if (fault == "conversion") return int(nan) > 0;
	return sumOfThreads(fault == "race") == 100 && numbers.data()[2 + one] == 1 ? 0 : 1;
}
