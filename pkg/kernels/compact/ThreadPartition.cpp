// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/ThreadPartition.hpp"

namespace hexmembrane {

void ThreadPartition::divide(int threads, const std::vector<int>& start, int grains)
{
	const int all = int(start.size()) - 1;
	const long pairs = start[all];
	// with contacts among the membrane's particles, those have rows too
	const int swept = threads == 1 || start[grains] < pairs ? all : grains;
	rows.resize(threads);
	others.resize(threads);
	int from = 0;
	for (int t = 0; t < threads; ++t) {
		int to = swept;
		if (t + 1 < threads) // a sphere counts as a pair: it is moved
			for (to = from; to < swept && start[to] + to < (start[swept] + long(swept)) * (t + 1) / threads;) ++to;
		rows[t] = {from, to};
		from = to;
		const auto share = [&](int part) { return swept + int((all - swept) * long(part) / threads); };
		others[t] = {share(t), share(t + 1)};
	}
}

} // namespace hexmembrane
