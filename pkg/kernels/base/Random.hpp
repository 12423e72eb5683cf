// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

namespace hexmembrane {

/// Random numbers that are the same for a seed with every compiler and standard library (those of <random> are not: its distributions are free to
/// differ). SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014): 64 bits of state, period 2^64.
class Random {
public:
	explicit Random(std::uint64_t seed) : state(seed) {}

	/// Uniform over all 64-bit integers.
	std::uint64_t bits()
	{
		state += 0x9e3779b97f4a7c15u;
		std::uint64_t z = state;
		z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
		z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
		return z ^ (z >> 31);
	}

	/// Uniform in [0, 1), multiples of 2^-53.
	double uniform() { return double(bits() >> 11) * 0x1p-53; }
	/// Uniform in [low, high).
	double uniform(double low, double high) { return low + (high - low) * uniform(); }

private:
	std::uint64_t state;
};

} // namespace hexmembrane
