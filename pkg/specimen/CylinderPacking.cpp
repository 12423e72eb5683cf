// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CylinderPacking.hpp"

#include "base/NamedFields.hpp"
#include "kernels/packing/StressedPacking.hpp"

#include <stdexcept>

namespace yade {

const CylinderPacking& CylinderPacking::generated() const
{
	if (packedCentres.empty()) throw std::runtime_error("CylinderPacking: there are no results yet; fix: call generate() first");
	return *this;
}

const CylinderPacking& CylinderPacking::stressed() const
{
	if (!generated().packedStressed)
		throw std::runtime_error("CylinderPacking: the packing was made without stress; fix: set stress, young and friction, then generate()");
	return *this;
}

void CylinderPacking::generate()
{
	for (int axis = 0; axis < 3; ++axis) hexmembrane::requireFinite("CylinderPacking.origin", static_cast<double>(origin[axis]), "m");
	hexmembrane::requireIn(hexmembrane::shared::packing_seed, "CylinderPacking.seed", static_cast<double>(seed), "1");

	if (stress != 0) hexmembrane::requirePositive("CylinderPacking.stress", static_cast<double>(stress), "Pa (0: no stress)");

	hexmembrane::StressedPackingSpec under;
	hexmembrane::SpherePackingSpec& spec = under.packing;
	spec.radius = static_cast<double>(radius);
	spec.height = static_cast<double>(height);
	spec.radii.assign(radii.begin(), radii.end());
	spec.porosity = static_cast<double>(porosity);
	spec.seed = static_cast<std::uint64_t>(seed);
	spec.tolerance = static_cast<double>(tolerance);
	spec.shakes = shakes;
	under.stress = static_cast<double>(stress);
	under.law = {static_cast<double>(emod), static_cast<double>(stiffnessRatio), static_cast<double>(friction), 0.5, static_cast<double>(rollingFriction)};
	under.porosityTolerance = static_cast<double>(porosityTolerance);

	hexmembrane::StressedPacking made;
	named("CylinderPacking", {{"modulus", "emod"}}, [&] {
		if (stress > 0)
			made = hexmembrane::packUnderStress(under);
		else
			static_cast<hexmembrane::SpherePacking&>(made) = hexmembrane::packSpheres(spec);
	});
	packedCentres.clear();
	packedCentres.reserve(made.centres.size());
	for (const auto& c : made.centres) packedCentres.push_back(origin + Vector3r(c[0], c[1], c[2]));
	packedRadii.assign(made.radii.begin(), made.radii.end());
	packedPorosity = made.porosity;
	packedOverlap = made.maxOverlap;
	packedScale = made.scale;
	packedShakes = made.shakesUsed;
	packedStressed = stress > 0;
	packedRadial = made.radialStress;
	packedAxial = made.axialStress;
	packedCoordination = made.coordination;
	packedRattlers = made.rattlers;
	packedFriction = made.frictionReached;
}

YADE_PLUGIN((CylinderPacking));

} // namespace yade
