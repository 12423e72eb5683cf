// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/FacetContact.hpp"

#include "kernels/base/CellGrid.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/membrane/HexLattice.hpp"
#include "kernels/membrane/RingsMoved.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace hexmembrane {

namespace {

/// Share of the particles' radius by which contacts may overlap before a triangle acts.
constexpr double softness = 0.1;
/// Share of the skin that may have been gone where it is looked at. What is left of half a skin is for steps in which nobody looks.
constexpr double measured = 0.25;

double fourth(double x) { return x * x * x * x; }

/// Weights of the point of a triangle that is nearest to c. Exactly 0 for corners that it does not depend on.
std::array<double, 3> nearestWeights(const Vec3& c, const std::array<Vec3, 3>& corner)
{
	// the regions of its corners and edges one after the other (Ericson, Real-Time Collision Detection, 5.1.5)
	const Vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
	const Vec3 fromA = c - corner[0], fromB = c - corner[1], fromC = c - corner[2];
	const double d1 = ab.dot(fromA), d2 = ac.dot(fromA), d3 = ab.dot(fromB), d4 = ac.dot(fromB), d5 = ab.dot(fromC), d6 = ac.dot(fromC);
	if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
	if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
	if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
	const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
	if (vc <= 0 && d1 >= 0 && d3 <= 0) {
		const double t = d1 / (d1 - d3);
		return {1 - t, t, 0};
	}
	if (vb <= 0 && d2 >= 0 && d6 <= 0) {
		const double t = d2 / (d2 - d6);
		return {1 - t, 0, t};
	}
	if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
		const double t = (d4 - d3) / (d4 - d3 + d5 - d6);
		return {0, 1 - t, t};
	}
	const double sum = va + vb + vc;
	return {1 - vb / sum - vc / sum, vb / sum, vc / sum};
}

} // namespace

/// Nearest point of a triangle.
struct FacetContact::Foot {
	int triangle = -1;
	std::array<double, 3> weights{};
	Vec3 point = Vec3::Zero();
	double square = std::numeric_limits<double>::infinity(); ///< of its distance (m2)
};

/// What a triangle carries of a grain: see Contact.
struct FacetContact::Part {
	double overlap, squared, stiffness;
};

double FacetContact::actingLength(double radius, double offset, double grain)
{
	const double sphere = (1 - softness) * radius;
	return std::sqrt(3 * (sphere - offset) * (sphere + offset + 2 * grain));
}

FacetContact::FacetContact(const HexStencil& s, double r, double offset, double stiffness)
    : force(s.perRing, s.rings), stencil(s), radius(r), h(offset), kn(stiffness), skin(0.15 * r), trianglesOf(s.particles())
{
	requirePositive("radius", r, "m");
	requirePositive("offset", offset, "m");
	if (!(offset < (1 - softness) * r))
		reject("offset", offset, "reaches through the particles, of radius " + formatNumber(r) + " m", "a quarter of their radius");
	requirePositive("kn", stiffness, "N/m");
	for (int k = 0; k + 1 < s.rings; ++k) appendTriangles(s, k, triangles);
	torn.assign(triangles.size(), 0);
	for (std::size_t t = 0; t < triangles.size(); ++t)
		for (const int v : triangles[t]) trianglesOf[v].push_back(int(t));
}

void FacetContact::setBroken(const std::vector<int>& broken)
{
	std::fill(torn.begin(), torn.end(), 0);
	listed = {}; // lists leave torn triangles out
	sure = {};
	if (broken.empty()) return;
	if (int(broken.size()) != stencil.bondCount()) reject("broken", int(broken.size()), "does not fit the tube", "one for each bond");
	const auto bonds = bondList(stencil);
	for (std::size_t b = 0; b < bonds.size(); ++b) {
		if (!broken[b]) continue;
		for (const int t : trianglesOf[bonds[b][0]])
			if (std::count(triangles[t].begin(), triangles[t].end(), bonds[b][1])) torn[t] = 1;
	}
}

double FacetContact::longestSquared(const Triangle& t) const
{
	const Vec3 a = at(t[0]), b = at(t[1]), c = at(t[2]);
	return std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
}

/// Whether a grain reaches the plane of a triangle: nearly all that are near do not, and this spares the rest.
bool FacetContact::planeReaches(const Triangle& t, const Place& grain) const
{
	const Vec3 a = at(t[0]), normal = (at(t[1]) - a).cross(at(t[2]) - a);
	const double along = normal.dot(grain.centre - a), reach = grain.radius + h;
	return along * along <= reach * reach * normal.squaredNorm();
}

Vec3 FacetContact::inwards(const Triangle& t) const
{
	const Vec3 a = at(t[0]), out = (at(t[1]) - a).cross(at(t[2]) - a);
	const double size = out.norm();
	return size > 0 ? Vec3(out / -size) : Vec3::Zero();
}

FacetContact::Foot FacetContact::footOn(int triangle, const Vec3& centre) const
{
	const Triangle& t = triangles[triangle];
	const std::array<Vec3, 3> corner{at(t[0]), at(t[1]), at(t[2])};
	Foot foot;
	foot.triangle = triangle;
	foot.weights = nearestWeights(centre, corner);
	foot.point = foot.weights[0] * corner[0] + foot.weights[1] * corner[1] + foot.weights[2] * corner[2];
	foot.square = (centre - foot.point).squaredNorm();
	return foot;
}

/// Whether triangles that act are all round a foot. \param normal inwards there: theirs by their angles at it, which gives the side of any point (Baerentzen
/// and Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005)
bool FacetContact::surrounded(const Foot& foot, Vec3& normal) const
{
	const Triangle& own = triangles[foot.triangle];
	std::vector<int> feature;
	for (int v = 0; v < 3; ++v)
		if (foot.weights[v] != 0) feature.push_back(own[v]);
	normal = Vec3::Zero();
	double round = 0; // share of the full turn
	for (const int t : trianglesOf[feature[0]]) {
		const Triangle& other = triangles[t];
		const auto holds = [&](int v) { return std::count(other.begin(), other.end(), v) > 0; };
		if (!std::all_of(feature.begin(), feature.end(), holds) || !acts(t)) continue;
		double angle = feature.size() == 3 ? 2 * M_PI : M_PI;
		if (feature.size() == 1) {
			const int corner = int(std::find(other.begin(), other.end(), feature[0]) - other.begin());
			const Vec3 from = at(feature[0]), one = at(other[(corner + 1) % 3]) - from, two = at(other[(corner + 2) % 3]) - from;
			angle = std::atan2(one.cross(two).norm(), one.dot(two));
		}
		normal += angle * inwards(other);
		round += feature.size() == 1 ? 1. / 6 : angle / (2 * M_PI);
	}
	if (normal.squaredNorm() > 0) normal.normalize();
	return round > 0.99;
}

void FacetContact::add(int grain, const SphereRows& rows, const Foot& foot, const Vec3& normal, double overlap, const Part& part)
{
	const Triangle& t = triangles[foot.triangle];
	const Place& place = rows.places[grain];
	const Vec3 point = place.centre - (place.radius - 0.5 * overlap) * normal;
	contacts.push_back({grain,
	                    rows.ids[grain],
	                    t,
	                    foot.weights,
	                    {at(t[0]), at(t[1]), at(t[2])},
	                    place.centre,
	                    point,
	                    normal,
	                    part.overlap,
	                    part.squared,
	                    part.stiffness});
}

/// \param feet of the triangles that the grain reaches
void FacetContact::touch(int grain, const SphereRows& rows, const std::vector<Foot>& feet)
{
	if (feet.empty()) return;
	const Vec3 centre = rows.places[grain].centre;
	const double reach = rows.places[grain].radius + h;
	const auto nearest = std::min_element(feet.begin(), feet.end(), [](const Foot& a, const Foot& b) { return a.square < b.square; });
	const double least = std::sqrt(nearest->square);
	if (least <= h) {
		const Vec3 branch = centre - nearest->point;
		Vec3 normal;
		const bool pushedBack = surrounded(*nearest, normal) && branch.dot(normal) < 0;
		const double distance = pushedBack ? -least : least, overlap = reach - distance;
		if (least > 1e-9 * radius) normal = branch / distance; // else a centre on the sheet
		add(grain, rows, *nearest, normal, overlap, {overlap, overlap * overlap, 1});
		return;
	}
	const double most = reach - least;
	double sum = 0, second = 0;
	for (auto foot = feet.begin(); foot != feet.end(); ++foot) {
		const double overlap = reach - std::sqrt(foot->square);
		sum += fourth(overlap);
		if (foot != nearest) second = std::max(second, overlap);
	}
	const double all = std::sqrt(std::sqrt(sum)), t = std::min((least - h) / h, 1.), fade = t * t * (3 - 2 * t), slope = 6 * t * (1 - t) / h;
	const double whole = most + fade * (all - most);
	bool first = true;
	for (auto foot = feet.begin(); foot != feet.end(); ++foot) {
		const double overlap = reach - std::sqrt(foot->square), ratio = overlap / all;
		Part part{fade * ratio * ratio * ratio, first ? whole * whole : 0, 3 * ratio * ratio};
		if (foot == nearest) {
			part.overlap += 1 - fade - slope * (all - most);
			part.stiffness = 1 + 2 * (second / all) * (second / all);
		}
		part.overlap *= whole;
		add(grain, rows, *foot, (centre - foot->point) / std::sqrt(foot->square), overlap, part);
		first = false;
	}
}

bool FacetContact::grainsHold(const SphereRows& rows) const
{
	if (std::size_t(rows.count) != listedGrains.size()) return false;
	// grains that have changed places are further apart than this
	double most = 0;
	for (int i = 0; i < rows.count; ++i) most = std::max(most, (rows.places[i].centre - listedGrains[i]).squaredNorm());
	return most < measured * measured * skin * skin;
}

void FacetContact::makeLists(const SphereRows& rows)
{
	++made;
	listed = *x;
	listedGrains.clear();
	near.clear();
	double smallest = std::numeric_limits<double>::infinity(), largest = 0;
	for (int i = 0; i < rows.count; ++i) {
		smallest = std::min(smallest, rows.places[i].radius);
		largest = std::max(largest, rows.places[i].radius);
	}
	anyLong = true; // ask again when there are none
	if (rows.count == 0) return;
	limit = actingLength(radius, h, smallest);
	std::vector<std::pair<int, double>> mayAct; // and their longest edges
	double size = 0;                            // of the largest of them
	for (std::size_t t = 0; t < triangles.size(); ++t) {
		if (torn[t]) continue;
		const double longest = std::sqrt(longestSquared(triangles[t]));
		if (!(longest > limit - skin)) continue;
		mayAct.push_back({int(t), longest});
		size = std::max(size, longest);
	}
	anyLong = !mayAct.empty();
	if (!anyLong) return;
	Vec3 low = rows.places[0].centre, high = low;
	for (int i = 0; i < rows.count; ++i) {
		listedGrains.push_back(rows.places[i].centre);
		low = low.cwiseMin(listedGrains[i]);
		high = high.cwiseMax(listedGrains[i]);
	}
	CellGrid grid(low, high, size + largest + h + skin);
	grid.fill(listedGrains);
	for (const auto& [number, longest] : mayAct) {
		const int t = number;
		const Vec3 middle = (at(triangles[t][0]) + at(triangles[t][1]) + at(triangles[t][2])) / 3;
		// two thirds of the longest median, which is shorter than the longest edge
		const double furthest = 2. / 3 * longest;
		grid.forEachNear(middle, [&](int i) {
			const double reach = rows.places[i].radius + h + skin;
			if ((listedGrains[i] - middle).squaredNorm() > (reach + furthest) * (reach + furthest)) return; // most, and this spares their feet
			if (footOn(t, listedGrains[i]).square < reach * reach) near.push_back({i, t});
		});
	}
	std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) { return std::array{a.grain, a.triangle} < std::array{b.grain, b.triangle}; });
}

void FacetContact::keepLists(const std::function<SphereRows()>& grains, const Travel& travel)
{
	const double gone = travel.way - sure.way;
	if (travel.order >= 0 && travel.order == sure.order && gone >= 0 && gone < 0.5 * skin) return;
	const bool sheetHolds = nearerThan(measured * skin, stencil, *x, listed);
	sure = {travel.order, travel.way - measured * skin};
	if (sheetHolds && !anyLong) return;
	const SphereRows rows = grains();
	if (sheetHolds && grainsHold(rows)) return;
	makeLists(rows);
	sure.way = travel.way;
}

void FacetContact::compute(const PaddedRings& position, const std::function<SphereRows()>& grains, const Travel& travel)
{
	x = &position;
	const int n = stencil.perRing;
	for (const Contact& contact : contacts)
		for (const int v : contact.corners) force.set(v / n, v % n, Vec3::Zero());
	contacts.clear();
	first = stencil.rings;
	last = -1;
	keepLists(grains, travel);
	if (near.empty()) return;
	const SphereRows rows = grains();
	std::vector<Foot> feet; // of one grain
	for (std::size_t p = 0; p < near.size();) {
		const int grain = near[p].grain;
		const double reach = rows.places[grain].radius + h;
		feet.clear();
		for (; p < near.size() && near[p].grain == grain; ++p) {
			const int t = near[p].triangle;
			if (!planeReaches(triangles[t], rows.places[grain]) || !acts(t)) continue;
			const Foot foot = footOn(t, rows.places[grain].centre);
			if (foot.square < reach * reach) feet.push_back(foot);
		}
		touch(grain, rows, feet);
	}
	std::sort(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) { return std::tie(a.id, a.corners) < std::tie(b.id, b.corners); });
	for (const Contact& contact : contacts)
		for (int c = 0; c < 3; ++c) {
			const int ring = contact.corners[c] / n, i = contact.corners[c] % n;
			force.set(ring, i, force.get(ring, i) - contact.shares[c] * kn * contact.overlap * contact.normal);
			first = std::min(first, ring);
			last = std::max(last, ring);
		}
}

double FacetContact::energy() const
{
	double sum = 0;
	for (const Contact& contact : contacts) sum += 0.5 * kn * contact.squared;
	return sum;
}

double FacetContact::largestShare() const
{
	std::vector<double> shares(stencil.particles(), 0);
	for (const Contact& contact : contacts)
		for (int c = 0; c < 3; ++c) shares[contact.corners[c]] += contact.shares[c] * contact.stiffness;
	return shares.empty() ? 0 : *std::max_element(shares.begin(), shares.end());
}

} // namespace hexmembrane
