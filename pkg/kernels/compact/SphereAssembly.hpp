// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/BoundaryContacts.hpp"
#include "kernels/compact/PairContacts.hpp"
#include "kernels/compact/FrictionlessContacts.hpp"
#include "kernels/compact/ThreadPartition.hpp"
#include "kernels/contact/ContactMaterial.hpp"

#include <algorithm>
#include <memory>
#include <vector>

namespace hexmembrane {

/// Spheres and boundaries of the compact tier: flat arrays, neighbour lists with a skin, contact forces and the motion of the grains. The membrane's own
/// mechanics and motion are MembraneMotion'.
///
/// Grains come first and are sorted in space whenever lists are made anew; the membrane's particles follow, ring by ring, and keep their order. Lists hold
/// all pairs nearer than the skin and are made anew before any sphere or boundary has moved half a skin: no contact is missed.
class SphereAssembly {
public:
	/// All spheres, in any order of grains. `grains` of them come before the membrane's particles.
	struct Sphere {
		int id; ///< the caller's name for it
		Place place;
		Motion motion;
		double mass, inertia; ///< kg, kg m2
		int material;
		bool fixed;   ///< moves at its velocity whatever acts on it
		int mask = 1; ///< a boundary whose mask has no bit of it does not meet it
	};
	void setSpheres(const std::vector<Sphere>& spheres, int grains);
	/// \param skin (m), > 0
	void setSkin(double skin);
	double skin() const { return gap; }
	/// What contacts of two materials have of their own; a and b are indices of the table.
	struct OwnPair {
		int a, b;
		PairProperties own;
		bool operator==(const OwnPair& o) const { return a == o.a && b == o.b && own == o.own; }
	};
	/// Parameters of all materials, and of the pairs that have their own; contacts follow at once. A membrane particle that touches a grain without friction
	/// needs no memory.
	void setMaterials(const std::vector<ContactMaterial>& table, const std::vector<OwnPair>& ownPairs = {});
	const ContactMaterial& materialOf(int index) const { return materials[index]; }
	/// Law of a contact of two spheres, or of a sphere with boundary b, without a bond.
	ContactLaw lawOf(int i, int j) const
	{
		const MaterialPair& pair = pairs[kindOfPair(material[i], material[j])];
		return sphereLaw(pair.a, pair.b, places[i].radius, places[j].radius);
	}
	ContactLaw boundaryLawOf(int b, int i) const
	{
		const MaterialPair& pair = pairs[kindOfPair(boundaries[b].material, material[i])];
		return boundaryLaw(pair.a, pair.b, places[i].radius);
	}

	/// Whether a contact of these two has neither friction nor rolling resistance.
	bool isSmooth(int i, int j) const { return normalOnly(kinds[kindOfPair(material[i], material[j])]); }

	int spheres() const { return int(places.size()); }
	int grains() const { return grainCount; }

	/// Whether the lists hold every contact at the present positions. Measures how far spheres have moved when it must.
	bool listsHold();
	/// Id of a sphere whose place is not finite, -1: none.
	int nowhere() const;
	/// Gives the grains another order: the one at place i was at from[i] before. Lists are to be made anew.
	void permuteGrains(const std::vector<int>& from);
	/// Sorts the grains and makes all lists anew; memories of contacts move over. \throws FieldError for a sphere that is nowhere, before anything is changed
	void makeLists();
	/// Steps at which lists were made so far.
	long listsMade() const { return made; }

	/// Particles that contacts with memory, boundaries or `outside` may load, ascending: all others have no load, nobody looks at their motion, and they
	/// need neither be cleared nor kept up to date.
	const std::vector<int>& loadedParticles() const { return loaded; }

	/// Loads of one step: those of `outside` (empty: none) and of all contacts.
	/// By as many parts as `threads`, which sets the order of sums; takeWorkers() says how many threads take them.
	void computeLoads(double dt, int threads);
	/// Threads that take the parts of a step; 0: as many as there are parts. Results depend on the parts alone.
	void takeWorkers(int count) { workers = count; }
	/// Leapfrog with local damping, as YADE's NewtonIntegrator: v += dt a, a reduced by the damping where it drives the motion and raised where it
	/// brakes it, x += dt v. Grains only.
	/// \return id of a grain that moved half a skin or more, or is not finite, -1: none
	int moveGrains(double dt, double damping, bool energies, int threads);
	/// Gives boundary b its present shape.
	void moveBoundary(int b, std::shared_ptr<const BoundaryShape> shape)
	{
		noteWay(shape->wayFrom(*boundaries[b].shape));
		boundaries[b].shape = std::move(shape);
	}
	std::vector<std::shared_ptr<const BoundaryShape>> shapes() const
	{
		std::vector<std::shared_ptr<const BoundaryShape>> all;
		for (const Boundary& boundary : boundaries) all.push_back(boundary.shape);
		return all;
	}
	/// Counts a way (m) of another sphere in this step against the skin.
	void noteWay(double way) { furthest = std::max(furthest, way); }
	/// Ends a step: adds the largest way of it to what has been travelled. A sum of every step's largest way: a bound of each sphere's own way.
	void endStep()
	{
		travelled += furthest;
		gone.way += furthest;
		furthest = 0;
	}
	/// How far spheres have gone at most since the grains were last put into another order.
	Travel travel() const { return gone; }

	// State: read and written by the caller between steps
	std::vector<int> id;
	std::vector<Place> places;
	std::vector<Motion> motions;
	std::vector<double> mass, inertia;
	std::vector<int> material;
	std::vector<unsigned char> fixed;
	std::vector<int> mask;
	std::vector<Load> outside; ///< loads from elsewhere, held for the step; empty: none
	std::vector<Vec3> turned;  ///< rotation of each grain since this was last zeroed (rad)
	std::vector<Boundary> boundaries;

	// Results of computeLoads()
	std::vector<Load> loads;             ///< on grains; on particles what contacts with memory and `outside` do
	std::vector<PaddedForce> onParticle; ///< what frictionless contacts do to the membrane's particles (N)
	std::vector<BoundaryLoad> onBoundary;
	SweepSums sums;        ///< of all steps since it was last reset
	double dampedWork = 0; ///< taken by the local damping since it was last reset (J)
	double kinetic = 0;    ///< of the grains, by the velocities before the last step (J)

	// Contacts
	PairContacts contacts;
	FrictionlessContacts smooth;
	std::vector<BoundaryContacts> boundaryContacts;

	// What lists were made from: part of the state that is saved
	std::vector<Vec3> listed;                                       ///< centres
	std::vector<std::shared_ptr<const BoundaryShape>> listedShapes; ///< of the boundaries
	double travelled = 0;                                           ///< upper bound of every sphere's way since (m)
	/// The lists of a saved state: from the centres and shapes that it had made them from, without sorting.
	void continueLists(const std::vector<Vec3>& centres, const std::vector<std::shared_ptr<const BoundaryShape>>& shapesThen, double travelledSince);

	double elasticEnergy() const;

private:
	/// Lists from `listed` and `listedShapes`.
	void buildLists(const std::vector<int>& newIndex);
	void sortGrains(std::vector<int>& newIndex);
	int workers = 0;
	int team(int parts) const { return workers > 0 ? std::min(workers, parts) : parts; }
	/// The division of the spheres among so many threads.
	void divide(int threads);
	void listLoaded();
	void clearLoads(int from, int to, bool all);
	int kindOfPair(int a, int b) const { return a * int(materials.size()) + b; }
	SpringsOfKind springsOf(int i, int j) const
	{
		const int kind = kindOfPair(material[i], material[j]);
		return {sphereSprings(pairs[kind].a, pairs[kind].b, places[i].radius, places[j].radius), kind};
	}
	SpringsOfKind springsOf(const Boundary& boundary, int i) const
	{
		const int kind = kindOfPair(boundary.material, material[i]);
		return {boundarySprings(pairs[kind].a, pairs[kind].b, places[i].radius), kind};
	}
	void findPairs(NearPairs& general, std::vector<FrictionlessContacts::Pair>& frictionless) const;
	ThreadPartition runs; ///< of the present lists; none: to be made
	int grainCount = 0;
	std::vector<int> loaded;
	bool loadsStale = true; ///< particles that are not in `loaded` may have a load
	double gap = 0, furthest = 0;
	Travel gone;
	void startTravel();
	long made = 0;
	std::vector<ContactMaterial> materials;
	std::vector<OwnPair> ownPairs;
	std::vector<MaterialPair> pairs;     ///< of every pair of materials, as they act in its contacts
	std::vector<PairKind<double>> kinds; ///< of the same pairs
};

} // namespace hexmembrane
