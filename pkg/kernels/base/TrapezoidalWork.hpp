// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <vector>

namespace hexmembrane {

/// Work of a set of point forces between two steps by the trapezoidal rule, sum of (F0 + F1)/2 . (x1 - x0): second order in the step, exact for forces
/// that are linear in the displacement. Summed in the order of the points: the same for any number of threads.
/// \return 0 when there is no previous step (other sizes)
inline double trapezoidalWork(const std::vector<Vec3>& force0, const std::vector<Vec3>& x0, const std::vector<Vec3>& force1, const std::vector<Vec3>& x1)
{
	if (force0.size() != force1.size() || x0.size() != force0.size() || x1.size() != force1.size()) return 0;
	double work = 0;
	for (size_t i = 0; i < force1.size(); ++i) work += 0.5 * (force0[i] + force1[i]).dot(x1[i] - x0[i]);
	return work;
}

/// Work of point forces over the steps of a run, one step after the other. What it remembers of the last step is the caller's, who saves it.
struct TrapezoidalRecord {
	long& lastStep;
	std::vector<Vec3>& lastForce;
	std::vector<Vec3>& lastPosition;

	/// Work since the step before; `force` and `position` are taken over for the next one (they come back with contents of no use).
	/// \return 0 where there is no step before: the first one, after a gap (the forces of long ago did not act meanwhile), or with other points
	double record(long step, std::vector<Vec3>& force, std::vector<Vec3>& position)
	{
		const double work = step == lastStep + 1 ? trapezoidalWork(lastForce, lastPosition, force, position) : 0;
		lastStep = step;
		lastForce.swap(force);
		lastPosition.swap(position);
		return work;
	}
};

} // namespace hexmembrane
