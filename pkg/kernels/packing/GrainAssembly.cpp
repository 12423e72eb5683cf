// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/packing/GrainAssembly.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/boundary/CylinderContact.hpp"
#include "kernels/boundary/PlatenContact.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <omp.h>

namespace hexmembrane {

namespace {

/// Reach of the neighbour list beyond contact, in largest radii.
constexpr double skinRatio = 0.1;

/// Parts of a step. They go by the number of grains alone, so that a packing does not depend on the number of threads; few grains have one: threads
/// would mostly wait for each other.
int partsOf(std::size_t grains) { return grains < 2000 ? 1 : 4; }

/// Of grains and of walls.
std::vector<ContactMaterial> materials(const GrainLaw& law)
{
	ContactMaterial wall;
	wall.emod = law.modulus;
	wall.kratio = law.stiffnessRatio;
	ContactMaterial grain = wall;
	grain.friction = law.friction;
	grain.rollingFriction = law.rollingFriction;
	return {grain, wall};
}

} // namespace

GrainAssembly::GrainAssembly(std::vector<Vec3> centres, std::vector<double> radii, double factor, double radius, double height, const GrainLaw& grainLaw)
    : parts(partsOf(centres.size())), law(grainLaw), size(factor), cylinderRadius(radius / factor), cylinderHeight(height / factor)
{
	std::vector<SphereAssembly::Sphere> grains;
	for (std::size_t i = 0; i < centres.size(); ++i) {
		const double r = radii[i], mass = 0.5 * M_PI * law.modulus * r;
		grains.push_back({int(i), {centres[i] / factor, r}, {Vec3::Zero(), Vec3::Zero()}, mass, 0.4 * mass * r * r, 0, false});
	}
	for (const auto& shape : shapes()) spheres.boundaries.push_back({shape, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), 1});
	spheres.setSpheres(grains, int(grains.size()));
	spheres.takeWorkers(std::min(parts, omp_get_max_threads()));
	spheres.setMaterials(materials(law));
	spheres.setSkin(skinRatio * *std::max_element(radii.begin(), radii.end()));
}

std::vector<std::shared_ptr<const BoundaryShape>> GrainAssembly::shapes() const
{
	// solids that no grain passes
	const double thick = cylinderRadius, wide = 2 * cylinderRadius;
	const Vec3 axis = Vec3::UnitZ();
	return {boundaryShape(PlatenBoundary{{-thick * axis, axis, wide, thick}}),
	        boundaryShape(PlatenBoundary{{(cylinderHeight + thick) * axis, axis, wide, thick}}),
	        boundaryShape(CylinderBoundary{0.5 * cylinderHeight * axis, cylinderRadius, cylinderHeight})};
}

void GrainAssembly::shrink(double share)
{
	size /= share;
	cylinderRadius *= share;
	cylinderHeight *= share;
	for (Place& place : spheres.places) place.centre *= share;
	for (Motion& motion : spheres.motions) motion.velocity *= share;
	const auto now = shapes();
	for (int b : {bottom, top, side}) spheres.moveBoundary(b, now[b]);
	spheres.noteWay(std::abs(1 / share - 1) * std::hypot(cylinderRadius, cylinderHeight));
	spheres.endStep();
}

void GrainAssembly::setFriction(double friction, double rollingFriction)
{
	law.friction = friction;
	law.rollingFriction = rollingFriction;
	spheres.setMaterials(materials(law));
}

void GrainAssembly::step(double growth)
{
	if (growth != 0) shrink(1 / (1 + growth));
	if (!spheres.listsHold()) spheres.makeLists();
	spheres.computeLoads(timeStep, parts);
	for (int b : {bottom, top, side}) pressed[b] = spheres.onBoundary[b].normalForce;
	const int lost = spheres.moveGrains(timeStep, law.damping, false, parts);
	if (lost >= 0)
		fail("modulus", law.modulus, "grain " + std::to_string(lost) + " flew off while the packing was made", "another seed, or a lower stress");
	spheres.endStep();
}

std::vector<Vec3> GrainAssembly::centres() const
{
	std::vector<Vec3> all(spheres.places.size());
	for (std::size_t k = 0; k < all.size(); ++k) all[spheres.id[k]] = spheres.places[k].centre * size;
	return all;
}

double GrainAssembly::unbalancedRatio() const
{
	double sum = pressed[bottom] + pressed[top] + pressed[side], net = 0;
	int count = 0;
	for (const BoundaryLoad& boundary : spheres.onBoundary) count += boundary.count;
	spheres.contacts.forEachTouching([&](int i, int j, const Contact& contact) {
		const Place &one = spheres.places[i], &other = spheres.places[j];
		sum += contact.law.kn * std::max(0., one.radius + other.radius - (other.centre - one.centre).norm());
		++count;
	});
	if (count == 0) return 0;
	for (const Load& load : spheres.loads) net += load.force.norm();
	return (net / double(spheres.loads.size())) / (sum / count);
}

int GrainAssembly::contacts() const
{
	int count = 0;
	spheres.contacts.forEachTouching([&](int, int, const Contact&) { ++count; });
	return count;
}

int GrainAssembly::rattlers() const
{
	std::vector<char> touches(spheres.places.size(), 0);
	spheres.contacts.forEachTouching([&](int i, int j, const Contact&) { touches[i] = touches[j] = 1; });
	for (const BoundaryContacts& boundary : spheres.boundaryContacts) boundary.forEachTouching([&](int i, const Contact&) { touches[i] = 1; });
	return int(std::count(touches.begin(), touches.end(), 0));
}

} // namespace hexmembrane
