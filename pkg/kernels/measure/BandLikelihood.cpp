// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/BandLikelihood.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/base/NelderMead.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace hexmembrane {

namespace {

constexpr int powers = BandColumns::powers, waveCount = BandWaves::count;

double sumOf(const BandWaves::Row& row) { return bandProduct(row, BandWaves::Row(row.size(), 1.)); }

} // namespace

BandLikelihood::BandLikelihood(const BandGrains& of, const std::vector<BandPlane>& planes, double diameter)
    : grains(of), columns(of.numbers()), waves(columns), count(double(of.size()))
{
	requirePositive("diameter", diameter, "m");
	const double all = sumOf(columns.weight);
	if (!(all > 0)) reject("weights", all, "leave no grain", "a positive one at least");
	for (double w : columns.weight) weight.push_back(w * count / all);
	gram.resize(powers + waveCount, powers + waveCount);
	for (int k = 0; k < powers + waveCount; ++k) gram.col(k) = waves.sums(bandTimes(weight, waves.function(k)));
	moved.resize(powers + waveCount, 3);
	int axis = 0;
	for (const auto* u : {&columns.ux, &columns.uy, &columns.uz}) {
		const BandWaves::Row weighted = bandTimes(weight, *u);
		moved.col(axis++) = waves.sums(weighted);
		movedSquare += bandProduct(weighted, *u);
	}
	estimate(planes, diameter);
	whiten(found);
}

void BandLikelihood::whiten(const BandNoise& noise)
{
	if (noise.ratio > 0) {
		const Eigen::VectorXd deviations = (noise.ratio * waves.variances(noise.length)).cwiseSqrt();
		const Eigen::MatrixXd scaled = deviations.asDiagonal() * gram.bottomRightCorner<waveCount, waveCount>() * deviations.asDiagonal();
		const Eigen::LLT<Eigen::MatrixXd> root(scaled + Eigen::MatrixXd::Identity(waveCount, waveCount));
		whitening = root.matrixL().solve(Eigen::MatrixXd(deviations.asDiagonal()));
	} else
		whitening.setZero(waveCount, waveCount);
	wavesOfPowers = whitening * gram.bottomLeftCorner<waveCount, powers>();
	wavesMoved = whitening * moved.bottomRows<waveCount>();
	powerGram = gram.topLeftCorner<powers, powers>() - wavesOfPowers.transpose() * wavesOfPowers;
	powersMoved = moved.topRows<powers>() - wavesOfPowers.transpose() * wavesMoved;
}

BandLikelihood::Profile BandLikelihood::profileOf(BandWaves::Row row) const
{
	Profile made;
	made.weighted = bandTimes(weight, row);
	made.plain = std::move(row);
	const Eigen::VectorXd sums = waves.sums(made.weighted);
	made.waves = whitening.triangularView<Eigen::Lower>() * sums.tail<waveCount>();
	made.powers = sums.head<powers>() - wavesOfPowers.transpose() * made.waves;
	made.moved = Vec3(bandProduct(made.weighted, columns.ux), bandProduct(made.weighted, columns.uy), bandProduct(made.weighted, columns.uz)) -
	             wavesMoved.transpose() * made.waves;
	return made;
}

std::vector<BandLikelihood::Profile> BandLikelihood::profilesOf(const BandPlane& plane) const
{
	BandSteps steps = bandSteps(columns, plane);
	std::vector<Profile> made;
	made.push_back(profileOf(std::move(steps.step)));
	made.push_back(profileOf(std::move(steps.shape)));
	return made;
}

double BandLikelihood::product(const Profile& a, const Profile& b) const { return bandProduct(a.weighted, b.plain) - a.waves.dot(b.waves); }

BandLikelihood::Beside BandLikelihood::with(const std::vector<BandPlane>& planes) const
{
	std::vector<Profile> profiles;
	for (const BandPlane& plane : planes)
		for (Profile& profile : profilesOf(plane)) profiles.push_back(std::move(profile));
	const int more = static_cast<int>(profiles.size()), all = powers + more;
	Eigen::MatrixXd products(all, all), displaced(all, 3);
	products.topLeftCorner<powers, powers>() = powerGram;
	displaced.topRows<powers>() = powersMoved;
	for (int a = 0; a < more; ++a) {
		products.block(powers + a, 0, 1, powers) = profiles[a].powers.transpose();
		products.block(0, powers + a, powers, 1) = profiles[a].powers;
		displaced.row(powers + a) = profiles[a].moved.transpose();
		for (int b = 0; b < more; ++b) products(powers + a, powers + b) = product(profiles[a], profiles[b]);
	}
	BandFunctions vertical = BandFunctions::vertical(all), sideways = BandFunctions::sideways(all);
	for (int k = powers; k < all; ++k) {
		vertical.add(k);
		sideways.add(k);
		sideways.add(-1, k);
	}
	vertical.orthonormalise(products);
	sideways.orthonormalise(products);
	const Eigen::VectorXd upFit = vertical.x * displaced.col(2), sideFit = sideways.x * displaced.col(0) + sideways.y * displaced.col(1);
	const double left = movedSquare - wavesMoved.squaredNorm() - upFit.squaredNorm() - sideFit.squaredNorm();
	return {std::move(profiles), std::move(vertical), std::move(sideways), upFit, sideFit, left};
}

// Generalised squares that the plane's two profiles take, a factor in each direction.
double BandLikelihood::taken(const BandPlane& plane, const Beside& beside) const
{
	const std::vector<Profile> own = profilesOf(plane);
	std::vector<Eigen::VectorXd> up, x, y;
	for (const Profile& profile : own) {
		Eigen::VectorXd moments(powers + beside.profiles.size());
		moments.head<powers>() = profile.powers;
		for (std::size_t k = 0; k < beside.profiles.size(); ++k) moments[powers + k] = product(profile, beside.profiles[k]);
		up.push_back(beside.vertical.x * moments);
		x.push_back(beside.sideways.x * moments);
		y.push_back(beside.sideways.y * moments);
	}
	Eigen::Matrix2d vertical;
	Eigen::Matrix4d sideways;
	Eigen::Vector2d with;
	Eigen::Vector4d beneath;
	for (int a = 0; a < 2; ++a) {
		with[a] = own[a].moved[2] - up[a].dot(beside.upFit);
		beneath[a] = own[a].moved[0] - x[a].dot(beside.sideFit);
		beneath[2 + a] = own[a].moved[1] - y[a].dot(beside.sideFit);
		for (int b = 0; b < 2; ++b) {
			const double whole = product(own[a], own[b]);
			vertical(a, b) = whole - up[a].dot(up[b]);
			sideways(a, b) = whole - x[a].dot(x[b]);
			sideways(2 + a, 2 + b) = whole - y[a].dot(y[b]);
			sideways(a, 2 + b) = -x[a].dot(y[b]);
			sideways(2 + a, b) = -y[a].dot(x[b]);
		}
	}
	const auto solved = [](const auto& products, const auto& right) {
		Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition(products);
		decomposition.setThreshold(1e-8);
		return right.dot(decomposition.solve(right));
	};
	return solved(vertical, with) + solved(sideways, beneath);
}

BandLikelihood::Rest BandLikelihood::restOf(const std::vector<BandPlane>& planes) const
{
	const Beside beside = with(planes);
	Rest made{Eigen::MatrixXd(powers + beside.profiles.size(), 3), moved.bottomRows<waveCount>(), beside.left};
	made.factors.col(0) = beside.sideways.x.transpose() * beside.sideFit;
	made.factors.col(1) = beside.sideways.y.transpose() * beside.sideFit;
	made.factors.col(2) = beside.vertical.x.transpose() * beside.upFit;
	made.sums -= gram.bottomLeftCorner<waveCount, powers>() * made.factors.topRows<powers>();
	for (std::size_t k = 0; k < beside.profiles.size(); ++k)
		made.sums -= waves.sums(beside.profiles[k].weighted).tail<waveCount>() * made.factors.row(powers + k);
	return made;
}

// The greatest marginal likelihood of what powers and planes leave. Waves are fitted beside fixed factors of the others.
void BandLikelihood::estimate(const std::vector<BandPlane>& planes, double diameter)
{
	whiten({diameter, 0, 0});
	const Rest rest = restOf(planes);
	double best = -std::numeric_limits<double>::infinity();
	for (double length : {2., 3., 4., 6., 8.})
		for (double ratio : {0.25, 1., 4., 16., 64.}) {
			const Eigen::VectorXd deviations = (ratio * waves.variances(length * diameter)).cwiseSqrt();
			const Eigen::MatrixXd scaled = deviations.asDiagonal() * gram.bottomRightCorner<waveCount, waveCount>() * deviations.asDiagonal();
			const Eigen::LLT<Eigen::MatrixXd> root(scaled + Eigen::MatrixXd::Identity(waveCount, waveCount));
			const double square = (rest.left - root.matrixL().solve(deviations.asDiagonal() * rest.sums).squaredNorm()) / (3 * count);
			const double likelihood = -1.5 * count * std::log(std::max(square, 1e-300)) - 3 * root.matrixLLT().diagonal().array().log().sum();
			if (!(likelihood > best)) continue;
			best = likelihood;
			found = {length * diameter, ratio, std::sqrt(std::max(square, 0.))};
		}
}

double BandLikelihood::unlikely(const BandPlane& plane, const Beside& beside, const BandField& strains) const
{
	const auto share = [](double part, double whole) { return std::log(std::max(1 - part / std::max(whole, 1e-300), 1e-12)); };
	return share(taken(plane, beside), beside.left) + strainWeight * share(strains.excess(plane).taken, strains.left()[1]);
}

double BandLikelihood::unlikely(const BandPlane& plane, const std::vector<BandPlane>& beside) const
{
	return unlikely(plane, with(beside), BandField(grains, beside));
}

std::vector<BandPlane> BandLikelihood::refined(std::vector<BandPlane> planes, const BandLimits& limits, int rounds, double tolerance, int trials) const
{
	for (int round = 0; round < rounds; ++round)
		for (std::size_t k = 0; k < planes.size(); ++k) {
			std::vector<BandPlane> beside = planes;
			beside.erase(beside.begin() + k);
			const BandField strains(grains, beside);
			const Beside others = with(beside);
			const BandPlane start = planes[k];
			const auto at = [&](const Eigen::VectorXd& steps) -> BandPlane {
				return (start + steps.cwiseProduct(limits.steps)).cwiseMax(limits.low).cwiseMin(limits.high);
			};
			std::vector<Eigen::VectorXd> simplex{Eigen::Vector4d::Zero()};
			for (int axis = 0; axis < 4; ++axis) simplex.push_back(0.5 * Eigen::Vector4d::Unit(axis));
			planes[k] = at(nelderMead(simplex, {tolerance, 1e-5, trials},
			                          [&](const Eigen::VectorXd& steps) { return unlikely(at(steps), others, strains); }));
		}
	return planes;
}

} // namespace hexmembrane
