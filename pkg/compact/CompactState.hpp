// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "BoundaryRegistry.hpp"
#include "ReadingContract.hpp"
#include "Stepped.hpp"

#include "contact/LinearContact.hpp"
#include "kernels/compact/MembraneMotion.hpp"
#include "kernels/compact/SphereAssembly.hpp"

namespace yade {

/*! A contact with the ids of its bodies; a boundary is the first. */
struct KeptContact {
	Body::id_t id1, id2;
	hexmembrane::Contact contact;
};

/*! All that the compact tier has collected from a scene. Made whole, then put in place: what is refused meanwhile leaves the one before as it was. */
class CompactState {
public:
	//! Reads the bodies. \throws std::invalid_argument, std::runtime_error for what the tier cannot do, with the body's id
	CompactState(const Scene& scene, const Sheet& sheet);

	//! Reads positions and velocities of the same bodies. \return false when something that is watched has changed: collect anew
	bool refresh(const Scene& scene, const Sheet& sheet, int threads);
	//! Gives the contacts the materials' present parameters.
	void refreshMaterials();
	//! Gives boundary b the place, shape and motion of its body.
	void refreshBoundary(const Scene& scene, int b);
	//! Fills the sheet's rows from the arrays.
	void fillRows();
	//! Goes on with the order of grains of a saved state. \return false when that state had other bodies
	bool takeOrder(const vector<int>& order);

	//! -1: no boundary.
	int boundaryIndex(Body::id_t id) const;
	//! Throws when a contact that is bonded has no place in the lists.
	void requirePlace(const KeptContact& kept) const;
	//! Puts a contact into the lists; what they do not hold does not touch, and is dropped.
	void put(const KeptContact& kept);
	template <typename Visit>
	void forEachContact(Visit&& visit) const
	{
		spheres.contacts.forEachTouching([&](int i, int j, const hexmembrane::Contact& c) { visit(KeptContact{spheres.id[i], spheres.id[j], c}); });
		for (size_t b = 0; b < spheres.boundaryContacts.size(); ++b)
			spheres.boundaryContacts[b].forEachTouching(
			        [&](int i, const hexmembrane::Contact& c) { visit(KeptContact{boundaryIds[b], spheres.id[i], c}); });
	}
	//! Indices of the spheres by their bodies' ids, for put(): grains change places when lists are made.
	void indexSpheres();

	//! Normal forces of the contacts of each particle of the sheet with what is not of it, with spheres at `places` and boundaries of these shapes (N).
	vector<Vector3r> contactForces(const vector<hexmembrane::Place>& places, const vector<std::shared_ptr<const hexmembrane::BoundaryShape>>& shapes) const;
	//! Calls visit for each touching contact, likewise.
	void visitContacts(const vector<hexmembrane::Place>& places, const vector<std::shared_ptr<const hexmembrane::BoundaryShape>>& shapes,
	                   const VisitContact& visit) const;
	//! Where two spheres touch, seen from the first.
	static hexmembrane::BoundaryTouch touchOf(const hexmembrane::Place& a, const hexmembrane::Place& b)
	{
		const Vector3r branch = b.centre - a.centre;
		const Real distance = branch.norm(), u = a.radius + b.radius - distance;
		const Vector3r normal = branch / distance;
		return {u, normal, a.centre + (a.radius - 0.5 * u) * normal};
	}
	//! Calls visit(i, j, contact) for each touching contact of two spheres, those without memory too, with spheres at `places`.
	template <typename Visit>
	void forEachSpherePair(const vector<hexmembrane::Place>& places, Visit&& visit) const
	{
		spheres.contacts.forEachTouching(visit);
		spheres.smooth.forEachTouching(places, [&](int i, int j, Real, Real, const Vector3r&) {
			visit(i, j, hexmembrane::Contact{hexmembrane::noMemory(), spheres.lawOf(i, j), hexmembrane::contactTouching});
		});
	}

	int grains() const { return spheres.grains(); }
	hexmembrane::PaddedRings& velocity() { return sheet.velocity ? *sheet.velocity : ownVelocity; }

	hexmembrane::SphereAssembly spheres;
	hexmembrane::MembraneMotion motion; //!< of the sheet's particles
	Sheet sheet;
	vector<Body::id_t> boundaryIds;
	Real spinInertia = 0; //!< of the sheet's particles that turn (kg m2), 0: none turns

private:
	using SphereRow = hexmembrane::SphereAssembly::Sphere;
	SphereRow sphereOf(const Body& body, bool ofSheet);
	void addBoundary(const Body& body);
	void collectSheet(const Scene& scene, vector<SphereRow>& rows);
	int materialIndex(const Body& body);
	int indexOf(Body::id_t id) const { return static_cast<size_t>(id) < sphereAt.size() ? sphereAt[id] : -1; }

	const Scene* collectedFrom;
	vector<BodyMark> marks; //!< by body id
	vector<shared_ptr<const LinearMat>> materials;
	vector<int> sphereAt;
	hexmembrane::PaddedRings ownVelocity; //!< of a sheet that has no rows for it
};

} // namespace yade
