// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/BandMoments.hpp"

#include <memory>

namespace hexmembrane {

/// What displacements and strains of grains in a step say about planes of shear, by weighted least squares.
///
/// The model, with the powers and profiles of BandMoments.hpp:
/// * vertical displacement: symmetric powers, a_x, a_y and the step of a plane;
/// * horizontal displacement: a times symmetric powers, an affine part and the step in either direction;
/// * deviatoric strain: symmetric powers and the slab of a plane, its factor not negative.
///
/// All but the planes is fitted once. A plane costs one pass over the grains.
class BandGrains {
public:
	/// \param x places, the axis at x = y = 0, mid-height at z = 0 (m) \param u displacements (m) \param weights not negative \param strain deviatoric
	/// \throws FieldError for other numbers of them, none that is finite, a negative weight
	BandGrains(const std::vector<Vec3>& x, const std::vector<Vec3>& u, const std::vector<double>& weights, const std::vector<double>& strain);

	std::size_t size() const { return count; }
	/// Displacements and strains less what is fitted.
	const BandColumns& numbers() const { return *columns; }
	/// The part of each grain's strain that symmetric powers explain.
	std::vector<double> symmetricStrain() const;

private:
	friend class BandField;
	void fit();

	std::size_t count;
	std::unique_ptr<BandColumns> columns;    // displacements and strains less what is fitted
	Eigen::MatrixXd gram;                    // of the powers
	Eigen::MatrixXd up, sideX, sideY, still; // orthonormal functions by their coefficients, a row each
	Eigen::VectorXd symmetric;               // coefficients of the strain
	double moved = 0, strained = 0;          // weighted squares that are left
};

/// Displacements and strains less what the other parts and given planes explain; what one plane more explains of the rest.
class BandField {
public:
	/// \param grains referred to, must outlive this \param beside planes in the model
	explicit BandField(const BandGrains& grains, const std::vector<BandPlane>& beside = {});

	enum class Profile { smooth, uniform };
	struct Jump {
		Vec3 jump;    ///< displacement above the plane less that below (m); 0 where the profile is nothing beside the rest
		double taken; ///< weighted squares that it takes of those left (m2)
	};
	struct Excess {
		double strain; ///< in the slab's middle above that beside it, 0 at least
		double taken;
	};
	Jump jump(const BandPlane& plane, Profile profile) const;
	Excess excess(const BandPlane& plane) const;
	/// Weighted squares that are left, of displacements (m2) and of strains.
	std::array<double, 2> left() const { return rest; }
	/// Logarithm of the product of the shares that the plane leaves of displacements and strains: the least is the most likely plane.
	double unlikely(const BandPlane& plane) const;

private:
	Jump jumpOf(const BandSums& sums) const;
	Excess excessOf(const BandSums& sums) const;
	void take(const BandPlane& plane);
	Eigen::VectorXd stepMoments(const BandSums& sums) const;
	Eigen::VectorXd slabMoments(const BandSums& sums) const;

	const BandGrains& grains;
	BandRows rows;                           // of the planes beside
	Eigen::MatrixXd stepGram, slabGram;      // of the powers and the planes beside
	Eigen::MatrixXd up, sideX, sideY, still; // as in BandGrains, with the planes beside
	Eigen::MatrixXd movedSums;               // of what the powers leave of the displacements, with powers and planes
	Eigen::VectorXd strainedSums;
	Eigen::VectorXd upFit, sideFit, stillFit; // what the functions take of that
	std::array<double, 2> rest;
};

/// The search's limits and paces.
struct BandLimits {
	BandPlane low, high, steps;
};

/// The most likely plane near `start`. \param tolerance in steps of the search \param trials planes looked at, at most
BandPlane refinedPlane(const BandField& field, const BandLimits& limits, const BandPlane& start, double tolerance, int trials);

/// The slab of uniform shear, parallel to the plane, whose displacement fits best.
BandPlane slabOf(const BandField& field, const BandLimits& limits, const BandPlane& plane);

} // namespace hexmembrane
