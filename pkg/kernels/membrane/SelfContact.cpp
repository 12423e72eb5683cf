// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/SelfContact.hpp"

#include "kernels/base/CellGrid.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/membrane/RingsMoved.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

SelfContact::SelfContact(const HexStencil& s, double r, double stiffness)
    // less than the 1.46 R that second neighbours are beyond the reach of contacts
    : force(s.perRing, s.rings), stencil(s), radius(r), kn(stiffness), skin(r)
{
	requirePositive("radius", r, "m");
	requirePositive("kn", stiffness, "N/m");
}

bool SelfContact::bonded(int i, int j) const
{
	const int n = stencil.perRing, k = i / n, up = j / n - k; // i < j: j is in the same ring or above
	const int shift = (j % n - i % n + n) % n;
	if (up == 0) return shift == 1 || shift == n - 1;
	return up == 1 && (shift == (HexStencil::left(k) + n) % n || shift == HexStencil::right(k));
}

void SelfContact::makeList(const PaddedRings& x)
{
	const std::vector<Vec3> centres = x.vectors();
	Vec3 low = centres[0], high = centres[0];
	for (const Vec3& c : centres) {
		low = low.cwiseMin(c);
		high = high.cwiseMax(c);
	}
	const NearPairs found = findNearPairs(centres, std::vector<double>(centres.size(), radius), skin, low, high);
	near.clear();
	for (int i = 0; i < stencil.particles(); ++i)
		for (int p = found.start[i]; p < found.start[i + 1]; ++p)
			if (!bonded(i, found.other[p])) near.push_back({i, found.other[p]});
	listed = x;
	++made;
}

void SelfContact::compute(const PaddedRings& x)
{
	const int n = stencil.perRing;
	for (const Pair& pair : pairs)
		for (const int v : {pair.i, pair.j}) force.set(v / n, v % n, Vec3::Zero());
	if (!nearerThan(0.5 * skin, stencil, x, listed)) makeList(x);
	pairs.clear();
	first = stencil.rings;
	last = -1;
	for (const auto& [i, j] : near) {
		const Vec3 branch = x.get(j / n, j % n) - x.get(i / n, i % n);
		const double square = branch.squaredNorm();
		if (!(square < 4 * radius * radius)) continue;
		pairs.push_back({i, j, branch});
		first = std::min(first, i / n);
		last = std::max(last, j / n);
		const double d = std::sqrt(square);
		if (!(d > 0)) continue;
		const Vec3 push = kn * (2 * radius - d) / d * branch;
		force.set(i / n, i % n, force.get(i / n, i % n) - push);
		force.set(j / n, j % n, force.get(j / n, j % n) + push);
	}
}

double SelfContact::energy() const
{
	double sum = 0;
	for (const Pair& pair : pairs) sum += 0.5 * kn * std::pow(2 * radius - pair.branch.norm(), 2);
	return sum;
}

int SelfContact::mostOfOne() const
{
	std::vector<int> contacts(stencil.particles(), 0);
	for (const Pair& pair : pairs)
		for (const int v : {pair.i, pair.j}) ++contacts[v];
	return contacts.empty() ? 0 : *std::max_element(contacts.begin(), contacts.end());
}

} // namespace hexmembrane
