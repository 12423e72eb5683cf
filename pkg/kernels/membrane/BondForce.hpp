// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/PaddedRings.hpp"

#include <limits>
#include <vector>

namespace hexmembrane {

/// Mechanics of a membrane bond: PFC's linear contact bond without moment, about the length that the bond was made with.
///   normal   N = kn (d - L0), tension positive; with tensionOnly no compression (a thin sheet wrinkles instead of carrying it)
///   shear    incremental, dFs = ks dus, dus the tangential relative displacement at mid-bond including both spins; carried along with the bond's axis
///   breakage N > tensileStrength: both forces become zero. |Fs| > shearStrength: the bond breaks too, and only what friction can hold is kept.
///   broken   no tension; in compression C = kn (L0 - d) the shear force is limited to friction * C
struct BondLaw {
	double kn = std::numeric_limits<double>::quiet_NaN();             ///< N/m, > 0
	double ks = 0;                                                    ///< N/m, >= 0; 0: central forces, rotations are not needed
	double tensileStrength = std::numeric_limits<double>::infinity(); ///< N
	double shearStrength = std::numeric_limits<double>::infinity();   ///< N
	double friction = 0;                                              ///< coefficient, of broken bonds only
	bool tensionOnly = false;                                         ///< with ks = 0 only

	/// Nothing but central springs that never break: the fast path.
	bool central() const;
	/// \throws std::invalid_argument
	void check() const;
};

/// What bonds remember, where the caller keeps it. Sizes: HexStencil::bondCount(), or 0 where the law does not need it; compute() makes them fit.
struct BondState {
	const std::vector<double>& restLength; ///< L0 (m)
	std::vector<Vec3>& shear;              ///< shear force on the bond's first particle (N)
	std::vector<int>& broken;              ///< 0 or 1
};

/// All bonds of a hexagonal tube in one sweep over padded rows. Forces of the bonds are stored first and then gathered particle by particle in a fixed
/// order: results do not depend on the number of threads, to the last bit. The central path is vectorised with the widest instructions that the
/// machine has (chosen at load time).
class BondForce {
public:
	BondForce() = default;
	/// \throws std::invalid_argument for a law out of range
	BondForce(const HexStencil& stencil, const BondLaw& law);

	/// Lengths of the bonds at the present positions, for those that are to be stress-free (m).
	std::vector<double> lengths() const;

	/// Forces (and torques when ks > 0) at the present positions. With ks > 0 also reads velocity and spin and advances the shear by dt.
	void compute(BondState state, double dt);

	/// Elastic energy of all bonds (J), by position and state.
	double energy(const BondState& state) const;
	/// Axial force of bond b at the present positions (N, tension positive).
	double normalForce(const BondState& state, int bond) const;

	const HexStencil& lattice() const { return stencil; }

	PaddedRings position;       ///< write before compute(), then wrap() each row
	PaddedRings velocity, spin; ///< the same, with ks > 0 only
	PaddedRings force, torque;  ///< read after compute(); torque with ks > 0 only

private:
	void centralRow(const BondState& state, int family, int k);
	void generalRow(BondState state, int family, int k, double dt);
	void gather(const std::vector<PaddedRings>& perBond, double signOfFarEnd, PaddedRings& perParticle) const;

	HexStencil stencil;
	BondLaw law;
	std::vector<PaddedRings> bondForce, bondTorque; ///< one field a family
};

} // namespace hexmembrane
