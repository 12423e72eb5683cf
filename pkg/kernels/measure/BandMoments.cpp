// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/BandMoments.hpp"

#include "kernels/base/Bell.hpp"

#include <algorithm>

namespace hexmembrane {

namespace {

// Columns are filled up to a multiple of this.
constexpr std::size_t widest = 8;

const Bell bell;

template <class V>
HEXMEMBRANE_INLINE void productsBy(const BandColumns& c, double* sums)
{
	constexpr int measured = BandColumns::measured, all = BandColumns::powers, symmetric = BandColumns::symmetric;
	std::vector<double> parts(std::size_t(measured) * (measured + 1) / 2 * laneCount<V>, 0.);
	for (std::size_t i = 0; i < c.weight.size(); i += laneCount<V>) {
		V f[measured];
		const V ax = load<V>(&c.ax[i]), ay = load<V>(&c.ay[i]), square = load<V>(&c.square[i]), weight = load<V>(&c.weight[i]);
		V factor = lanes<V>(1);
		for (int p = 0, k = 0; p < BandColumns::radii; ++p, factor *= square)
			for (int q = 0; q < BandColumns::heights; ++q, ++k) {
				f[k] = factor * load<V>(&c.legendre[q][i]);
				f[symmetric + k] = ax * f[k];
				f[2 * symmetric + k] = ay * f[k];
			}
		f[all] = load<V>(&c.ux[i]);
		f[all + 1] = load<V>(&c.uy[i]);
		f[all + 2] = load<V>(&c.uz[i]);
		f[all + 3] = load<V>(&c.strain[i]);
		double* part = parts.data();
		for (int a = 0; a < measured; ++a) {
			const V weighted = weight * f[a];
			for (int b = 0; b <= a; ++b, part += laneCount<V>) store(part, load<V>(part) + weighted * f[b]);
		}
	}
	for (int k = 0; k < measured * (measured + 1) / 2; ++k) sums[k] = total(load<V>(&parts[std::size_t(k) * laneCount<V>]));
}

HEXMEMBRANE_WIDEST_LANES(void productsWidest(const BandColumns& columns, double* sums), productsBy<Lanes<width>>(columns, sums))

/// Some grains at a time, so that what is added up stays in registers and the profiles in the nearest memory.
constexpr std::size_t chunk = 256;

/// Adds up the products of a factor and the six Legendre polynomials. \param other a second factor, nullptr: none
template <class V>
HEXMEMBRANE_INLINE void addHeights(const BandColumns& c, std::size_t from, std::size_t count, const double* factor, const double* other, V* sums)
{
	static_assert(BandColumns::heights == 6);
	const double *l1 = &c.legendre[1][from], *l2 = &c.legendre[2][from], *l3 = &c.legendre[3][from], *l4 = &c.legendre[4][from], *l5 = &c.legendre[5][from];
	V s0 = sums[0], s1 = sums[1], s2 = sums[2], s3 = sums[3], s4 = sums[4], s5 = sums[5];
	for (std::size_t i = 0; i < count; i += laneCount<V>) {
		V f = load<V>(factor + i);
		if (other) f *= load<V>(other + i);
		s0 += f;
		s1 += f * load<V>(l1 + i);
		s2 += f * load<V>(l2 + i);
		s3 += f * load<V>(l3 + i);
		s4 += f * load<V>(l4 + i);
		s5 += f * load<V>(l5 + i);
	}
	sums[0] = s0;
	sums[1] = s1;
	sums[2] = s2;
	sums[3] = s3;
	sums[4] = s4;
	sums[5] = s5;
}

template <class V>
HEXMEMBRANE_INLINE void sumBy(const BandColumns& c, const BandPlane& plane, BandProfile profile, const BandRows& besides, BandRows* keep, BandSums& sums)
{
	constexpr int n = BandColumns::powers, m = BandColumns::symmetric, heights = BandColumns::heights, most = BandColumns::mostBeside;
	const bool ramp = profile == BandProfile::ramp, jumps = profile != BandProfile::slab,
	           shears = profile == BandProfile::both || profile == BandProfile::slab;
	const double scale = (ramp ? 1 : std::sqrt(6.)) * std::exp(-plane[3]), offset = scale * plane[2];
	const double nx = scale * std::sin(plane[0]) * std::cos(plane[1]), ny = scale * std::sin(plane[0]) * std::sin(plane[1]),
	             nz = scale * std::cos(plane[0]);
	const int beside = static_cast<int>(besides.step.size());
	V stepSums[n] = {}, slabSums[m] = {}, stepBeside[most] = {}, slabBeside[most] = {}, moved[3] = {}, stepSquare{}, slabSquare{}, strained{};
	double jump[chunk], shear[chunk];
	for (std::size_t from = 0; from < c.weight.size(); from += chunk) {
		const std::size_t count = std::min(chunk, c.weight.size() - from);
		for (std::size_t k = 0; k < count; k += laneCount<V>) {
			const std::size_t i = from + k;
			const V distance = nx * load<V>(&c.x[i]) + ny * load<V>(&c.y[i]) + nz * load<V>(&c.z[i]) - offset, weight = load<V>(&c.weight[i]);
			V jumped, sheared{};
			if (ramp) {
				jumped = distance < -0.5 ? lanes<V>(-0.5) : distance;
				jumped = jumped > 0.5 ? lanes<V>(0.5) : jumped;
			} else {
				bell.at(distance, sheared, jumped);
				jumped *= 0.5;
			}
			const V j = weight * jumped, s = weight * sheared;
			moved[0] += j * load<V>(&c.ux[i]);
			moved[1] += j * load<V>(&c.uy[i]);
			moved[2] += j * load<V>(&c.uz[i]);
			stepSquare += j * jumped;
			strained += s * load<V>(&c.strain[i]);
			slabSquare += s * sheared;
			for (int b = 0; b < beside; ++b) {
				stepBeside[b] += jumped * load<V>(&besides.step[b][i]);
				slabBeside[b] += sheared * load<V>(&besides.slab[b][i]);
			}
			store(jump + k, j);
			store(shear + k, s);
		}
		if (keep) {
			std::copy(jump, jump + count, &keep->step.back()[from]);
			std::copy(shear, shear + count, &keep->slab.back()[from]);
		}
		for (int p = 0; p < BandColumns::radii; ++p) {
			if (p > 0)
				for (std::size_t k = 0; k < count; k += laneCount<V>) {
					const V square = load<V>(&c.square[from + k]);
					store(jump + k, square * load<V>(jump + k));
					store(shear + k, square * load<V>(shear + k));
				}
			if (jumps) {
				addHeights<V>(c, from, count, jump, nullptr, stepSums + p * heights);
				addHeights<V>(c, from, count, jump, &c.ax[from], stepSums + m + p * heights);
				addHeights<V>(c, from, count, jump, &c.ay[from], stepSums + 2 * m + p * heights);
			}
			if (shears) addHeights<V>(c, from, count, shear, nullptr, slabSums + p * heights);
		}
	}
	for (int k = 0; k < n; ++k) sums.step[k] = total(stepSums[k]);
	for (int k = 0; k < m; ++k) sums.slab[k] = total(slabSums[k]);
	for (int b = 0; b < beside; ++b) {
		sums.stepBeside[b] = total(stepBeside[b]);
		sums.slabBeside[b] = total(slabBeside[b]);
	}
	for (int k = 0; k < 3; ++k) sums.moved[k] = total(moved[k]);
	sums.stepSquare = total(stepSquare);
	sums.slabSquare = total(slabSquare);
	sums.strained = total(strained);
}

HEXMEMBRANE_WIDEST_LANES(void sumWidest(const BandColumns& columns, const BandPlane& plane, BandProfile profile, const BandRows& beside, BandRows* keep,
                                        BandSums& sums),
                         sumBy<Lanes<width>>(columns, plane, profile, beside, keep, sums))

} // namespace

BandColumns::BandColumns(const std::vector<Vec3>& places, const std::vector<Vec3>& displacements, const std::vector<double>& weights,
                         const std::vector<double>& strains)
{
	const std::size_t count = places.size();
	double wide = 0, wideSquare = 0, high = 0;
	for (const Vec3& place : places) {
		wide = std::max({wide, std::abs(place[0]), std::abs(place[1])});
		wideSquare = std::max(wideSquare, place.head<2>().squaredNorm());
		high = std::max(high, std::abs(place[2]));
	}
	const auto share = [](double whole) { return whole > 0 ? 1 / whole : 0; };
	const double perWide = share(wide), perSquare = share(wideSquare), perHigh = share(high);
	const std::size_t filled = (count + widest - 1) / widest * widest;
	for (auto* column : {&x, &y, &z, &ax, &ay, &square, &weight, &ux, &uy, &uz, &strain}) column->assign(filled, 0);
	for (auto& column : legendre) column.assign(filled, 0);
	for (std::size_t i = 0; i < count; ++i) {
		x[i] = places[i][0];
		y[i] = places[i][1];
		z[i] = places[i][2];
		ax[i] = perWide * places[i][0];
		ay[i] = perWide * places[i][1];
		square[i] = perSquare * places[i].head<2>().squaredNorm();
		weight[i] = weights[i];
		ux[i] = displacements[i][0];
		uy[i] = displacements[i][1];
		uz[i] = displacements[i][2];
		strain[i] = strains[i];
		const double z = perHigh * places[i][2];
		legendre[0][i] = 1;
		legendre[1][i] = z;
		for (int q = 2; q < heights; ++q) legendre[q][i] = ((2 * q - 1) * z * legendre[q - 1][i] - (q - 1) * legendre[q - 2][i]) / q;
	}
}

std::array<double, BandColumns::powers> BandColumns::powersAt(std::size_t i) const
{
	std::array<double, powers> f;
	double factor = 1;
	for (int p = 0, k = 0; p < radii; ++p, factor *= square[i])
		for (int q = 0; q < heights; ++q, ++k) {
			f[k] = factor * legendre[q][i];
			f[symmetric + k] = ax[i] * f[k];
			f[2 * symmetric + k] = ay[i] * f[k];
		}
	return f;
}

std::vector<double> bandProducts(const BandColumns& columns)
{
	std::vector<double> sums(std::size_t(BandColumns::measured) * (BandColumns::measured + 1) / 2);
	productsWidest(columns, sums.data());
	return sums;
}

BandSums bandSums(const BandColumns& columns, const BandPlane& plane, BandProfile profile, const BandRows& beside, BandRows* keep)
{
	if (keep)
		for (auto* rows : {&keep->step, &keep->slab}) rows->emplace_back(columns.weight.size());
	BandSums sums;
	sumWidest(columns, plane, profile, beside, keep, sums);
	return sums;
}

} // namespace hexmembrane
