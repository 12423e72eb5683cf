// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/BandFunctions.hpp"
#include "kernels/measure/BandSearch.hpp"
#include "kernels/measure/BandWaves.hpp"

namespace hexmembrane {

/// What grains move by beside the model: each on its own, and many together. Variances are of a direction.
struct BandNoise {
	double length; ///< motion is correlated as exp(-r^2/(2 length^2)) (m)
	double ratio;  ///< factor of BandWaves::variances, over the variance of single grains
	double single; ///< standard deviation of single grains (m)
};

/// Generalised least squares: planes that are the most likely ones for grains that move in vortices as well.
///
/// The model is that of BandGrains, with two additions. Correlated motion is a sum of waves whose factors have variances (a Gaussian process of low rank). Each plane
/// has a second profile, a exp(-a^2) with a = sqrt(6) s/t, for steps of another shape than erf. Vortices bend a plane's step over many grains; that is what the waves take,
/// so that the plane is found by what only a plane has, the sharp step. The noise is that of the greatest marginal likelihood among a table of lengths and
/// ratios, for what the given planes leave.
///
/// C. E. Rasmussen and C. K. I. Williams, Gaussian Processes for Machine Learning, 2006, section 2.7; A. Solin and S. Sarkka, Stat. Comput. 30, 2020.
class BandLikelihood {
public:
	/// \param grains referred to, must outlive this \param planes what is there \param diameter d50 (m), the unit of the lengths tried
	BandLikelihood(const BandGrains& grains, const std::vector<BandPlane>& planes, double diameter);

	const BandNoise& noise() const { return found; }

	/// Logarithm of the share that the plane leaves of the generalised squares of displacements, and strainWeight times that of strains. \param beside other planes
	double unlikely(const BandPlane& plane, const std::vector<BandPlane>& beside = {}) const;

	/// The planes fitted in turn, each with the others in the model. \param rounds of all planes \param tolerance in steps of the search
	std::vector<BandPlane> refined(std::vector<BandPlane> planes, const BandLimits& limits, int rounds, double tolerance, int trials) const;

	/// The strains are derivatives of the displacements and say little more; they keep a thickness that the displacements leave open.
	static constexpr double strainWeight = 0.1;

private:
	/// A profile's sums.
	struct Profile {
		BandWaves::Row plain, weighted;
		Eigen::VectorXd powers, waves; // with powers less what waves take; with whitened waves
		Vec3 moved;                    // with displacements, less what waves take
	};
	/// Planes in the model.
	struct Beside {
		std::vector<Profile> profiles;
		BandFunctions vertical, sideways;
		Eigen::VectorXd upFit, sideFit;
		double left;
	};
	Profile profileOf(BandWaves::Row row) const;
	std::vector<Profile> profilesOf(const BandPlane& plane) const;
	double product(const Profile& a, const Profile& b) const;
	Beside with(const std::vector<BandPlane>& planes) const;
	double taken(const BandPlane& plane, const Beside& beside) const;
	double unlikely(const BandPlane& plane, const Beside& beside, const BandField& strains) const;
	/// Factors of powers and planes, and sums of the waves with what they leave, a column each direction.
	struct Rest {
		Eigen::MatrixXd factors, sums;
		double left;
	};
	Rest restOf(const std::vector<BandPlane>& planes) const;
	void whiten(const BandNoise& noise);
	void estimate(const std::vector<BandPlane>& planes, double diameter);

	const BandGrains& grains;
	const BandColumns& columns;
	BandWaves waves;
	BandWaves::Row weight;                     // one a grain in the mean
	Eigen::MatrixXd gram, moved;               // of powers and waves; of them with the displacements
	Eigen::MatrixXd whitening;                 // of the waves, none: empty
	Eigen::MatrixXd wavesOfPowers, wavesMoved; // whitened waves with powers, with displacements
	Eigen::MatrixXd powerGram, powersMoved;    // of powers, less what waves take
	double movedSquare = 0, count;
	BandNoise found{};
};

} // namespace hexmembrane
