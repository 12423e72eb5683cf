// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/BondForce.hpp"

#include <vector>

namespace hexmembrane {

/// Force on the first particle of every bond (N), normal and shear part, at the kernel's present positions, in the order of HexStencil. What is broken
/// counts with what it still carries.
std::vector<Vec3> bondForces(const BondForce& bonds, const BondState& state);

/// Axial tension (N) that a tube carries through the horizontal plane at each height z: sum over the bonds that cross it of the z component of the force that
/// the part above exerts on the part below; positive pulls the two together. A bond that crosses belongs to one particle below z and one not below, so
/// that every plane cuts the tube in two whatever its folds. Of a thin tube of radius r: 2 pi r N_z. Summed in the order of the bonds.
/// \param x positions of the particles (m) \param onFirst force on the first particle of each bond (N)
std::vector<double> axialTension(const HexStencil& tube, const std::vector<Vec3>& x, const std::vector<Vec3>& onFirst, const std::vector<double>& heights);

/// The same (N) of forces f on the particles that add up to nothing, whatever calls them up: minus the axial forces on the particles that are not below z.
std::vector<double> axialPull(const std::vector<Vec3>& x, const std::vector<Vec3>& f, const std::vector<double>& heights);

/// Radial load of a ring.
struct RingLoad {
	double force; ///< sum of the inward radial parts of the forces on its particles (N)
	double area;  ///< its share of the smooth inner surface, 2 pi (r - R) times half the distance of its neighbours (m2)
};

/// Radial load of every ring under forces f on the particles (N), each towards the vertical axis through its ring's present centroid.
/// \param sphereRadius R (m)
std::vector<RingLoad> ringLoads(const HexStencil& tube, const std::vector<Vec3>& x, const std::vector<Vec3>& f, double sphereRadius);

} // namespace hexmembrane
