// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

namespace hexmembrane {

/// Which spheres each thread owns: it alone writes their loads and moves them, so that they stay in its cache from one loop to the next.
///
/// A thread has a run of rows of the contact list with about the same number of pairs as every other, and a run of the membrane's particles where those
/// have no rows of their own. Grains are sorted upwards and rings stand upwards: both runs of a thread lie at the same height.
class ThreadPartition {
public:
	/// Spheres from .. to - 1.
	struct Range {
		int from, to;
	};

	/// \param rowStart start[i] .. start[i + 1] are the pairs of sphere i \param grains their number; all others are the membrane's particles
	void divide(int threads, const std::vector<int>& rowStart, int grains);

	int threads() const { return int(rows.size()); }
	/// Spheres whose rows thread t sweeps.
	const Range& rowsOf(int t) const { return rows[t]; }
	/// Particles that it owns beside them.
	const Range& othersOf(int t) const { return others[t]; }
	/// Calls visit(from, to) for both.
	template <typename Visit>
	void forOwned(int t, Visit&& visit) const
	{
		visit(rows[t].from, rows[t].to);
		visit(others[t].from, others[t].to);
	}

private:
	std::vector<Range> rows, others;
};

} // namespace hexmembrane
