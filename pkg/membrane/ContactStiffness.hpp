// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"

namespace yade {

/*! Stiffness kn of an engine's contacts (N/m) as given, or when it is NaN that of the membrane's material in contact with itself.
 * \param membrane generated; of no consequence when kn is given \param engine class of the engine. \throws std::invalid_argument */
Real contactStiffness(Real kn, const HexMembrane* membrane, const string& engine);

} // namespace yade
