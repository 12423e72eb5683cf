// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/BandMoments.hpp"

#include <Eigen/Eigenvalues>

namespace hexmembrane {

/// Functions by their coefficients, in two components, a row each.
struct BandFunctions {
	/// Share of a function's square that others must leave for it to count as another one.
	static constexpr double dependent = 1e-9;

	Eigen::MatrixXd x, y;
	explicit BandFunctions(int columns) : x(0, columns), y(0, columns) {}
	/// \param k, l the powers that its components are; -1: none
	void add(int k, int l = -1)
	{
		x.conservativeResize(x.rows() + 1, Eigen::NoChange);
		y.conservativeResize(y.rows() + 1, Eigen::NoChange);
		x.bottomRows<1>().setZero();
		y.bottomRows<1>().setZero();
		if (k >= 0) x(x.rows() - 1, k) = 1;
		if (l >= 0) y(y.rows() - 1, l) = 1;
	}
	/// Orthonormal functions of the same space, those that depend on others left out. \param gram inner products of the powers
	void orthonormalise(const Eigen::MatrixXd& gram)
	{
		Eigen::MatrixXd products = x * gram * x.transpose() + y * gram * y.transpose();
		const Eigen::VectorXd sizes = products.diagonal().cwiseSqrt().unaryExpr([](double size) { return size > 0 ? 1 / size : 0; });
		products = sizes.asDiagonal() * products * sizes.asDiagonal();
		const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(products);
		const auto& values = solved.eigenvalues();
		const Eigen::Index from = (values.array() <= dependent * values[values.size() - 1]).count(), kept = values.size() - from;
		const Eigen::MatrixXd turn =
		        values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal() * solved.eigenvectors().rightCols(kept).transpose() * sizes.asDiagonal();
		x = turn * x;
		y = turn * y;
	}

	/// What vertical displacements are made of besides planes. \param columns powers, and what comes after them
	static BandFunctions vertical(int columns)
	{
		BandFunctions made(columns);
		for (int k = 0; k < BandColumns::symmetric; ++k) made.add(k);
		for (int k : {BandColumns::symmetric, 2 * BandColumns::symmetric}) made.add(k);
		return made;
	}
	/// The same of horizontal ones.
	static BandFunctions sideways(int columns)
	{
		constexpr int one = 0, z = 1, ax = BandColumns::symmetric, ay = 2 * BandColumns::symmetric;
		BandFunctions made(columns);
		for (int k = 0; k < BandColumns::symmetric; ++k) made.add(ax + k, ay + k);
		for (int k : {one, ax, ay, z}) {
			made.add(k);
			made.add(-1, k);
		}
		return made;
	}
};

} // namespace hexmembrane
