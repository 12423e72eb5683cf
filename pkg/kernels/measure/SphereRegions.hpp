// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/CellGrid.hpp"

#include <memory>
#include <vector>

namespace hexmembrane {

using Mat3 = Eigen::Matrix3d;

/// A sphere of the soil: centre (m), radius (m), velocity (m/s).
struct MeasuredGrain {
	Vec3 centre;
	double radius;
	Vec3 velocity;
};

/// A touching contact of one or two grains.
struct MeasuredContact {
	int first, second;  ///< indices of its grains, -1: no grain
	Vec3 start, end;    ///< of the branch, from the first body to the second (m): centres of grains, the contact point on all else
	Vec3 point;         ///< half way through the overlap (m)
	Vec3 force;         ///< on the second body (N)
	double normalForce; ///< compression positive (N); 0: the contact is not active
	double friction;    ///< coefficient (-); infinite: held by a bond, NaN: not known
};

/// What the regions hold, one entry a region; NaN where nothing tells.
struct RegionMeasures {
	std::vector<int> grains;            ///< with their centres inside
	std::vector<int> contacts;          ///< active ones with their points inside
	std::vector<double> porosity;       ///< 1: nothing inside (-)
	std::vector<double> coordination;   ///< NaN: no centre inside (-)
	std::vector<double> sliding;        ///< share of the contacts; NaN: none of two grains in compression inside, or one of unknown friction (-)
	std::vector<Mat3> stress;           ///< compression positive; NaN: no branch inside (Pa)
	std::vector<Vec3> velocity;         ///< mean of the grains with their centres inside; NaN: none (m/s)
	std::vector<Mat3> velocityGradient; ///< dv_i/dx_j, extension positive; NaN: less than four grains inside, or all in a plane (1/s)
	std::vector<double> sizes;          ///< volumes of grains inside by bins of diameter, one row a region (m3)
};

/// Grains with their centres inside: those of region k are grain[start[k]] .. grain[start[k + 1] - 1], ascending.
struct RegionMembers {
	std::vector<int> start, grain;
};

/// Volume (m3) that two balls share, the distance of their centres given: 0 apart, the smaller ball's when it lies in the other.
double lensVolume(double radius1, double radius2, double distance);

/// Measurement regions as PFC's: balls that may overlap, over an assembly of grains (PFC 6.0 documentation, "Measured Quantities").
///
/// Porosity: 1 - (sum of the grains' volumes inside - sum of the overlaps' volumes)/V. A grain that the surface cuts counts with the exact lens. An overlap of
/// two grains in contact counts whole when its contact point lies inside, as in PFC: the error is at most the volume of the overlaps that the surface cuts.
/// Where three grains share a volume it is taken away once too often: the porosity is too large by it, over V, at most (Bonferroni). Three equal grains share
/// nothing while their overlaps are less than 13 % of the diameter.
///
/// Coordination: mean number of active contacts, with whatever body, of the grains with their centres inside.
///
/// Sliding: share of the active contacts of two grains in compression, with their points inside, whose tangential force is at friction times the normal one.
///
/// Stress: V sigma = sum F (x) l, l the part of the branch that lies inside. This is Goldhirsch's stress field (Granular Matter 12, 2010), coarse-grained by
/// the region's own ball: its mean over all places is the assembly's mean stress exactly, and regions that fill a volume share a branch without rest. PFC
/// takes whole branches of contacts inside, which holds for large regions only. No porosity is needed.
///
/// Velocity gradient: least squares of the velocities of the grains with their centres inside, from their means, as in PFC.
///
/// Sizes: volumes of grains inside, cut ones with the lens, by diameter. Overlaps are not taken away.
class SphereRegions {
public:
	/// \throws FieldError for no grain, one without a positive radius, or a coordinate that is not finite
	SphereRegions(std::vector<MeasuredGrain> grains, std::vector<MeasuredContact> contacts);

	/// \param diameters borders of bins (m), rising: a grain on a border belongs to the upper bin, one beyond the ends to none; empty: no sizes.
	/// \throws FieldError for a region that is none, or that does not meet the box round the grains
	RegionMeasures measure(const std::vector<Vec3>& centres, const std::vector<double>& radii, const std::vector<double>& diameters = {}) const;

	RegionMembers members(const std::vector<Vec3>& centres, const std::vector<double>& radii) const;

private:
	/// What is added up of the contacts that lie inside whole.
	struct ContactSums {
		double moment[9];                   // F (x) l, row by row
		double overlap;                     // volume of the lens
		double active, compressed, sliding; // numbers of contacts; compressed: of two grains; NaN: not known

		void addMoment(double share, const ContactSums& other);
		void addPoint(const ContactSums& other);
	};
	/// A ball that a contact's branch and point lie in.
	struct Reach {
		Vec3 middle;
		double radius;
	};
	struct Branch {
		Vec3 start, whole, point;
	};
	void requireRegions(const std::vector<Vec3>& centres, const std::vector<double>& radii) const;
	std::vector<int> binsOf(const std::vector<double>& diameters) const;

	std::vector<MeasuredGrain> grains; // sorted by the grid's cells, as the following
	std::vector<double> volume;
	std::vector<int> active; // contacts of each grain
	std::vector<int> given;  // index of each in the list that was given
	std::vector<Reach> reaches;
	std::vector<Branch> branches;
	std::vector<ContactSums> sums;
	std::unique_ptr<CellGrid> grainGrid, contactGrid;
	Vec3 low, high; // of the box round the grains
	double largestRadius = 0, longestReach = 0;
};

} // namespace hexmembrane
