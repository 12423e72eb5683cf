// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/PaddedRings.hpp"

namespace hexmembrane {

/// Follower pressure on rings first .. last of a hexagonal tube: what PressureForce does on any mesh (same formulas, same surface, see there), by rows
/// instead of lists of vertices, and vectorised with the widest instructions that the machine has. The same to the last bit for any number of threads.
class TubePressure {
public:
	TubePressure() = default;
	/// \param first,last rings that are loaded, 0 <= first <= last < rings \param offset distance of the loaded surface inwards from the centres (m), >= 0
	/// \throws std::invalid_argument
	TubePressure(const HexStencil& stencil, int first, int last, double offset);

	/// Forces (N) on the loaded rings at these positions, whose rows are wrapped.
	void compute(double pressure, const PaddedRings& position);

	int firstRing() const { return first; }
	int lastRing() const { return last; }
	/// A third of every triangle round each loaded particle, on the loaded surface, at the last compute() (m2).
	double area() const;

	PaddedRings force; ///< rows first .. last, after compute()

private:
	void areaVectors(const PaddedRings& x);

	HexStencil stencil;
	int first = 0, last = 0;
	double offset = 0;
	/// Twice the area vectors of the triangles between ring k and the next: `up` stands on (k, i), (k, i + 1), `down` hangs from (k, i).
	PaddedRings up, down;
	PaddedRings inner; ///< the loaded surface, when it is not the centres'
};

} // namespace hexmembrane
