// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "SoilMeasure.hpp"

#include "NumpyArray.hpp"

#include "base/GatherBodies.hpp"
#include "boundary/CylinderWall.hpp"
#include "boundary/Platen.hpp"
#include "membrane/BodyView.hpp"

#include <core/Scene.hpp>

namespace yade {

YADE_PLUGIN((SoilMeasure));

namespace {

template <typename Wanted>
const Body& bodyOf(const Scene& scene, Body::id_t id, const string& what, const string& shape)
{
	const Body* body = livingBody(*scene.bodies, id);
	if (!body) throw std::runtime_error(what + " = " + std::to_string(id) + ": there is no such body; fix: give the id of a " + shape + " body");
	if (!dynamic_cast<const Wanted*>(body->shape.get()))
		throw std::runtime_error(what + " = " + std::to_string(id) + ": the body's shape is no " + shape + "; fix: give the id of a " + shape +
		                         " body");
	return *body;
}

Real halfOf(const Body& platen) { return 0.5 * static_cast<const Platen&>(*platen.shape).height; }

boost::python::object tensor(const Matrix3r& m) { return numpyTensors({m})[0]; }

// The branch joins the centres of grains; to what is no grain it ends at the contact.
void addBranch(hexmembrane::SlabStress& slabs, const TouchingContact& c, bool first, bool second)
{
	const Vector3r start = first ? c.centre1 : c.point;
	slabs.add(start, (second ? c.centre2 : c.point) - start, c.force);
}

} // namespace

void SoilMeasure::require(const Scene& scene, const string& who) const
{
	if (static_cast<bool>(membrane) == (wall >= 0))
		hexmembrane::reject(who + ".membrane", string(membrane ? "given together with wall" : "None"), "what is round the soil is not clear",
		                    "either membrane=HexMembrane(...) or wall=the id of a CylinderWall");
	if (membrane)
		membrane->requireGenerated(who);
	else
		bodyOf<CylinderWall>(scene, wall, who + ".wall", "CylinderWall");
	bodyOf<Platen>(scene, bottomPlaten, who + ".bottomPlaten", "Platen");
	bodyOf<Platen>(scene, topPlaten, who + ".topPlaten", "Platen");
	const auto [low, high] = faces(scene);
	if (!(low < high)) hexmembrane::reject(who + ".topPlaten", int(topPlaten), "its face is not above the bottom platen's", "the upper platen's id here");
}

std::array<Real, 2> SoilMeasure::faces(const Scene& scene) const
{
	const Body &bottom = *(*scene.bodies)[bottomPlaten], &top = *(*scene.bodies)[topPlaten];
	return {bottom.state->pos[2] + halfOf(bottom), top.state->pos[2] - halfOf(top)};
}

vector<Real> SoilMeasure::volumes(const Scene& scene, const vector<Vector3r>& sheet, const vector<Real>& heights) const
{
	if (membrane) return membrane->volumesBetween(sheet, heights);
	const Real radius = static_cast<const CylinderWall&>(*(*scene.bodies)[wall]->shape).radius;
	vector<Real> found;
	for (size_t k = 1; k < heights.size(); ++k) found.push_back(M_PI * radius * radius * (heights[k] - heights[k - 1]));
	return found;
}

vector<char> SoilMeasure::grainsOf(const Scene& scene) const
{
	vector<char> grain(scene.bodies->size(), 0);
	for (const auto& body : *scene.bodies)
		if (body && dynamic_cast<const Sphere*>(body->shape.get())) grain[body->getId()] = 1;
	if (membrane)
		for (Body::id_t id : membrane->ids) grain[id] = 0;
	return grain;
}

SoilMeasure::Stress SoilMeasure::measure(const Scene& scene, const EachContact& contacts, const vector<Vector3r>& sheet) const
{
	const auto [low, high] = faces(scene);
	const Real quarter = 0.25 * (high - low);
	const vector<Real> heights{low, low + quarter, high - quarter, high};
	hexmembrane::SlabStress slabs(heights);
	const vector<char> grain = grainsOf(scene);
	Stress found;
	int count = 0;
	contacts([&](const TouchingContact& c) {
		++count;
		found.contactForce += c.force.norm();
		const bool first = grain[c.id1], second = grain[c.id2];
		if (!first && !second) return;
		addBranch(slabs, c, first, second);
		if (first && second)
			found.grainContacts += c.normalForce > 0;
		else
			found.boundary -= (second ? c.force : Vector3r(-c.force)) * c.point.transpose();
	});
	if (count > 0) found.contactForce /= count;
	found.grains = static_cast<int>(std::count(grain.begin(), grain.end(), 1));
	const vector<Real> parts = volumes(scene, sheet, heights);
	found.volume = parts[0] + parts[1] + parts[2];
	found.middleVolume = parts[1];
	found.whole = slabs.total() / found.volume;
	found.middle = slabs.sums()[1] / found.middleVolume;
	found.boundary /= found.volume;
	return found;
}

SoilMeasure::Stress SoilMeasure::measure(const Scene& scene, StepView& view) const
{
	return measure(scene, [&](const VisitContact& visit) { view.forEachContact(visit); }, membrane ? membrane->positionsIn(view) : vector<Vector3r>());
}

vector<Vector3r> SoilMeasure::sheetNow() const { return membrane ? membrane->positions_get() : vector<Vector3r>(); }

boost::python::dict SoilMeasure::stress() const
{
	const Scene& scene = currentScene();
	require(scene, "SoilMeasure");
	const Stress found = measure(scene, [&](const VisitContact& visit) { forEachContactOf(scene, "SoilMeasure", visit); }, sheetNow());
	boost::python::dict values;
	values["whole"] = tensor(found.whole);
	values["middle"] = tensor(found.middle);
	values["boundary"] = tensor(found.boundary);
	values["volume"] = found.volume;
	values["middleVolume"] = found.middleVolume;
	values["coordination"] = found.grains > 0 ? 2. * found.grainContacts / found.grains : NaN;
	values["contactForce"] = found.contactForce;
	return values;
}

boost::python::tuple SoilMeasure::profile(int count) const
{
	const Scene& scene = currentScene();
	require(scene, "SoilMeasure");
	if (count < 1) hexmembrane::reject("SoilMeasure.profile: slabs", count, "is no slab", "1 or more");
	const auto [low, high] = faces(scene);
	vector<Real> edges;
	for (int k = 0; k <= count; ++k) edges.push_back(low + (high - low) * k / count);
	hexmembrane::SlabStress slabs(edges);
	const vector<char> grain = grainsOf(scene);
	forEachContactOf(scene, "SoilMeasure", [&](const TouchingContact& c) {
		const bool first = grain[c.id1], second = grain[c.id2];
		if (!first && !second) return;
		addBranch(slabs, c, first, second);
	});
	const vector<Real> parts = volumes(scene, sheetNow(), edges);
	vector<Matrix3r> stresses;
	for (int s = 0; s < count; ++s) stresses.push_back(slabs.sums()[s] / parts[s]);
	return boost::python::make_tuple(numpyArray(edges, "f8"), numpyArray(parts, "f8"), numpyTensors(stresses));
}

boost::python::dict SoilMeasure::contacts() const
{
	const Scene& scene = currentScene();
	require(scene, "SoilMeasure");
	enum Kind { ofGrain, ofMembrane, ofBottom, ofTop, ofOther };
	vector<char> kinds(scene.bodies->size(), ofOther);
	const vector<char> grain = grainsOf(scene);
	for (size_t id = 0; id < kinds.size(); ++id)
		if (grain[id]) kinds[id] = ofGrain;
	if (membrane)
		for (Body::id_t id : membrane->ids) kinds[id] = ofMembrane;
	kinds[bottomPlaten] = ofBottom;
	kinds[topPlaten] = ofTop;
	vector<Body::id_t> ids;
	vector<int> kind;
	vector<Vector3r> ends;
	vector<Real> normal, shear;
	forEachContactOf(scene, "SoilMeasure", [&](const TouchingContact& c) {
		const bool first = grain[c.id1], second = grain[c.id2];
		if (!first && !second) return;
		const Body::id_t other = first ? c.id2 : c.id1;
		ids.insert(ids.end(), {first ? c.id1 : c.id2, other});
		kind.push_back(kinds[other]);
		ends.push_back(first ? c.centre1 : c.centre2);
		ends.push_back(first && second ? c.centre2 : c.point);
		normal.push_back(c.normalForce);
		shear.push_back(std::sqrt(std::max(0., c.force.squaredNorm() - c.normalForce * c.normalForce)));
	});
	boost::python::dict values;
	values["ids"] = numpyArray(ids, "i4", 2);
	values["kind"] = numpyArray(kind, "i4");
	values["ends"] = numpyArray(ends, "f8", 3).attr("reshape")(-1, 2, 3);
	values["normalForce"] = numpyArray(normal, "f8");
	values["shearForce"] = numpyArray(shear, "f8");
	return values;
}

boost::python::object SoilMeasure::coordinationNumbers(const vector<Body::id_t>& ids) const
{
	const Scene& scene = currentScene();
	vector<int> all(scene.bodies->size(), 0), wanted;
	forEachContactOf(scene, "SoilMeasure", [&](const TouchingContact& c) {
		if (!(c.normalForce > 0)) return;
		++all[c.id1];
		++all[c.id2];
	});
	for (Body::id_t id : ids) wanted.push_back(all.at(id));
	return numpyArray(wanted, "i4");
}

boost::python::tuple SoilMeasure::faces_get() const
{
	require(currentScene(), "SoilMeasure");
	const auto [low, high] = faces(currentScene());
	return boost::python::make_tuple(low, high);
}

} // namespace yade
