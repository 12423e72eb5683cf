// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Bell.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/base/NelderMead.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/measure/BandLikelihood.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>

using namespace hexmembrane;
using namespace hexmembrane::support;

namespace {

struct Step {
	std::vector<Vec3> x, u;
	std::vector<double> weights, strain;
};

/// Grains at random in a cylinder, one of them without weight, that move about two planes and at random.
Step someStep(int count)
{
	Random random(4);
	Step made;
	while (int(made.x.size()) < count) {
		const Vec3 x(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), random.uniform(-0.04, 0.04));
		if (x.head<2>().norm() > 0.02) continue;
		made.x.push_back(x);
		made.u.emplace_back(Vec3(1e-4, 2e-5, -3e-4) * std::erf(200 * (x[0] + x[2])) - 0.01 * x +
		                    2e-5 * Vec3(random.uniform(), random.uniform(), random.uniform()));
		made.weights.push_back(random.uniform(0.5, 1.5));
		made.strain.push_back(0.01 + 0.02 * std::exp(-4e4 * std::pow(x[0] + x[2], 2)) + 0.005 * random.uniform());
	}
	made.weights[3] = 0;
	return made;
}

/// Least squares with one column a function, as they are written down.
struct Oracle {
	const Step* step;
	std::vector<Eigen::VectorXd> displacement, strain; // functions, the former of ux, uy and uz one below the other

	int n() const { return int(step->x.size()); }
	static Vec3 normal(const BandPlane& p) { return {std::sin(p[0]) * std::cos(p[1]), std::sin(p[0]) * std::sin(p[1]), std::cos(p[0])}; }
	double distance(int i, const BandPlane& p) const { return (normal(p).dot(step->x[i]) - p[2]) / std::exp(p[3]); }

	explicit Oracle(const Step& of) : step(&of)
	{
		double wide = 0, square = 0, high = 0;
		for (const Vec3& x : step->x) {
			wide = std::max({wide, std::abs(x[0]), std::abs(x[1])});
			square = std::max(square, x.head<2>().squaredNorm());
			high = std::max(high, std::abs(x[2]));
		}
		const auto add = [&](auto&& at) {
			Eigen::VectorXd column(3 * n());
			for (int i = 0; i < n(); ++i) {
				const Vec3 value = at(step->x[i]);
				for (int k = 0; k < 3; ++k) column[k * n() + i] = value[k];
			}
			displacement.push_back(column);
		};
		for (int p = 0; p < 3; ++p)
			for (int q = 0; q < 6; ++q) {
				const auto power = [=](const Vec3& x) {
					return std::pow(x.head<2>().squaredNorm() / square, p) * std::legendre(q, std::abs(x[2]) / high) *
					       (q % 2 && x[2] < 0 ? -1 : 1);
				};
				add([&](const Vec3& x) { return Vec3(0, 0, power(x)); });
				add([&](const Vec3& x) { return Vec3(x[0] / wide * power(x), x[1] / wide * power(x), 0); });
				Eigen::VectorXd column(n());
				for (int i = 0; i < n(); ++i) column[i] = power(step->x[i]);
				strain.push_back(column);
			}
		for (int k : {0, 1}) add([&](const Vec3& x) { return Vec3(0, 0, x[k] / wide); });
		for (int k : {0, 1}) {
			add([&](const Vec3&) { return Vec3(Vec3::Unit(k)); });
			for (int l = 0; l < 3; ++l) add([&](const Vec3& x) { return Vec3(x[l] / wide * Vec3::Unit(k)); });
		}
	}

	Oracle with(const BandPlane& plane, bool uniform = false) const
	{
		Oracle more = *this;
		Eigen::VectorXd slab(n());
		for (int i = 0; i < n(); ++i) slab[i] = std::exp(-6 * std::pow(distance(i, plane), 2));
		more.strain.push_back(slab);
		for (int k = 0; k < 3; ++k) {
			Eigen::VectorXd column = Eigen::VectorXd::Zero(3 * n());
			for (int i = 0; i < n(); ++i) {
				const double s = distance(i, plane);
				column[k * n() + i] = uniform ? std::max(-0.5, std::min(0.5, s)) : 0.5 * std::erf(std::sqrt(6.) * s);
			}
			more.displacement.push_back(column);
		}
		return more;
	}

	struct Fit {
		double left;
		Eigen::VectorXd factors;
	};
	Fit solved(const std::vector<Eigen::VectorXd>& functions, Eigen::VectorXd values) const
	{
		Eigen::MatrixXd a(values.size(), Eigen::Index(functions.size()));
		for (Eigen::Index i = 0; i < values.size(); ++i) {
			const double root = std::sqrt(step->weights[i % n()]);
			values[i] *= root;
			for (std::size_t k = 0; k < functions.size(); ++k) a(i, Eigen::Index(k)) = root * functions[k][i];
		}
		// functions that depend on each other are among them
		Eigen::JacobiSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
		svd.setThreshold(1e-10);
		const Eigen::VectorXd factors = svd.solve(values);
		return {(values - a * factors).squaredNorm(), factors};
	}
	Fit moved() const
	{
		Eigen::VectorXd values(3 * n());
		for (int i = 0; i < n(); ++i)
			for (int k = 0; k < 3; ++k) values[k * n() + i] = step->u[i][k];
		return solved(displacement, values);
	}
	Fit strained() const { return solved(strain, Eigen::Map<const Eigen::VectorXd>(step->strain.data(), n())); }
};

const BandPlane along(0.8, 0.1, 0.001, std::log(0.008)), across(0.9, 3, -0.002, std::log(0.012)), third(1.1, 1.5, 0.004, std::log(0.01));

} // namespace

TEST(BandSearch, isLeastSquares)
{
	const Step step = someStep(600);
	const BandGrains grains(step.x, step.u, step.weights, step.strain);
	for (int count : {0, 1, 2}) {
		std::vector<BandPlane> beside{along, across};
		beside.resize(count, along);
		Oracle oracle(step);
		for (const BandPlane& plane : beside) oracle = oracle.with(plane);
		const BandField field(grains, beside);
		const double moved = oracle.moved().left, strained = oracle.strained().left;
		EXPECT_NEAR(field.left()[0], moved, 1e-10 * moved) << count;
		EXPECT_NEAR(field.left()[1], strained, 1e-10 * strained) << count;
		for (const BandPlane& plane : {third, across, along}) {
			if (count > 0 && plane != third) continue;
			for (bool uniform : {false, true}) {
				const auto fit = oracle.with(plane, uniform).moved();
				const auto found = field.jump(plane, uniform ? BandField::Profile::uniform : BandField::Profile::smooth);
				EXPECT_NEAR(found.taken, moved - fit.left, 1e-10 * moved);
				EXPECT_LT((found.jump - fit.factors.tail<3>()).norm(), 1e-10 * found.jump.norm());
			}
			const auto fit = oracle.with(plane).strained();
			const double excess = fit.factors.tail<1>().value();
			const auto found = field.excess(plane);
			EXPECT_NEAR(found.strain, std::max(0., excess), 1e-10 * std::abs(excess));
			EXPECT_NEAR(found.taken, excess > 0 ? strained - fit.left : 0, 1e-10 * strained);
			EXPECT_NEAR(field.unlikely(plane), std::log(oracle.with(plane).moved().left / moved) + std::log(1 - found.taken / strained), 1e-10);
		}
	}
}

TEST(BandSearch, symmetricStrain)
{
	const Step step = someStep(600);
	const auto found = BandGrains(step.x, step.u, step.weights, step.strain).symmetricStrain();
	const Oracle oracle(step);
	const Eigen::VectorXd factors = oracle.strained().factors;
	for (int i : {0, 3, 599}) {
		double expected = 0;
		for (std::size_t k = 0; k < oracle.strain.size(); ++k) expected += factors[Eigen::Index(k)] * oracle.strain[k][i];
		EXPECT_NEAR(found[i], expected, 1e-12);
	}
}

TEST(BandSearch, aPlaneThatIsInTheModelTakesNothingMore)
{
	const Step step = someStep(600);
	const BandGrains grains(step.x, step.u, step.weights, step.strain);
	const BandField once(grains, {along}), twice(grains, {along, along});
	EXPECT_NEAR(once.left()[0], twice.left()[0], 1e-12 * once.left()[0]);
	EXPECT_NEAR(once.left()[1], twice.left()[1], 1e-12 * once.left()[1]);
}

TEST(BandSearch, findsThePlane)
{
	const Step step = someStep(3000);
	const BandGrains grains(step.x, step.u, step.weights, step.strain);
	const double inf = std::numeric_limits<double>::infinity();
	const BandLimits limits{{0.3, -inf, -0.04, std::log(0.002)}, {1.4, inf, 0.04, std::log(0.03)}, {0.07, 0.1, 0.002, 0.25}};
	const BandField field(grains);
	const BandPlane found = refinedPlane(field, limits, {0.9, 0.2, 0.004, std::log(0.015)}, 0.02, 200);
	EXPECT_NEAR(found[0], M_PI / 4, 0.01);
	EXPECT_NEAR(found[1], 0, 0.015);
	EXPECT_NEAR(found[2], 0, 3e-4);
	// erf(200 (x + z)) = erf(200 sqrt(2) s)
	EXPECT_NEAR(std::exp(found[3]), std::sqrt(6.) / (200 * std::sqrt(2.)), 5e-4);
	const BandPlane slab = slabOf(field, limits, found);
	EXPECT_EQ(slab.head<2>(), found.head<2>());
	EXPECT_NEAR(std::exp(slab[3] - found[3]), 0.884, 0.03); // as syntheticBands.py has it
	for (int k = 0; k < 4; ++k) EXPECT_LE(field.unlikely(found), field.unlikely(found + 0.2 * limits.steps[k] * BandPlane::Unit(k))) << k;
}

TEST(BandSearch, refusesWhatIsNoInput)
{
	Step step = someStep(100);
	EXPECT_THROW(BandGrains({}, {}, {}, {}), FieldError);
	EXPECT_THROW(BandGrains(step.x, {}, step.weights, step.strain), FieldError);
	EXPECT_THROW(BandField(BandGrains(step.x, step.u, step.weights, step.strain), std::vector<BandPlane>(5, along)), FieldError);
	step.u[7][1] = NAN;
	EXPECT_THROW(BandGrains(step.x, step.u, step.weights, step.strain), FieldError);
	step.u[7][1] = 0;
	step.weights[5] = -1;
	EXPECT_THROW(BandGrains(step.x, step.u, step.weights, step.strain), FieldError);
}

TEST(Bell, isErfAndItsDerivative)
{
	const Bell bell;
	for (double t = -7; t < 7; t += 0.00173) {
		Two density, integral;
		bell.at(lanes<Two>(t), density, integral);
		EXPECT_NEAR(density[0], std::exp(-t * t), 4e-16) << t;
		EXPECT_NEAR(integral[1], std::erf(t), 4e-16) << t;
	}
}

TEST(NelderMead, aCurvedValley)
{
	const auto rosenbrock = [](const Eigen::VectorXd& x) { return 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1 - x[0], 2); };
	const std::vector<Eigen::VectorXd> simplex{Eigen::Vector2d(-1.2, 1), Eigen::Vector2d(-1, 1), Eigen::Vector2d(-1.2, 1.2)};
	EXPECT_LT((nelderMead(simplex, {1e-6, 1e-12, 1000}, rosenbrock) - Eigen::Vector2d(1, 1)).norm(), 1e-5);
	int trials = 0;
	nelderMead(simplex, {0, 0, 50}, [&](const Eigen::VectorXd& x) { return ++trials, rosenbrock(x); });
	EXPECT_GE(trials, 50);
	EXPECT_LE(trials, 53);
}

TEST(BandLikelihood, isGeneralisedLeastSquares)
{
	const Step step = someStep(500);
	const BandGrains grains(step.x, step.u, step.weights, step.strain);
	const BandLikelihood likelihood(grains, {along}, 0.002);
	const BandNoise& noise = likelihood.noise();
	// the waves as functions, and a row for each with the root of its precision: the squares with them are the generalised ones
	const BandColumns columns(step.x, step.u, step.weights, step.strain);
	const BandWaves waves(columns);
	const Eigen::VectorXd variances = noise.ratio * waves.variances(noise.length);
	double all = 0;
	for (double w : step.weights) all += w;
	const int n = int(step.x.size());
	const auto left = [&](const std::vector<BandPlane>& planes) {
		Oracle oracle(step);
		for (const BandPlane& plane : planes) {
			oracle = oracle.with(plane);
			for (int k = 0; k < 3; ++k) {
				Eigen::VectorXd shape = Eigen::VectorXd::Zero(3 * n);
				for (int i = 0; i < n; ++i) {
					const double a = std::sqrt(6.) * oracle.distance(i, plane);
					shape[k * n + i] = a * std::exp(-a * a);
				}
				oracle.displacement.push_back(shape);
			}
		}
		const std::size_t free = oracle.displacement.size();
		for (int k = 0; k < 3; ++k)
			for (int w = 0; w < BandWaves::count; ++w) {
				const auto wave = waves.function(BandColumns::powers + w);
				Eigen::VectorXd column = Eigen::VectorXd::Zero(3 * n);
				for (int i = 0; i < n; ++i) column[k * n + i] = wave[i] * std::sqrt(variances[w]);
				oracle.displacement.push_back(column);
			}
		const Eigen::Index total = Eigen::Index(oracle.displacement.size());
		Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * n + total, total);
		Eigen::VectorXd values = Eigen::VectorXd::Zero(3 * n + total);
		for (int i = 0; i < 3 * n; ++i) {
			const double root = std::sqrt(step.weights[i % n] * n / all);
			values[i] = root * step.u[i % n][i / n];
			for (Eigen::Index k = 0; k < total; ++k) a(i, k) = root * oracle.displacement[k][i];
		}
		for (Eigen::Index k = Eigen::Index(free); k < total; ++k) a(3 * n + k, k) = 1;
		Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solved;
		solved.setThreshold(1e-10);
		solved.compute(a);
		return (values - a * solved.solve(values)).squaredNorm();
	};
	const auto strains = [&](const BandPlane& plane, const std::vector<BandPlane>& beside) {
		const BandField field(grains, beside);
		return BandLikelihood::strainWeight * std::log(1 - field.excess(plane).taken / field.left()[1]);
	};
	const double none = left({}), one = left({along}), both = left({along, third});
	EXPECT_NEAR(likelihood.unlikely(along), std::log(one / none) + strains(along, {}), 1e-8);
	EXPECT_NEAR(likelihood.unlikely(third, {along}), std::log(both / one) + strains(third, {along}), 1e-8);
}

TEST(BandLikelihood, knowsTheNoiseAndFindsThePlane)
{
	Step step = someStep(6000);
	Random random(9);
	// vortices with wave lengths as in syntheticBands.py
	constexpr double length = 0.01, size = 3e-5;
	std::vector<Vec3> numbers, sizes;
	std::vector<double> phases;
	const auto normal = [&] { return std::sqrt(-2 * std::log(1 - random.uniform())) * std::cos(2 * M_PI * random.uniform()); };
	for (int k = 0; k < 60; ++k) {
		numbers.push_back(Vec3(normal(), normal(), normal()) / length);
		sizes.push_back(std::sqrt(2 / 60.) * size * Vec3(normal(), normal(), normal()));
		phases.push_back(2 * M_PI * random.uniform());
	}
	for (std::size_t i = 0; i < step.x.size(); ++i)
		for (int k = 0; k < 60; ++k) step.u[i] += std::cos(numbers[k].dot(step.x[i]) + phases[k]) * sizes[k];
	const BandGrains grains(step.x, step.u, step.weights, step.strain);
	const double inf = std::numeric_limits<double>::infinity();
	const BandLimits limits{{0.3, -inf, -0.04, std::log(0.002)}, {1.4, inf, 0.04, std::log(0.03)}, {0.07, 0.1, 0.002, 0.25}};
	const BandPlane start = refinedPlane(BandField(grains), limits, {0.9, 0.2, 0.004, std::log(0.015)}, 0.02, 200);
	const BandLikelihood likelihood(grains, {start}, 0.0025);
	EXPECT_NEAR(likelihood.noise().length, length, 0.0051);
	// the vortices, five times that of single grains, are told from them, all but their shortest waves
	constexpr double single = 2e-5 / 3.4641;
	EXPECT_GT(likelihood.noise().single, 0.95 * single);
	EXPECT_LT(likelihood.noise().single, 1.5 * single);
	const BandPlane found = likelihood.refined({start}, limits, 1, 0.02, 200)[0];
	EXPECT_NEAR(found[0], M_PI / 4, 0.003);
	EXPECT_NEAR(found[1], 0, 0.005);
}
