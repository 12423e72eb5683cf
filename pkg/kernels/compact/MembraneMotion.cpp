// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/MembraneMotion.hpp"

#include "kernels/base/LocalDamping.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

MembraneMotion::MembraneMotion(const HexStencil& s) : stencil(s), total(s.perRing, s.rings), freeRowsOf(s.rings, -1) {}

namespace {

/// Powers of a force by the velocities before and after a step.
struct Powers {
	double before, after;
};

/// One coordinate of a row: v += dt damped(f/m), x += dt v, and the powers of the force `term`.
HEXMEMBRANE_WIDEST Powers moveRow(int n, double dt, double damping, double mass, const double* __restrict f, const double* __restrict term,
                                  double* __restrict v, double* __restrict x)
{
	double powerBefore = 0, powerAfter = 0;
#pragma omp simd reduction(+ : powerBefore, powerAfter)
	for (int i = 0; i < n; ++i) {
		const double a = f[i] / mass, before = v[i];
		const double p = a * (before + 0.5 * dt * a);
		const double sign = (p > 0 ? 1. : 0.) - (p < 0 ? 1. : 0.);
		const double after = before + dt * (a * (1 - damping * sign));
		v[i] = after;
		x[i] += dt * after;
		powerBefore += term[i] * before;
		powerAfter += term[i] * after;
	}
	return {powerBefore, powerAfter};
}

/// Records of four numbers into three rows, and three rows into such records, whose fourth number stays.
HEXMEMBRANE_WIDEST void toRows(int n, const double* records, double* x, double* y, double* z)
{
	int i = 0;
	for (; i + 4 <= n; i += 4) {
		const double* from = records + 4 * i;
		Four a, b, c, d;
		Rows<Four>::loaded([&](int k) __attribute__((always_inline)) { return from + 4 * k; }).columns(a, b, c, d);
		store(x + i, a);
		store(y + i, b);
		store(z + i, c);
	}
	for (; i < n; ++i) {
		x[i] = records[4 * i];
		y[i] = records[4 * i + 1];
		z[i] = records[4 * i + 2];
	}
}

HEXMEMBRANE_WIDEST void fromRows(int n, const double* x, const double* y, const double* z, double* records)
{
	int i = 0;
	for (; i + 4 <= n; i += 4) {
		double* to = records + 4 * i;
		Rows<Four>::ofColumns(load<Four>(x + i), load<Four>(y + i), load<Four>(z + i), Four{to[3], to[7], to[11], to[15]})
		        .stored([&](int k) __attribute__((always_inline)) { return to + 4 * k; });
	}
	for (; i < n; ++i) {
		records[4 * i] = x[i];
		records[4 * i + 1] = y[i];
		records[4 * i + 2] = z[i];
	}
}

HEXMEMBRANE_WIDEST void addRow(int n, const double* __restrict a, double* __restrict sum)
{
#pragma omp simd
	for (int i = 0; i < n; ++i) sum[i] += a[i];
}

HEXMEMBRANE_WIDEST double dot(int n, const double* a, const double* b)
{
	double sum = 0;
#pragma omp simd reduction(+ : sum)
	for (int i = 0; i < n; ++i) sum += a[i] * b[i];
	return sum;
}

HEXMEMBRANE_WIDEST double absoluteDot(int n, const double* a, const double* b)
{
	double sum = 0;
#pragma omp simd reduction(+ : sum)
	for (int i = 0; i < n; ++i) sum += std::abs(a[i] * b[i]);
	return sum;
}

/// Largest of the squared speeds; NaN when one is not finite.
HEXMEMBRANE_WIDEST double fastestSquared(int n, const double* x, const double* y, const double* z)
{
	double most = 0, all = 0;
#pragma omp simd reduction(max : most) reduction(+ : all)
	for (int i = 0; i < n; ++i) {
		const double square = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
		all += square;
		most = std::max(most, square);
	}
	return all - all == 0 ? most : all - all;
}

} // namespace

void MembraneMotion::setBlocked(const std::vector<unsigned char>& bits)
{
	const int n = stencil.perRing;
	freeRows.clear();
	freeRowsOf.assign(stencil.rings, -1);
	for (int k = 0; k < stencil.rings; ++k) {
		const auto from = bits.begin() + k * n;
		if (std::all_of(from, from + n, [](unsigned char b) { return b == 0; })) continue;
		freeRowsOf[k] = int(freeRows.size());
		freeRows.emplace_back();
		for (int component = 0; component < 6; ++component)
			for (int i = 0; i < n; ++i) freeRows.back()[component].push_back(from[i] >> component & 1 ? 0 : 1);
	}
}

const double* MembraneMotion::accelerating(int k, int component, const double* force, std::vector<double>& kept) const
{
	if (isFree(k)) return force;
	const std::vector<double>& free = freeRows[freeRowsOf[k]][component];
	kept.resize(stencil.perRing);
	for (int i = 0; i < stencil.perRing; ++i) kept[i] = free[i] * force[i];
	return kept.data();
}

void MembraneMotion::giveVelocities(const PaddedRings& velocity, Motion* motions) const
{
	for (int k = 0; k < stencil.rings; ++k)
		for (int i = 0; i < stencil.perRing; ++i) motions[stencil.at(k, i)].velocity = velocity.get(k, i);
}

void MembraneMotion::addForces(int k, const std::vector<Term>& terms, const Contacts& contacts)
{
	const int n = stencil.perRing;
	toRows(n, contacts.onParticle[k * n].force.data(), total.row(0, k), total.row(1, k), total.row(2, k));
	// those of this ring that more than frictionless contacts act on
	const auto from = std::lower_bound(contacts.loaded.begin(), contacts.loaded.end(), contacts.grains + k * n);
	for (auto sphere = from; sphere != contacts.loaded.end() && *sphere < contacts.grains + (k + 1) * n; ++sphere) {
		const int m = *sphere - contacts.grains;
		total.set(k, m - k * n, contacts.onParticle[m].force + contacts.loads[m].force);
	}
	for (const Term& term : terms)
		if (term.first <= k && k <= term.last)
			for (int a = 0; a < 3; ++a) addRow(n, term.force->row(a, k), total.row(a, k));
}

int MembraneMotion::move(double dt, double damping, double limit, std::vector<Term>& terms, std::vector<Grip>& grips, const Contacts& contacts,
                         PaddedRings& position, PaddedRings& velocity, bool energies, int threads)
{
	const int n = stencil.perRing, rings = stencil.rings;
	// one slot a ring, summed in their order: the same bits for any number of threads
	std::vector<double> square(rings), kineticPart(rings, 0.), dampedPart(rings, 0.);
	std::vector<Powers> termPart(rings * terms.size(), Powers{0, 0});
	std::vector<Grip*> gripOf(rings, nullptr);
	for (Grip& grip : grips) gripOf[grip.ring] = &grip;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
	for (int k = 0; k < rings; ++k) {
		addForces(k, terms, contacts);
		std::vector<double> kept;
		if (energies)
			for (int a = 0; a < 3; ++a) {
				kineticPart[k] += 0.5 * mass * dot(n, velocity.row(a, k), velocity.row(a, k));
				if (!gripOf[k]) dampedPart[k] += damping * dt * absoluteDot(n, velocity.row(a, k), accelerating(k, a, total.row(a, k), kept));
			}
		// the work of the last term that acts here comes with the motion, that of others by a loop of its own
		int fused = -1;
		for (int t = 0; t < int(terms.size()); ++t)
			if (terms[t].worked && terms[t].first <= k && k <= terms[t].last) fused = t;
		const auto addOthers = [&](double Powers::* part) {
			for (int t = 0; t < fused; ++t)
				if (terms[t].worked && terms[t].first <= k && k <= terms[t].last)
					for (int a = 0; a < 3; ++a)
						termPart[k * terms.size() + t].*part += dot(n, terms[t].force->row(a, k), velocity.row(a, k));
		};
		addOthers(&Powers::before);
		for (int a = 0; a < 3; ++a) {
			double *v = velocity.row(a, k), *x = position.row(a, k);
			const double* f = total.row(a, k);
			if (Grip* grip = gripOf[k]) {
				const double told = grip->velocity[a];
				for (int i = 0; i < n; ++i) {
					grip->work.atOnce += 0.5 * mass * (told - v[i]) * (v[i] + told);
					grip->work.before -= 0.5 * dt * f[i] * v[i];
					grip->work.after -= 0.5 * dt * f[i] * told;
					v[i] = told;
					x[i] += dt * told;
				}
				continue;
			}
			const double* worked = fused < 0 ? f : terms[fused].force->row(a, k);
			const Powers power = moveRow(n, dt, damping, mass, accelerating(k, a, f, kept), worked, v, x);
			if (fused < 0) continue;
			termPart[k * terms.size() + fused].before += power.before;
			termPart[k * terms.size() + fused].after += power.after;
		}
		addOthers(&Powers::after);
		position.wrap(k);
		velocity.wrap(k);
		square[k] = fastestSquared(n, velocity.row(0, k), velocity.row(1, k), velocity.row(2, k));
		fromRows(n, position.row(0, k), position.row(1, k), position.row(2, k), contacts.places[k * n].centre.data());
		const auto from = std::lower_bound(contacts.loaded.begin(), contacts.loaded.end(), contacts.grains + k * n);
		for (auto sphere = from; sphere != contacts.loaded.end() && *sphere < contacts.grains + (k + 1) * n; ++sphere)
			contacts.motions[*sphere - contacts.grains].velocity = velocity.get(k, *sphere - contacts.grains - k * n);
	}
	double fastest2 = 0;
	kinetic = 0;
	for (Term& term : terms) term.work = {};
	int lost = -1;
	for (int k = 0; k < rings; ++k) {
		kinetic += kineticPart[k];
		dampedWork += dampedPart[k];
		for (std::size_t t = 0; t < terms.size(); ++t) {
			terms[t].work.before += 0.5 * dt * termPart[k * terms.size() + t].before;
			terms[t].work.after += 0.5 * dt * termPart[k * terms.size() + t].after;
		}
		if (lost < 0 && !(square[k] * dt * dt < limit * limit))
			for (int i = 0; i < n && lost < 0; ++i)
				if (!(velocity.get(k, i).squaredNorm() * dt * dt < limit * limit)) lost = k * n + i;
		fastest2 = std::max(fastest2, square[k]);
	}
	fastest = std::sqrt(fastest2);
	return lost;
}

int MembraneMotion::moveSpins(double dt, double damping, double inertia, const std::vector<const PaddedRings*>& torques, const Load* loads, PaddedRings& spin,
                              Motion* motions, bool energies)
{
	const int n = stencil.perRing;
	int lost = -1;
	for (int k = 0; k < stencil.rings; ++k) {
		for (int i = 0; i < n; ++i) {
			const int m = k * n + i;
			Vec3 torque = loads[m].torque, after;
			for (const PaddedRings* rows : torques) torque += rows->get(k, i);
			const Vec3 before = spin.get(k, i);
			for (int a = 0; a < 3; ++a) {
				if (!isFree(k)) torque[a] *= freeRows[freeRowsOf[k]][3 + a][i];
				after[a] = dampedStep(before[a], torque[a], 1 / inertia, dt, damping);
			}
			if (energies) {
				kinetic += 0.5 * inertia * before.squaredNorm();
				dampedWork += damping * dt * before.cwiseAbs().dot(torque.cwiseAbs());
			}
			if (lost < 0 && !std::isfinite(after.sum())) lost = m;
			spin.set(k, i, after);
			motions[m].spin = after;
		}
		spin.wrap(k);
	}
	return lost;
}

} // namespace hexmembrane
