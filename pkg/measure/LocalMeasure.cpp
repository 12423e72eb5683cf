// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "LocalMeasure.hpp"

#include "NumpyArray.hpp"

#include "base/GatherBodies.hpp"
#include "base/NamedFields.hpp"
#include "boundary/CylinderWall.hpp"
#include "kernels/measure/LocalStrain.hpp"
#include "membrane/BodyView.hpp"

#include <pkg/common/Sphere.hpp>

namespace yade {

YADE_PLUGIN((LocalMeasure));

namespace {

boost::python::object tensors(const vector<Matrix3r>& each, const vector<Real>& divisors)
{
	vector<Matrix3r> quotients;
	for (size_t g = 0; g < each.size(); ++g) quotients.push_back(each[g] / (divisors[g] > 0 ? divisors[g] : NaN));
	return numpyTensors(quotients);
}

// Distance of the points that a wall is taken for, in radii of the smallest grain: as the membrane's particles by default.
constexpr Real wallSpacing = 1.6;

hexmembrane::PowerSite siteOf(const Scene& scene, Body::id_t id)
{
	const Body* body = livingBody(*scene.bodies, id);
	const auto* sphere = body ? dynamic_cast<const Sphere*>(body->shape.get()) : nullptr;
	if (!sphere)
		throw std::runtime_error("LocalMeasure.triangulation: ids = " + std::to_string(id) + ": there is no such sphere; fix: give the ids of spheres");
	return {body->state->pos, sphere->radius};
}

} // namespace

void LocalMeasure::requireSoil(const Scene& scene) const
{
	if (!soil) hexmembrane::reject("LocalMeasure.soil", string("None"), "what the grains are in is not known", "soil=SoilMeasure(membrane=...)");
	soil->require(scene, "LocalMeasure.soil");
}

LocalMeasure::Places LocalMeasure::placesNow(const Scene& scene) const
{
	requireSoil(scene);
	Places now;
	const vector<char> grain = soil->grainsOf(scene);
	Real smallest = std::numeric_limits<Real>::infinity();
	for (size_t id = 0; id < grain.size(); ++id) {
		if (!grain[id]) continue;
		now.ids.push_back(static_cast<Body::id_t>(id));
		now.grains.push_back(siteOf(scene, now.ids.back()));
		smallest = std::min(smallest, now.grains.back().radius);
	}
	now.faces = soil->faces(scene);
	if (soil->membrane) {
		soil->membrane->gather(scene, "LocalMeasure.soil", now.sheet);
		return now;
	}
	const Body& wall = *(*scene.bodies)[soil->wall];
	now.axis = wall.state->pos;
	now.wallRadius = static_cast<const CylinderWall&>(*wall.shape).radius;
	// points of two states are the same ones
	now.lattice = reference && reference->lattice.around > 0
	                      ? reference->lattice
	                      : hexmembrane::cylinderLattice(now.wallRadius, now.faces[1] - now.faces[0], wallSpacing * smallest);
	return now;
}

LocalMeasure::Instant LocalMeasure::with(Places places) const
{
	Instant made;
	static_cast<Places&>(made) = std::move(places);
	hexmembrane::Enclosure enclosure;
	if (soil->membrane) {
		enclosure.centres = made.sheet;
		enclosure.radius = soil->membrane->sphereRadius;
		enclosure.inner = soil->membrane->innerPoints(made.sheet);
		enclosure.triangles = soil->membrane->triangleList();
		enclosure.bottom = made.faces[0];
		enclosure.top = made.faces[1];
	} else
		enclosure = hexmembrane::cylinderTube(made.axis, made.wallRadius, made.faces[0], made.faces[1], made.lattice);
	made.cells = named("LocalMeasure", {{"grains", "soil"}, {"triangles", "soil.membrane: particle"}},
	                   [&] { return std::make_shared<const hexmembrane::PowerCells>(made.grains, enclosure); });
	made.inner = std::move(enclosure.inner);
	made.triangles = std::move(enclosure.triangles);
	return made;
}

LocalMeasure::Places LocalMeasure::placesFrom(const Scene& scene, const boost::python::dict& given) const
{
	const auto numbers = [&](const char* name, int columns = 0) {
		if (!given.has_key(name))
			hexmembrane::reject(string("LocalMeasure.setReference: places['") + name + "']", string("None"), "is missing",
			                    "a value of LocalMeasure.reference");
		return numbersOf(given[name], string("LocalMeasure.setReference: places['") + name + "']", columns);
	};
	const auto vectors = [&](const char* name) {
		vector<Vector3r> found;
		const vector<Real> rows = numbers(name, 3);
		for (size_t i = 0; i < rows.size(); i += 3) found.emplace_back(rows[i], rows[i + 1], rows[i + 2]);
		return found;
	};
	Places then = placesNow(scene);
	const vector<Real> ids = numbers("ids"), faces = numbers("faces"), wall = numbers("wall");
	const vector<Vector3r> centres = vectors("centres"), sheet = vectors("sheet");
	if (centres.size() != then.ids.size() || !std::equal(ids.begin(), ids.end(), then.ids.begin(), then.ids.end()) || sheet.size() != then.sheet.size() ||
	    faces.size() != 2 || wall.size() != (soil->membrane ? 0 : 5))
		throw std::runtime_error(
		        "LocalMeasure.setReference: places are not of this scene's grains and lateral boundary; fix: give those of the same test");
	for (size_t g = 0; g < centres.size(); ++g) then.grains[g].centre = centres[g];
	then.faces = {faces[0], faces[1]};
	then.sheet = sheet;
	if (!soil->membrane) {
		then.axis = Vector3r(wall[0], wall[1], 0);
		then.wallRadius = wall[2];
		then.lattice = {static_cast<int>(wall[3]), static_cast<int>(wall[4])};
	}
	return then;
}

void LocalMeasure::setReference(const boost::python::object& places)
{
	const Scene& scene = currentScene();
	const bool before = !places.is_none();
	reference = std::make_shared<const Instant>(with(before ? placesFrom(scene, boost::python::extract<boost::python::dict>(places)) : placesNow(scene)));
}

boost::python::object LocalMeasure::reference_get() const
{
	if (!reference) return {};
	vector<Vector3r> centres;
	for (const auto& grain : reference->grains) centres.push_back(grain.centre);
	vector<Real> wall;
	if (reference->lattice.around > 0)
		wall = {reference->axis[0], reference->axis[1], reference->wallRadius, Real(reference->lattice.around), Real(reference->lattice.rows)};
	boost::python::dict values;
	values["ids"] = numpyArray(reference->ids, "i4");
	values["centres"] = numpyArray(centres, "f8", 3);
	values["faces"] = numpyArray(vector<Real>(reference->faces.begin(), reference->faces.end()), "f8");
	values["sheet"] = numpyArray(reference->sheet, "f8", 3);
	values["wall"] = numpyArray(wall, "f8");
	return values;
}

vector<Matrix3r> LocalMeasure::stresses(const Scene& scene, const Instant& now) const
{
	vector<int> row(scene.bodies->size(), -1);
	for (size_t g = 0; g < now.ids.size(); ++g) row[now.ids[g]] = static_cast<int>(g);
	vector<Matrix3r> sums(now.ids.size(), Matrix3r::Zero());
	// each grain has the part of the branch on its side of the contact point
	forEachContactOf(scene, "LocalMeasure", [&](const TouchingContact& c) {
		if (row[c.id1] >= 0) sums[row[c.id1]] += c.force * (c.point - c.centre1).transpose();
		if (row[c.id2] >= 0) sums[row[c.id2]] += c.force * (c.centre2 - c.point).transpose();
	});
	return sums;
}

void LocalMeasure::addStrain(const Instant& now, boost::python::dict& values) const
{
	const Instant& before = *reference;
	if (before.ids != now.ids || before.inner.size() != now.inner.size())
		throw std::runtime_error("LocalMeasure.measure: the grains are not those of the reference state (" + std::to_string(now.ids.size()) + ", not " +
		                         std::to_string(before.ids.size()) + "); fix: call setReference() after bodies are added or erased");
	vector<Vector3r> x, u, sheet;
	for (size_t g = 0; g < now.ids.size(); ++g) {
		x.push_back(before.grains[g].centre);
		u.push_back(now.grains[g].centre - x.back());
	}
	for (size_t i = 0; i < now.inner.size(); ++i) sheet.push_back(now.inner[i] - before.inner[i]);
	const auto& cells = *before.cells;
	const auto gradients = cells.gradients(u, sheet, now.faces[0] - before.faces[0], now.faces[1] - before.faces[1]);
	vector<Real> volumetric, deviatoric;
	vector<Vector3r> rotation;
	for (size_t g = 0; g < gradients.size(); ++g) {
		const Real volume = cells.volumes()[g];
		const auto found = hexmembrane::invariantsOf(gradients[g] / (volume > 0 ? volume : NaN));
		volumetric.push_back(found.volumetric);
		deviatoric.push_back(found.deviatoric);
		rotation.push_back(found.rotation);
	}
	values["referenceVolume"] = numpyArray(cells.volumes(), "f8");
	values["gradient"] = tensors(gradients, cells.volumes());
	values["volumetric"] = numpyArray(volumetric, "f8");
	values["deviatoric"] = numpyArray(deviatoric, "f8");
	values["rotation"] = numpyArray(rotation, "f8", 3);
	values["nonAffine"] = numpyArray(hexmembrane::nonAffine(x, u, cells.starts(), cells.neighbours()), "f8");
}

boost::python::dict LocalMeasure::measure(bool advance)
{
	const Scene& scene = currentScene();
	Instant now = look(scene);
	const auto& volumes = now.cells->volumes();
	vector<Real> voidRatios;
	for (size_t g = 0; g < volumes.size(); ++g) voidRatios.push_back(volumes[g] / (4 / 3. * M_PI * std::pow(now.grains[g].radius, 3)) - 1);
	boost::python::dict values;
	values["ids"] = numpyArray(now.ids, "i4");
	values["volume"] = numpyArray(volumes, "f8");
	values["voidRatio"] = numpyArray(voidRatios, "f8");
	values["stress"] = tensors(stresses(scene, now), volumes);
	if (reference) addStrain(now, values);
	if (advance) reference = std::make_shared<const Instant>(std::move(now));
	return values;
}

boost::python::dict LocalMeasure::mesh() const
{
	const Instant now = look(currentScene());
	const auto& cells = *now.cells;
	vector<std::array<int, 4>> tetrahedra;
	vector<int> times;
	for (const auto& t : cells.tetrahedra()) {
		tetrahedra.push_back(t.corners);
		times.push_back(t.times);
	}
	boost::python::dict values;
	values["corners"] = numpyArray(cells.corners(), "f8", 3);
	values["tetrahedra"] = numpyArray(tetrahedra, "i4", 4);
	values["times"] = numpyArray(times, "i4");
	values["feet"] = numpyArray(cells.feet(), "i4");
	vector<std::array<int, 3>> triangles = now.triangles;
	for (auto& t : triangles)
		for (int& corner : t) corner += static_cast<int>(now.grains.size());
	values["triangles"] = numpyArray(triangles, "i4", 3);
	return values;
}

boost::python::object LocalMeasure::triangulation(const vector<Body::id_t>& ids)
{
	vector<hexmembrane::PowerSite> sites;
	for (Body::id_t id : ids) sites.push_back(siteOf(currentScene(), id));
	return numpyArray(hexmembrane::triangulate(sites, static_cast<int>(sites.size())).tetrahedra, "i4", 4);
}

} // namespace yade
