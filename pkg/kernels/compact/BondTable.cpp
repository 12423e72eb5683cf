// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/BondTable.hpp"

#include "kernels/base/Check.hpp"

#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace hexmembrane {

BondTable::Bond BondTable::between(int id1, int id2, const Place& first, const Place& second, double radius, double kn, double ks)
{
	const Vec3 branch = second.centre - first.centre;
	const double distance = branch.norm();
	return {id1, id2, {radius, kn, ks, distance}, {0, 0, Vec3::Zero(), Vec3::Zero(), branch / distance}, first.centre, first.radius - second.radius, false};
}

BondTable::Bond BondTable::loaded(Bond bond, const Vec3& force, const Vec3& moment)
{
	const Vec3 axis = bond.loads.axis;
	const double normal = force.dot(axis), twist = moment.dot(axis);
	bond.loads = {normal, twist, force - normal * axis, moment - twist * axis, axis};
	bond.made.rest += normal / (bond.made.kn * bond.made.area());
	return bond;
}

double BondTable::distanceOf(const Bond& bond) { return bond.made.rest - bond.loads.normal / (bond.made.kn * bond.made.area()); }

void BondTable::locate(const int* ids, int count)
{
	std::unordered_map<int, int> rowOf;
	for (int r = 0; r < count; ++r) rowOf[ids[r]] = r;
	const auto row = [&](int id) {
		const auto found = rowOf.find(id);
		if (found == rowOf.end()) reject("ids", id, "is bonded, and is no grain any more", "release() it first");
		return found->second;
	};
	std::vector<Pair> found;
	for (const Bond& bond : bonds) found.push_back({row(bond.id1), row(bond.id2)});
	std::vector<int> order(bonds.size());
	std::iota(order.begin(), order.end(), 0);
	const auto key = [&](int b) { return std::minmax(found[b].first, found[b].second); };
	std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return std::pair<int, int>(key(a)) < std::pair<int, int>(key(b)); });
	std::vector<Bond> sorted;
	pairs.clear();
	for (int b : order) {
		sorted.push_back(bonds[b]);
		pairs.push_back(found[b]);
	}
	bonds = std::move(sorted);
	listed = false;
}

void BondTable::list()
{
	if (listed) return;
	int highest = -1;
	for (const Pair& pair : pairs) highest = std::max({highest, pair.first, pair.second});
	std::vector<int> count(highest + 1, 0), place(highest + 1, -1);
	for (const Pair& pair : pairs) {
		++count[pair.first];
		++count[pair.second];
	}
	rows.clear();
	start.assign(1, 0);
	for (int r = 0; r <= highest; ++r) {
		if (count[r] == 0) continue;
		place[r] = int(rows.size());
		rows.push_back(r);
		start.push_back(start.back() + count[r]);
	}
	ends.resize(start.back());
	std::vector<int> next(start.begin(), start.end() - 1);
	for (std::size_t b = 0; b < pairs.size(); ++b) {
		ends[next[place[pairs[b].first]]++] = 2 * int(b);
		ends[next[place[pairs[b].second]]++] = 2 * int(b) + 1;
	}
	summed.resize(rows.size());
	actions.resize(pairs.size());
	breaks.resize(pairs.size());
	listed = true;
}

BondBreak BondTable::advance(Bond& bond, const Place& first, const Place& second, const Motion& motion1, const Motion& motion2, double dt,
                             const ParallelStrength& strength, Action& action) const
{
	const Vec3 branch = second.centre - first.centre;
	const double distance = branch.norm();
	const Vec3 normal = branch / distance;
	const Arms arms = armsOf(bond, distance);
	const Vec3 arm1 = arms.first * normal, arm2 = arms.second * normal;
	ParallelLoads<double>& loads = bond.loads;
	if (bond.begun)
		advanceParallel<double>(bond.made, distance, normal,
		                        {relativeVelocity(motion1.velocity, motion1.spin, arm1, motion2.velocity, motion2.spin, arm2),
		                         motion1.spin + motion2.spin, motion2.spin - motion1.spin},
		                        dt, loads);
	bond.begun = true;
	bond.centre = first.centre;
	const BondBreak broken = bondBreak(strength, stressOf<double>(bond.made, loads, strength.momentFactor));
	if (broken != BondBreak::none) {
		action = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
		return broken;
	}
	const Vec3 moment = loads.bending + loads.twist * normal;
	action = {loads.normal * normal + loads.shear, -arm1.cross(loads.shear) - moment, arm2.cross(loads.shear) + moment};
	return broken;
}

void BondTable::step(const Place* places, const Motion* motions, double dt, const ParallelStrength& strength)
{
	list();
	const long count = long(bonds.size()), loaded = long(rows.size());
	int broken = 0;
#pragma omp parallel for schedule(static) reduction(+ : broken) if (count > worthThreads)
	for (long b = 0; b < count; ++b) {
		const auto [i, j] = pairs[b];
		breaks[b] = advance(bonds[b], places[i], places[j], motions[i], motions[j], dt, strength, actions[b]);
		broken += breaks[b] != BondBreak::none;
	}
#pragma omp parallel for schedule(static) if (loaded > worthThreads)
	for (long r = 0; r < loaded; ++r) {
		Load sum = noLoad();
		for (int e = start[r]; e < start[r + 1]; ++e) {
			const Action& action = actions[ends[e] / 2];
			if (ends[e] % 2)
				sum += {action.force, action.torque2};
			else
				sum += {-action.force, action.torque1};
		}
		summed[r] = sum;
	}
	tensileBreaks = shearBreaks = 0;
	freed = 0;
	if (broken > 0) removeBroken();
}

void BondTable::removeBroken()
{
	std::size_t kept = 0;
	for (std::size_t b = 0; b < bonds.size(); ++b) {
		if (breaks[b] == BondBreak::none) {
			bonds[kept] = bonds[b];
			pairs[kept++] = pairs[b];
			continue;
		}
		tensileBreaks += breaks[b] == BondBreak::tension;
		shearBreaks += breaks[b] == BondBreak::shear;
		freed += bondEnergy(bonds[b].made, bonds[b].loads);
	}
	bonds.resize(kept);
	pairs.resize(kept);
	listed = false;
}

double BondTable::energy() const
{
	double sum = 0;
	for (const Bond& bond : bonds) sum += bondEnergy(bond.made, bond.loads);
	return sum;
}

} // namespace hexmembrane
