// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"
#include "kernels/contact/ParallelBond.hpp"

#include <vector>

namespace hexmembrane {

/// Parallel bonds of pairs of spheres, whoever keeps the spheres. The same bits for any number of threads: each sphere's loads are added in the bonds' order.
class BondTable {
public:
	/// A bond and what it remembers; all of it is plain numbers.
	struct Bond {
		int id1, id2; ///< of its spheres
		ParallelBond<double> made;
		ParallelLoads<double> loads;
		Vec3 centre;       ///< of the first sphere when the loads were computed (m)
		double difference; ///< R1 - R2 (m)
		bool begun;        ///< false: no step yet, nothing has moved since it was made
	};
	/// A bond between two spheres as they are, without loads. \param radius of the disc (m) \param kn, ks stiffness by area (N/m3)
	static Bond between(int id1, int id2, const Place& first, const Place& second, double radius, double kn, double ks);
	/// A new bond with loads on its second sphere, as one has that was made long ago: its rest length follows from the force along the line of centres.
	static Bond loaded(Bond bond, const Vec3& force, const Vec3& moment);
	/// From the centre of the first sphere to the second's when the loads were computed (m).
	static double distanceOf(const Bond& bond);
	/// From the centres to the contact point, along the normal (m).
	struct Arms {
		double first, second;
	};
	static Arms armsOf(const Bond& bond, double distance) { return {0.5 * (distance + bond.difference), -0.5 * (distance - bond.difference)}; }

	/// The bonds that hold, sorted by where their spheres stand. What changes them calls locate() before the next step.
	std::vector<Bond> bonds;

	/// Says where the spheres stand: row r is the sphere ids[r]. Sorts the bonds. \throws FieldError (ids) for a bonded sphere that is not among them
	void locate(const int* ids, int count);
	/// A step of all bonds; those that break are taken out. \param places, motions by the rows of locate()
	void step(const Place* places, const Motion* motions, double dt, const ParallelStrength& strength);
	/// Calls visit(row, load) for each sphere that bonds act on, as of the last step: parallel, each row once.
	template <typename Visit>
	void forEachLoad(Visit&& visit) const
	{
		const long count = long(rows.size());
#pragma omp parallel for schedule(static) if (count > worthThreads)
		for (long r = 0; r < count; ++r) visit(rows[r], summed[r]);
	}

	/// Bonds that broke in the last step, and the elastic energy that they set free (J).
	int tensileBreaks = 0, shearBreaks = 0;
	double freed = 0;

	/// Elastic energy of all bonds (J), as of the last step.
	double energy() const;

private:
	static constexpr long worthThreads = 500; ///< fewer bonds or spheres are done before threads have met
	/// What a bond does to its spheres.
	struct Action {
		Vec3 force, torque1, torque2; ///< the force on the second one
	};
	BondBreak advance(Bond& bond, const Place& first, const Place& second, const Motion& motion1, const Motion& motion2, double dt,
	                  const ParallelStrength& strength, Action& action) const;
	void list();
	void removeBroken();

	struct Pair {
		int first, second; ///< rows
	};
	std::vector<Pair> pairs; ///< of the bonds
	std::vector<Action> actions;
	std::vector<BondBreak> breaks;
	std::vector<int> rows, start, ends; ///< spheres with bonds; where the ends of each begin in `ends`; twice a bond's index, plus 1 for its second sphere
	std::vector<Load> summed;           ///< of `rows`
	bool listed = false;                ///< false: `rows`, `start` and `ends` are of bonds that are gone
};

} // namespace hexmembrane
