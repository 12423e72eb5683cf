// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "compact/Stepped.hpp"

namespace yade {

/*! Calls visit for every touching contact of the last step, in either tier. `who` asks. \throws std::runtime_error for a contact whose law does not tell its forces */
void forEachContactOf(const Scene& scene, const string& who, const VisitContact& visit);

/*! The reference tier's StepView: YADE's bodies, forces and interactions. */
class BodyView : public StepView {
public:
	BodyView(Scene& s, const string& engine) : scene(s), who(engine) {}

	const hexmembrane::PaddedRings& positions(const HexMembrane& membrane) override;
	void refresh(const Sheet& sheet) override;
	void addForces(const HexMembrane& membrane, const vector<RingRange>& rings, const hexmembrane::PaddedRings& force,
	               const hexmembrane::PaddedRings* torque, WorkMeter* meter) override;
	void grip(const HexMembrane& membrane, const vector<std::pair<int, Vector3r>>& rings, WorkMeter& meter) override;
	hexmembrane::SphereRows grains(const HexMembrane& membrane) override;
	void addForce(int grain, const Vector3r& force) override;
	MovingRows moving(const vector<Body::id_t>& ids) override;
	void addLoad(int row, const hexmembrane::Load& load) override;
	vector<Vector3r> contactForces(const HexMembrane& membrane) override;
	ContactSums contacts(Body::id_t boundary) override;
	Real stiffness(Body::id_t boundary, const Vector3r& along) override;
	Real touchingMass(Body::id_t boundary) override;
	void forEachContact(const VisitContact& visit) override;

private:
	Scene& scene;
	const string who;
	hexmembrane::PaddedRings rows;
	const HexMembrane* rowsOf = nullptr;
	vector<hexmembrane::Place> grainPlaces;
	vector<Body::id_t> grainIds;
	const HexMembrane* grainsBeside = nullptr; //!< membrane that they are not of
	vector<hexmembrane::Place> movingPlaces;
	vector<hexmembrane::Motion> motions;
	const vector<Body::id_t>* movingIds = nullptr;
};

} // namespace yade
