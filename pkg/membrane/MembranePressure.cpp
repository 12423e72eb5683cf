// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembranePressure.hpp"

#include "Scatter.hpp"
#include "kernels/Check.hpp"

namespace yade {

YADE_PLUGIN((MembranePressure));

void MembranePressure::prepareMembrane()
{
	membrane->requireGenerated("MembranePressure");
	vertexIds = membrane->ids;
	loaded.clear();
	// all triangles of the rings that group 3 touches, and those of one ring more, so that vertex normals on its border are whole
	const auto tube = membrane->stencil();
	vector<std::array<int, 3>> list;
	const auto isMain = [&](int k) { return k >= 0 && k < membrane->rings && membrane->groupOfRing(k) == 3; };
	for (int k = 0; k + 1 < membrane->rings; ++k)
		if (isMain(k - 1) || isMain(k) || isMain(k + 1) || isMain(k + 2)) hexmembrane::appendTriangles(tube, k, list);
	for (int k = 0; k < membrane->rings; ++k)
		for (int i = 0; isMain(k) && i < membrane->perRing; ++i) loaded.push_back(tube.at(k, i));
	const Real offset = surface == "centre" ? 0. : math::isnan(surfaceOffset) ? membrane->sphereRadius : surfaceOffset;
	kernel = hexmembrane::PressureForce(hexmembrane::TriangleMesh(tube.particles(), std::move(list)), offset);
}

void MembranePressure::prepareMesh()
{
	if (surface == "inner" && math::isnan(surfaceOffset))
		hexmembrane::reject("MembranePressure.surfaceOffset", surfaceOffset,
		                    "the 'inner' surface of a mesh of your own has no known distance from the centres",
		                    "surfaceOffset in m, or surface='centre'");
	vector<std::array<int, 3>> list;
	for (const auto& t : triangles) list.push_back({t[0], t[1], t[2]});
	kernel = hexmembrane::PressureForce(hexmembrane::TriangleMesh(static_cast<int>(ids.size()), std::move(list)), surface == "centre" ? 0. : surfaceOffset);
	vertexIds = ids;
	loaded.resize(ids.size());
	for (size_t i = 0; i < ids.size(); ++i) loaded[i] = static_cast<int>(i);
}

void MembranePressure::prepare()
{
	hexmembrane::requireFinite("MembranePressure.pressure", pressure, "Pa");
	const bool sameOffset = builtOffset == surfaceOffset || (math::isnan(builtOffset) && math::isnan(surfaceOffset));
	if (!vertexIds.empty() && builtFor == membrane.get() && builtSurface == surface && sameOffset && builtIds == ids && builtTriangles == triangles) return;

	if (surface != "inner" && surface != "centre") hexmembrane::reject("MembranePressure.surface", "'" + surface + "'", "unknown", "'inner' or 'centre'");
	const bool mesh = !ids.empty() || !triangles.empty();
	if (static_cast<bool>(membrane) == mesh)
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

void MembranePressure::action()
{
	prepare();
	const int count = static_cast<int>(vertexIds.size());
	const auto& bodies = *scene->bodies;
	int missing = -1, bad = -1;
	positions.resize(count);
#pragma omp parallel for schedule(static) reduction(max : missing)
	for (int i = 0; i < count; ++i) {
		prefetchAhead(bodies, vertexIds, i);
		const Body* b = livingBody(bodies, vertexIds[i]);
		if (b)
			positions[i] = b->state->se3.position;
		else
			missing = std::max(missing, i);
	}
	if (missing >= 0)
		throw std::runtime_error("MembranePressure: body " + std::to_string(vertexIds[missing]) + " of the loaded surface is gone (iteration " +
		                         std::to_string(scene->iter) + "); fix: do not erase it, or load the last checkpoint");

	kernel.compute(pressure, positions, force);

	// forces out, and the work since the last step by the trapezoidal rule, in one sweep
	const int loadedCount = static_cast<int>(loaded.size());
	const bool continued = static_cast<int>(lastForces.size()) == loadedCount && static_cast<int>(lastPositions.size()) == loadedCount;
	lastForces.resize(loadedCount, Vector3r::Zero());
	lastPositions.resize(loadedCount, Vector3r::Zero());
	Real done = 0;
#pragma omp parallel for schedule(static) reduction(max : bad) reduction(+ : done)
	for (int l = 0; l < loadedCount; ++l) {
		const int v = loaded[l];
		if (!isFinite(force[v])) bad = std::max(bad, v);
		scene->forces.addForce(vertexIds[v], force[v]);
		done += 0.5 * (lastForces[l] + force[v]).dot(positions[v] - lastPositions[l]);
		lastForces[l] = force[v];
		lastPositions[l] = positions[v];
	}
	if (bad >= 0) throwNotFinite("MembranePressure: force", vertexIds[bad], *scene);
	if (continued) work += done;
	if (scene->trackEnergy) scene->energy->add(-work, "pressureWork", energyIndex, /*reset*/ true);
}

void MembranePressure::requireStepped(const char* what) const
{
	if (force.empty()) throw std::runtime_error(string("MembranePressure.") + what + ": nothing computed yet; fix: run a step first");
}

Real MembranePressure::area() const
{
	requireStepped("area");
	vector<Real> perVertex;
	kernel.vertexAreas(perVertex);
	Real sum = 0;
	for (int v : loaded) sum += perVertex[v];
	return sum;
}

Vector3r MembranePressure::resultant() const
{
	requireStepped("resultant");
	Vector3r sum = Vector3r::Zero();
	for (int v : loaded) sum += force[v];
	return sum;
}

vector<Vector3r> MembranePressure::forces() const
{
	requireStepped("forces");
	vector<Vector3r> applied(force.size(), Vector3r::Zero());
	for (int v : loaded) applied[v] = force[v];
	return applied;
}

} // namespace yade
