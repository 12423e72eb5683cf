// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hexmembrane {

/// Position, force or direction in space. Never aligned nor padded: an array of them is a plain array of 3 n doubles. The kernels are compiled with
/// EIGEN_DONT_ALIGN and EIGEN_DONT_VECTORIZE, as YADE is, so that both sides of the library agree on every inline function of Eigen.
using Vec3 = Eigen::Vector3d;

static_assert(sizeof(Vec3) == 3 * sizeof(double), "arrays of Vec3 are read as plain doubles");

} // namespace hexmembrane
