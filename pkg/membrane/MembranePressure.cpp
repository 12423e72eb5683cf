// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembranePressure.hpp"

#include "GatherBodies.hpp"
#include "base/NamedFields.hpp"
#include "kernels/base/IntegralController.hpp"
#include "kernels/base/TrapezoidalWork.hpp"

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
	hexmembrane::requireNonNegative("MembranePressure.gain", gain, "1");
	if (gain > 0) {
		if (!membrane) hexmembrane::reject("MembranePressure.gain", gain, "a mesh of your own has no transmitted pressure to close the loop with", "0");
		if (iterPeriod < 1) hexmembrane::reject("MembranePressure.iterPeriod", iterPeriod, "must be at least one step", "500, say");
		if (!(maxFactor > 1) || !math::isfinite(maxFactor))
			hexmembrane::reject("MembranePressure.maxFactor", maxFactor, "leaves no room for corrections", "a number above 1");
	}
	const bool sameOffset = builtOffset == surfaceOffset || (math::isnan(builtOffset) && math::isnan(surfaceOffset));
	if (!vertexIds.empty() && builtFor == membrane.get() && builtSurface == surface && sameOffset && builtIds == ids && builtTriangles == triangles) return;

	if (surface != "inner" && surface != "centre") hexmembrane::reject("MembranePressure.surface", "'" + surface + "'", "unknown", "'inner' or 'centre'");
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

void MembranePressure::computeMesh()
{
	positions.resize(vertexIds.size());
	const int missing = forEachState(*scene->bodies, vertexIds, [this](int i, const State& state) { positions[i] = state.se3.position; });
	if (missing >= 0)
		throw std::runtime_error("MembranePressure: body " + std::to_string(vertexIds[missing]) + " of the loaded surface is gone (iteration " +
		                         std::to_string(scene->iter) + "); fix: do not erase it, or load the last checkpoint");
	mesh.compute(pressure, positions, force);
}

void MembranePressure::closeLoop(const std::function<Real()>& transmittedNow)
{
	if (!(gain > 0) || scene->iter % iterPeriod != 0) return;
	transmitted = transmittedNow();
	factor = hexmembrane::correctedFactor(factor, gain, pressure, transmitted, 1 / maxFactor, maxFactor, saturated);
}

void MembranePressure::action()
{
	prepare();
	if (tube) {
		closeLoop([this]() { return membrane->transmittedPressure(3); });
		membrane->gather(*scene, "MembranePressure", rows);
		tube->compute(applied(), rows);
	} else
		computeMesh();

	const int loadedCount = static_cast<int>(loaded.size());
	loadedForces.resize(loadedCount);
	loadedPositions.resize(loadedCount);
	int bad = -1;
#pragma omp parallel for schedule(static) reduction(max : bad)
	for (int l = 0; l < loadedCount; ++l) {
		const int v = loaded[l];
		loadedForces[l] = forceOn(v);
		loadedPositions[l] = positionOf(v);
		if (!isFinite(loadedForces[l])) bad = std::max(bad, v);
		scene->forces.addForce(vertexIds[v], loadedForces[l]);
	}
	if (bad >= 0) throwNotFinite("MembranePressure: force", vertexIds[bad], *scene);
	work += hexmembrane::WorkMeter{lastIter, lastForces, lastPositions}.record(scene->iter, loadedForces, loadedPositions);
	bookWork();
}

void MembranePressure::bookWork()
{
	if (scene->trackEnergy) scene->energy->add(-work, "pressureWork", energyIndex, /*reset*/ true);
}

Vector3r MembranePressure::forceOn(int v) const { return tube ? tube->force.get(v / membrane->perRing, v % membrane->perRing) : force[v]; }

Vector3r MembranePressure::positionOf(int v) const { return tube ? rows.get(v / membrane->perRing, v % membrane->perRing) : positions[v]; }

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

} // namespace yade
