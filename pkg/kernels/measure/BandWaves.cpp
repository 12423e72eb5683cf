// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/BandWaves.hpp"

#include "kernels/base/Bell.hpp"

#include <algorithm>
#include <tuple>

namespace hexmembrane {

namespace {

const Bell bell;

/// Sums of row * factor with up to four others at a time.
template <class V, int n>
HEXMEMBRANE_INLINE void addProducts(std::size_t count, const double* product, const double* const* others, double* out)
{
	V sums[n] = {};
	for (std::size_t i = 0; i < count; i += laneCount<V>) {
		const V f = load<V>(product + i);
#pragma GCC unroll 4
		for (int k = 0; k < n; ++k) sums[k] += f * load<V>(others[k] + i);
	}
	for (int k = 0; k < n; ++k) out[k] += total(sums[k]);
}

template <class V>
HEXMEMBRANE_INLINE void productsBy(std::size_t count, const double* row, const double* factor, const double* const* others, int n, double* out)
{
	constexpr std::size_t chunk = 512;
	double product[chunk];
	const double* from[4];
	for (std::size_t start = 0; start < count; start += chunk) {
		const std::size_t size = std::min(chunk, count - start);
		for (std::size_t i = 0; i < size; i += laneCount<V>) store(product + i, load<V>(row + start + i) * load<V>(factor + start + i));
		for (int k = 0; k < n; k += 4) {
			const int these = std::min(4, n - k);
			for (int l = 0; l < these; ++l) from[l] = others[k + l] + start;
			if (these == 4) addProducts<V, 4>(size, product, from, out + k);
			if (these == 3) addProducts<V, 3>(size, product, from, out + k);
			if (these == 2) addProducts<V, 2>(size, product, from, out + k);
			if (these == 1) addProducts<V, 1>(size, product, from, out + k);
		}
	}
}

HEXMEMBRANE_WIDEST_LANES(void productsWidest(std::size_t count, const double* row, const double* factor, const double* const* others, int n, double* out),
                         productsBy<Lanes<width>>(count, row, factor, others, n, out))

template <class V>
HEXMEMBRANE_INLINE double productBy(std::size_t count, const double* a, const double* b)
{
	static_assert(8 % laneCount<V> == 0);
	V sums[8 / laneCount<V>] = {};
	for (std::size_t i = 0; i < count; i += 8)
#pragma GCC unroll 4
		for (int k = 0; k < 8 / laneCount<V>; ++k) sums[k] += load<V>(a + i + k * laneCount<V>) * load<V>(b + i + k * laneCount<V>);
	for (int k = 1; k < 8 / laneCount<V>; ++k) sums[0] += sums[k];
	return total(sums[0]);
}

HEXMEMBRANE_WIDEST_LANES(double productWidest(std::size_t count, const double* a, const double* b), productBy<Lanes<width>>(count, a, b))

template <class V>
HEXMEMBRANE_INLINE void stepsBy(const BandColumns& c, const BandPlane& plane, double* step, double* shape)
{
	const double scale = std::sqrt(6.) * std::exp(-plane[3]), offset = scale * plane[2];
	const double nx = scale * std::sin(plane[0]) * std::cos(plane[1]), ny = scale * std::sin(plane[0]) * std::sin(plane[1]),
	             nz = scale * std::cos(plane[0]);
	for (std::size_t i = 0; i < c.weight.size(); i += laneCount<V>) {
		const V distance = nx * load<V>(&c.x[i]) + ny * load<V>(&c.y[i]) + nz * load<V>(&c.z[i]) - offset;
		V density, integral;
		bell.at(distance, density, integral);
		store(step + i, 0.5 * integral);
		store(shape + i, distance * density);
	}
}

HEXMEMBRANE_WIDEST_LANES(void stepsWidest(const BandColumns& columns, const BandPlane& plane, double* step, double* shape),
                         stepsBy<Lanes<width>>(columns, plane, step, shape))

} // namespace

BandWaves::BandWaves(const BandColumns& c) : filled(c.weight.size())
{
	for (int d = 0, number = 0; d < 3; ++d) {
		Row factor(filled, 1.);
		if (d > 0) factor = d == 1 ? c.ax : c.ay;
		for (int p = 0; p < BandColumns::radii; ++p, factor = bandTimes(factor, c.square)) {
			Group group{factor, {}, {}};
			for (const Row& height : c.legendre) {
				group.others.push_back(height.data());
				group.numbers.push_back(number++);
			}
			groups.push_back(std::move(group));
		}
	}
	const auto widest = [](const Row& row) {
		return 1.1 * std::max(*std::max_element(row.begin(), row.end()), -*std::min_element(row.begin(), row.end()));
	};
	const double wide = std::max(widest(c.x), widest(c.y)), high = widest(c.z);
	struct Wave {
		double square;
		std::array<int, 3> turns;
	};
	std::vector<Wave> waves;
	constexpr int most = 32; // half turns along an axis
	for (int i = 0; i < most; ++i)
		for (int j = 0; j < most; ++j)
			for (int k = 0; k < most; ++k)
				if (i + j + k > 0)
					waves.push_back({std::pow(M_PI / 2, 2) * ((i * i + j * j) / (wide * wide) + k * k / (high * high)), {i, j, k}});
	std::nth_element(waves.begin(), waves.begin() + count, waves.end(),
	                 [](const Wave& a, const Wave& b) { return std::tie(a.square, a.turns) < std::tie(b.square, b.turns); });
	waves.resize(count);
	std::sort(waves.begin(), waves.end(), [](const Wave& a, const Wave& b) { return a.turns < b.turns; });
	const auto cosines = [&](const Row& place, double half, int turns) {
		Row row(filled);
		for (std::size_t i = 0; i < filled; ++i) row[i] = std::cos(0.5 * M_PI * turns * (place[i] / half + 1));
		return row;
	};
	int tallest = 0;
	for (const Wave& wave : waves) tallest = std::max(tallest, wave.turns[2]);
	for (int k = 0; k <= tallest; ++k) heights.push_back(cosines(c.z, high, k));
	for (int w = 0; w < count; ++w) {
		const auto& t = waves[w].turns;
		if (w == 0 || t[0] != waves[w - 1].turns[0] || t[1] != waves[w - 1].turns[1])
			groups.push_back({bandTimes(cosines(c.x, wide, t[0]), cosines(c.y, wide, t[1])), {}, {}});
		groups.back().others.push_back(heights[t[2]].data());
		groups.back().numbers.push_back(BandColumns::powers + w);
		squares.push_back(waves[w].square);
		sizes.push_back(std::pow(2., (t[0] > 0) + (t[1] > 0) + (t[2] > 0)));
	}
}

Eigen::VectorXd BandWaves::sums(const Row& row) const
{
	Eigen::VectorXd found(BandColumns::powers + count);
	std::vector<double> out;
	for (const Group& group : groups) {
		out.assign(group.others.size(), 0);
		productsWidest(filled, row.data(), group.factor.data(), group.others.data(), static_cast<int>(out.size()), out.data());
		for (std::size_t k = 0; k < out.size(); ++k) found[group.numbers[k]] = out[k];
	}
	return found;
}

BandWaves::Row BandWaves::function(int number) const
{
	for (const Group& group : groups)
		for (std::size_t k = 0; k < group.numbers.size(); ++k)
			if (group.numbers[k] == number) return bandTimes(group.factor, Row(group.others[k], group.others[k] + filled));
	return {};
}

Eigen::VectorXd BandWaves::variances(double length) const
{
	Eigen::VectorXd found(count);
	for (int w = 0; w < count; ++w) found[w] = sizes[w] * std::exp(-0.5 * squares[w] * length * length);
	return found / (found.sum());
}

BandSteps bandSteps(const BandColumns& columns, const BandPlane& plane)
{
	BandSteps made{BandWaves::Row(columns.weight.size()), BandWaves::Row(columns.weight.size())};
	stepsWidest(columns, plane, made.step.data(), made.shape.data());
	return made;
}

double bandProduct(const BandWaves::Row& a, const BandWaves::Row& b) { return productWidest(a.size(), a.data(), b.data()); }

BandWaves::Row bandTimes(const BandWaves::Row& a, const BandWaves::Row& b)
{
	BandWaves::Row made(a.size());
	for (std::size_t i = 0; i < a.size(); ++i) made[i] = a[i] * b[i];
	return made;
}

} // namespace hexmembrane
