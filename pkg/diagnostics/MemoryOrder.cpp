// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MemoryOrder.hpp"

#include "compact/BoundaryRegistry.hpp"
#include "kernels/base/CellGrid.hpp"

#include <core/InteractionContainer.hpp>
#include <lib/pyutil/gil.hpp>
#include <lib/serialization/ObjectIO.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <sstream>
#include <tuple>

namespace yade {

YADE_PLUGIN((MemoryOrder));

namespace {

// Objects of any class allocated anew, one after the other: through an archive, as O.save and O.load do it. What is shared within the list stays shared.
template <typename Object>
vector<shared_ptr<Object>> allocatedAnew(vector<shared_ptr<Object>> objects)
{
	std::stringstream memory(std::ios::in | std::ios::out | std::ios::binary);
	ObjectIO::save<vector<shared_ptr<Object>>, boost::archive::binary_oarchive>(memory, "objects", objects);
	vector<shared_ptr<Object>> anew;
	ObjectIO::load<vector<shared_ptr<Object>>, boost::archive::binary_iarchive>(memory, "objects", anew);
	return anew;
}

// Whether somebody holds the object beside `owners` known pointers. An object that was made in Python is owned by its Python object: who holds it there
// is not among the pointers' count.
template <typename Object>
bool isHeld(const shared_ptr<Object>& object, long owners)
{
	const auto* python = boost::get_deleter<boost::python::converter::shared_ptr_deleter>(object);
	return object.use_count() > owners || (python && Py_REFCNT(python->owner.get()) > 1);
}

// A member stays the object that it was when somebody else holds it too.
template <typename Object>
void keepHeld(const shared_ptr<Object>& before, shared_ptr<Object>& now)
{
	if (!before || isHeld(before, 1)) now = before;
}

// Shapes that hold no other body: an interaction between them holds none either.
bool standsAlone(const shared_ptr<Body>& body)
{
	static const std::array<const char*, 4> known{"Sphere", "Wall", "Box", "Facet"};
	return body && body->shape &&
	       (BoundaryRegistry::find(*body->shape) || std::find(known.begin(), known.end(), body->shape->getClassName()) != known.end());
}

} // namespace

vector<shared_ptr<Body>> MemoryOrder::spheresInSpace() const
{
	vector<shared_ptr<Body>> spheres;
	vector<Vector3r> centres;
	Vector3r low = Vector3r::Constant(std::numeric_limits<Real>::max()), high = -low;
	Real largest = 0;
	for (const auto& b : *scene->bodies) {
		if (!b->isStandalone() || !b->shape || b->shape->getClassName() != "Sphere") continue;
		spheres.push_back(b);
		centres.push_back(b->state->pos);
		low = low.cwiseMin(b->state->pos);
		high = high.cwiseMax(b->state->pos);
		largest = std::max(largest, static_cast<const Sphere&>(*b->shape).radius);
	}
	if (spheres.empty()) return spheres;
	const Real spacing = std::cbrt(std::max<Real>((high - low).prod(), 0) / spheres.size());
	hexmembrane::CellGrid grid(low, high, std::max(2 * largest, spacing));
	grid.fill(centres); // says which point is not finite
	vector<shared_ptr<Body>> sorted;
	for (const int i : grid.order()) sorted.push_back(spheres[i]);
	return sorted;
}

// Along space by the first body, then by the second; bodies that are no spheres last. Real ones before potential ones: the collider drops and makes potential
// ones all the time, each time moving the last of the list to the gap, and so leaves the real ones in their order.
vector<shared_ptr<Interaction>> MemoryOrder::interactionsInSpace(const vector<shared_ptr<Body>>& spheres) const
{
	const size_t all = scene->bodies->size();
	vector<size_t> rank(all);
	for (size_t id = 0; id < all; ++id) rank[id] = all + id;
	for (size_t i = 0; i < spheres.size(); ++i) rank[spheres[i]->id] = i;
	vector<shared_ptr<Interaction>> sorted(scene->interactions->begin(), scene->interactions->end());
	const auto place = [&](const shared_ptr<Interaction>& i) {
		const size_t first = rank[i->getId1()], second = rank[i->getId2()];
		return std::make_tuple(!i->isReal(), std::min(first, second), std::max(first, second));
	};
	std::sort(sorted.begin(), sorted.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
	return sorted;
}

void MemoryOrder::replaceBodies(const vector<shared_ptr<Body>>& spheres, const vector<shared_ptr<Body>>& anew) const
{
	for (size_t i = 0; i < spheres.size(); ++i) {
		Body &before = *spheres[i], &now = *anew[i];
		now.material = before.material;
		if (before.bound) { // an archive leaves these out
			now.bound->min = before.bound->min;
			now.bound->max = before.bound->max;
		}
		keepHeld(before.state, now.state);
		keepHeld(before.shape, now.shape);
		keepHeld(before.bound, now.bound);
		if (isHeld(spheres[i], 2)) { // beside the container and this list
			before.state = now.state;
			before.shape = now.shape;
			before.bound = now.bound;
		} else
			(*scene->bodies)[before.id] = anew[i];
	}
}

void MemoryOrder::replaceInteraction(shared_ptr<Interaction>& interaction, const shared_ptr<Interaction>& anew) const
{
	// an archive leaves these out
	anew->isActive = interaction->isActive;
	anew->functorCache = interaction->functorCache;
	anew->iterLastSeen = interaction->iterLastSeen;
	if (const auto* geometry = dynamic_cast<const ScGeom*>(interaction->geom.get())) {
		static_cast<ScGeom&>(*anew->geom).penetrationDepth = geometry->penetrationDepth;
		static_cast<ScGeom&>(*anew->geom).shearInc = geometry->shearInc;
	}
	keepHeld(interaction->geom, anew->geom);
	keepHeld(interaction->phys, anew->phys);
	interaction = anew;
}

void MemoryOrder::action()
{
	const gilLock lock; // objects that were made in Python die here
	const vector<shared_ptr<Body>> spheres = spheresInSpace();
	vector<shared_ptr<Interaction>> interactions = interactionsInSpace(spheres);
	InteractionContainer& container = *scene->interactions;
	const bool dirty = container.dirty;
	container.clear(); // bodies hold interactions, an archive of bodies would hold them too
	const auto putBack = [&] {
		for (const auto& interaction : interactions) {
			const long born = interaction->iterBorn;
			container.insert(interaction);
			interaction->iterBorn = born;
		}
		container.dirty = dirty; // for the collider nothing has changed
	};
	try {
		vector<size_t> movable;
		vector<shared_ptr<Interaction>> moving;
		const BodyContainer& bodies = *scene->bodies;
		for (size_t i = 0; i < interactions.size(); ++i) {
			if (isHeld(interactions[i], 1)) continue;
			if (!standsAlone(bodies[interactions[i]->getId1()]) || !standsAlone(bodies[interactions[i]->getId2()])) continue;
			movable.push_back(i);
		}
		for (const size_t i : movable) moving.push_back(interactions[i]);
		const vector<shared_ptr<Body>> newSpheres = allocatedAnew(spheres);
		const vector<shared_ptr<Interaction>> newInteractions = allocatedAnew(moving);
		moving.clear();
		replaceBodies(spheres, newSpheres);
		for (size_t i = 0; i < movable.size(); ++i) replaceInteraction(interactions[movable[i]], newInteractions[i]);
		moved = static_cast<long>(spheres.size() + movable.size());
	} catch (...) {
		putBack();
		throw;
	}
	putBack();
}

} // namespace yade
