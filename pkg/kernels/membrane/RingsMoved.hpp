// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/PaddedRings.hpp"

namespace hexmembrane {

/// Whether every particle of a tube is nearer than `way` (m) to where it was. False for places that are not finite, or that were another tube's.
bool nearerThan(double way, const HexStencil& stencil, const PaddedRings& now, const PaddedRings& then);

} // namespace hexmembrane
