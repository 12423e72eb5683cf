// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>

namespace hexmembrane {

/// Connectivity of a hexagonal tube by arithmetic instead of lists: `rings` rings of `perRing` particles, odd rings turned forward by half a spacing.
/// Bonds come in three families, all stored row by row, so that a kernel works on contiguous rows:
///   family 0, row k: (k, i) - (k, i + 1)            index                  k n + i     rings rows
///   family 1, row k: (k, i) - (k + 1, i + left(k))  index rings n        + k n + i     rings - 1 rows
///   family 2, row k: (k, i) - (k + 1, i + right(k)) index (2 rings - 1) n + k n + i     rings - 1 rows
struct HexStencil {
	int perRing = 0;
	int rings = 0;

	int particles() const { return perRing * rings; }
	int bondCount() const { return perRing * (3 * rings - 2); }
	/// Offset of the first bond of a family.
	int familyStart(int family) const { return family == 0 ? 0 : perRing * (family == 1 ? rings : 2 * rings - 1); }
	/// Rows that a family has.
	int familyRows(int family) const { return family == 0 ? rings : rings - 1; }

	/// Index of particle i of ring k; i may run over by one turn on either side.
	int at(int k, int i) const { return k * perRing + (i + perRing) % perRing; }
	/// Shift in i of the upper left and upper right neighbour of a particle of ring k.
	static int left(int k) { return k % 2 == 0 ? -1 : 0; }
	static int right(int k) { return left(k) + 1; }
	/// Shift in (ring, i) of the far end of a bond of `family` that starts in ring k.
	static std::array<int, 2> farEnd(int family, int k)
	{
		if (family == 0) return {0, 1};
		return {1, family == 1 ? left(k) : right(k)};
	}
};

} // namespace hexmembrane
