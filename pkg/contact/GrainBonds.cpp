// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "GrainBonds.hpp"

#include "base/GatherBodies.hpp"
#include "base/NamedFields.hpp"
#include "kernels/base/CellGrid.hpp"
#include "measure/NumpyArray.hpp"

#include <pkg/common/Sphere.hpp>

#include <set>

namespace yade {

YADE_PLUGIN((GrainBonds));

using hexmembrane::BondTable;

namespace {

const string engineName = "GrainBonds";

const Sphere& sphereOf(const Scene& scene, Body::id_t id)
{
	const Body* body = livingBody(*scene.bodies, id);
	const auto* sphere = body ? dynamic_cast<const Sphere*>(body->shape.get()) : nullptr;
	if (!sphere) hexmembrane::reject(engineName + ".ids", int(id), body ? "is no sphere" : "there is no such body", "give the ids of grains");
	return *sphere;
}

hexmembrane::Place placeOf(const Scene& scene, Body::id_t id)
{
	const Sphere& sphere = sphereOf(scene, id);
	return {(*scene.bodies)[id]->state->pos, sphere.radius};
}

void requireCementStrength(const char* name, Real strength)
{
	if (math::isnan(strength)) hexmembrane::reject(engineName + "." + name, strength, "is not given", "a number >= 0 in Pa, or inf");
	if (!(strength >= 0)) hexmembrane::reject(engineName + "." + name, strength, "a strength must not be negative", "a number >= 0 in Pa, or inf");
}

// A bond's numbers as they are saved.
constexpr size_t savedSize = 20;

void save(const BondTable::Bond& bond, vector<Real>& numbers)
{
	numbers.insert(numbers.end(), {bond.made.radius, bond.made.kn, bond.made.ks, bond.made.rest, bond.loads.normal, bond.loads.twist});
	for (const Vector3r& v : {bond.loads.shear, bond.loads.bending, bond.loads.axis, bond.centre}) numbers.insert(numbers.end(), v.data(), v.data() + 3);
	numbers.insert(numbers.end(), {bond.difference, bond.begun ? 1. : 0.});
}

BondTable::Bond saved(const Vector2i& ids, const Real* n)
{
	const auto vector = [n](int from) { return Vector3r(n[from], n[from + 1], n[from + 2]); };
	return {ids[0], ids[1], {n[0], n[1], n[2], n[3]}, {n[4], n[5], vector(6), vector(9), vector(12)}, vector(15), n[18], n[19] > 0};
}

} // namespace

void GrainBonds::requireStiffness() const
{
	const bool direct = !math::isnan(kn) || !math::isnan(ks), modulus = !math::isnan(emod) || !math::isnan(kratio);
	if (direct && modulus) hexmembrane::reject("GrainBonds.kn", kn, "stiffness is given twice", "either kn and ks, or emod and kratio");
	hexmembrane::requirePositive(modulus ? "GrainBonds.emod" : "GrainBonds.kn", modulus ? emod : kn, modulus ? "Pa" : "N/m3");
	if (modulus)
		hexmembrane::requirePositive("GrainBonds.kratio", kratio, "1");
	else
		hexmembrane::requireNonNegative("GrainBonds.ks", ks, "N/m3");
	hexmembrane::requirePositive("GrainBonds.radiusMultiplier", radiusMultiplier, "1");
}

void GrainBonds::requireStrengths() const
{
	requireCementStrength("tensileStrength", tensileStrength);
	requireCementStrength("cohesion", cohesion);
	if (!(frictionAngle >= 0 && frictionAngle < M_PI / 2))
		hexmembrane::reject("GrainBonds.frictionAngle", frictionAngle, "is out of range", "an angle from 0 to below pi/2 in rad");
	if (!(momentFactor >= 0 && momentFactor <= 1)) hexmembrane::reject("GrainBonds.momentFactor", momentFactor, "is out of range", "a number from 0 to 1");
}

void GrainBonds::restore() const
{
	if (savedNumbers.size() != savedSize * savedIds.size())
		throw std::runtime_error("GrainBonds: the saved bonds are not whole (" + std::to_string(savedIds.size()) + " bonds, " +
		                         std::to_string(savedNumbers.size()) +
		                         " numbers); fix: go on with the version that saved the state, or load another one");
	for (size_t b = 0; b < savedIds.size(); ++b) table.bonds.push_back(saved(savedIds[b], savedNumbers.data() + savedSize * b));
}

BondTable& GrainBonds::held() const
{
	if (!live) restore();
	live = true;
	return table;
}

void GrainBonds::preSave(GrainBonds&)
{
	if (!live) return; // what was loaded is still there
	savedIds.clear();
	savedNumbers.clear();
	for (const BondTable::Bond& bond : table.bonds) {
		savedIds.emplace_back(bond.id1, bond.id2);
		save(bond, savedNumbers);
	}
}

int GrainBonds::bond(const vector<Body::id_t>& ids, Real gap)
{
	requireStiffness();
	requireStrengths();
	hexmembrane::requireNonNegative("GrainBonds.bond.gap", gap, "m");
	const Scene& scene = currentScene();
	BondTable& all = held();
	std::set<std::pair<int, int>> have;
	for (const BondTable::Bond& one : all.bonds) have.insert(std::minmax(one.id1, one.id2));
	vector<Vector3r> centres;
	vector<Real> radii;
	Vector3r low = Vector3r::Constant(1e300), high = -low;
	for (Body::id_t id : ids) {
		const hexmembrane::Place place = placeOf(scene, id);
		if (!isFinite(place.centre)) throwNotFinite("GrainBonds.bond: the position", id, scene);
		centres.push_back(place.centre);
		radii.push_back(place.radius);
		low = low.cwiseMin(place.centre);
		high = high.cwiseMax(place.centre);
	}
	if (ids.empty()) return 0;
	const hexmembrane::NearPairs near = named("GrainBonds.bond", {}, [&] { return hexmembrane::findNearPairs(centres, radii, gap, low, high); });
	const size_t before = all.bonds.size();
	for (size_t i = 0; i < ids.size(); ++i)
		for (int p = near.start[i]; p < near.start[i + 1]; ++p) {
			const int j = near.other[p];
			if (!have.insert(std::minmax<int>(ids[i], ids[j])).second) continue;
			const Real length = radii[i] + radii[j], normal = math::isnan(emod) ? kn : emod / length;
			all.bonds.push_back(BondTable::between(ids[i], ids[j], {centres[i], radii[i]}, {centres[j], radii[j]},
			                                       radiusMultiplier * std::min(radii[i], radii[j]), normal,
			                                       math::isnan(emod) ? ks : normal / kratio));
		}
	located = -1;
	return static_cast<int>(all.bonds.size() - before);
}

int GrainBonds::take(const boost::python::object& ids, const boost::python::object& radius, const boost::python::object& kn, const boost::python::object& ks,
                     const boost::python::object& force, const boost::python::object& moment)
{
	requireStrengths();
	const Scene& scene = currentScene();
	const vector<Real> ends = numbersOf(ids, "GrainBonds.take.ids", 2);
	const size_t count = ends.size() / 2;
	const auto column = [count](const boost::python::object& given, const char* name, int columns) {
		const string field = string("GrainBonds.take.") + name;
		vector<Real> found = numbersOf(given, field, columns);
		const size_t rows = found.size() / std::max(columns, 1);
		if (rows != count)
			hexmembrane::reject(field, int(rows), "has another number of rows than ids, " + std::to_string(count), "one row for each bond");
		for (Real number : found)
			if (!math::isfinite(number)) hexmembrane::reject(field, number, "is not finite", "finite numbers");
		return found;
	};
	const vector<Real> radii = column(radius, "radius", 0), normal = column(kn, "kn", 0), shear = column(ks, "ks", 0), forces = column(force, "force", 3),
	                   moments = column(moment, "moment", 3);
	BondTable& all = held();
	std::set<std::pair<int, int>> have;
	for (const BondTable::Bond& one : all.bonds) have.insert(std::minmax(one.id1, one.id2));
	vector<BondTable::Bond> made;
	for (size_t b = 0; b < count; ++b) {
		const int i = int(ends[2 * b]), j = int(ends[2 * b + 1]);
		const hexmembrane::Place first = placeOf(scene, i), second = placeOf(scene, j);
		hexmembrane::requirePositive("GrainBonds.take.radius", radii[b], "m");
		hexmembrane::requirePositive("GrainBonds.take.kn", normal[b], "N/m3");
		hexmembrane::requireNonNegative("GrainBonds.take.ks", shear[b], "N/m3");
		if (i == j || !have.insert(std::minmax(i, j)).second)
			hexmembrane::reject("GrainBonds.take.ids", std::to_string(i) + " and " + std::to_string(j),
			                    i == j ? "are one grain" : "have a bond of this engine already", "two grains without one, or another engine");
		made.push_back(BondTable::loaded(BondTable::between(i, j, first, second, radii[b], normal[b], shear[b]),
		                                 Vector3r(forces[3 * b], forces[3 * b + 1], forces[3 * b + 2]),
		                                 Vector3r(moments[3 * b], moments[3 * b + 1], moments[3 * b + 2])));
	}
	all.bonds.insert(all.bonds.end(), made.begin(), made.end());
	located = -1;
	return static_cast<int>(count);
}

int GrainBonds::release(const vector<Body::id_t>& ids)
{
	BondTable& all = held();
	const std::set<Body::id_t> gone(ids.begin(), ids.end());
	vector<BondTable::Bond> kept;
	Real energy = 0;
	for (const BondTable::Bond& one : all.bonds)
		if (gone.count(one.id1) || gone.count(one.id2))
			energy += hexmembrane::bondEnergy(one.made, one.loads);
		else
			kept.push_back(one);
	const int released = static_cast<int>(all.bonds.size() - kept.size());
	all.bonds = std::move(kept);
	located = -1;
	if (currentScene().trackEnergy) freed += energy;
	return released;
}

void GrainBonds::prepare()
{
	if (scene->isPeriodic)
		throw std::runtime_error("GrainBonds: O.periodic = True: a bond would end at the cell's faces; fix: a scene that is not periodic");
	if (count() > 0) requireStrengths();
}

void GrainBonds::action() { stepOverBodies(*this); }

void GrainBonds::step(StepView& view)
{
	BondTable& all = held();
	if (all.bonds.empty()) return;
	if (located < 0) {
		std::set<Body::id_t> bodies;
		for (const BondTable::Bond& one : all.bonds) bodies.insert({one.id1, one.id2});
		bonded.assign(bodies.begin(), bodies.end());
	}
	const MovingRows rows = view.moving(bonded);
	if (rows.order != located) named(engineName, {}, [&] { all.locate(rows.ids, rows.count); });
	located = rows.order;
	all.step(rows.places, rows.motions, scene->dt, {tensileStrength, cohesion, std::tan(frictionAngle), momentFactor});
	all.forEachLoad([&](int row, const hexmembrane::Load& load) { view.addLoad(row, load); });
	tensileBreaks += all.tensileBreaks;
	shearBreaks += all.shearBreaks;
	if (scene->trackEnergy) freed += all.freed;
}

void GrainBonds::bookStored()
{
	if (!scene->trackEnergy || (count() == 0 && freed == 0 && energyIndex < 0)) return;
	scene->energy->add(elasticEnergy(), "elastGrainBonds", energyIndex, /*reset*/ true);
	if (freed != 0) scene->energy->add(freed, "bondDissip", freedIndex);
	freed = 0;
}

void GrainBonds::forEachJoint(const VisitContact& visit) const
{
	for (const BondTable::Bond& one : held().bonds) {
		const Real distance = BondTable::distanceOf(one);
		const Vector3r& axis = one.loads.axis;
		visit({one.id1, one.id2, one.centre, one.centre + distance * axis, one.centre + BondTable::armsOf(one, distance).first * axis,
		       one.loads.normal * axis + one.loads.shear, one.loads.normal, std::numeric_limits<Real>::infinity()});
	}
}

void GrainBonds::forEachJointSpring(const VisitJointSpring& visit) const
{
	for (const BondTable::Bond& one : held().bonds) {
		const auto arms = BondTable::armsOf(one, BondTable::distanceOf(one));
		const Real area = one.made.area(), inertia = one.made.inertia();
		visit(one.id1, one.id2, one.loads.axis, {arms.first, -arms.second},
		      {one.made.kn * area, one.made.ks * area, one.made.kn * inertia, 2 * one.made.ks * inertia});
	}
}

boost::python::tuple GrainBonds::springs() const
{
	vector<int> ids;
	vector<Vector3r> normals;
	vector<Real> stiffness, arms;
	forEachJointSpring([&](Body::id_t a, Body::id_t b, const Vector3r& normal, const std::array<Real, 2>& arm, const JointStiffness& k) {
		ids.insert(ids.end(), {a, b});
		normals.push_back(normal);
		stiffness.insert(stiffness.end(), {k.normal, k.shear, k.bending, k.twisting});
		arms.insert(arms.end(), arm.begin(), arm.end());
	});
	return boost::python::make_tuple(numpyArray(ids, "i4", 2), numpyArray(normals, "f8", 3), numpyArray(stiffness, "f8", 4), numpyArray(arms, "f8", 2));
}

boost::python::dict GrainBonds::bonds() const
{
	vector<int> ids;
	vector<Vector3r> points, forces, moments;
	vector<Real> radii, kn, ks, normal, tension, shear;
	forEachJoint([&](const TouchingContact& joint) {
		points.push_back(joint.point);
		forces.push_back(joint.force);
	});
	for (const BondTable::Bond& one : held().bonds) {
		const auto stress = hexmembrane::stressOf<Real>(one.made, one.loads, momentFactor);
		ids.insert(ids.end(), {one.id1, one.id2});
		moments.push_back(one.loads.bending + one.loads.twist * one.loads.axis);
		radii.push_back(one.made.radius);
		kn.push_back(one.made.kn);
		ks.push_back(one.made.ks);
		normal.push_back(one.loads.normal);
		tension.push_back(stress.tension);
		shear.push_back(stress.shear);
	}
	boost::python::dict values;
	values["ids"] = numpyArray(ids, "i4", 2);
	values["radius"] = numpyArray(radii, "f8");
	values["kn"] = numpyArray(kn, "f8");
	values["ks"] = numpyArray(ks, "f8");
	values["point"] = numpyArray(points, "f8", 3);
	values["force"] = numpyArray(forces, "f8", 3);
	values["moment"] = numpyArray(moments, "f8", 3);
	values["normalForce"] = numpyArray(normal, "f8");
	values["tension"] = numpyArray(tension, "f8");
	values["shear"] = numpyArray(shear, "f8");
	return values;
}

} // namespace yade
