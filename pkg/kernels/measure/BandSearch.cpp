// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/BandSearch.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/base/NelderMead.hpp"
#include "kernels/measure/BandFunctions.hpp"

namespace hexmembrane {

namespace {

constexpr double dependent = BandFunctions::dependent;
/// What the last of the powers adds to orthonormal functions, as one more of them. \param alongX whether it is the x component
void append(Eigen::MatrixXd& x, Eigen::MatrixXd* y, const Eigen::MatrixXd& gram, bool alongX = true)
{
	const Eigen::Index last = gram.rows() - 1;
	Eigen::RowVectorXd ownX = Eigen::RowVectorXd::Zero(last + 1), ownY = ownX;
	(alongX ? ownX : ownY)[last] = 1 / std::sqrt(std::max(gram(last, last), 1e-300));
	for (int pass = 0; pass < 2; ++pass) { // the second takes what rounding has left of the first
		Eigen::VectorXd with = x * (gram * ownX.transpose());
		if (y) with += *y * (gram * ownY.transpose());
		ownX -= with.transpose() * x;
		if (y) ownY -= with.transpose() * *y;
	}
	const double square = ownX * gram * ownX.transpose() + (ownY * gram * ownY.transpose()).value();
	if (!(square > dependent)) return;
	x.conservativeResize(x.rows() + 1, Eigen::NoChange);
	x.bottomRows<1>() = ownX / std::sqrt(square);
	if (!y) return;
	y->conservativeResize(y->rows() + 1, Eigen::NoChange);
	y->bottomRows<1>() = ownY / std::sqrt(square);
}

template <class Matrix>
void addColumn(Matrix& matrix)
{
	matrix.conservativeResize(Eigen::NoChange, matrix.cols() + 1);
	matrix.template rightCols<1>().setZero();
}

/// Inner products with one function more. \param products with all functions, itself the last
void addFunction(Eigen::MatrixXd& gram, const Eigen::VectorXd& products)
{
	gram.conservativeResize(products.size(), products.size());
	gram.bottomRows<1>() = products.transpose();
	gram.rightCols<1>() = products;
}

} // namespace

BandGrains::BandGrains(const std::vector<Vec3>& x, const std::vector<Vec3>& u, const std::vector<double>& weights, const std::vector<double>& strain)
    : count(x.size())
{
	const auto require = [&](const char* name, std::size_t size) {
		if (size != count) reject(name, int(size), "is not the number of places", std::to_string(count) + " of them");
	};
	require("displacements", u.size());
	require("weights", weights.size());
	require("strains", strain.size());
	if (count == 0) reject("positions", 0, "are no grains", "one at least");
	for (std::size_t i = 0; i < count; ++i) {
		const auto at = [&](const char* name) { return name + ("[" + std::to_string(i) + "]"); };
		requireNonNegative(at("weights"), weights[i], "m3");
		requireFinite(at("strains"), strain[i], "-");
		requireFinite(at("positions"), x[i].sum(), "m");
		requireFinite(at("displacements"), u[i].sum(), "m");
	}
	columns = std::make_unique<BandColumns>(x, u, weights, strain);
	fit();
}

void BandGrains::fit()
{
	constexpr int all = BandColumns::powers, powers = BandColumns::symmetric, measured = BandColumns::measured;
	const std::vector<double> sums = bandProducts(*columns);
	Eigen::MatrixXd products(measured, measured);
	for (int a = 0, k = 0; a < measured; ++a)
		for (int b = 0; b <= a; ++b, ++k) products(a, b) = products(b, a) = sums[k];
	gram = products.topLeftCorner<all, all>();
	BandFunctions vertical = BandFunctions::vertical(all), sideways = BandFunctions::sideways(all), symmetrical(all);
	for (int k = 0; k < powers; ++k) symmetrical.add(k);
	for (auto* functions : {&vertical, &sideways, &symmetrical}) functions->orthonormalise(gram);
	up = vertical.x;
	sideX = sideways.x;
	sideY = sideways.y;
	still = symmetrical.x;
	const Eigen::MatrixXd with = products.topRightCorner<all, 4>(); // ux, uy, uz, strain
	const Eigen::VectorXd fitUp = up.transpose() * (up * with.col(2)), side = sideX * with.col(0) + sideY * with.col(1);
	const Eigen::VectorXd fitX = sideX.transpose() * side, fitY = sideY.transpose() * side;
	symmetric = still.transpose() * (still * with.col(3));
	BandColumns& c = *columns;
	for (std::size_t i = 0; i < count; ++i) {
		const auto values = columns->powersAt(i);
		const Eigen::Map<const Eigen::Matrix<double, all, 1>> f(values.data());
		c.ux[i] -= fitX.dot(f);
		c.uy[i] -= fitY.dot(f);
		c.uz[i] -= fitUp.dot(f);
		c.strain[i] -= symmetric.dot(f);
		moved += c.weight[i] * (c.ux[i] * c.ux[i] + c.uy[i] * c.uy[i] + c.uz[i] * c.uz[i]);
		strained += c.weight[i] * c.strain[i] * c.strain[i];
	}
}

std::vector<double> BandGrains::symmetricStrain() const
{
	std::vector<double> found;
	for (std::size_t i = 0; i < count; ++i) {
		const auto values = columns->powersAt(i);
		found.push_back(symmetric.dot(Eigen::Map<const Eigen::Matrix<double, BandColumns::powers, 1>>(values.data())));
	}
	return found;
}

BandField::BandField(const BandGrains& of, const std::vector<BandPlane>& beside)
    : grains(of), stepGram(of.gram), slabGram(of.gram.topLeftCorner<BandColumns::symmetric, BandColumns::symmetric>()), up(of.up), sideX(of.sideX),
      sideY(of.sideY), still(of.still.leftCols<BandColumns::symmetric>()), movedSums(Eigen::MatrixXd::Zero(BandColumns::powers, 3)),
      strainedSums(Eigen::VectorXd::Zero(BandColumns::symmetric)), upFit(Eigen::VectorXd::Zero(up.rows())), sideFit(Eigen::VectorXd::Zero(sideX.rows())),
      stillFit(Eigen::VectorXd::Zero(still.rows())), rest{of.moved, of.strained}
{
	if (beside.size() > BandColumns::mostBeside)
		reject("beside", int(beside.size()), "are too many planes", std::to_string(BandColumns::mostBeside) + " at most");
	for (const BandPlane& plane : beside) take(plane);
}

// Adds a plane to the model.
void BandField::take(const BandPlane& plane)
{
	const BandRows before = rows;
	const BandSums sums = bandSums(*grains.columns, plane, BandProfile::both, before, &rows);
	const auto with = [](Eigen::VectorXd moments, double square) {
		moments.conservativeResize(moments.size() + 1);
		moments[moments.size() - 1] = square;
		return moments;
	};
	addFunction(stepGram, with(stepMoments(sums), sums.stepSquare));
	addFunction(slabGram, with(slabMoments(sums), sums.slabSquare));
	for (auto* functions : {&up, &sideX, &sideY, &still}) addColumn(*functions);
	append(up, nullptr, stepGram);
	append(still, nullptr, slabGram);
	for (bool alongX : {true, false}) append(sideX, &sideY, stepGram, alongX);
	movedSums.conservativeResize(movedSums.rows() + 1, Eigen::NoChange);
	movedSums.bottomRows<1>() << sums.moved[0], sums.moved[1], sums.moved[2];
	strainedSums = with(strainedSums, sums.strained);
	upFit = up * movedSums.col(2);
	sideFit = sideX * movedSums.col(0) + sideY * movedSums.col(1);
	stillFit = still * strainedSums;
	rest = {grains.moved - upFit.squaredNorm() - sideFit.squaredNorm(), grains.strained - stillFit.squaredNorm()};
}

Eigen::VectorXd BandField::stepMoments(const BandSums& sums) const
{
	Eigen::VectorXd moments(stepGram.rows());
	for (Eigen::Index k = 0; k < moments.size(); ++k) moments[k] = k < BandColumns::powers ? sums.step[k] : sums.stepBeside[k - BandColumns::powers];
	return moments;
}

Eigen::VectorXd BandField::slabMoments(const BandSums& sums) const
{
	Eigen::VectorXd moments(slabGram.rows());
	for (Eigen::Index k = 0; k < moments.size(); ++k) moments[k] = k < BandColumns::symmetric ? sums.slab[k] : sums.slabBeside[k - BandColumns::symmetric];
	return moments;
}

BandField::Jump BandField::jumpOf(const BandSums& sums) const
{
	const Eigen::VectorXd moments = stepMoments(sums), vertical = up * moments, x = sideX * moments, y = sideY * moments;
	const double zz = sums.stepSquare - vertical.squaredNorm(), bz = sums.moved[2] - vertical.dot(upFit);
	const double xx = sums.stepSquare - x.squaredNorm(), yy = sums.stepSquare - y.squaredNorm(), xy = -x.dot(y);
	const double bx = sums.moved[0] - x.dot(sideFit), by = sums.moved[1] - y.dot(sideFit), determinant = xx * yy - xy * xy;
	if (!(zz > 0 && determinant > 0)) return {Vec3::Zero(), 0};
	const Vec3 jump((yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant, bz / zz);
	return {jump, jump.dot(Vec3(bx, by, bz))};
}

BandField::Excess BandField::excessOf(const BandSums& sums) const
{
	const Eigen::VectorXd functions = still * slabMoments(sums);
	const double square = sums.slabSquare - functions.squaredNorm(), with = sums.strained - functions.dot(stillFit);
	const double strain = square > 0 ? std::max(0., with / square) : 0;
	return {strain, strain * with};
}

BandField::Jump BandField::jump(const BandPlane& plane, Profile profile) const
{
	const BandSums sums = bandSums(*grains.columns, plane, profile == Profile::smooth ? BandProfile::step : BandProfile::ramp, rows);
	return jumpOf(sums);
}

BandField::Excess BandField::excess(const BandPlane& plane) const
{
	const BandSums sums = bandSums(*grains.columns, plane, BandProfile::slab, rows);
	return excessOf(sums);
}

double BandField::unlikely(const BandPlane& plane) const
{
	const BandSums sums = bandSums(*grains.columns, plane, BandProfile::both, rows);
	const std::array<double, 2> taken{jumpOf(sums).taken, excessOf(sums).taken};
	double found = 0;
	for (int k = 0; k < 2; ++k) found += std::log(std::max(1 - taken[k] / std::max(rest[k], 1e-300), 1e-12));
	return found;
}

BandPlane refinedPlane(const BandField& field, const BandLimits& limits, const BandPlane& start, double tolerance, int trials)
{
	const auto at = [&](const Eigen::VectorXd& steps) -> BandPlane {
		return (start + steps.cwiseProduct(limits.steps)).cwiseMax(limits.low).cwiseMin(limits.high);
	};
	std::vector<Eigen::VectorXd> simplex{Eigen::Vector4d::Zero()};
	for (int k = 0; k < 4; ++k) simplex.push_back(Eigen::Vector4d::Unit(k));
	return at(nelderMead(simplex, {tolerance, 1e-5, trials}, [&](const Eigen::VectorXd& steps) { return field.unlikely(at(steps)); }));
}

BandPlane slabOf(const BandField& field, const BandLimits& limits, const BandPlane& plane)
{
	const auto at = [&](const Eigen::VectorXd& steps) -> BandPlane {
		const BandPlane moved = plane + BandPlane(0, 0, steps[0] * limits.steps[2], steps[1] * limits.steps[3]);
		return moved.cwiseMax(limits.low).cwiseMin(limits.high);
	};
	const std::vector<Eigen::VectorXd> simplex{Eigen::Vector2d(0, 0), Eigen::Vector2d(0.5, 0), Eigen::Vector2d(0, 1)};
	return at(nelderMead(simplex, {0.02, 1e-6 * field.left()[0], 80},
	                     [&](const Eigen::VectorXd& steps) { return -field.jump(at(steps), BandField::Profile::uniform).taken; }));
}

} // namespace hexmembrane
