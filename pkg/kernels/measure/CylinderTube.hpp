// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/PowerCells.hpp"

namespace hexmembrane {

/// How many points stand for a cylinder: in a ring, and rows of triangles between the faces.
struct CylinderLattice {
	int around, rows;
};

/// The lattice whose neighbouring points are about `spacing` apart.
/// \throws FieldError for lengths that are not positive
CylinderLattice cylinderLattice(double radius, double height, double spacing);

/// An upright cylinder as an enclosure of triangles. Rings of points stand at both faces, evenly between them and two rows beyond, every other one turned by half
/// a spacing. Their radius is a little larger than the cylinder's: the volume between the faces is the cylinder's exactly, and the points are beyond it, and the
/// triangles' middles within it, by less than 3 radius/around^2.
/// \param axis its x and y are those of the cylinder \param lattice 6 points around or more, a row or more
/// \throws FieldError for lengths or counts that are not positive
Enclosure cylinderTube(const Vec3& axis, double radius, double bottom, double top, const CylinderLattice& lattice);

} // namespace hexmembrane
