// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "HexMembrane.hpp"

#include "base/GatherBodies.hpp"
#include "base/NamedFields.hpp"
#include "compact/Stepped.hpp"
#include "kernels/membrane/MembraneTension.hpp"
#include "kernels/membrane/PressureForce.hpp"
#include "kernels/membrane/RadialForce.hpp"
#include "kernels/membrane/TubeInside.hpp"

#include <core/InteractionContainer.hpp>
#include <pkg/common/NormShearPhys.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/ScGeom.hpp>

namespace yade {

YADE_PLUGIN((HexMembrane));
CREATE_LOGGER(HexMembrane);

static_assert(std::is_same<Vector3r, hexmembrane::Vec3>::value, "the kernels work in double precision: build against yade-double");

namespace {

bool innerFromName(const string& surface)
{
	hexmembrane::requireOneOf(hexmembrane::shared::pressure_surface, "HexMembrane: surface", surface);
	return surface == "inner";
}

hexmembrane::Placement placementFromName(const string& placement)
{
	hexmembrane::requireOneOf(hexmembrane::shared::placement, "HexMembrane.placement", placement);
	return placement == "outside" ? hexmembrane::Placement::outside : hexmembrane::Placement::centred;
}

} // namespace

hexmembrane::HexLatticeSpec HexMembrane::spec() const
{
	return {specimenRadius, specimenHeight, particleRadius, placementFromName(placement), oRingRows, platenRows};
}

void HexMembrane::checkGrain(Real radius) const
{
	if (math::isnan(smallestGrain)) return;
	hexmembrane::requirePositive("HexMembrane.smallestGrain", smallestGrain, "m");
	const Real largest = hexmembrane::largestMembraneRadius(smallestGrain);
	if (radius <= largest) return;
	const string wrong = "too coarse for grains of radius " + hexmembrane::formatNumber(smallestGrain) + " m, they pass between three spheres (Eq. 1)";
	const string fix = "at most " + hexmembrane::formatNumber(largest) + " m, or allowCoarse=True";
	if (!allowCoarse) hexmembrane::reject("HexMembrane.particleRadius", radius, wrong, fix);
	LOG_WARN("HexMembrane.particleRadius = " << radius << ": " << wrong << "; allowed by allowCoarse (limit " << largest << " m)");
}

vector<Body::id_t> HexMembrane::generate()
{
	if (!ids.empty())
		hexmembrane::reject("HexMembrane.ids", static_cast<int>(ids.size()), "the membrane has been generated already",
		                    "make a new HexMembrane for a second one");
	const hexmembrane::HexLattice lattice = named("HexMembrane", {}, [this] { return hexmembrane::makeHexLattice(spec()); });
	checkGrain(lattice.sphereRadius);
	for (int a = 0; a < 3; ++a) hexmembrane::requireFinite("HexMembrane.origin", origin[a], "m");
	const shared_ptr<Scene>& scene = Omega::instance().getScene();
	if (!material) {
		if (scene->materials.empty())
			hexmembrane::reject("HexMembrane.material", string("None"), "the scene has no material to take",
			                    "O.materials.append(FrictMat(frictionAngle=0)) first, or give one");
		material = scene->materials.back();
	}
	const Real rho = math::isnan(density) ? material->density : density;
	hexmembrane::requirePositive("HexMembrane.density", rho, "kg/m3");

	const Real r = lattice.sphereRadius, mass = rho * 4. / 3 * M_PI * r * r * r;
	for (int p = 0; p < lattice.particles(); ++p) {
		shared_ptr<Sphere> sphere(new Sphere);
		sphere->radius = r;
		sphere->color = color;
		shared_ptr<Body> particle(new Body);
		particle->shape = sphere;
		particle->material = material;
		particle->groupMask = mask;
		particle->state = material->newAssocState();
		particle->state->pos = particle->state->refPos = origin + lattice.positions[p];
		particle->state->mass = mass;
		particle->state->inertia = Vector3r::Constant(.4 * mass * r * r);
		if (lattice.groups[p] == 1)
			particle->state->blockedDOFs = State::DOF_ALL;
		else if (!rotations)
			particle->state->blockedDOFs = State::DOF_RXRYRZ;
		ids.push_back(scene->bodies->insert(particle));
	}
	perRing = lattice.perRing;
	rings = lattice.rings;
	sphereRadius = r;
	centreRadius = lattice.centreRadius;
	innerRadius = lattice.innerRadius;
	ringSpacing = lattice.ringSpacing;
	return ids;
}

void HexMembrane::requireGenerated(const string& who) const
{
	if (ids.empty()) throw std::runtime_error(who + ": the membrane has no particles; fix: call its generate() first");
}

int HexMembrane::groupOfRing(int k) const
{
	const int fromEnd = std::min(k, rings - 1 - k);
	return fromEnd < oRingRows ? 1 : fromEnd < oRingRows + platenRows ? 2 : 3;
}

const shared_ptr<Body>& HexMembrane::body(const Scene& scene, int index, const string& who) const
{
	const Body::id_t id = ids[index];
	if (id >= static_cast<Body::id_t>(scene.bodies->size()) || !(*scene.bodies)[id])
		throw std::runtime_error(who + ": body " + std::to_string(id) + " of the membrane is gone (iteration " + std::to_string(scene.iter) +
		                         "); fix: do not erase membrane bodies, or load the last checkpoint");
	return (*scene.bodies)[id];
}

void HexMembrane::gather(const Scene& scene, const string& who, vector<Vector3r>& x) const
{
	requireGenerated(who);
	x.resize(ids.size());
	const int missing = forEachState(*scene.bodies, ids, [&](int i, const State& state) { x[i] = state.se3.position; });
	if (missing >= 0) body(scene, missing, who); // throws
}

void HexMembrane::gather(const Scene& scene, const string& who, hexmembrane::PaddedRings& x) const
{
	requireGenerated(who);
	if (!x.fits(perRing, rings)) x = hexmembrane::PaddedRings(perRing, rings);
	const int missing = forEachState(*scene.bodies, ids, [&](int i, const State& state) { x.set(i / perRing, i % perRing, state.se3.position); });
	if (missing >= 0) body(scene, missing, who); // throws
	for (int k = 0; k < rings; ++k) x.wrap(k);
}

vector<std::array<int, 3>> HexMembrane::triangleList() const
{
	vector<std::array<int, 3>> list;
	const auto tube = stencil();
	list.reserve(2 * perRing * (rings - 1));
	for (int k = 0; k + 1 < rings; ++k) hexmembrane::appendTriangles(tube, k, list);
	return list;
}

vector<int> HexMembrane::groups_get() const
{
	requireGenerated("HexMembrane.groups");
	vector<int> g;
	for (int k = 0; k < rings; ++k) g.insert(g.end(), perRing, groupOfRing(k));
	return g;
}

vector<Vector3i> HexMembrane::triangles_get() const
{
	requireGenerated("HexMembrane.triangles");
	vector<Vector3i> out;
	for (const auto& t : triangleList()) out.emplace_back(t[0], t[1], t[2]);
	return out;
}

vector<Vector2i> HexMembrane::bonds_get() const
{
	requireGenerated("HexMembrane.bonds");
	vector<Vector2i> out;
	for (const auto& b : hexmembrane::bondList(stencil())) out.emplace_back(b[0], b[1]);
	return out;
}

vector<Vector3r> HexMembrane::positions_get() const
{
	vector<Vector3r> x;
	gather(currentScene(), "HexMembrane.positions", x);
	return x;
}

vector<Vector3r> HexMembrane::surfacePoints(const string& surface, vector<Vector3r> x) const
{
	if (!innerFromName(surface)) return x;
	hexmembrane::PressureForce mesh(hexmembrane::TriangleMesh(static_cast<int>(x.size()), triangleList()), 0.);
	vector<Vector3r> unused, normals;
	mesh.compute(0., x, unused);
	mesh.vertexNormals(normals);
	for (size_t i = 0; i < x.size(); ++i) x[i] -= sphereRadius * normals[i];
	return x;
}

hexmembrane::TubeSlab HexMembrane::slab(const string& surface, const vector<Vector3r>& centres, Real zBottom, Real zTop, const char* argument) const
{
	constexpr Real inf = std::numeric_limits<Real>::infinity();
	const vector<Vector3r> x = surfacePoints(surface, centres);
	const Real low = math::isnan(zBottom) ? -inf : zBottom, high = math::isnan(zTop) ? inf : zTop;
	return named("HexMembrane", {{"zBottom", argument}}, [&] { return hexmembrane::measureTube(triangleList(), x, {low, high})[0]; });
}

Real HexMembrane::surfaceArea(const string& surface, Real zBottom, Real zTop) const
{
	return slab(surface, positions_get(), zBottom, zTop, "surfaceArea: zBottom").area;
}

Real HexMembrane::enclosedVolume(Real zBottom, Real zTop, const string& surface) const
{
	return slab(surface, positions_get(), zBottom, zTop, "enclosedVolume: zBottom").volume;
}

vector<Real> HexMembrane::volumesBetween(const vector<Vector3r>& x, const vector<Real>& heights) const
{
	vector<Real> volumes;
	for (const auto& slab : hexmembrane::measureTube(triangleList(), surfacePoints("inner", x), heights)) volumes.push_back(slab.volume);
	return volumes;
}

vector<Body::id_t> HexMembrane::outside(const vector<Body::id_t>& bodies) const
{
	const vector<Vector3r> x = positions_get();
	const auto triangles = triangleList();
	const hexmembrane::TubeInside tube(perRing, triangles, x);
	vector<Body::id_t> found;
	for (Body::id_t id : bodies) {
		const Body* body = livingBody(*currentScene().bodies, id);
		if (!body) hexmembrane::reject("HexMembrane.outside: ids", int(id), "there is no such body", "ids of bodies of the scene");
		if (!tube.inside(body->state->pos)) found.push_back(id);
	}
	return found;
}

Real HexMembrane::meanRadius(Real zBottom, Real zTop, const string& surface) const
{
	const bool inner = innerFromName(surface);
	vector<Vector3r> x = positions_get();
	Real sum = 0;
	int count = 0;
	for (int k = 0; k < rings; ++k) {
		const auto shape = hexmembrane::ringShape(stencil(), x, k);
		if (shape.centre[2] < zBottom || shape.centre[2] > zTop) continue; // false for NaN
		sum += shape.radius;
		++count;
	}
	if (count == 0)
		throw std::runtime_error("HexMembrane.meanRadius: no ring between zBottom = " + hexmembrane::formatNumber(zBottom) +
		                         " and zTop = " + hexmembrane::formatNumber(zTop) + " m; fix: give the heights of the platens' faces");
	return sum / count - (inner ? sphereRadius : 0.);
}

vector<Vector3r> HexMembrane::contactForces(const Scene& scene, const string& who) const
{
	const std::set<Body::id_t> own(ids.begin(), ids.end());
	vector<Vector3r> forces(ids.size(), Vector3r::Zero());
	for (size_t i = 0; i < ids.size(); ++i)
		for (const auto& entry : body(scene, static_cast<int>(i), who)->intrs) {
			const Interaction& contact = *entry.second;
			if (!contact.isReal() || own.count(entry.first)) continue;
			const auto* phys = dynamic_cast<const NormPhys*>(contact.phys.get());
			if (!phys) continue;
			// YADE's laws apply +normalForce to the second body
			forces[i] += contact.getId1() == ids[i] ? Vector3r(-phys->normalForce) : phys->normalForce;
		}
	Stepped::forEachIn(scene, [&](const Stepped& engine) { engine.addContactForces(ids, forces); });
	return forces;
}

Real HexMembrane::groupPressure(int group, const vector<Vector3r>& x, const vector<Vector3r>& forces, const string& who) const
{
	if (group != 0 && group != 2 && group != 3)
		hexmembrane::reject(who + ": group", group, "no pressure is transmitted there", "0 (groups 2 and 3), 2 or 3");
	const auto loads = hexmembrane::ringLoads(stencil(), x, forces, sphereRadius);
	Real force = 0, area = 0;
	for (int k = 0; k < rings; ++k) {
		const int g = groupOfRing(k);
		if (g == 1 || (group != 0 && g != group)) continue;
		force += loads[k].force;
		area += loads[k].area;
	}
	if (area <= 0) throw std::runtime_error(who + ": group " + std::to_string(group) + " has no area; fix: platenRows > 0 when the membrane is generated");
	return force / area;
}

vector<Vector3r> HexMembrane::positionsIn(StepView& view) const
{
	const hexmembrane::PaddedRings& rows = view.positions(*this);
	vector<Vector3r> x;
	x.reserve(ids.size());
	for (int k = 0; k < rings; ++k)
		for (int i = 0; i < perRing; ++i) x.push_back(rows.get(k, i));
	return x;
}

Real HexMembrane::transmitted(StepView& view, int group, const string& who) const
{
	return groupPressure(group, positionsIn(view), pressing(view.contactForces(*this)), who);
}

// What the particles press on others, from what others press on them.
vector<Vector3r> HexMembrane::pressing(vector<Vector3r> onParticles)
{
	for (Vector3r& force : onParticles) force = -force;
	return onParticles;
}

vector<Vector3r> HexMembrane::pressingNow(const string& who) const
{
	requireGenerated(who);
	const ContactKeeper* keeper = ContactKeeper::in(currentScene());
	return pressing(keeper ? keeper->contactForces(*this) : contactForces(currentScene(), who));
}

Real HexMembrane::transmittedPressure(int group) const
{
	const string who = "HexMembrane.transmittedPressure";
	return groupPressure(group, positions_get(), pressingNow(who), who);
}

boost::python::dict HexMembrane::transmittedByGroup() const
{
	const string who = "HexMembrane.transmittedByGroup";
	const vector<Vector3r> forces = pressingNow(who), x = positions_get();
	boost::python::dict pressures;
	for (int group : {0, 2, 3})
		if (group != 2 || platenRows > 0) pressures[group] = groupPressure(group, x, forces, who);
	return pressures;
}

vector<Real> HexMembrane::transmittedByRing() const
{
	const string who = "HexMembrane.transmittedByRing";
	const vector<Vector3r> forces = pressingNow(who);
	vector<Real> pressures;
	for (const auto& load : hexmembrane::ringLoads(stencil(), positions_get(), forces, sphereRadius)) pressures.push_back(load.force / load.area);
	return pressures;
}

} // namespace yade
