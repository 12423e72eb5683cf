// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembranePressure.hpp"

#include "base/GatherBodies.hpp"
#include "base/NamedFields.hpp"

namespace yade {

YADE_PLUGIN((MembranePressure));

void MembranePressure::prepareMembrane()
{
	membrane->requireGenerated("MembranePressure");
	vertexIds = membrane->ids;
	loaded.clear();
	int first = membrane->rings, last = -1;
	for (int k = 0; k < membrane->rings; ++k) {
		if (membrane->groupOfRing(k) != 3) continue;
		first = std::min(first, k);
		last = k;
		for (int i = 0; i < membrane->perRing; ++i) loaded.push_back(k * membrane->perRing + i);
	}
	const Real offset = surface == "centre" ? 0. : math::isnan(surfaceOffset) ? membrane->sphereRadius : surfaceOffset;
	named("MembranePressure", {{"offset", "surfaceOffset"}}, [&] { tube.reset(new hexmembrane::TubePressure(membrane->stencil(), first, last, offset)); });
}

void MembranePressure::prepareMesh()
{
	if (surface == "inner" && math::isnan(surfaceOffset))
		hexmembrane::reject("MembranePressure.surfaceOffset", surfaceOffset,
		                    "the 'inner' surface of a mesh of your own has no known distance from the centres",
		                    "surfaceOffset in m, or surface='centre'");
	vector<std::array<int, 3>> list;
	for (const auto& t : triangles) list.push_back({t[0], t[1], t[2]});
	named("MembranePressure", {{"offset", "surfaceOffset"}}, [&] {
		hexmembrane::TriangleMesh surfaceMesh(static_cast<int>(ids.size()), std::move(list));
		mesh = hexmembrane::PressureForce(std::move(surfaceMesh), surface == "centre" ? 0. : surfaceOffset);
	});
	tube.reset();
	vertexIds = ids;
	loaded.resize(ids.size());
	for (size_t i = 0; i < ids.size(); ++i) loaded[i] = static_cast<int>(i);
}

void MembranePressure::prepare()
{
	hexmembrane::requireFinite("MembranePressure.pressure", pressure, "Pa");
	hexmembrane::requireNonNegative("MembranePressure.rampTime", rampTime, "s");
	loop().require(scene->dt);
	if (loop().closed()) {
		if (!membrane)
			hexmembrane::reject("MembranePressure.timeConstant", timeConstant,
			                    "a mesh of your own has no transmitted pressure to close the loop with", "inf");
		if (!(maxFactor > 1) || !math::isfinite(maxFactor))
			hexmembrane::reject("MembranePressure.maxFactor", maxFactor, "leaves no room for corrections", "a number above 1");
	}
	const bool sameOffset = builtOffset == surfaceOffset || (math::isnan(builtOffset) && math::isnan(surfaceOffset));
	if (!vertexIds.empty() && builtFor == membrane.get() && builtSurface == surface && sameOffset && builtIds == ids && builtTriangles == triangles) return;

	hexmembrane::requireOneOf(hexmembrane::shared::pressure_surface, "MembranePressure.surface", surface);
	const bool ofMesh = !ids.empty() || !triangles.empty();
	if (static_cast<bool>(membrane) == ofMesh)
		hexmembrane::reject("MembranePressure.membrane", string(membrane ? "given together with ids or triangles" : "None"),
		                    "what to press on is not clear", "either membrane=HexMembrane(...), or ids and triangles");
	if (membrane)
		prepareMembrane();
	else
		prepareMesh();
	builtFor = membrane.get();
	builtSurface = surface;
	builtOffset = surfaceOffset;
	builtIds = ids;
	builtTriangles = triangles;
}

PressureLoop MembranePressure::loop() { return {"MembranePressure", timeConstant, 1 / maxFactor, maxFactor, factor, transmitted, saturated, lastCorrection}; }

void MembranePressure::requireCompactScene() const
{
	if (!membrane) throw std::runtime_error("MembranePressure: a mesh of your own is not stepped in the compact tier; fix: use the reference tier");
}

void MembranePressure::action() { stepOverBodies(*this); }

void MembranePressure::step(StepView& view)
{
	followPressure(pressure, rampTime, scene->dt, rampTarget, ramps);
	if (!tube) return stepMesh();
	loop().close(*scene, ramped(), [&] { return membrane->transmitted(view, 3, "MembranePressure"); });
	tube->compute(applied(), view.positions(*membrane));
	view.addForces(*membrane, {{tube->firstRing(), tube->lastRing()}}, tube->force, nullptr, meter.get());
}

void MembranePressure::stepMesh()
{
	const int count = static_cast<int>(vertexIds.size());
	positions.resize(count);
	const int missing = forEachState(*scene->bodies, vertexIds, [&](int i, const State& state) { positions[i] = state.se3.position; });
	if (missing >= 0)
		throw std::runtime_error("MembranePressure: body " + std::to_string(vertexIds[missing]) + " of the loaded surface is gone (iteration " +
		                         std::to_string(scene->iter) + "); fix: do not erase it, or load the last checkpoint");
	mesh.compute(ramped(), positions, force);
	for (int i = 0; i < count; ++i) {
		if (!isFinite(force[i])) throwNotFinite("MembranePressure: force", vertexIds[i], *scene);
		scene->forces.addForce(vertexIds[i], force[i]);
	}
	vector<Vector3r> f(force), x(positions);
	meter->add(scene->iter, f, x);
}

void MembranePressure::bookWorks() { meter->book(*scene, "pressureWork"); }

Vector3r MembranePressure::forceOn(int v) const { return tube ? tube->force.get(v / membrane->perRing, v % membrane->perRing) : force[v]; }

void MembranePressure::requireStepped(const char* what) const
{
	if (force.empty() && !tube) throw std::runtime_error(string("MembranePressure.") + what + ": nothing computed yet; fix: run a step first");
}

Real MembranePressure::area() const
{
	requireStepped("area");
	if (tube) return tube->area();
	vector<Real> perVertex;
	mesh.vertexAreas(perVertex);
	Real sum = 0;
	for (int v : loaded) sum += perVertex[v];
	return sum;
}

Vector3r MembranePressure::resultant() const
{
	requireStepped("resultant");
	Vector3r sum = Vector3r::Zero();
	for (int v : loaded) sum += forceOn(v);
	return sum;
}

vector<Vector3r> MembranePressure::forces() const
{
	requireStepped("forces");
	vector<Vector3r> applied(vertexIds.size(), Vector3r::Zero());
	for (int v : loaded) applied[v] = forceOn(v);
	return applied;
}

Real MembranePressure::axialPush(Real z) const
{
	requireStepped("axialPush");
	hexmembrane::requireFinite("MembranePressure.axialPush: z", z, "m");
	const auto& bodies = *Omega::instance().getScene()->bodies;
	Real push = 0;
	for (int v : loaded) push += (bodies[vertexIds[v]]->state->pos.z() < z ? 0.5 : -0.5) * forceOn(v).z();
	return push;
}

} // namespace yade
