// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "BodyArrays.hpp"

#include "NumpyArray.hpp"
#include "base/GatherBodies.hpp"

#include <core/Scene.hpp>
#include <pkg/common/Sphere.hpp>

namespace yade {

YADE_PLUGIN((BodyArrays));

namespace {

// Calls take(i, body) for each id, in their order.
template <typename Take>
void forEachBody(const vector<Body::id_t>& ids, Take&& take)
{
	const auto& bodies = *currentScene().bodies;
	for (size_t i = 0; i < ids.size(); ++i) {
		prefetchAhead(bodies, ids, i);
		Body* body = bodies.exists(ids[i]) ? bodies[ids[i]].get() : nullptr;
		if (!body) throw std::runtime_error("BodyArrays.ids = " + std::to_string(ids[i]) + ": there is no such body; fix: leave it out");
		take(i, *body);
	}
}

template <typename Value>
boost::python::object vectors(const vector<Body::id_t>& ids, Value&& value)
{
	vector<Vector3r> rows(ids.size());
	forEachBody(ids, [&](size_t i, const Body& body) { rows[i] = value(body); });
	return numpyArray(rows, "f8", 3);
}

template <typename Value>
boost::python::object numbers(const vector<Body::id_t>& ids, Value&& value)
{
	vector<Real> row(ids.size());
	forEachBody(ids, [&](size_t i, const Body& body) { row[i] = value(body); });
	return numpyArray(row, "f8");
}

} // namespace

boost::python::object BodyArrays::positions(const vector<Body::id_t>& ids)
{
	return vectors(ids, [](const Body& body) { return body.state->pos; });
}

boost::python::object BodyArrays::displacements(const vector<Body::id_t>& ids)
{
	return vectors(ids, [](const Body& body) { return Vector3r(body.state->pos - body.state->refPos); });
}

boost::python::object BodyArrays::velocities(const vector<Body::id_t>& ids)
{
	return vectors(ids, [](const Body& body) { return body.state->vel; });
}

boost::python::object BodyArrays::forces(const vector<Body::id_t>& ids)
{
	auto& all = currentScene().forces;
	all.sync();
	return vectors(ids, [&](const Body& body) { return all.getForce(body.getId()); });
}

boost::python::object BodyArrays::radii(const vector<Body::id_t>& ids)
{
	return numbers(ids, [](const Body& body) {
		const auto* sphere = dynamic_cast<const Sphere*>(body.shape.get());
		if (!sphere) throw std::runtime_error("BodyArrays.ids = " + std::to_string(body.getId()) + ": the body is no Sphere; fix: leave it out");
		return sphere->radius;
	});
}

boost::python::object BodyArrays::masses(const vector<Body::id_t>& ids)
{
	return numbers(ids, [](const Body& body) { return body.state->mass; });
}

void BodyArrays::setReference()
{
	for (const auto& body : *currentScene().bodies) {
		if (!body) continue;
		body->state->refPos = body->state->pos;
		body->state->refOri = body->state->ori;
	}
}

} // namespace yade
