// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <vector>

namespace hexmembrane {

using Mat3 = Eigen::Matrix3d;

/// Mean stress of a granular assembly in horizontal slabs: V sigma = sum over the contacts of F (x) l, compression positive, with F (N) the contact force on
/// the second body and l (m) the branch from the first to the second. A branch that crosses a border counts in each slab with the part that lies in it, so
/// that the slabs' sums add up to the whole assembly's exactly. What lies beyond the ends counts to the end slabs.
class SlabStress {
public:
	/// \param edges heights (m) of the slabs' borders, rising, two at least. \throws FieldError for others
	explicit SlabStress(std::vector<double> edges);

	/// Adds a contact: the start of its branch, the branch, the force on the second body.
	void add(const Vec3& start, const Vec3& branch, const Vec3& force);

	/// Sums of F (x) l by slab from below (N m): entry (i, j) is sum F_i l_j. Over a slab's volume they are its mean stress.
	const std::vector<Mat3>& sums() const { return inSlab; }
	Mat3 total() const;

private:
	std::vector<double> edges;
	std::vector<Mat3> inSlab;
};

} // namespace hexmembrane
