// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "ContactStiffness.hpp"

#include "contact/LinearContact.hpp"

namespace yade {

Real contactStiffness(Real kn, const HexMembrane* membrane, const string& engine)
{
	if (!math::isnan(kn)) {
		hexmembrane::requirePositive(engine + ".kn", kn, "N/m");
		return kn;
	}
	const auto& material = membrane->body(*Omega::instance().getScene(), 0, engine + ".normalStiffness")->material;
	const auto* linear = dynamic_cast<const LinearMat*>(material.get());
	if (!linear)
		hexmembrane::reject(engine + ".kn", kn, "not given, and the membrane's material (" + material->getClassName() + ") tells no stiffness",
		                    "kn in N/m, or LinearMat");
	linear->requireComplete();
	const auto m = linear->contactMaterial();
	return hexmembrane::sphereLaw(m, m, membrane->sphereRadius, membrane->sphereRadius).kn;
}

} // namespace yade
