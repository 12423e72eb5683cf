// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/packing/SpherePacking.hpp"

#include "kernels/base/CellGrid.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/packing/SphereRelaxation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace hexmembrane {

namespace {

using Outcome = SphereRelaxation::Outcome;

/// Solid fractions: where growth starts, by how much it goes on, and the largest up to which loose packings may be spread (denser ones jam).
constexpr double firstFraction = 0.50, growth = 0.01, largestEven = 0.6;
/// Share by which a jammed packing is shrunk before it is shaken, and the half width of the random steps over the mean radius.
constexpr double loosening = 0.02, shakeAmplitude = 0.5;
/// A jammed packing whose mean overlap exceeds this share of the mean diameter is beyond what shaking can gain.
constexpr double hopelessOverlap = 0.008;
constexpr int maxStepsEach = 20000;

double sphereVolume(double radius) { return 4. / 3. * M_PI * radius * radius * radius; }

double solidVolume(const std::vector<double>& radii)
{
	double sum = 0;
	for (double r : radii) sum += sphereVolume(r);
	return sum;
}

void checkCylinder(double radius, double height)
{
	requirePositive("radius", radius, "m");
	requirePositive("height", height, "m");
}

void checkRadii(const std::vector<double>& radii)
{
	if (radii.empty()) reject("radii", "[]", "no spheres", "one radius (m) for each sphere");
	for (std::size_t i = 0; i < radii.size(); ++i) requirePositive("radii[" + std::to_string(i) + "]", radii[i], "m");
}

void checkSpec(const SpherePackingSpec& s)
{
	checkCylinder(s.radius, s.height);
	checkRadii(s.radii);
	if (!std::isnan(s.porosity) && !(s.porosity > 0 && s.porosity < 1))
		reject("porosity", s.porosity, "outside 0 .. 1", "e.g. 0.40, or nan to keep the radii");
	requirePositive("tolerance", s.tolerance, "1 (share of the mean radius)");
	if (s.tolerance > 0.01) reject("tolerance", s.tolerance, "too coarse for a packing without overlaps", "at most 0.01, 1e-4 by default");
	requireNonNegative("even", s.even, "1 (solid fraction)");
	if (s.even > largestEven) reject("even", s.even, "as dense as spheres jam", "at most " + formatNumber(largestEven));
	if (s.shakes < 0) reject("shakes", s.shakes, "a number of trials cannot be negative", "0 or more");
}

void checkSpheresFit(const SpherePackingSpec& s, double scale)
{
	const double largest = scale * *std::max_element(s.radii.begin(), s.radii.end());
	const double room = std::min(s.radius, s.height / 2);
	if (largest >= room)
		reject("radii", largest, "the largest sphere (m, scaled to the porosity) does not go into the cylinder",
		       "more (smaller) spheres or a wider cylinder: radii below " + formatNumber(room) + " m");
	const double fraction = scale * scale * scale * solidVolume(s.radii) / (M_PI * s.radius * s.radius * s.height);
	if (fraction >= 1) reject("radii", 1 - fraction, "the porosity that these radii make", "fewer or smaller spheres, or give a porosity to scale them to");
}

/// Uniform in the part of the cylinder that a sphere's centre may take. Drawn from the square round it: no sine, so the same bits everywhere.
std::vector<Vec3> drawCentres(const std::vector<double>& radii, double radius, double height, Random& random)
{
	std::vector<Vec3> centres;
	centres.reserve(radii.size());
	for (double r : radii) {
		const double limit = radius - r;
		double px, py;
		do {
			px = random.uniform(-limit, limit);
			py = random.uniform(-limit, limit);
		} while (px * px + py * py > limit * limit);
		centres.emplace_back(px, py, random.uniform(r, height - r));
	}
	return centres;
}

/// Grows, shakes and judges one packing. Sizes are given as factors on the wanted radii.
class Grower {
public:
	Grower(const SpherePackingSpec& spec, const std::vector<double>& wanted)
	    : random(spec.seed), radii(wanted), fraction(1 - packingPorosity(wanted, spec.radius, spec.height)),
	      meanRadius(std::accumulate(wanted.begin(), wanted.end(), 0.0) / double(wanted.size())), smallest(*std::min_element(wanted.begin(), wanted.end())),
	      tolerance(spec.tolerance), spheres(drawCentres(wanted, spec.radius, spec.height, random), wanted, spec.radius, spec.height)
	{
	}

	/// Factor that makes the solid fraction `wanted`.
	double factorFor(double wanted) const { return std::cbrt(wanted / fraction); }

	bool separate(double factor) { return spheres.relax(factor * (1 + tolerance), tolerance * smallest, maxStepsEach) == Outcome::separated; }

	/// From where the spheres are to the wanted size, in steps of the solid fraction. \returns whether it got there
	bool grow(double from)
	{
		for (double f = from; f < fraction; f += growth)
			if (!separate(factorFor(f))) return false;
		return separate(1);
	}

	/// Past the wanted size, as far as it goes up to the solid fraction `even`; the last good state is kept.
	void spread(double even)
	{
		kept = spheres.centres();
		for (double f = fraction + growth; f < even; f += growth) {
			if (!separate(factorFor(f))) return;
			kept = spheres.centres();
		}
	}

	void loosenAndShake()
	{
		separate(1 - loosening);
		spheres.shake(shakeAmplitude * meanRadius, random);
	}

	bool hopeless() const { return spheres.meanOverlap() > hopelessOverlap * 2 * meanRadius; }

	/// Shrinks from a jammed state until nothing overlaps. \returns the porosity reached
	double densest()
	{
		double factor = 1;
		while (!separate(factor)) factor *= 1 - std::max(0.7 * spheres.meanOverlap() / (2 * meanRadius), 3e-4);
		return 1 - fraction * factor * factor * factor;
	}

	const std::vector<Vec3>& result() const { return kept; }
	long steps() const { return spheres.steps(); }
	double mean() const { return meanRadius; }
	double start() const { return std::min(firstFraction, fraction); }

private:
	Random random;
	const std::vector<double>& radii;
	double fraction, meanRadius, smallest, tolerance;
	SphereRelaxation spheres;
	std::vector<Vec3> kept;
};

[[noreturn]] void refuse(const SpherePackingSpec& spec, double asked, double reached)
{
	// the densest state of one trial, that of the next may be a little looser
	const double advised = std::ceil((reached + 0.004) * 1000) / 1000;
	fail("porosity", asked,
	     "denser than these " + std::to_string(spec.radii.size()) + " spheres go into this cylinder at random, the densest state found has " +
	             formatNumber(reached),
	     "a porosity of at least " + formatNumber(advised) + ", more (smaller) spheres, or a wider gradation");
}

} // namespace

double packingPorosity(const std::vector<double>& radii, double cylinderRadius, double cylinderHeight)
{
	checkCylinder(cylinderRadius, cylinderHeight);
	checkRadii(radii);
	return 1 - solidVolume(radii) / (M_PI * cylinderRadius * cylinderRadius * cylinderHeight);
}

double scaleForPorosity(const std::vector<double>& radii, double cylinderRadius, double cylinderHeight, double porosity)
{
	checkCylinder(cylinderRadius, cylinderHeight);
	checkRadii(radii);
	requireFinite("porosity", porosity, "1");
	if (!(porosity > 0 && porosity < 1)) reject("porosity", porosity, "outside 0 .. 1", "e.g. 0.40");
	return std::cbrt((1 - porosity) * M_PI * cylinderRadius * cylinderRadius * cylinderHeight / solidVolume(radii));
}

double largestOverlap(const std::vector<Vec3>& centres, const std::vector<double>& radii, double cylinderRadius, double cylinderHeight)
{
	checkCylinder(cylinderRadius, cylinderHeight);
	const Vec3 low(-cylinderRadius, -cylinderRadius, 0), high(cylinderRadius, cylinderRadius, cylinderHeight);
	const NearPairs pairs = findNearPairs(centres, radii, 0, low, high);
	double worst = 0;
	for (std::size_t i = 0; i < centres.size(); ++i) {
		const Vec3& c = centres[i];
		worst = std::max({worst, radii[i] - c[2], c[2] + radii[i] - cylinderHeight, std::sqrt(c[0] * c[0] + c[1] * c[1]) + radii[i] - cylinderRadius});
		for (int k = pairs.start[i]; k < pairs.start[i + 1]; ++k)
			worst = std::max(worst, radii[i] + radii[pairs.other[k]] - (c - centres[pairs.other[k]]).norm());
	}
	return worst;
}

SpherePacking packSpheres(const SpherePackingSpec& spec)
{
	checkSpec(spec);
	SpherePacking out;
	out.scale = std::isnan(spec.porosity) ? 1 : scaleForPorosity(spec.radii, spec.radius, spec.height, spec.porosity);
	checkSpheresFit(spec, out.scale);
	out.radii = spec.radii;
	for (double& r : out.radii) r *= out.scale;
	out.porosity = packingPorosity(out.radii, spec.radius, spec.height);

	Grower grower(spec, out.radii);
	out.shakesUsed = 0;
	for (bool done = grower.grow(grower.start()); !done; done = grower.grow(1 - out.porosity)) {
		if (out.shakesUsed == spec.shakes || grower.hopeless()) refuse(spec, out.porosity, grower.densest());
		grower.loosenAndShake();
		++out.shakesUsed;
	}
	grower.spread(spec.even);
	out.centres = grower.result();
	out.steps = grower.steps();
	out.maxOverlap = largestOverlap(out.centres, out.radii, spec.radius, spec.height) / grower.mean();
	if (!(out.maxOverlap <= spec.tolerance))
		fail("maxOverlap", out.maxOverlap, "above the tolerance although the relaxation ended", "report it with radii and seed");
	return out;
}

} // namespace hexmembrane
