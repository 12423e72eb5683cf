// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/BendingForce.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/base/Simd.hpp"
#include "SharedValues.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hexmembrane {

double bendingSpring(double plateStiffness, double spacing)
{
	requireIn(shared::plate_stiffness, "stiffness", plateStiffness, "N m");
	requirePositive("spacing", spacing, "m");
	return 8 * std::sqrt(3.) * plateStiffness / (spacing * spacing);
}

double criticalStepOfBending(double spring, double mass)
{
	requireNonNegative("spring", spring, "N/m");
	requirePositive("mass", mass, "kg");
	return spring > 0 ? 2 * std::sqrt(mass / (2.25 * spring)) : std::numeric_limits<double>::infinity();
}

namespace {

/// Mean of the six neighbours: `below` and `above` are shifted so that their i-th stands upper (lower) left of own[i].
inline double meanOfSix(const double* own, const double* below, const double* above, int i)
{
	return ((own[i - 1] + own[i + 1]) + (below[i] + below[i + 1]) + (above[i] + above[i + 1])) / 6;
}

/// \return the sum of squares of `out`
HEXMEMBRANE_WIDEST double bendRow(int n, const double* __restrict own, const double* __restrict below, const double* __restrict above,
                                  const double* __restrict rest, double* __restrict out)
{
	double sum = 0;
#pragma omp simd reduction(+ : sum)
	for (int i = 0; i < n; ++i) {
		const double b = (own[i] - meanOfSix(own, below, above, i)) - rest[i];
		out[i] = b;
		sum += b * b;
	}
	return sum;
}

/// \return the sum of squares of `row` without its torn particles
HEXMEMBRANE_WIDEST double tearRow(int n, const double* __restrict whole, double* __restrict row)
{
	double sum = 0;
#pragma omp simd reduction(+ : sum)
	for (int i = 0; i < n; ++i) {
		row[i] *= whole[i];
		sum += row[i] * row[i];
	}
	return sum;
}

HEXMEMBRANE_WIDEST void forceRow(int n, double spring, const double* __restrict own, const double* __restrict below, const double* __restrict above,
                                 double* __restrict out)
{
#pragma omp simd
	for (int i = 0; i < n; ++i) out[i] = spring * (meanOfSix(own, below, above, i) - own[i]);
}

} // namespace

BendingForce::BendingForce(const HexStencil& s, double spring, const PaddedRings& unbent)
    : force(s.perRing, s.rings), stencil(s), kb(spring), rest(unbent), whole(s.rings), squares(s.rings, 0.)
{
	requireNonNegative("spring", spring, "N/m");
	if (s.rings < 3) reject("rings", s.rings, "no ring has neighbours on both sides", "3 rings at least");
	if (!unbent.fits(s.perRing, 2)) reject("rest", unbent.rows(), "does not fit the tube", "2 rows of perRing vectors");
}

PaddedRings BendingForce::restOfTube(int perRing, double radius)
{
	requirePositive("radius", radius, "m");
	PaddedRings rest(perRing, 2);
	const double step = M_PI / perRing;
	// two neighbours a whole step further round, four half a step; axially they stand in balance
	const double inwards = radius * (1 - (2 * std::cos(2 * step) + 4 * std::cos(step)) / 6);
	for (int odd = 0; odd < 2; ++odd)
		for (int i = 0; i < perRing; ++i) {
			const double angle = step * (2 * i + odd);
			rest.set(odd, i, inwards * Vec3(std::cos(angle), std::sin(angle), 0));
		}
	return rest;
}

void BendingForce::setTorn(const std::vector<char>& torn)
{
	const int n = stencil.perRing;
	if (int(torn.size()) != stencil.particles()) reject("torn", int(torn.size()), "does not fit the tube", "one for each particle");
	for (int k = 0; k < stencil.rings; ++k) {
		whole[k].clear();
		if (std::count(torn.begin() + k * n, torn.begin() + (k + 1) * n, 0) == n) continue;
		for (int i = 0; i < n; ++i) whole[k].push_back(torn[k * n + i] ? 0 : 1);
	}
}

void BendingForce::act(const PaddedRings& x, const PaddedRings& from, PaddedRings& onParticle, std::vector<double>& squared) const
{
	const int n = stencil.perRing, rings = stencil.rings;
#pragma omp parallel
	{
		const int thread = omp_get_thread_num(), threads = omp_get_num_threads();
		const int first = rings * thread / threads, end = rings * (thread + 1) / threads;
		// B x - b0 of three rings at a time, ring k in row k % 3: they stay in the nearest cache. What two threads need of a ring they both compute
		PaddedRings bent(n, 3);
		const PaddedRings none(n, 1);
		const auto inside = [&](int k) { return k > 0 && k < rings - 1; };
		const auto row = [&](int a, int k) { return inside(k) ? bent.row(a, k % 3) : none.row(a, 0); };
		const auto bend = [&](int k) {
			if (!inside(k)) return;
			const int left = HexStencil::left(k);
			double sum = 0;
			for (int a = 0; a < 3; ++a)
				sum += bendRow(n, x.row(a, k), x.row(a, k - 1) + left, x.row(a, k + 1) + left, from.row(a, k % 2), bent.row(a, k % 3));
			if (!whole[k].empty()) {
				sum = 0;
				for (int a = 0; a < 3; ++a) sum += tearRow(n, whole[k].data(), bent.row(a, k % 3));
			}
			bent.wrap(k % 3);
			if (first <= k && k < end) squared[k] = sum;
		};
		bend(first - 1);
		bend(first);
		for (int k = first; k < end; ++k) {
			bend(k + 1);
			const int left = HexStencil::left(k);
			for (int a = 0; a < 3; ++a) forceRow(n, kb, row(a, k), row(a, k - 1) + left, row(a, k + 1) + left, onParticle.row(a, k));
		}
	}
}

void BendingForce::compute(const PaddedRings& position) { act(position, rest, force, squares); }

void BendingForce::addAnswer(const PaddedRings& displacement, PaddedRings& sum) const
{
	PaddedRings own(stencil.perRing, stencil.rings);
	std::vector<double> unused(stencil.rings);
	act(displacement, flat(stencil.perRing), own, unused);
	for (int k = 0; k < stencil.rings; ++k)
		for (int i = 0; i < stencil.perRing; ++i) sum.set(k, i, sum.get(k, i) + own.get(k, i));
}

double BendingForce::energy() const { return 0.5 * kb * std::accumulate(squares.begin(), squares.end(), 0.); }

} // namespace hexmembrane
