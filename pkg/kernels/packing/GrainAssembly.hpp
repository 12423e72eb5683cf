// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereAssembly.hpp"

#include <vector>

namespace hexmembrane {

/// Contact law of the grains of a GrainAssembly: linear, frictional, with rolling resistance if wished.
struct GrainLaw {
	double modulus;             ///< emod of ContactMaterial (Pa), > 0, of grains and walls
	double stiffnessRatio;      ///< kn/ks, > 0
	double friction;            ///< of grains with each other, >= 0; the walls are smooth
	double damping;             ///< local damping: share of every net force that opposes the motion, in [0, 1)
	double rollingFriction = 0; ///< of grains with each other, >= 0
};

/// Frictional spheres inside a smooth vertical cylinder with two ends, which are compressed by growing all of them by one common factor: the compact tier's
/// SphereAssembly, with platens and wall that close in while the grains keep their size. Seen from outside the cylinder keeps its size and the grains grow.
/// Quasi-static only: masses are pi/2 times modulus and radius in a unit of time of 1, so that one time step suits all sizes, and nothing here has a
/// meaning in seconds. Axis z, lower end on z = 0. Same input, same bits on one kind of processor, whatever the number
/// of threads.
class GrainAssembly {
public:
	/// Input is the caller's to check. Radii in m, at factor 1.
	GrainAssembly(std::vector<Vec3> centres, std::vector<double> radii, double factor, double radius, double height, const GrainLaw& law);

	/// One step; radii grow by `growth` times their size in it.
	/// \throws FieldFailure for a grain that flies off
	void step(double growth);

	void setFriction(double friction, double rollingFriction);
	double factor() const { return size; }

	/// In the order that they were given in.
	std::vector<Vec3> centres() const;
	/// Mean pressure of the grains on the cylinder's side, and on its ends (Pa, mean of both).
	double radialStress() const { return pressed[side] / (2 * M_PI * cylinderRadius * cylinderHeight); }
	double axialStress() const { return (pressed[bottom] + pressed[top]) / (2 * M_PI * cylinderRadius * cylinderRadius); }
	double meanStress() const { return (2 * radialStress() + axialStress()) / 3; }
	/// Mean net force on a grain over the mean contact force; 0 without contacts.
	double unbalancedRatio() const;
	/// Contacts between grains, and grains without any contact.
	int contacts() const;
	int rattlers() const;

	/// In units of sqrt(mass/stiffness); the stiffest mode allows about 0.5.
	static constexpr double timeStep = 0.2;

private:
	enum { bottom, top, side };

	/// Platens and wall of the present size.
	std::vector<std::shared_ptr<const BoundaryShape>> shapes() const;
	/// Brings everything nearer to the origin.
	void shrink(double share);

	SphereAssembly spheres;
	int parts; ///< of a step
	GrainLaw law;
	double size, cylinderRadius, cylinderHeight; ///< the cylinder as the grains see it, which keep their size
	double pressed[3] = {0, 0, 0};               ///< normal forces (N) on the boundaries
};

} // namespace hexmembrane
