// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"
#include "kernels/membrane/PaddedRings.hpp"

#include <vector>

namespace hexmembrane {

/// Motion of a membrane's particles, ring by ring, all of one mass: leapfrog with local damping as SphereAssembly::moveGrains, vectorised, with the powers
/// of what acts on them. Rings of the O-rings move at a velocity of their own.
class MembraneMotion {
public:
	/// A load on the particles whose work is wanted.
	struct Term {
		const PaddedRings* force = nullptr; ///< null: none
		int first = 0, last = -1;           ///< rings that it acts on
		/// Work of the last move() (J), by the trapezoidal rule in force and displacement: half of it belongs to the way that led to these positions, half
		/// to the one that leads on.
		double before = 0, after = 0;
	};

	MembraneMotion() = default;
	/// \param oRings rings at each end that move as told
	MembraneMotion(const HexStencil& stencil, int oRings);

	/// What contacts do to the particles, and the particles' own places in the arrays of all spheres.
	struct Contacts {
		const std::vector<Push>& onParticle; ///< frictionless ones (N)
		const Load* loads;                   ///< others, of the particles alone
		const std::vector<int>& loaded;      ///< particles that may have such loads, ascending, by their index among all spheres
		int grains;                          ///< spheres before the first particle
		Place* places;                       ///< of the particles alone
		Motion* motions;
	};
	/// One step. Adds bond forces, terms and contacts.
	/// \param position moved, and wrapped again; places of all particles are written, motions of the loaded ones
	/// \return index of a particle that is lost (moved `limit` in this step or is not finite), -1: none
	int move(double dt, double damping, double limit, const PaddedRings& bonds, std::vector<Term>& terms, const Contacts& contacts, PaddedRings& position,
	         bool energies, int threads);
	/// Velocities of all particles.
	void giveVelocities(Motion* motions) const;

	/// The same for particles that rotate: their spins and torques.
	int moveSpins(double dt, double damping, double inertia, const PaddedRings& bondTorque, const Load* loads, PaddedRings& spin, Motion* motions,
	              bool energies);

	/// Sum of all forces on the particles in the last step (N).
	const PaddedRings& force() const { return total; }

	double mass = 0;           ///< of a particle (kg)
	PaddedRings velocity;      ///< of all particles
	Vec3 below = Vec3::Zero(); ///< velocity of the lower O-ring
	Vec3 above = Vec3::Zero(); ///< of the upper one
	double fastest = 0;        ///< of the last step (m/s)
	double kinetic = 0;        ///< by the velocities before the last step (J)
	double dampedWork = 0;     ///< since last reset (J)
	double oRingBefore = 0;    ///< work of the O-rings on the membrane in the last step (J), as Term::before, and what brings their particles to speed
	double oRingAfter = 0;     ///< as Term::after

private:
	bool isORing(int k) const { return k < oRings || k >= stencil.rings - oRings; }

	HexStencil stencil;
	int oRings = 0;
	PaddedRings total; ///< sum of all forces
};

} // namespace hexmembrane
