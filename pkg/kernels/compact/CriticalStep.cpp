// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/CriticalStep.hpp"

#include "kernels/base/Random.hpp"

#include <cmath>
#include <limits>

namespace hexmembrane {

CriticalStep::CriticalStep(const SphereAssembly& flat) : grains(flat.grains())
{
	for (int i = 0; i < flat.spheres(); ++i) {
		const bool moves = !flat.fixed[i];
		inverseMass.push_back(moves ? 1 / flat.mass[i] : 0);
		inverseInertia.push_back(moves ? 1 / flat.inertia[i] : 0);
	}
	flat.contacts.forEachTouching([&](int i, int j, const Contact& contact) {
		const Place &a = flat.places[i], &b = flat.places[j];
		const Vec3 branch = b.centre - a.centre, normal = branch.normalized();
		const double u = a.radius + b.radius - branch.norm();
		add(i, j, normal, (a.radius - 0.5 * u) * normal, -(b.radius - 0.5 * u) * normal, stickingSprings(contact.law));
	});
	flat.smooth.forEachTouching(
	        flat.places, [&](int i, int j, double kn, double, const Vec3& normal) { add(i, j, normal, Vec3::Zero(), Vec3::Zero(), springsAlone(kn, 0)); });
	for (std::size_t b = 0; b < flat.boundaries.size(); ++b)
		flat.boundaryContacts[b].forEachTouching([&](int i, const Contact& contact) {
			const BoundaryTouch touch = flat.boundaries[b].shape->touch(flat.places[i]);
			add(i, -1, -touch.normal, touch.point - flat.places[i].centre, Vec3::Zero(), stickingSprings(contact.law));
		});
}

void CriticalStep::addBond(int first, int second, const Vec3& branch, double kn, double ks)
{
	const Vec3 normal = branch.normalized();
	add(grains + first, grains + second, normal, 0.5 * branch, -0.5 * branch, springsAlone(kn, ks));
}

void CriticalStep::addSupport(int particle, int grain, const Vec3& normal, double kn)
{
	add(grains + particle, grain, normal, Vec3::Zero(), Vec3::Zero(), springsAlone(kn, 0));
}

void CriticalStep::setSheet(const HexStencil& tube, Answer addAnswer)
{
	sheet = tube;
	answer = std::move(addAnswer);
}

void CriticalStep::addSheet(const std::vector<Vec3>& x, std::vector<Vec3>& force) const
{
	PaddedRings displacement(sheet.perRing, sheet.rings), sum(sheet.perRing, sheet.rings);
	for (int k = 0; k < sheet.rings; ++k) {
		for (int i = 0; i < sheet.perRing; ++i) displacement.set(k, i, x[grains + sheet.at(k, i)]);
		displacement.wrap(k);
	}
	answer(displacement, sum);
	for (int k = 0; k < sheet.rings; ++k)
		for (int i = 0; i < sheet.perRing; ++i) force[grains + sheet.at(k, i)] += sum.get(k, i);
}

double CriticalStep::compute(double tolerance, int most) const
{
	if (springs.empty() && !answer) return std::numeric_limits<double>::infinity();
	const std::size_t count = inverseMass.size();
	std::vector<Vec3> x(count), w(count), f(count), t(count);
	Random random(1);
	for (std::size_t i = 0; i < count; ++i)
		for (int a = 0; a < 3; ++a) {
			x[i][a] = inverseMass[i] > 0 ? random.uniform(-1, 1) : 0;
			w[i][a] = turnStart > 0 && inverseInertia[i] > 0 ? turnStart * random.uniform(-1, 1) : 0;
		}
	// in coordinates scaled by the roots of mass and inertia the matrix is symmetric; the norms are those of kinetic energy
	const auto norm = [&](const std::vector<Vec3>& u, const std::vector<Vec3>& v) {
		double sum = 0;
		for (std::size_t i = 0; i < count; ++i) {
			if (inverseMass[i] > 0) sum += u[i].squaredNorm() / inverseMass[i];
			if (inverseInertia[i] > 0) sum += v[i].squaredNorm() / inverseInertia[i];
		}
		return std::sqrt(sum);
	};
	double before = 0, eigenvalue = 0;
	for (int iteration = 0; iteration < most; ++iteration) {
		const double size = norm(x, w);
		if (!(size > 0)) return std::numeric_limits<double>::infinity();
		for (std::size_t i = 0; i < count; ++i) {
			x[i] /= size;
			w[i] /= size;
			f[i] = t[i] = Vec3::Zero();
		}
		for (const Spring& s : springs) {
			Vec3 slide = -x[s.i] - w[s.i].cross(s.arm1), turn = -w[s.i];
			if (s.j >= 0) {
				slide += x[s.j] + w[s.j].cross(s.arm2);
				turn += w[s.j];
			}
			const double along = s.normal.dot(slide);
			const Vec3 force = s.law.kn * along * s.normal + s.law.ks * (slide - along * s.normal); // on i, pulling it after j
			const Vec3 moment = answerTo(turn, s.law, s.normal) + s.twist * turn.dot(s.normal) * s.normal;
			f[s.i] += force;
			t[s.i] += s.arm1.cross(force) + moment;
			if (s.j < 0) continue;
			f[s.j] -= force;
			t[s.j] -= s.arm2.cross(force) + moment;
		}
		if (answer) addSheet(x, f);
		for (std::size_t i = 0; i < count; ++i) {
			x[i] = -inverseMass[i] * f[i];
			w[i] = -inverseInertia[i] * t[i];
		}
		eigenvalue = norm(x, w); // of a unit vector: rises to the largest eigenvalue
		if (iteration > 20 && std::abs(eigenvalue - before) < tolerance * eigenvalue) break;
		before = eigenvalue;
	}
	return 2 / std::sqrt(eigenvalue);
}

} // namespace hexmembrane
