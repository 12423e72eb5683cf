// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereAssembly.hpp"
#include "kernels/membrane/PaddedRings.hpp"

#include <functional>

namespace hexmembrane {

/// Critical time step of central differences, 2/omega, with omega the highest frequency of the springs that are there now: every touching contact with its
/// normal, shear and rolling spring (as if none were sliding), the bonds that are added and the sheet's answer. Largest eigenvalue of M^-1 K by power iteration from a fixed
/// start, matrix-free; K is symmetric and positive, so the iterates rise to it from below. Geometric stiffness (forces times rotations) is left out.
class CriticalStep {
public:
	explicit CriticalStep(const SphereAssembly& flat);
	/// Adds a bond of two membrane particles (local indices), `branch` from the first to the second; ks acts at its middle.
	void addBond(int first, int second, const Vec3& branch, double kn, double ks);
	/// Adds a spring between a membrane particle (local index) and a grain (index among all spheres) along a unit vector.
	void addSupport(int particle, int grain, const Vec3& normal, double kn);
	/// Adds what holds two spheres together (indices among all): springs of their relative motion at distances `arm1`, `arm2` from the centres, and against
	/// twisting (N m).
	void addJoint(int i, int j, const Vec3& normal, double arm1, double arm2, const LinearLaw<double>& law, double twist)
	{
		add(i, j, normal, arm1 * normal, -arm2 * normal, law);
		springs.back().twist = twist;
		turnStart = 1 / arm1;
	}
	/// Gives the membrane's particles further forces that are linear in their displacements, wrapped rows of `tube`, and that have an energy.
	/// \param addAnswer adds them to its second argument
	using Answer = std::function<void(const PaddedRings&, PaddedRings&)>;
	void setSheet(const HexStencil& tube, Answer addAnswer);
	/// \return the step (s), infinite without springs \param tolerance relative change of the eigenvalue at which to stop
	double compute(double tolerance = 1e-4, int most = 2000) const;

private:
	struct Spring {
		int i, j; ///< j < 0: a boundary
		Vec3 normal, arm1, arm2;
		LinearLaw<double> law;
		double twist; ///< stiffness against twisting (N m)
	};
	void add(int i, int j, const Vec3& normal, const Vec3& arm1, const Vec3& arm2, const LinearLaw<double>& law)
	{
		springs.push_back({i, j, normal, arm1, arm2, law, 0});
	}

	/// Adds the sheet's answer to displacements x of all spheres to their forces.
	void addSheet(const std::vector<Vec3>& x, std::vector<Vec3>& force) const;

	std::vector<Spring> springs;
	double turnStart = 0; ///< size of the rotations to start from (1/m): joints can turn spheres without any shear that would set them going
	HexStencil sheet;
	Answer answer;
	std::vector<double> inverseMass, inverseInertia; ///< 0 for what does not move
	int grains;
};

} // namespace hexmembrane
