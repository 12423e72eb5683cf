// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "boundary/PlatenDrive.hpp"
#include "boundary/RadialWallServo.hpp"
#include "contact/LinearContact.hpp"
#include "kernels/compact/SphereAssembly.hpp"
#include "kernels/compact/MembraneMotion.hpp"
#include "membrane/MembraneBonds.hpp"
#include "membrane/MembraneORings.hpp"
#include "membrane/MembranePressure.hpp"
#include "membrane/MembraneRadialServo.hpp"

#include <core/GlobalEngine.hpp>

namespace yade {

/*! The compact tier: collider, interaction loop and integrator in one, over flat arrays, many steps per YADE iteration. */
class CompactLoop : public GlobalEngine {
public:
	void action() override;
	void preSave(CompactLoop&);

	void exportContacts();
	int contactCount() const;
	Real criticalTimeStep();

private:
	// CompactLoop.cpp: the run of a step
	void prepareEngines();
	long stepsToDo() const;
	void step(bool last);
	void membraneForces();
	void driveBoundaries();
	void moveAll();
	void bookWorks();
	void bookEnergies(Real elastic);
	[[noreturn]] void stopLost(Body::id_t id);
	Real transmittedByGroup(int group) const;

	// CompactScene.cpp: between YADE's bodies and the arrays
	void takeScene();
	void collect();
	void collectBoundary(const Body& body, hexmembrane::FlatBoundary::Kind kind);
	hexmembrane::SphereAssembly::Sphere sphereOf(const Body& body, bool ofMembrane);
	int materialIndex(const Body& body);
	void checkMasks() const;
	bool inSavedOrder(vector<hexmembrane::SphereAssembly::Sphere>& spheres, int grains) const;
	bool rotatingMembrane() const { return bonds->bondKernel().velocity.fits(collectedMembrane->perRing, collectedMembrane->rings); }
	bool refreshBodies();
	void refreshBoundary(size_t b);
	void refreshMaterials();
	void takeOutsideForces();
	void giveScene();
	Real usedSkin() const;

	// CompactContacts.cpp: contacts between the arrays, saved attributes and O.interactions
	void storeContacts();
	void forgetStored();
	void continueLists();
	void restoreContacts();
	void indexSpheres();
	void putContact(Body::id_t a, Body::id_t b, hexmembrane::ContactMemory memory, unsigned char bits);
	void importInteractions();
	template <typename Visit>
	void forEachContact(Visit&& visit) const;
	struct Instant {
		vector<hexmembrane::Place> places;
		vector<hexmembrane::FlatBoundary> boundaries;
	};
	Instant lastInstant() const;

	// Caches: made from the scene and the saved attributes.
	hexmembrane::SphereAssembly flat;
	hexmembrane::MembraneMotion rows;
	vector<hexmembrane::MembraneMotion::Term> terms;
	vector<Body::id_t> boundaryIds;
	vector<int> sphereAt; //!< index of each body among the spheres, -1: none; of use while contacts are put in
	vector<const LinearMat*> materials;
	size_t collectedBodies = 0;
	const HexMembrane* collectedMembrane = nullptr;
	const Scene* collectedScene = nullptr;
	bool collected = false;
	int threads = 1;
	Real lastDt = 0;

	// The engines, by what they are.
	MembraneBonds* bonds = nullptr;
	MembranePressure* pressure = nullptr;
	MembraneRadialServo* radialServo = nullptr;
	MembraneORings* oRings = nullptr;
	RadialWallServo* wallServo = nullptr;
	vector<PlatenDrive*> drives;

	int elasticIx = -1, slipIx = -1, rollIx = -1, bondIx = -1, kineticIx = -1, dampIx = -1;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(CompactLoop,GlobalEngine,
		"The compact tier: replaces collider, interaction loop and :yref:`NewtonIntegrator` for scenes of spheres of :yref:`LinearMat`, :yref:`Platens<Platen>`, a :yref:`CylinderWall` and one :yref:`HexMembrane`, with the same laws and the same engines as the reference tier. It keeps flat arrays sorted in space, finds neighbours with a cell grid and a skin, and takes many steps in one YADE iteration.\n\n"
		"``O.engines`` is then :yref:`ForceResetter`, this, and whatever looks at the scene between iterations; the engines of membrane and boundaries go into :yref:`engines<CompactLoop.engines>`, as the same objects that the reference tier has in ``O.engines``. Their attributes are read and written as there.\n\n"
		"One YADE iteration takes :yref:`substeps<CompactLoop.substeps>` steps, fewer when ``O.run(n)`` or ``O.stopAtTime`` asks for it; ``O.iter`` and ``O.time`` count steps. Before it the bodies are read (a script may move them, change materials, add bodies), after it positions, velocities, orientations and forces stand in ``O.bodies`` and ``O.forces``. Forces that other engines have added before it are held for the whole iteration. "
		"Contacts live in the arrays; :yref:`exportContacts<CompactLoop.exportContacts>` writes them to ``O.interactions`` for YADE's tools, real contacts found there at the first step are taken over with their history.\n\n"
		"Formulas: contacts as :yref:`Law2_ScGeom_LinearPhys_Linear` with the geometry of :yref:`Ig2_Sphere_Sphere_LinearScGeom` (``avoidGranularRatcheting=False``); motion as :yref:`NewtonIntegrator` (spheres, local damping; no gravity). Contact parameters follow the materials at once when these change. Membrane particles do not meet each other unless :yref:`membraneContacts<CompactLoop.membraneContacts>` is set. Orientations of grains are advanced by the sum of an iteration's small rotations; those of membrane particles are not kept.\n\n"
		"One thread repeats and continues a saved run to the last bit; with several threads the sums over contacts have another order, the same one for the same number of threads. :yref:`ompThreads<Engine.ompThreads>` takes fewer of them than ``yade -jN`` gives.\n\n"
		"Errors: ``ValueError`` or ``RuntimeError`` for bodies, materials or engines that it does not know, before anything is changed; a sphere that moves half a skin in one step or is not finite stops the run with its id and the iteration.\n\n"
		"Example::\n\n\tO.engines=[ForceResetter(),CompactLoop(engines=[bonds,pressure,servo,bottom,top,oRings],damping=.2)]",
		((vector<shared_ptr<Engine>>,engines,,,"Engines that are stepped inside: at most one :yref:`MembraneBonds`, :yref:`MembranePressure`, :yref:`MembraneRadialServo`, :yref:`MembraneORings`, :yref:`RadialWallServo`, and :yref:`PlatenDrives<PlatenDrive>`. They do not stand in ``O.engines``."))
		((Real,damping,0.2,,"Local damping, as :yref:`NewtonIntegrator.damping` [-], 0 to below 1."))
		((int,substeps,100,,"Steps in one YADE iteration [-], >= 1."))
		((Real,skin,NaN,,"Reach of the neighbour lists beyond contact [m]; NaN: 0.3 of the smallest sphere's radius. Larger: longer lists, made more seldom."))
		((bool,membraneContacts,false,,"Let membrane particles that are not bonded to each other collide (folds of the membrane)."))
		((long,listsMade,0,Attr::readonly,"How often neighbour lists were made."))
		((bool,exported,false,Attr::readonly,"``O.interactions`` holds contacts written by :yref:`exportContacts<CompactLoop.exportContacts>`; they are cleared before the next step."))
		// State of the arrays that the bodies do not hold, as of the last save.
		((vector<int>,order,,Attr::hidden,""))
		((vector<Vector3r>,listedCentres,,Attr::hidden,""))
		((vector<Vector3r>,listedBoundaryCentres,,Attr::hidden,""))
		((vector<Real>,listedBoundaryRadii,,Attr::hidden,""))
		((Real,travelled,0,Attr::hidden,""))
		((vector<Real>,aheadWork,,Attr::hidden,""))
		((vector<Vector2i>,contactIds,,Attr::hidden,""))
		((vector<int>,contactBits,,Attr::hidden,""))
		((vector<Vector3r>,contactShear,,Attr::hidden,""))
		((vector<Vector3r>,contactMoment,,Attr::hidden,""))
		((vector<Vector3r>,contactNormal,,Attr::hidden,""))
		((vector<Real>,contactTensile,,Attr::hidden,""))
		((vector<Real>,contactStrength,,Attr::hidden,""))
		,/*ctor*/,
		.def("exportContacts",&CompactLoop::exportContacts,"Writes all touching contacts, as of the last step, to ``O.interactions`` (:yref:`ScGeom` and :yref:`LinearPhys` with forces, moments, bonds), replacing what is there. Takes about a microsecond a contact; they are cleared before the next step.")
		.def("contactCount",&CompactLoop::contactCount,"Number of touching contacts, boundaries and membrane included.")
		.def("criticalTimeStep",&CompactLoop::criticalTimeStep,"Critical time step [s] of central differences, $2/\\omega$, with the highest frequency $\\omega$ of the contacts and membrane bonds as they are now (all sticking), by power iteration to about 1 %.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(CompactLoop);

} // namespace yade
