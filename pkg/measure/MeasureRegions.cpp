// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MeasureRegions.hpp"

#include "NumpyArray.hpp"

#include "base/GatherBodies.hpp"
#include "base/NamedFields.hpp"
#include "membrane/BodyView.hpp"

#include <core/Scene.hpp>
#include <pkg/common/Sphere.hpp>

namespace yade {

YADE_PLUGIN((MeasureRegions));

namespace {

struct Regions {
	vector<Vector3r> centres;
	vector<Real> radii;
};

Regions regionsFrom(const boost::python::object& centres, const boost::python::object& radii)
{
	Regions found;
	const vector<Real> rows = numbersOf(centres, "centres", 3);
	for (size_t i = 0; i < rows.size(); i += 3) found.centres.emplace_back(rows[i], rows[i + 1], rows[i + 2]);
	found.radii = numbersOf(radii, "radii");
	if (found.radii.size() == 1) found.radii.resize(found.centres.size(), found.radii[0]);
	return found;
}

} // namespace

vector<Body::id_t> MeasureRegions::grainsOf(const Scene& scene) const
{
	if (scene.isPeriodic)
		throw std::runtime_error(
		        "MeasureRegions: O.periodic = True: a region would miss the grains beyond the cell's faces; fix: a scene that is not periodic");
	vector<char> excluded(scene.bodies->size(), 0);
	if (membrane)
		for (const Body::id_t id : membrane->ids) excluded.at(id) = 1;
	vector<Body::id_t> ids;
	for (const auto& body : *scene.bodies) {
		if (!body || excluded[body->getId()] || (body->groupMask & exclude) || !dynamic_cast<const Sphere*>(body->shape.get())) continue;
		if (!body->isStandalone())
			throw std::runtime_error("MeasureRegions: body " + std::to_string(body->getId()) +
			                         " is of a clump, whose spheres share volumes; fix: MeasureRegions.exclude with a bit of its groupMask");
		ids.push_back(body->getId());
	}
	if (ids.empty()) hexmembrane::reject("exclude", exclude, "leaves no grain in the scene", "a mask that spares the soil, and a scene with spheres");
	return ids;
}

hexmembrane::SphereRegions MeasureRegions::regionsOf(const Scene& scene, const vector<Body::id_t>& ids) const
{
	vector<int> indexOf(scene.bodies->size(), -1);
	vector<hexmembrane::MeasuredGrain> grains;
	for (const Body::id_t id : ids) {
		const Body& body = *livingBody(*scene.bodies, id);
		if (!isFinite(body.state->pos)) throwNotFinite("MeasureRegions: the position", id, scene);
		indexOf[id] = static_cast<int>(grains.size());
		grains.push_back({body.state->pos, static_cast<const Sphere&>(*body.shape).radius, body.state->vel});
	}
	vector<hexmembrane::MeasuredContact> contacts;
	forEachContactOf(scene, "MeasureRegions", [&](const TouchingContact& c) {
		const int first = indexOf[c.id1], second = indexOf[c.id2];
		if (first < 0 && second < 0) return;
		contacts.push_back(
		        {first, second, first < 0 ? c.point : c.centre1, second < 0 ? c.point : c.centre2, c.point, c.force, c.normalForce, c.friction});
	});
	return {std::move(grains), std::move(contacts)};
}

boost::python::dict MeasureRegions::measure(const boost::python::object& centres, const boost::python::object& radii,
                                            const boost::python::object& diameters) const
{
	return named("MeasureRegions", {}, [&] {
		const Scene& scene = currentScene();
		const Regions regions = regionsFrom(centres, radii);
		const vector<Real> borders = numbersOf(diameters, "diameters");
		const hexmembrane::RegionMeasures found = regionsOf(scene, grainsOf(scene)).measure(regions.centres, regions.radii, borders);
		vector<Matrix3r> rates;
		for (const Matrix3r& gradient : found.velocityGradient) rates.push_back(-0.5 * (gradient + gradient.transpose()));
		boost::python::dict values;
		values["grains"] = numpyArray(found.grains, "i4");
		values["contacts"] = numpyArray(found.contacts, "i4");
		values["porosity"] = numpyArray(found.porosity, "f8");
		values["coordination"] = numpyArray(found.coordination, "f8");
		values["sliding"] = numpyArray(found.sliding, "f8");
		values["stress"] = numpyTensors(found.stress);
		values["velocity"] = numpyArray(found.velocity, "f8", 3);
		values["velocityGradient"] = numpyTensors(found.velocityGradient);
		values["strainRate"] = numpyTensors(rates);
		if (!borders.empty()) values["sizes"] = numpyArray(found.sizes, "f8", static_cast<int>(borders.size()) - 1);
		return values;
	});
}

boost::python::tuple MeasureRegions::members(const boost::python::object& centres, const boost::python::object& radii) const
{
	return named("MeasureRegions", {}, [&] {
		const Scene& scene = currentScene();
		const Regions regions = regionsFrom(centres, radii);
		const vector<Body::id_t> ids = grainsOf(scene);
		const hexmembrane::RegionMembers found = regionsOf(scene, ids).members(regions.centres, regions.radii);
		vector<int> inside;
		for (const int grain : found.grain) inside.push_back(ids[grain]);
		return boost::python::make_tuple(numpyArray(found.start, "i4"), numpyArray(inside, "i4"));
	});
}

boost::python::object MeasureRegions::grid(const Vector3r& low, const Vector3r& high, Real spacing)
{
	return named("MeasureRegions.grid", {{"cellSize", "spacing"}}, [&] {
		const hexmembrane::CellGrid cells(low, high, spacing);
		const auto& count = cells.cells();
		vector<Vector3r> centres;
		for (int z = 0; z < count[2]; ++z)
			for (int y = 0; y < count[1]; ++y)
				for (int x = 0; x < count[0]; ++x) {
					const Vector3r part((x + 0.5) / count[0], (y + 0.5) / count[1], (z + 0.5) / count[2]);
					centres.emplace_back(low + part.cwiseProduct(high - low));
				}
		return numpyArray(centres, "f8", 3);
	});
}

} // namespace yade
