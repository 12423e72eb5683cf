// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"
#include "kernels/membrane/PaddedRings.hpp"

#include <array>
#include <vector>

namespace hexmembrane {

/// Motion of a membrane's particles, ring by ring, all of one mass: leapfrog with local damping as GrainMotion, vectorised, with the works of what acts on them.
class MembraneMotion {
public:
	/// Work (J) in a step by the trapezoidal rule in force and displacement: half of it belongs to the way that led to the present positions, half to the one
	/// that leads on.
	struct HalfWorks {
		double before = 0, after = 0;
		double atOnce = 0; ///< of bringing what is gripped to its speed

		HalfWorks& operator+=(const HalfWorks& other)
		{
			before += other.before;
			after += other.after;
			atOnce += other.atOnce;
			return *this;
		}
	};

	/// Forces on the rings first .. last, besides contacts.
	struct Term {
		const PaddedRings* force;
		int first, last;
		bool worked; ///< whether its work is wanted
		HalfWorks work;
	};

	/// A ring that is given a velocity, and the work of what holds them: against all forces, and of bringing their particles to speed.
	struct Grip {
		int ring;
		Vec3 velocity;
		HalfWorks work;
	};

	MembraneMotion() = default;
	explicit MembraneMotion(const HexStencil& stencil);

	/// Components that nothing accelerates, by particle: bit a of the translation along axis a, bit 3 + a of the rotation about it.
	void setBlocked(const std::vector<unsigned char>& bits);

	/// What contacts do to the particles, and the particles' own places in the arrays of all spheres.
	struct Contacts {
		const std::vector<PaddedForce>& onParticle; ///< frictionless ones (N)
		const Load* loads;                          ///< others, of the particles alone
		const std::vector<int>& loaded;             ///< particles that may have such loads, ascending, by their index among all spheres
		int grains;                                 ///< spheres before the first particle
		Place* places;                              ///< of the particles alone
		Motion* motions;
	};
	/// One step. \param limit way (m) that is too long for a step
	/// \param position, velocity moved, and wrapped again; places of all particles are written, motions of the loaded ones
	/// \return index of a particle that is lost (moved `limit` in this step or is not finite), -1: none
	int move(double dt, double damping, double limit, std::vector<Term>& terms, std::vector<Grip>& grips, const Contacts& contacts, PaddedRings& position,
	         PaddedRings& velocity, bool energies, int threads);
	/// The same for the spins. \param torques besides those of contacts
	int moveSpins(double dt, double damping, double inertia, const std::vector<const PaddedRings*>& torques, const Load* loads, PaddedRings& spin,
	              Motion* motions, bool energies);

	/// Velocities of all particles.
	void giveVelocities(const PaddedRings& velocity, Motion* motions) const;
	/// Sum of all forces on the particles in the last step (N).
	const PaddedRings& force() const { return total; }

	double mass = 0;       ///< of a particle (kg)
	double fastest = 0;    ///< of the last step (m/s)
	double kinetic = 0;    ///< by the velocities before the last step (J)
	double dampedWork = 0; ///< taken by the damping since last reset (J)

private:
	bool isFree(int k) const { return freeRowsOf[k] < 0; }
	/// `force` of ring k without its blocked components. \param kept room for them
	const double* accelerating(int k, int component, const double* force, std::vector<double>& kept) const;
	void addForces(int k, const std::vector<Term>& terms, const Contacts& contacts);

	HexStencil stencil;
	PaddedRings total;           ///< sum of all forces
	std::vector<int> freeRowsOf; ///< by ring: where its rows stand in freeRows, -1: nothing is blocked
	/// By component 0 to 5, each a row: 1 for a particle that moves freely, 0 for one that is blocked.
	std::vector<std::array<std::vector<double>, 6>> freeRows;
};

} // namespace hexmembrane
