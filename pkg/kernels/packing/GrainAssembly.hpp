// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/CellGrid.hpp"
#include "kernels/contact/ContactLaw.hpp"
#include "kernels/base/Vec3.hpp"

#include <vector>

namespace hexmembrane {

/// Contact law of the grains of a GrainAssembly: linear, frictional, with rolling resistance if wished.
struct GrainLaw {
	double modulus;             ///< Pa, > 0: two grains have kn = 2 modulus r1 r2/(r1 + r2), grain and wall kn = modulus r
	double stiffnessRatio;      ///< kn/ks, > 0
	double friction;            ///< of grains with each other, >= 0; the walls are smooth
	double damping;             ///< local damping: share of every net force that opposes the motion, in [0, 1)
	double rollingFriction = 0; ///< of grains with each other, >= 0; kr = ks Rbar^2, moment at most rollingFriction Rbar N, Rbar = r1 r2/(r1 + r2)
};

/// Discrete elements in the smallest form that makes a stressed packing: frictional spheres inside a fixed, smooth vertical cylinder, compressed by
/// growing all of them by one common factor. Quasi-static only: masses are modulus times radius (in a unit of time of 1), so that one time step suits
/// all sizes; nothing here has a meaning in seconds. Axis z, lower end on z = 0. One thread, sums in a fixed order: same input, same bits.
///
/// Contacts of grains follow the linear law with rolling resistance, ContactLaw.hpp, with a stiffness rule of their own (GrainLaw).
class GrainAssembly {
public:
	/// Input is the caller's to check. Radii in m, at factor 1.
	GrainAssembly(std::vector<Vec3> centres, std::vector<double> radii, double factor, double radius, double height, const GrainLaw& law);

	/// One step; radii grow by `growth` times their size in it.
	void step(double growth);

	void setFriction(double friction, double rollingFriction);
	double friction() const { return law.friction; }
	double factor() const { return size; }

	const std::vector<Vec3>& centres() const { return x; }
	/// Mean pressure of the grains on the cylinder's side, and on its ends (Pa, mean of both).
	double radialStress() const { return sideForce / (2 * M_PI * cylinderRadius * cylinderHeight); }
	double axialStress() const { return endForce / (2 * M_PI * cylinderRadius * cylinderRadius); }
	double meanStress() const { return (2 * radialStress() + axialStress()) / 3; }
	/// Mean net force on a grain over the mean contact force; 0 without contacts.
	double unbalancedRatio() const;
	/// Contacts between grains, those of them that slide, and grains without any contact.
	int contacts() const { return contactCount; }
	int sliding() const { return slidingCount; }
	int rattlers() const;

	/// In units of sqrt(mass/stiffness); the stiffest mode allows about 0.5.
	static constexpr double timeStep = 0.2;

private:
	void refreshPairs();
	LinearLaw<double> lawOf(double r1, double r2) const;
	void addWalls(std::size_t i);
	void computeForces();

	std::vector<Vec3> x, v, w, f, t; // places, velocities, spins, forces, torques
	std::vector<double> base, r;     // radii at factor 1 and now
	std::vector<int> touching;       // contacts of each grain
	double size, cylinderRadius, cylinderHeight, largest, skin;
	GrainLaw law;

	NearPairs pairs;
	std::vector<ContactMemory<double>> memories; // of the pairs
	std::vector<Vec3> listed;
	double listedSize = 0; // 0: no list yet

	double sideForce = 0, endForce = 0, sumForce = 0;
	int contactCount = 0, slidingCount = 0, wallCount = 0;
};

} // namespace hexmembrane
