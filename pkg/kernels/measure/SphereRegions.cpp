// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/SphereRegions.hpp"

#include "kernels/base/Check.hpp"

#include <Eigen/Cholesky>

#include <algorithm>

namespace hexmembrane {

namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double ballVolume(double radius) { return 4. / 3 * M_PI * radius * radius * radius; }

/// Share of the segment from `start` (seen from the ball's centre) along `branch` that lies in the ball.
double shareInside(const Vec3& start, const Vec3& branch, double radius)
{
	const double a = branch.squaredNorm(), b = start.dot(branch), c = start.squaredNorm() - radius * radius, square = b * b - a * c;
	if (!(square > 0)) return 0;
	const double root = std::sqrt(square);
	return std::max(0., std::min(1., (root - b) / a) - std::max(0., (-root - b) / a));
}

/// A grid of about four points a cell, the quickest for regions of few and of hundreds of grains. Its indices are those of the points in the order of its
/// cells; `order` tells which were which.
std::unique_ptr<CellGrid> sortedGrid(std::vector<Vec3> points, std::vector<int>& order)
{
	if (points.empty()) return nullptr;
	Vec3 low = points[0], high = points[0];
	for (const Vec3& x : points) {
		low = low.cwiseMin(x);
		high = high.cwiseMax(x);
	}
	const double longest = (high - low).maxCoeff(), widest = longest > 0 ? longest : 1;
	// a flat or slender assembly gets no finer cells than its longest side wants
	const double spacing = std::cbrt((high - low).cwiseMax(widest * 1e-3).prod() / (0.25 * double(points.size())));
	auto grid = std::make_unique<CellGrid>(low, high, std::max(spacing, widest * 1e-2));
	grid->fill(points);
	order = grid->order();
	std::vector<Vec3> sorted;
	for (const int i : order) sorted.push_back(points[i]);
	grid->fill(sorted);
	return grid;
}

/// Mean velocity and gradient, with two sums over the grains: the second one of differences from the means.
void fitVelocities(const std::vector<MeasuredGrain>& grains, const std::vector<int>& inside, Vec3& mean, Mat3& gradient)
{
	Vec3 place = Vec3::Zero();
	mean.setZero();
	for (const int i : inside) {
		place += grains[i].centre;
		mean += grains[i].velocity;
	}
	place /= double(inside.size());
	mean /= double(inside.size());
	Mat3 spread = Mat3::Zero(), together = Mat3::Zero();
	for (const int i : inside) {
		const Vec3 x = grains[i].centre - place, v = grains[i].velocity - mean;
		spread += x * x.transpose();
		together += v * x.transpose();
	}
	// three numbers that are equal for a ball; one is 0 for grains in a plane
	const double third = spread.trace() / 3;
	if (spread.determinant() > 1e-9 * third * third * third)
		gradient = spread.ldlt().solve(together.transpose()).transpose();
	else
		gradient.setConstant(nan);
}

} // namespace

double lensVolume(double radius1, double radius2, double distance)
{
	const double sum = radius1 + radius2, difference = radius1 - radius2;
	if (distance >= sum) return 0;
	if (distance <= std::abs(difference)) return ballVolume(std::min(radius1, radius2));
	return M_PI * (sum - distance) * (sum - distance) * (distance * distance + 2 * distance * sum - 3 * difference * difference) / (12 * distance);
}

void SphereRegions::ContactSums::addMoment(double share, const ContactSums& other)
{
	for (int a = 0; a < 9; ++a) moment[a] += share * other.moment[a];
}

void SphereRegions::ContactSums::addPoint(const ContactSums& other)
{
	overlap += other.overlap;
	active += other.active;
	compressed += other.compressed;
	sliding += other.sliding;
}

SphereRegions::SphereRegions(std::vector<MeasuredGrain> unsorted, std::vector<MeasuredContact> contacts)
{
	if (unsorted.empty()) reject("grains", 0, "are none", "an assembly of one grain at least");
	std::vector<Vec3> points;
	for (std::size_t i = 0; i < unsorted.size(); ++i) {
		requirePositive("radii[" + std::to_string(i) + "]", unsorted[i].radius, "m");
		points.push_back(unsorted[i].centre);
	}
	std::vector<int> activeOf(unsorted.size(), 0);
	for (const MeasuredContact& c : contacts)
		for (const int grain : {c.first, c.second})
			if (grain >= 0 && c.normalForce != 0) ++activeOf.at(grain);

	low = high = points[0];
	grainGrid = sortedGrid(points, given);
	for (const int i : given) {
		const MeasuredGrain& g = unsorted[i];
		low = low.cwiseMin(g.centre - Vec3::Constant(g.radius));
		high = high.cwiseMax(g.centre + Vec3::Constant(g.radius));
		largestRadius = std::max(largestRadius, g.radius);
		grains.push_back(g);
		volume.push_back(ballVolume(g.radius));
		active.push_back(activeOf[i]);
	}

	points.clear();
	for (const MeasuredContact& c : contacts) points.push_back(0.5 * (c.start + c.end));
	std::vector<int> order;
	contactGrid = sortedGrid(points, order);
	for (const int i : order) {
		const MeasuredContact& c = contacts[i];
		const bool grainsTouch = c.first >= 0 && c.second >= 0;
		const Vec3 branch = c.end - c.start;
		const double length = branch.norm();
		reaches.push_back({points[i], std::max(0.5 * length, (c.point - points[i]).norm())});
		longestReach = std::max(longestReach, reaches.back().radius);
		branches.push_back({c.start, branch, c.point});
		ContactSums sum{};
		for (int a = 0; a < 9; ++a) sum.moment[a] = c.force[a / 3] * branch[a % 3];
		sum.active = c.normalForce != 0;
		if (grainsTouch) sum.overlap = lensVolume(unsorted[c.first].radius, unsorted[c.second].radius, length);
		if (grainsTouch && c.normalForce > 0) {
			sum.compressed = 1;
			// the tangential springs' force may lean out of the contact plane a little; the law cuts its size, with another rounding
			const double tangential = (c.force - c.normalForce / length * branch).norm(), limit = (1 - 1e-6) * c.friction * c.normalForce;
			sum.sliding = std::isnan(limit) ? nan : tangential >= limit;
		}
		sums.push_back(sum);
	}
}

void SphereRegions::requireRegions(const std::vector<Vec3>& centres, const std::vector<double>& radii) const
{
	if (centres.size() != radii.size())
		reject("radii", int(radii.size()), "radii for " + std::to_string(centres.size()) + " centres", "one radius for each centre");
	const auto text = [](const Vec3& x) { return "(" + formatNumber(x[0]) + ", " + formatNumber(x[1]) + ", " + formatNumber(x[2]) + ")"; };
	for (std::size_t k = 0; k < centres.size(); ++k) {
		const std::string index = "[" + std::to_string(k) + "]";
		requirePositive("radii" + index, radii[k], "m");
		for (int axis = 0; axis < 3; ++axis) requireFinite("centres" + index, centres[k][axis], "m");
		const Vec3 nearest = centres[k].cwiseMax(low).cwiseMin(high);
		if ((nearest - centres[k]).squaredNorm() > radii[k] * radii[k])
			reject("centres" + index, text(centres[k]), "the region lies outside the specimen",
			       "in m, a centre in the box round the grains, " + text(low) + " to " + text(high));
	}
}

std::vector<int> SphereRegions::binsOf(const std::vector<double>& diameters) const
{
	if (diameters.empty()) return {};
	if (diameters.size() < 2) reject("diameters", int(diameters.size()), "are no bin", "two borders at least, in m");
	for (std::size_t k = 0; k < diameters.size(); ++k) {
		requireNonNegative("diameters[" + std::to_string(k) + "]", diameters[k], "m");
		if (k > 0 && !(diameters[k] > diameters[k - 1]))
			reject("diameters[" + std::to_string(k) + "]", diameters[k], "is not above the one before",
			       "give the borders of the bins rising, in m");
	}
	std::vector<int> bins;
	for (const MeasuredGrain& g : grains) {
		const int bin = int(std::upper_bound(diameters.begin(), diameters.end(), 2 * g.radius) - diameters.begin()) - 1;
		bins.push_back(bin + 1 < int(diameters.size()) ? bin : -1);
	}
	return bins;
}

RegionMeasures SphereRegions::measure(const std::vector<Vec3>& centres, const std::vector<double>& radii, const std::vector<double>& diameters) const
{
	requireRegions(centres, radii);
	const std::vector<int> bins = binsOf(diameters);
	const std::size_t count = centres.size(), binCount = bins.empty() ? 0 : diameters.size() - 1;
	RegionMeasures found;
	found.sizes.assign(count * binCount, 0);
	found.grains.resize(count);
	found.contacts.resize(count);
	for (auto* numbers : {&found.porosity, &found.coordination, &found.sliding}) numbers->assign(count, nan);
	for (auto* tensors : {&found.stress, &found.velocityGradient}) tensors->assign(count, Mat3::Constant(nan));
	found.velocity.assign(count, Vec3::Constant(nan));
	std::vector<int> inside, order;
	sortedGrid(centres, order); // neighbours one after the other read the same memory
	for (const int k : order) {
		const Vec3 centre = centres[k];
		const double radius = radii[k], square = radius * radius, whole = ballVolume(radius);
		double solid = 0;
		int touching = 0;
		inside.clear();
		grainGrid->forEachWithin(centre, radius + largestRadius, [&](int i) {
			const MeasuredGrain& g = grains[i];
			const double apart = (g.centre - centre).squaredNorm(), outer = radius + g.radius, inner = radius - g.radius;
			if (apart >= outer * outer) return;
			const double part = inner > 0 && apart <= inner * inner ? volume[i] : lensVolume(radius, g.radius, std::sqrt(apart));
			solid += part;
			if (binCount > 0 && bins[i] >= 0) found.sizes[k * binCount + bins[i]] += part;
			if (apart < square) {
				inside.push_back(i);
				touching += active[i];
			}
		});

		ContactSums sum{};
		int met = 0;
		if (contactGrid)
			contactGrid->forEachWithin(centre, radius + longestReach, [&](int i) {
				const Reach& reach = reaches[i];
				const double apart = (reach.middle - centre).squaredNorm(), outer = radius + reach.radius, inner = radius - reach.radius;
				if (apart >= outer * outer) return;
				if (inner > 0 && apart <= inner * inner) {
					++met;
					sum.addMoment(1, sums[i]);
					sum.addPoint(sums[i]);
					return;
				}
				const Branch& branch = branches[i];
				const double share = shareInside(branch.start - centre, branch.whole, radius);
				met += share > 0;
				sum.addMoment(share, sums[i]);
				if ((branch.point - centre).squaredNorm() < square) sum.addPoint(sums[i]);
			});
		solid -= sum.overlap;

		found.grains[k] = int(inside.size());
		found.contacts[k] = int(sum.active);
		found.porosity[k] = 1 - solid / whole;
		if (sum.compressed > 0) found.sliding[k] = sum.sliding / sum.compressed;
		if (met > 0) found.stress[k] = Eigen::Map<const RowMajor>(sum.moment) / whole;
		if (inside.empty()) continue;
		found.coordination[k] = double(touching) / double(inside.size());
		fitVelocities(grains, inside, found.velocity[k], found.velocityGradient[k]);
	}
	return found;
}

RegionMembers SphereRegions::members(const std::vector<Vec3>& centres, const std::vector<double>& radii) const
{
	requireRegions(centres, radii);
	RegionMembers found;
	found.start.push_back(0);
	for (std::size_t k = 0; k < centres.size(); ++k) {
		grainGrid->forEachWithin(centres[k], radii[k], [&](int i) {
			if ((grains[i].centre - centres[k]).squaredNorm() < radii[k] * radii[k]) found.grain.push_back(given[i]);
		});
		std::sort(found.grain.begin() + found.start.back(), found.grain.end());
		found.start.push_back(int(found.grain.size()));
	}
	return found;
}

} // namespace hexmembrane
