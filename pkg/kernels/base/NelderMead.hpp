// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <vector>

namespace hexmembrane {

/// Where a minimisation ends.
struct NelderMeadEnd {
	double way;   ///< corners are this near to the best one in each coordinate, and
	double value; ///< the function differs by this or less between them; or
	int trials;   ///< it was evaluated so many times
};

/// The least value of a function of few variables by J. A. Nelder and R. Mead, Computer J. 7, 1965: a simplex that is reflected, stretched, contracted and shrunk by
/// 1, 2, 1/2 and 1/2. No derivatives. \param simplex its n + 1 corners at the start \return the best corner
template <class Function>
Eigen::VectorXd nelderMead(std::vector<Eigen::VectorXd> simplex, const NelderMeadEnd& end, Function&& f)
{
	struct Corner {
		Eigen::VectorXd x;
		double value;
	};
	int trials = 0;
	const auto at = [&](Eigen::VectorXd x) {
		++trials;
		const double value = f(x);
		return Corner{std::move(x), value};
	};
	std::vector<Corner> c;
	for (auto& x : simplex) c.push_back(at(std::move(x)));
	const auto sort = [&] { std::stable_sort(c.begin(), c.end(), [](const Corner& a, const Corner& b) { return a.value < b.value; }); };
	const auto done = [&] {
		double way = 0;
		for (std::size_t k = 1; k < c.size(); ++k) way = std::max(way, (c[k].x - c[0].x).cwiseAbs().maxCoeff());
		return way <= end.way && c.back().value - c[0].value <= end.value;
	};
	for (sort(); trials < end.trials && !done(); sort()) {
		Eigen::VectorXd middle = Eigen::VectorXd::Zero(c[0].x.size());
		for (std::size_t k = 0; k + 1 < c.size(); ++k) middle += c[k].x / double(c.size() - 1);
		Corner& worst = c.back();
		const auto beyond = [&](double part) { return at(middle + part * (middle - worst.x)); };
		const Corner reflected = beyond(1);
		if (reflected.value < c[0].value) {
			Corner stretched = beyond(2);
			worst = stretched.value < reflected.value ? std::move(stretched) : reflected;
		} else if (reflected.value < c[c.size() - 2].value)
			worst = reflected;
		else {
			const bool outside = reflected.value < worst.value;
			Corner contracted = beyond(outside ? 0.5 : -0.5);
			if (outside ? contracted.value <= reflected.value : contracted.value < worst.value)
				worst = std::move(contracted);
			else
				for (std::size_t k = 1; k < c.size(); ++k) c[k] = at(0.5 * (c[0].x + c[k].x));
		}
	}
	return c[0].x;
}

} // namespace hexmembrane
