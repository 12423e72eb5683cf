// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/packing/StressedPacking.hpp"

#include "kernels/base/Check.hpp"
#include "SharedValues.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace hexmembrane {

namespace {

/// How much looser than wanted it starts, the densest and the loosest start, and the start of grains without friction. All of them are far from jamming.
constexpr double looser = 0.08, densestStart = 0.45, loosest = 0.65, smoothStart = 0.55;
/// Inertial number of the growth; share of the friction lost in the time that a grain needs to move its own size under the stress.
constexpr double inertialNumber = 2e-3, frictionLoss = 0.1;
/// Friction below this is none.
constexpr double noFriction = 1e-4;
/// Grains without friction are too stiff when they grow by less than this in so many steps.
constexpr double leastGrowth = 2e-5;
constexpr long stallSteps = 1000;
/// What counts as the wanted stress and as equilibrium, for this many looks in a row.
constexpr double stressTolerance = 0.03, equilibrium = 1e-3;
constexpr int lookEvery = 100, looks = 3;
constexpr long maxSteps = 1000000;

bool smooth(const StressedPackingSpec& s) { return s.law.friction < noFriction; }

void check(const StressedPackingSpec& s)
{
	requirePositive("stress", s.stress, "Pa");
	requirePositive("modulus", s.law.modulus, "Pa");
	requireIn(shared::stiffness_ratio, "stiffnessRatio", s.law.stiffnessRatio, "1 (kn/ks)");
	requireIn(shared::friction, "friction", s.law.friction, "1 (tan of the angle)");
	requireIn(shared::rolling_friction, "rollingFriction", s.law.rollingFriction, "1");
	requireNonNegative("damping", s.law.damping, "1");
	requirePositive("porosityTolerance", s.porosityTolerance, "1");
	if (s.law.damping >= 1) reject("damping", s.law.damping, "would stop everything", "below 1, 0.5 by default");
	if (s.porosityTolerance >= 0.1) reject("porosityTolerance", s.porosityTolerance, "no tolerance of a porosity", "e.g. 0.001");
	if (s.stress > 1e-2 * s.law.modulus)
		reject("stress", s.stress, "grains would overlap by more than 1 %",
		       "at most 0.01 of the contact modulus, " + formatNumber(s.law.modulus) + " Pa");
	if (std::isnan(s.packing.porosity) && smooth(s)) return;
	requireFinite("porosity", s.packing.porosity, "1 (a packing under stress needs one)");
	if (!(s.packing.porosity > 0)) reject("porosity", s.packing.porosity, "outside 0 .. 1", "e.g. 0.40");
	if (s.packing.porosity >= loosest)
		reject("porosity", s.packing.porosity, "no packing of spheres that carries stress", "below " + formatNumber(loosest));
}

/// Brings one assembly to size 1 and to the wanted stress.
class Compactor {
public:
	Compactor(const StressedPackingSpec& spec, const SpherePacking& start, double toSize)
	    : wanted(spec.stress), final(spec.law.friction), rolling(spec.law.rollingFriction), friction(final),
	      growth(inertialNumber / std::sqrt(spec.law.modulus / (2 * spec.stress)) * GrainAssembly::timeStep),
	      loss(frictionLoss / std::sqrt(spec.law.modulus / (2 * spec.stress)) * GrainAssembly::timeStep),
	      grains(start.centres, scaledBy(start.radii, toSize), 1 / toSize, spec.packing.radius, spec.packing.height, spec.law)
	{
	}

	/// Grows to size 1, then waits there until the stress is not above the wanted one. \returns false when even smooth grains are too stiff on the way
	bool compress()
	{
		double before = 0;
		while (grains.factor() < 1 || over() > 1 + stressTolerance) {
			if (friction < noFriction && made % stallSteps == 0) {
				if (grains.factor() - before < leastGrowth) return false;
				before = grains.factor();
			}
			grains.step(std::min(growth * std::clamp(1 - over() / 2, 0.0, 1.0), 1 / grains.factor() - 1));
			lowerFriction();
			count();
		}
		return true;
	}

	/// With the final friction: size follows the stress until both stand still. Slow, so that what it does to the stress is seen in time.
	void settle()
	{
		grains.setFriction(final, rolling);
		for (int good = 0, step = 1; good < looks; ++step) {
			const double lack = 1 - over();
			grains.step(growth * (lack > 0.5 ? 1 : 0.1) * std::clamp(lack, -1.0, 1.0));
			count();
			if (step % lookEvery != 0) continue;
			good = std::abs(1 - over()) < stressTolerance && grains.unbalancedRatio() < equilibrium ? good + 1 : 0;
		}
	}

	const GrainAssembly& assembly() const { return grains; }
	double lowestFriction() const { return friction; }
	long steps() const { return made; }

private:
	static std::vector<double> scaledBy(std::vector<double> radii, double factor)
	{
		for (double& r : radii) r *= factor;
		return radii;
	}

	double over() const { return grains.meanStress() / wanted; }

	void lowerFriction()
	{
		if (over() <= 1) return;
		friction *= 1 - loss * std::min(over() - 1, 1.0);
		grains.setFriction(friction, rolling * (friction / final));
	}

	void count()
	{
		if (++made > maxSteps)
			fail("stress", wanted,
			     "no equilibrium after " + std::to_string(maxSteps) + " steps, the stress is " + formatNumber(grains.meanStress()) + " Pa",
			     "a higher stress, another seed, or another porosity");
	}

	double wanted, final, rolling, friction, growth, loss;
	long made = 0;
	GrainAssembly grains;
};

[[noreturn]] void refuse(const StressedPackingSpec& spec, bool tooDense, double reached)
{
	// another seed or a neighbouring porosity may end a little off what this one reached, a loose one more than a dense one
	const double advised = tooDense ? std::ceil((reached + 0.005) * 1000) / 1000 : std::floor((reached - 0.02) * 1000) / 1000;
	fail("porosity", spec.packing.porosity,
	     std::string(tooDense ? "denser" : "looser") + " than these " + std::to_string(spec.packing.radii.size()) + " grains get at " +
	             formatNumber(spec.stress) + " Pa with friction " + formatNumber(spec.law.friction) +
	             (spec.law.rollingFriction > 0 ? " and rolling friction " + formatNumber(spec.law.rollingFriction) : "") + ", " + formatNumber(reached) +
	             " was reached",
	     std::string("a porosity of at ") + (tooDense ? "least " : "most ") + formatNumber(advised) +
	             (tooDense ? "" : ", or more friction or rolling friction"));
}

void requirePorosity(const StressedPackingSpec& spec, bool densest, double reached)
{
	const double excess = reached - spec.packing.porosity;
	if (smooth(spec) && std::abs(excess) > spec.porosityTolerance) // false for a porosity that is not asked for
		fail("porosity", spec.packing.porosity,
		     "grains without friction have one porosity at this stress, whatever is asked for; " + formatNumber(reached) + " was reached",
		     "friction, no stress, or no porosity (nan: the packing's own)");
	if (densest || excess > spec.porosityTolerance) refuse(spec, true, reached);
	if (excess < -spec.porosityTolerance) refuse(spec, false, reached);
}

} // namespace

StressedPacking packUnderStress(const StressedPackingSpec& spec)
{
	check(spec);
	SpherePackingSpec loose = spec.packing;
	loose.porosity = smooth(spec) ? smoothStart : std::clamp(spec.packing.porosity + looser, densestStart, loosest);
	loose.even = 0;
	const SpherePacking start = packSpheres(loose);
	// grains without friction grow until they carry the stress: there is no other size to bring them to, and no friction to lower
	const double size = smooth(spec) ? 1 : std::cbrt((1 - spec.packing.porosity) / (1 - start.porosity));

	Compactor compactor(spec, start, size);
	const bool densest = !smooth(spec) && !compactor.compress();
	compactor.settle();
	const GrainAssembly& grains = compactor.assembly();

	StressedPacking out;
	out.scale = start.scale * size * grains.factor();
	out.centres = grains.centres();
	out.radii = spec.packing.radii;
	double mean = 0;
	for (double& r : out.radii) {
		r *= out.scale;
		mean += r / double(out.radii.size());
	}
	out.porosity = packingPorosity(out.radii, spec.packing.radius, spec.packing.height);
	requirePorosity(spec, densest, out.porosity);
	out.maxOverlap = largestOverlap(out.centres, out.radii, spec.packing.radius, spec.packing.height) / mean;
	out.shakesUsed = start.shakesUsed;
	out.steps = start.steps + compactor.steps();
	out.radialStress = grains.radialStress();
	out.axialStress = grains.axialStress();
	out.coordination = 2.0 * grains.contacts() / double(out.radii.size());
	out.rattlers = grains.rattlers() / double(out.radii.size());
	out.unbalanced = grains.unbalancedRatio();
	out.frictionReached = compactor.lowestFriction();
	return out;
}

} // namespace hexmembrane
