// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/SlabStress.hpp"

namespace hexmembrane {

/// What a small displacement gradient (entry (i, j) du_i/dx_j) says about strain.
struct StrainInvariants {
	double volumetric; ///< trace of the strain; compression negative (-)
	double deviatoric; ///< sqrt(2/3 e:e), e the strain's deviator: the axial strain of a triaxial test at constant volume (-)
	Vec3 rotation;     ///< half the curl (rad)
};
StrainInvariants invariantsOf(const Mat3& gradient);

/// Non-affine motion: of each site, the mean square (m2) of what the best affine fit leaves of its neighbours' displacements relative to its own.
/// M. L. Falk and J. S. Langer, Phys. Rev. E 57, 1998: their D2min over the number of neighbours. NaN where neighbours do not span space.
/// \param x, u places and displacements (m) \param starts, neighbours those of site i lie from starts[i] to starts[i + 1]
std::vector<double> nonAffine(const std::vector<Vec3>& x, const std::vector<Vec3>& u, const std::vector<int>& starts, const std::vector<int>& neighbours);

} // namespace hexmembrane
