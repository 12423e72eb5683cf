// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "WorkMeter.hpp"

#include "kernels/base/TrapezoidalWork.hpp"

namespace yade {

YADE_PLUGIN((WorkMeter));

void WorkMeter::add(long iter, const hexmembrane::MembraneMotion::HalfWorks& halves)
{
	if (iter == lastIter + 1) work += ahead + halves.before;
	ahead = halves.after;
	lastIter = iter;
	lastForces.clear();
	lastPositions.clear();
}

void WorkMeter::add(long iter, vector<Vector3r>& forces, vector<Vector3r>& positions, Real atOnce)
{
	work += hexmembrane::WorkMeter{lastIter, lastForces, lastPositions}.record(iter, forces, positions) + atOnce;
	ahead = 0;
}

void WorkMeter::book(Scene& scene, const char* name)
{
	if (scene.trackEnergy) scene.energy->add(-work, name, energyIndex, /*reset*/ true);
}

} // namespace yade
