// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "WorkMeter.hpp"

#include "kernels/base/TrapezoidalWork.hpp"

namespace yade {

YADE_PLUGIN((WorkMeter));

void WorkMeter::add(long iter, const hexmembrane::MembraneMotion::HalfWorks& halves)
{
	if (iter == lastIter + 1) work += ahead + halves.before;
	work += halves.atOnce;
	ahead = halves.after;
	lastIter = iter;
	lastForces.clear();
	lastPositions.clear();
}

void WorkMeter::takeOver(long iter, const std::function<Vector3r(size_t)>& position)
{
	if (lastForces.empty() || iter != lastIter + 1) return;
	for (size_t i = 0; i < lastForces.size(); ++i) ahead += 0.5 * lastForces[i].dot(position(i) - lastPositions[i]);
	lastForces.clear();
	lastPositions.clear();
}

void WorkMeter::takeOver(long iter, const vector<Vector3r>& forces, const std::function<Vector3r(size_t)>& way)
{
	if (!lastForces.empty() || iter != lastIter + 1) return;
	work += ahead;
	for (size_t i = 0; i < forces.size(); ++i) work += 0.5 * forces[i].dot(way(i));
}

void WorkMeter::add(long iter, vector<Vector3r>& forces, vector<Vector3r>& positions, Real atOnce)
{
	work += hexmembrane::TrapezoidalRecord{lastIter, lastForces, lastPositions}.record(iter, forces, positions) + atOnce;
	ahead = 0;
}

void WorkMeter::book(Scene& scene, const char* name)
{
	if (scene.trackEnergy) scene.energy->add(-work, name, energyIndex, /*reset*/ true);
}

} // namespace yade
