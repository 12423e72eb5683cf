// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/SphereAssembly.hpp"

#include "kernels/compact/GrainMotion.hpp"
#include "kernels/base/Check.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

#include <omp.h>

namespace hexmembrane {

void SphereAssembly::setSkin(double skin)
{
	requirePositive("skin", skin, "m");
	if (skin != gap) listed.clear(); // lists are made anew; what contacts remember moves over
	gap = skin;
}

void SphereAssembly::setSpheres(const std::vector<Sphere>& all, int count)
{
	grainCount = count;
	const auto fill = [&](auto& field, auto&& value) {
		field.clear();
		for (const Sphere& s : all) field.push_back(value(s));
	};
	fill(id, [](const Sphere& s) { return s.id; });
	fill(places, [](const Sphere& s) { return s.place; });
	fill(motions, [](const Sphere& s) { return s.motion; });
	fill(mass, [](const Sphere& s) { return s.mass; });
	fill(inertia, [](const Sphere& s) { return s.inertia; });
	fill(material, [](const Sphere& s) { return s.material; });
	fill(fixed, [](const Sphere& s) { return s.fixed; });
	fill(mask, [](const Sphere& s) { return s.mask; });
	turned.assign(count, Vec3::Zero());
	outside.clear();
	contacts = {};
	smooth = {};
	boundaryContacts.clear();
	boundaryContacts.resize(boundaries.size());
	listed.clear();
	travelled = 0;
	startTravel();
}

// No two orders, of this or another assembly, are taken for the same.
void SphereAssembly::startTravel()
{
	static std::atomic<long> orders{0};
	gone = {++orders, 0};
}

namespace {

/// Whether two tables have the same springs: coefficients of friction may differ, but not whether there is friction.
bool sameSprings(std::vector<ContactMaterial> now, const std::vector<ContactMaterial>& then)
{
	if (now.size() != then.size()) return false;
	const auto bothOrNone = [](double x, double y) { return (x > 0) == (y > 0); };
	for (std::size_t m = 0; m < now.size(); ++m) {
		if (!bothOrNone(now[m].friction, then[m].friction) || !bothOrNone(now[m].rollingFriction, then[m].rollingFriction)) return false;
		now[m].friction = then[m].friction;
		now[m].rollingFriction = then[m].rollingFriction;
	}
	return now == then;
}

} // namespace

void SphereAssembly::setMaterials(const std::vector<ContactMaterial>& table, const std::vector<OwnPair>& own)
{
	if (table == materials && own == ownPairs) return;
	if (table.size() > 255) reject("materials", double(table.size()), "too many", "255 materials at most: bodies with the same parameters can share one");
	const bool listsStay = own == ownPairs && sameSprings(table, materials);
	materials = table;
	ownPairs = own;
	pairs.clear();
	kinds.clear();
	for (const ContactMaterial& a : table)
		for (const ContactMaterial& b : table) pairs.push_back({a, b});
	for (const OwnPair& pair : own) {
		pairs[kindOfPair(pair.a, pair.b)] = paired(table[pair.a], table[pair.b], pair.own);
		pairs[kindOfPair(pair.b, pair.a)] = paired(table[pair.b], table[pair.a], pair.own);
	}
	for (const MaterialPair& pair : pairs) kinds.push_back(kindOf(pair.a, pair.b));
	if (listed.empty()) return;
	if (listsStay) {
		contacts.setKinds(kinds);
		for (BoundaryContacts& boundary : boundaryContacts) boundary.setKinds(kinds);
		return;
	}
	// springs are made with the lists; friction may have come or gone, and with it what a list holds
	std::vector<int> same(places.size());
	std::iota(same.begin(), same.end(), 0);
	buildLists(same);
}

bool SphereAssembly::listsHold()
{
	if (listed.size() != places.size() || listedShapes.size() != boundaries.size()) return false;
	if (travelled < 0.5 * gap) return true;
	// a sum of every step's largest way: look how far each sphere has really come
	double way = 0;
	const long count = long(places.size());
#pragma omp parallel for schedule(static) reduction(max : way)
	for (long i = 0; i < count; ++i) way = std::max(way, (places[i].centre - listed[i]).squaredNorm());
	way = std::sqrt(way);
	for (std::size_t b = 0; b < boundaries.size(); ++b) way = std::max(way, boundaries[b].shape->wayFrom(*listedShapes[b]));
	travelled = way;
	// lists are made already at 0.4 of the skin: near half of it this measure would be due in every step
	return travelled < 0.4 * gap;
}

void SphereAssembly::sortGrains(std::vector<int>& newIndex)
{
	std::vector<Vec3> centres(grainCount);
	Vec3 low = Vec3::Constant(1e300), high = -low;
	double largest = 0;
	for (int i = 0; i < grainCount; ++i) {
		centres[i] = places[i].centre;
		low = low.cwiseMin(centres[i]);
		high = high.cwiseMax(centres[i]);
		largest = std::max(largest, places[i].radius);
	}
	newIndex.resize(places.size());
	std::iota(newIndex.begin(), newIndex.end(), 0);
	if (grainCount == 0) return;
	// no finer than one cell a grain, as findNearPairs
	const double spacing = std::cbrt(std::max((high - low).prod(), 0.) / grainCount);
	CellGrid grid(low, high, std::max(2 * largest + gap, spacing));
	grid.fill(centres);
	const std::vector<int>& order = grid.order();
	for (int i = 0; i < grainCount; ++i) newIndex[order[i]] = i;
	permuteGrains(order);
}

void SphereAssembly::permuteGrains(const std::vector<int>& from)
{
	const auto permute = [&](auto& field) {
		if (field.empty()) return;
		auto before = field;
		for (int i = 0; i < grainCount; ++i) field[i] = before[from[i]];
	};
	permute(id);
	permute(places);
	permute(motions);
	permute(mass);
	permute(mask);
	permute(inertia);
	permute(material);
	permute(fixed);
	permute(outside);
	permute(turned);
	startTravel();
}

void SphereAssembly::findPairs(NearPairs& general, std::vector<FrictionlessContacts::Pair>& frictionless) const
{
	const int all = spheres();
	std::vector<Vec3> centres(listed.begin(), listed.begin() + grainCount);
	std::vector<double> radii(grainCount);
	Vec3 low = Vec3::Constant(1e300), high = -low;
	double largest = 0, largestParticle = 0;
	for (int i = 0; i < grainCount; ++i) {
		radii[i] = places[i].radius;
		largest = std::max(largest, radii[i]);
		low = low.cwiseMin(centres[i]);
		high = high.cwiseMax(centres[i]);
	}
	if (grainCount > 0) general = findNearPairs(centres, radii, gap, low, high);
	general.start.resize(all + 1, int(general.other.size()));
	if (all == grainCount) return;

	for (int m = grainCount; m < all; ++m) largestParticle = std::max(largestParticle, places[m].radius);
	std::vector<std::array<int, 2>> extra; // pairs with particles that need memory
	if (grainCount > 0) {
		CellGrid grid(low, high, largest + largestParticle + gap);
		grid.fill(centres);
		// by parts, put together in their order
		const int parts = omp_get_max_threads();
		std::vector<std::vector<FrictionlessContacts::Pair>> smoothParts(parts);
		std::vector<std::vector<std::array<int, 2>>> extraParts(parts);
#pragma omp parallel for schedule(static, 1)
		for (int part = 0; part < parts; ++part) {
			std::vector<int> near;
			const auto border = [&](int k) { return grainCount + int((all - grainCount) * long(k) / parts); };
			for (int m = border(part); m < border(part + 1); ++m) {
				near.clear();
				grid.forEachNear(listed[m], [&](int i) {
					const double reach = radii[i] + places[m].radius + gap;
					if ((listed[m] - centres[i]).squaredNorm() < reach * reach) near.push_back(i);
				});
				std::sort(near.begin(), near.end());
				for (int i : near)
					if (isSmooth(i, m))
						smoothParts[part].push_back({i, m});
					else
						extraParts[part].push_back({i, m});
			}
		}
		for (const auto& part : smoothParts) frictionless.insert(frictionless.end(), part.begin(), part.end());
		for (const auto& part : extraParts) extra.insert(extra.end(), part.begin(), part.end());
	}
	if (extra.empty()) return;
	// particles' indices are above all grains': appended to a row they leave it ascending
	std::sort(extra.begin(), extra.end());
	NearPairs merged;
	merged.start.assign(1, 0);
	auto next = extra.begin();
	for (int i = 0; i < all; ++i) {
		merged.other.insert(merged.other.end(), general.other.begin() + general.start[i], general.other.begin() + general.start[i + 1]);
		for (; next != extra.end() && (*next)[0] == i; ++next) merged.other.push_back((*next)[1]);
		merged.start.push_back(int(merged.other.size()));
	}
	general = std::move(merged);
}

void SphereAssembly::buildLists(const std::vector<int>& newIndex)
{
	NearPairs general;
	std::vector<FrictionlessContacts::Pair> frictionless;
	findPairs(general, frictionless);
	sums.works += contacts.rebuild(std::move(general), newIndex, kinds, [this](int i, int j) { return springsOf(i, j); });
	smooth.rebuild(frictionless, grainCount, spheres() - grainCount, [this](int i, int j) { return springsOf(i, j).springs.kn; });
	runs = {};
	loadsStale = true;
	boundaryContacts.resize(boundaries.size());
	for (std::size_t b = 0; b < boundaries.size(); ++b) {
		std::vector<int> near;
		for (int i = 0; i < spheres(); ++i)
			if ((mask[i] & boundaries[b].mask) && listedShapes[b]->near({listed[i], places[i].radius}, gap)) near.push_back(i);
		sums.works += boundaryContacts[b].rebuild(std::move(near), newIndex, kinds, [&](int i) { return springsOf(boundaries[b], i); });
	}
}

int SphereAssembly::nowhere() const
{
	for (std::size_t i = 0; i < places.size(); ++i)
		if (!std::isfinite(places[i].centre.sum())) return id[i];
	return -1;
}

void SphereAssembly::makeLists()
{
	const int lost = nowhere();
	if (lost >= 0) reject("places", "not finite for sphere " + std::to_string(lost), "no list can be made", "find out what sent it away");
	std::vector<int> newIndex;
	sortGrains(newIndex);
	listed.resize(places.size());
	for (std::size_t i = 0; i < places.size(); ++i) listed[i] = places[i].centre;
	listedShapes = shapes();
	travelled = 0;
	buildLists(newIndex);
	++made;
}

void SphereAssembly::continueLists(const std::vector<Vec3>& centres, const std::vector<std::shared_ptr<const BoundaryShape>>& shapesThen, double travelledSince)
{
	listed = centres;
	listedShapes = shapesThen;
	travelled = travelledSince;
	std::vector<int> same(places.size());
	std::iota(same.begin(), same.end(), 0);
	buildLists(same);
}

void SphereAssembly::divide(int threads)
{
	if (runs.threads() == threads) return;
	runs.divide(threads, contacts.rowStart(), grainCount);
	contacts.divide(runs);
}

void SphereAssembly::listLoaded()
{
	loaded.clear();
	if (!outside.empty()) {
		for (int m = grainCount; m < spheres(); ++m) loaded.push_back(m);
		return;
	}
	std::vector<char> is(spheres(), 0);
	contacts.forEachPair([&](int i, int j) { is[i] = is[j] = 1; });
	for (const BoundaryContacts& boundary : boundaryContacts) boundary.forEachNear([&](int i) { is[i] = 1; });
	for (int m = grainCount; m < spheres(); ++m)
		if (is[m]) loaded.push_back(m);
}

void SphereAssembly::clearLoads(int from, int to, bool all)
{
	if (!outside.empty()) {
		std::copy(outside.begin() + from, outside.begin() + to, loads.begin() + from);
		return;
	}
	const int upto = all ? to : std::max(from, std::min(to, grainCount));
	std::fill(loads.begin() + from, loads.begin() + upto, noLoad());
	for (auto m = std::lower_bound(loaded.begin(), loaded.end(), upto); m != loaded.end() && *m < to; ++m) loads[*m] = noLoad();
}

void SphereAssembly::computeLoads(double dt, int threads)
{
	divide(threads);
	const std::size_t count = boundaries.size();
	loads.resize(places.size());
	onParticle.resize(spheres() - grainCount);
	const bool held = !outside.empty(), all = loadsStale || held;
	if (all) listLoaded();
	loadsStale = held;
	// one slot a thread, summed in their order
	std::vector<SweepSums> parts(threads);
	std::vector<BoundaryLoad> received(count * threads);
#pragma omp parallel num_threads(team(threads)) if (team(threads) > 1)
	{
#pragma omp for schedule(static, 1)
		for (int t = 0; t < threads; ++t) {
			runs.forOwned(t, [&](int from, int to) { clearLoads(from, to, all); });
			parts[t] = contacts.sweep(runs, t, places, motions, loads, dt);
		}
#pragma omp for schedule(static, 1)
		for (int t = 0; t < threads; ++t) {
			contacts.addSpills(runs, t, loads);
			runs.forOwned(t, [&](int from, int to) {
				smooth.sweep(from, to, places, loads);
				for (std::size_t b = 0; b < count; ++b)
					boundaryContacts[b].sweep(from, to, boundaries[b], places, motions, loads, dt, received[t * count + b]);
			});
		}
#pragma omp for schedule(static, 1)
		for (int t = 0; t < threads; ++t) runs.forOwned(t, [&](int from, int to) { smooth.gather(from, to, onParticle); });
	}
	onBoundary.assign(count, {});
	for (int t = 0; t < threads; ++t) {
		sums += parts[t];
		for (std::size_t b = 0; b < count; ++b) onBoundary[b] += received[t * count + b];
	}
	for (const BoundaryLoad& boundary : onBoundary) sums += boundary.sums;
}

double SphereAssembly::elasticEnergy() const
{
	double sum = contacts.energy(places) + smooth.energy(places);
	for (std::size_t b = 0; b < boundaries.size(); ++b) sum += boundaryContacts[b].energy(boundaries[b], places);
	return sum;
}

int SphereAssembly::moveGrains(double dt, double damping, bool energies, int threads)
{
	divide(threads);
	std::vector<GrainMotion> parts(threads); // summed in the order of the threads
#pragma omp parallel for schedule(static, 1) num_threads(team(threads)) if (team(threads) > 1)
	for (int t = 0; t < threads; ++t) {
		GrainMotion part{};
		part.places = places.data();
		part.motions = motions.data();
		part.loads = loads.data();
		part.mass = mass.data();
		part.inertia = inertia.data();
		part.fixed = fixed.data();
		part.turned = turned.data();
		part.from = runs.rowsOf(t).from;
		part.to = std::max(part.from, std::min(runs.rowsOf(t).to, grainCount));
		part.dt = dt;
		part.damping = damping;
		part.limit2 = 0.25 * gap * gap / (dt * dt);
		part.energies = energies;
		hexmembrane::moveGrains(part);
		parts[t] = part;
	}
	double fastest2 = 0;
	if (energies) kinetic = 0;
	int lost = -1;
	for (const GrainMotion& part : parts) {
		fastest2 = std::max(fastest2, part.fastest2);
		dampedWork += part.dampedWork;
		if (energies) kinetic += part.kinetic;
		if (lost < 0 && part.lost < part.to) lost = id[part.lost];
	}
	noteWay(std::sqrt(fastest2) * dt);
	return lost;
}

} // namespace hexmembrane
