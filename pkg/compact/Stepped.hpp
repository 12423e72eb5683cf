// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "WorkMeter.hpp"

#include "kernels/base/Place.hpp"
#include "kernels/compact/SphereArrays.hpp"
#include "kernels/membrane/PaddedRings.hpp"

#include <core/Body.hpp>
#include <core/GlobalEngine.hpp>

#include <array>
#include <functional>

/* What an engine implements to be stepped in either tier. CompactLoop knows its engines by this interface alone; in the reference tier their action() makes the same
 * calls over YADE's bodies (BodyView). How to write one: CONTRIBUTING.md, "An engine". */
namespace yade {

class HexMembrane;

/*! Particles in rings that the compact tier moves in rows. An engine that holds them together owns the rows and offers them. */
struct Sheet {
	const HexMembrane* membrane = nullptr; //!< none: the engine owns no particles
	const vector<Body::id_t>* ids = nullptr;
	hexmembrane::HexStencil stencil;
	hexmembrane::PaddedRings* position = nullptr;
	hexmembrane::PaddedRings* velocity = nullptr;
	hexmembrane::PaddedRings* spin = nullptr; //!< none: the particles do not turn
};

//! Rings first .. last of a membrane.
struct RingRange {
	int first, last;
};

/*! What a boundary's contacts do to it in this instant. */
struct ContactSums {
	Vector3r force = Vector3r::Zero(); //!< on the boundary (N)
	Real normalForce = 0;              //!< sum of the sizes of the normal forces (N)
	Real normalStiffness = 0;          //!< sum of the normal stiffnesses (N/m)
	int count = 0;                     //!< of contacts
	string silent;                     //!< class of a contact that does not tell its normal force and stiffness, empty: none
};

/*! A touching contact in an instant. */
struct TouchingContact {
	Body::id_t id1, id2;       //!< of its bodies; a boundary is the first
	Vector3r centre1, centre2; //!< of its spheres; of a boundary the point (m)
	Vector3r point;            //!< half way through the overlap (m)
	Vector3r force;            //!< of the springs, on the second body (N)
	Real normalForce;          //!< compression positive (N)
	Real friction;             //!< coefficient (-); infinite: a bond holds it, NaN: the law does not tell
};
using VisitContact = std::function<void(const TouchingContact&)>;

/*! Spheres where a view has them, with their velocities and spins. `order`: rows are where they were while it is the same. */
struct MovingRows {
	const hexmembrane::Place* places;
	const hexmembrane::Motion* motions;
	const int* ids;
	int count;
	long order; //!< not negative
};

/*! Springs of a joint of two spheres: along its normal and across it (N/m), about axes across it and along it (N m). */
struct JointStiffness {
	Real normal, shear, bending, twisting;
};

/*! An instant of a run as engines see it: positions and contact forces belong together, velocities are those of half a step before. */
class StepView {
public:
	virtual ~StepView() = default;
	//! Present centres of a membrane's particles, as wrapped rows.
	virtual const hexmembrane::PaddedRings& positions(const HexMembrane& membrane) = 0;
	//! Brings the rows of a sheet up to the present positions, velocities and spins.
	virtual void refresh(const Sheet& sheet) = 0;
	//! Whether rows move on in this step, and the present instant is one that somebody may ask for.
	virtual bool leavesInstant() const { return false; }
	//! Adds forces to rings, and torques where given; they stay where they are until the step ends. `meter`: books their work; none: nobody wants it.
	virtual void addForces(const HexMembrane& membrane, const vector<RingRange>& rings, const hexmembrane::PaddedRings& force,
	                       const hexmembrane::PaddedRings* torque, WorkMeter* meter) = 0;
	//! Gives rings a velocity, whatever acts on them, and books the work of what holds them. After all forces.
	virtual void grip(const HexMembrane& membrane, const vector<std::pair<int, Vector3r>>& rings, WorkMeter& meter) = 0;
	//! The spheres that are not of this membrane; they stay where they are until the step ends.
	virtual hexmembrane::SphereRows grains(const HexMembrane& membrane) = 0;
	//! How far those spheres and the particles have gone; not known: look.
	virtual hexmembrane::Travel travel() const { return {}; }
	//! Adds a force to one of those rows.
	virtual void addForce(int grain, const Vector3r& force) = 0;
	//! Grains with their motions, these bodies at least; they stay where they are until the step ends. \throws std::invalid_argument for a body that is gone
	virtual MovingRows moving(const vector<Body::id_t>& ids) = 0;
	//! Adds a load to one of those rows; may be called in parallel for different ones.
	virtual void addLoad(int row, const hexmembrane::Load& load) = 0;
	//! Normal forces of the contacts of each particle with all that is not membrane (N), on the particle.
	virtual vector<Vector3r> contactForces(const HexMembrane& membrane) = 0;
	//! Sums over the contacts of a boundary.
	virtual ContactSums contacts(Body::id_t boundary) = 0;
	//! Stiffness of a boundary's contacts along a unit vector: sum of kn c^2 + ks (1 - c^2), c the cosine between normal and vector (N/m).
	virtual Real stiffness(Body::id_t boundary, const Vector3r& along) = 0;
	//! Mass of the spheres that touch a boundary (kg).
	virtual Real touchingMass(Body::id_t boundary) = 0;
	//! Calls visit for every touching contact, those that engines make included: of this step when they stand before the one that asks.
	virtual void forEachContact(const VisitContact& visit) = 0;
};

class Stepped {
public:
	virtual ~Stepped() = default;
	//! Once before steps are taken, with the engine's `scene` set. \throws std::invalid_argument, std::runtime_error for what is set wrong
	virtual void prepare() = 0;
	//! Adds forces, or says how something moves until the next instant.
	virtual void step(StepView& view) = 0;
	//! Enters stored energies of this instant into the scene's, before anything moves.
	virtual void bookStored() {}
	//! Enters works into the scene's energies.
	virtual void bookWorks() {}
	//! The particles that this engine holds together, after prepare().
	virtual Sheet sheet() { return {}; }
	//! Calls visit(first, second, branch, kn, ks) for each spring between particles of its membrane, by their indices there: for the critical time step.
	using VisitBond = std::function<void(int, int, const Vector3r&, Real, Real)>;
	virtual void forEachBond(const VisitBond&) const {}
	//! Adds the forces that small displacements of its membrane's particles (wrapped rows) call up beyond those springs, linear in them: likewise.
	virtual void addAnswer(const hexmembrane::PaddedRings& displacement, hexmembrane::PaddedRings& sum) const { (void)displacement, (void)sum; }
	//! Calls visit for every touching contact that this engine made in its last step, a particle of its membrane first. They have no friction.
	virtual void forEachContact(const VisitContact&) const {}
	//! Calls visit for each pair of spheres that this engine holds together beside their contact, or without one, as of its last step.
	virtual void forEachJoint(const VisitContact&) const {}
	//! Calls visit(id1, id2, normal, distances of the centres from the joint, stiffness) for each of them: as forEachBond().
	using VisitJointSpring = std::function<void(Body::id_t, Body::id_t, const Vector3r&, const std::array<Real, 2>&, const JointStiffness&)>;
	virtual void forEachJointSpring(const VisitJointSpring&) const {}
	//! Calls visit for every contact: those that `own` visits, and those of these engines. A pair with a joint is one contact, with the forces of both.
	static void forEachContactWith(const vector<shared_ptr<Engine>>& engines, const std::function<void(const VisitContact&)>& own,
	                               const VisitContact& visit);
	//! Adds their forces to those of `onParticles`, which belong to these bodies (N).
	void addContactForces(const vector<Body::id_t>& ids, vector<Vector3r>& onParticles) const;
	//! Calls visit(particle, id of a grain, unit vector from one to the other, kn) for each spring between them: as forEachBond().
	using VisitSupport = std::function<void(int, Body::id_t, const Vector3r&, Real)>;
	virtual void forEachSupport(const VisitSupport&) const {}
	//! Calls visit for each of these engines that is stepped and not dead.
	using Visit = std::function<void(const Stepped&)>;
	static void forEachOf(const vector<shared_ptr<Engine>>& engines, const Visit& visit);
	//! The list that such engines of a scene stand in, in either tier.
	static const vector<shared_ptr<Engine>>& enginesOf(const Scene& scene);
	//! Calls visit for each such engine of a scene, in either tier.
	static void forEachIn(const Scene& scene, const Visit& visit);
	//! The membrane that it acts on, none: no membrane.
	virtual const HexMembrane* actsOn() const { return nullptr; }
	//! Whether there may be several engines of this class in a list.
	virtual bool mayBeSeveral() const { return false; }
	//! In the compact tier: what it cannot do there. \throws std::runtime_error
	virtual void requireCompactScene() const {}
	//! In the reference tier: what in the scene would make it act wrongly. \throws std::runtime_error
	virtual void requireReferenceScene() const {}

protected:
	//! A step of `self` over YADE's bodies: its action() in the reference tier.
	void stepOverBodies(GlobalEngine& self);
};

/*! An engine that keeps the scene's contacts itself, so that O.interactions does not have them. */
class ContactKeeper {
public:
	virtual ~ContactKeeper() = default;
	//! The one of the scene's engines that is not dead; none: a scene of the reference tier.
	static const Engine* of(const Scene& scene);
	//! The one of the scene that holds contacts now; none: they are in O.interactions.
	static const ContactKeeper* in(const Scene& scene);
	virtual bool keepsContacts() const = 0;
	//! As StepView::contactForces(), of the last step.
	virtual vector<Vector3r> contactForces(const HexMembrane& membrane) const = 0;
	//! As StepView::forEachContact(), of the last step.
	virtual void forEachContact(const VisitContact& visit) const = 0;
	//! The engines that it steps.
	virtual const vector<shared_ptr<Engine>>& innerEngines() const = 0;
};

} // namespace yade
