// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "CompactState.hpp"
#include "SharedValues.hpp"

#include <core/GlobalEngine.hpp>

#include <memory>

namespace yade {

/*! The compact tier: collider, interaction loop and integrator in one, over flat arrays, many steps per YADE iteration. It knows engines by Stepped, boundaries by
 * BoundaryRegistry and contacts by LinearPhys. */
class CompactLoop : public GlobalEngine, public ContactKeeper {
public:
	void action() override;
	void postLoad(CompactLoop&);
	void preSave(CompactLoop&);

	void exportContacts();
	int contactCount() const;
	Real criticalTimeStep();
	static boost::python::list contract();
	static bool canStep(const shared_ptr<Engine>& engine);

	bool keepsContacts() const override { return state && !exported; }
	vector<Vector3r> contactForces(const HexMembrane& membrane) const override;
	void forEachContact(const VisitContact& visit) const override;
	const vector<shared_ptr<Engine>>& innerEngines() const override { return engines; }

private:
	// CompactLoop.cpp: the run of a step
	void prepareEngines();
	//! Makes labels names in Python, when they are new.
	void labelEngines();
	//! Says so when a tool of YADE will find no contacts.
	void warnReaders();
	long stepsToDo() const;
	void step(bool last);
	void moveAll();
	void moveSheet();
	template <typename Part>
	void addWorks(const vector<Part>& parts, const vector<WorkMeter*>& owners);
	void moveBoundaries();
	void bookEnergies(Real elastic);
	[[noreturn]] void stopLost(Body::id_t id);

	// CompactScene.cpp: between YADE's bodies and the arrays
	void takeScene();
	void collect(const Sheet& sheet);
	void takeOutsideForces();
	void giveScene();
	Real usedSkin(const hexmembrane::SphereAssembly& spheres) const;

	// CompactContacts.cpp: contacts between the arrays, saved attributes and O.interactions
	vector<KeptContact> contactsSoFar() const;
	vector<KeptContact> savedContacts() const;
	vector<KeptContact> interactionContacts() const;
	bool continueLists(CompactState& next) const;
	struct Instant {
		vector<hexmembrane::Place> places;
		vector<std::shared_ptr<const hexmembrane::BoundaryShape>> shapes;
	};
	Instant lastInstant() const;
	//! Forces of contacts on the sheet's particles, with those of the contacts that engines have made.
	vector<Vector3r> withEngines(vector<Vector3r> forces) const;
	//! All contacts, with spheres at `places` and boundaries of these shapes.
	void visitWithEngines(const vector<hexmembrane::Place>& places, const vector<std::shared_ptr<const hexmembrane::BoundaryShape>>& shapes,
	                      const VisitContact& visit) const;
	void requireRun(const char* what) const;

	//! The instant of a step as the engines see it.
	class View;

	// Caches: made from the scene and the saved attributes.
	std::unique_ptr<CompactState> state; //!< none: nothing collected
	vector<Stepped*> stepped;            //!< the engines that are not dead
	vector<hexmembrane::MembraneMotion::Term> terms;
	vector<WorkMeter*> meters; //!< of the terms
	vector<hexmembrane::MembraneMotion::Grip> grips;
	vector<WorkMeter*> gripMeters;
	vector<const hexmembrane::PaddedRings*> torques;
	vector<std::shared_ptr<const hexmembrane::BoundaryShape>> stepShapes; //!< of the boundaries when the last step's forces were computed
	vector<Vector3r> outsideOn;                                           //!< forces on the boundaries that are held for the iteration (N)
	int threads = 1;
	Real lastDt = 0;
	bool warned = false;
	vector<string> labelled;

	vector<int> workIndices;
	int elasticIx = -1, kineticIx = -1, dampIx = -1;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(CompactLoop,GlobalEngine,
		"The compact tier: replaces collider, interaction loop and NewtonIntegrator for scenes of spheres of LinearMat, Platens, "
		"a CylinderWall and one HexMembrane, with the same laws and the same engines as the reference tier. "
		"It keeps flat arrays sorted in space, finds neighbours with a cell grid and a skin, and takes many steps in one YADE iteration.\n\n"
		"``O.engines`` is then ForceResetter, this, and whatever looks at the scene between iterations; "
		"the engines of membrane and boundaries go into engines, as the same objects that the reference tier has in ``O.engines``, "
		"and act in the order of that list. Their attributes are read and written as there, their labels are names as YADE's own are, "
		"from the first step on and after ``O.load`` (``O.labeledEngine`` does not find them).\n\n"
		"One YADE iteration takes substeps steps, fewer when ``O.run(n)`` or ``O.stopAtTime`` asks for it; ``O.iter`` and ``O.time`` count steps. "
		"Before it the bodies are read, after it positions, velocities, orientations and forces stand in ``O.bodies`` and ``O.forces``. "
		"What a script may change between iterations, and what is refused, is one table: contract. "
		"Forces that other engines have added before it are held for the whole iteration; so GravityEngine before it acts as in the reference tier. "
		"What is refused leaves everything as it was.\n\n"
		"Contacts live in the arrays. Our own classes read them there; "
		"YADE's tools read ``O.interactions``, which exportContacts or exportPeriod fills. "
		"Real contacts found there at the first step are taken over with their history.\n\n"
		"Formulas: contacts as Law2_ScGeom_LinearPhys_Linear with the geometry of Ig2_Sphere_Sphere_LinearScGeom "
		"(``avoidGranularRatcheting=False``); motion as NewtonIntegrator (spheres, local damping). "
		"Contact parameters follow the materials at once when these change. Membrane particles do not meet each other. "
		"Orientations of grains are advanced by the sum of an iteration's small rotations; those of membrane particles are not kept.\n\n"
		"One thread repeats and continues a saved run to the last bit on one kind of processor; "
		"with several threads the sums over contacts have another order, the same one for the same number of threads. "
		"ompThreads takes fewer of them than ``yade -jN`` gives.\n\n"
		"Errors: ``ValueError`` or ``RuntimeError`` for bodies, materials or engines that it does not know, before anything is changed; "
		"a sphere that moves half a skin in one step or is not finite stops the run with its id and the iteration.\n\n"
		"Example::\n\n\tO.engines=[ForceResetter(),CompactLoop(engines=[bonds,pressure,servo,bottom,top,oRings],damping=.2)]",
		((vector<shared_ptr<Engine>>,engines,,Attr::triggerPostLoad,
			"Engines that are stepped inside, in this order: those that implement C++'s ``Stepped``, as MembraneBonds, MembranePressure, "
			"MembraneRadialServo, PlatenDrive, MembraneORings, RadialWallServo. They do not stand in ``O.engines``."))
		((Real,damping,HEXMEMBRANE_LOCAL_DAMPING_DEFAULT,,"Local damping, as NewtonIntegrator.damping [-], " HEXMEMBRANE_LOCAL_DAMPING_RANGE "."))
		((int,substeps,HEXMEMBRANE_SUBSTEPS_DEFAULT,,"Steps in one YADE iteration [-], " HEXMEMBRANE_SUBSTEPS_RANGE "."))
		((Real,skin,NaN,,"Reach of the neighbour lists beyond contact [m]; NaN: " BOOST_PP_STRINGIZE(HEXMEMBRANE_LIST_SKIN_DEFAULT)
			" of the smallest sphere's radius. Larger: longer lists, made more seldom."))
		((int,exportPeriod,0,,
			"Iterations after which contacts are written to ``O.interactions`` for YADE's own tools (VTKRecorder, ``unbalancedForce``); 0: never. "
			"It costs about a microsecond a contact each time."))
		((long,listsMade,0,Attr::readonly,"How often neighbour lists were made."))
		((bool,exported,false,Attr::readonly,"``O.interactions`` holds contacts written by exportContacts; they are cleared before the next step."))
		// State of the arrays that the bodies do not hold, as of the last save.
		((vector<int>,order,,Attr::hidden,""))
		((vector<Vector3r>,listedCentres,,Attr::hidden,""))
		((vector<Real>,listedShapes,,Attr::hidden,""))
		((Real,travelled,0,Attr::hidden,""))
		((long,iterations,0,Attr::hidden,""))
		((vector<Vector2i>,contactIds,,Attr::hidden,""))
		((vector<int>,contactBits,,Attr::hidden,""))
		((vector<Real>,contactNumbers,,Attr::hidden,""))
		((string,contactFields,"",Attr::hidden,""))
		,/*ctor*/,
		.def("exportContacts",&CompactLoop::exportContacts,
			"Writes all touching contacts, as of the last step, to ``O.interactions`` (ScGeom and LinearPhys with forces, moments, bonds), "
			"replacing what is there. They are cleared before the next step.")
		.def("contactCount",&CompactLoop::contactCount,"Number of touching contacts, boundaries and membrane included.")
		.def("contract",&CompactLoop::contract,"What is done with each attribute that a script may change between iterations: "
			"a list of (of, attribute, 'read' | 'watched' | 'refused', what). Read: acts from the next iteration on. Watched: "
			"a change makes the tier collect the scene anew. Refused: an error with body id and fix, before anything is changed.").staticmethod("contract")
		.def("canStep",&CompactLoop::canStep,(boost::python::arg("engine")),"Whether an engine can be stepped inside, by its class.").staticmethod("canStep")
		.def("criticalTimeStep",&CompactLoop::criticalTimeStep,
			"Critical time step [s] of central differences, 2/ω, with the highest frequency ω of the contacts and the sheet (bonds, bending, "
			"contacts that its engines make) as they are now (all sticking), by power iteration to about 1 %.")
	);
	// clang-format on
	DECLARE_LOGGER;
};
REGISTER_SERIALIZABLE(CompactLoop);

} // namespace yade
