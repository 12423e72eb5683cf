// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/PaddedRings.hpp"

namespace hexmembrane {

/// Spring stiffness k_b (N/m) of BendingForce for a plate of bending stiffness D (N m) whose neighbours are `spacing` s (m) apart: D = k_b s^2/(8 sqrt 3).
/// \throws std::invalid_argument unless D >= 0 and s > 0
double bendingSpring(double plateStiffness, double spacing);

/// Critical time step (s) of central differences, 2/omega, of the bending alone: omega^2 = 2.25 k_b/m, infinite without stiffness. Exact for the free flat
/// lattice, whose fastest wave moves three neighbours of a triangle at phases of 120 degrees; a lower bound for any tube.
/// \throws std::invalid_argument unless k_b >= 0 and mass > 0
double criticalStepOfBending(double spring, double mass);

/// Linear plate on a hexagonal tube: energy k_b/2 sum |B x - b0|^2 over the particles that have six neighbours, with B x = x - mean of the six neighbours.
/// B x tends to -(s^2/4) times the Laplacian of the surface, so the energy of an area is D/2 (kappa_1 + kappa_2)^2. The two end rings lack neighbours and
/// are left out: the ends carry no moment.
///
/// B x - b0 is a vector and b0 keeps its direction in space. So a translation costs nothing, but a surface that turns by an angle a costs
/// D (a kappa_0)^2/2 an area, kappa_0 the curvature of b0. Forces add up to nothing; their moment about an axis vanishes with b0 only.
///
/// Vectorised with the widest instructions that the machine has. The same to the last bit for any number of threads.
class BendingForce {
public:
	BendingForce() = default;
	/// \param spring k_b (N/m), >= 0 \param rest b0 of an even ring in row 0 and of an odd ring in row 1 (m), the same in all of them
	/// \throws std::invalid_argument for a tube of fewer than 3 rings, and such
	BendingForce(const HexStencil& stencil, double spring, const PaddedRings& rest);

	/// B x of the tube that makeHexLattice() generates, its centres at `radius` (m) from the axis: the rest of a sheet that was made round.
	static PaddedRings restOfTube(int perRing, double radius);
	/// That of a flat sheet.
	static PaddedRings flat(int perRing) { return {perRing, 2}; }

	/// Particles (by their index) about which the sheet is torn: they bend nothing any more.
	void setTorn(const std::vector<char>& torn);

	/// Forces (N) on all rings at these positions, whose rows are wrapped.
	void compute(const PaddedRings& position);
	/// Adds the forces that displacements from anywhere call up; they are linear in them. Rows are wrapped.
	void addAnswer(const PaddedRings& displacement, PaddedRings& sum) const;
	/// At the last compute() (J).
	double energy() const;

	PaddedRings force; ///< after compute()

private:
	/// Forces of departures from `from`, and the sum of their squares of each ring.
	void act(const PaddedRings& x, const PaddedRings& from, PaddedRings& onParticle, std::vector<double>& squared) const;

	HexStencil stencil;
	double kb = 0;
	PaddedRings rest;
	std::vector<std::vector<double>> whole; ///< by ring: 1 for a particle that is not torn, 0 for one that is; empty: none is
	std::vector<double> squares;            ///< of B x - b0, by ring (m2); 0 of the end rings
};

} // namespace hexmembrane
