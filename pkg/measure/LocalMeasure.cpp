// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "LocalMeasure.hpp"

#include "NumpyArray.hpp"

#include "base/GatherBodies.hpp"
#include "base/NamedFields.hpp"
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
	if (!soil->membrane)
		hexmembrane::reject("LocalMeasure.soil", string("SoilMeasure(wall=" + std::to_string(soil->wall) + ")"), "has no membrane",
		                    "a soil in a HexMembrane");
}

LocalMeasure::Instant LocalMeasure::look(const Scene& scene) const
{
	requireSoil(scene);
	const HexMembrane& membrane = *soil->membrane;
	Instant now;
	const vector<char> grain = soil->grainsOf(scene);
	for (size_t id = 0; id < grain.size(); ++id) {
		if (!grain[id]) continue;
		now.ids.push_back(static_cast<Body::id_t>(id));
		now.grains.push_back(siteOf(scene, now.ids.back()));
	}
	hexmembrane::Enclosure enclosure;
	membrane.gather(scene, "LocalMeasure.soil", enclosure.centres);
	enclosure.radius = membrane.sphereRadius;
	enclosure.inner = now.inner = membrane.innerPoints(enclosure.centres);
	enclosure.triangles = membrane.triangleList();
	now.faces = soil->faces(scene);
	enclosure.bottom = now.faces[0];
	enclosure.top = now.faces[1];
	now.cells = named("LocalMeasure", {{"grains", "soil"}, {"triangles", "soil.membrane: particle"}},
	                  [&] { return std::make_shared<const hexmembrane::PowerCells>(now.grains, enclosure); });
	return now;
}

void LocalMeasure::setReference() { reference = std::make_shared<const Instant>(look(currentScene())); }

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
	return values;
}

boost::python::object LocalMeasure::triangulation(const vector<Body::id_t>& ids)
{
	vector<hexmembrane::PowerSite> sites;
	for (Body::id_t id : ids) sites.push_back(siteOf(currentScene(), id));
	return numpyArray(hexmembrane::triangulate(sites, static_cast<int>(sites.size())).tetrahedra, "i4", 4);
}

} // namespace yade
