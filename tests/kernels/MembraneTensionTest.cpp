// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/MembraneTension.hpp"
#include "tests/kernels/oracle/BondForceReference.hpp"

using namespace hexmembrane;

namespace {

constexpr double kn = 700, small = 1e-6;

/// Springs and sheet constants of the lattice: E t = 2 sqrt(3) kn (kn + ks)/(3 kn + ks), nu = (kn - ks)/(3 kn + ks).
struct Sheet {
	double ks;
	double stiffness() const { return 2 * std::sqrt(3.) * kn * (kn + ks) / (3 * kn + ks); }
	double poisson() const { return (kn - ks) / (3 * kn + ks); }
	/// Membrane force (N/m) along a direction strained by `along`, the other one by `across`.
	double force(double along, double across) const { return stiffness() / (1 - poisson() * poisson()) * (along + poisson() * across); }
};

/// A tube of radius 0.02 m and n spheres a ring, strained from its generated state in one step.
struct Strained {
	HexLattice tube;
	BondForce bonds;
	reference::Memory memory;
	std::vector<Vec3> x, force;

	Strained(int n, double ks, double hoop, double axial)
	    : tube(makeHexLattice({0.02, 0.04, 0.02 * std::sin(M_PI / n), Placement::centred, 1, 1})), bonds(tube, [ks] {
		      BondLaw law;
		      law.kn = kn;
		      law.ks = ks;
		      return law;
	      }())
	{
		place(bonds.position, [&](int p) { return tube.positions[p]; });
		memory.restLength = bonds.lengths();
		for (const auto& p : tube.positions) x.emplace_back(p[0] * (1 + hoop), p[1] * (1 + hoop), p[2] * (1 + axial));
		place(bonds.position, [&](int p) { return x[p]; });
		if (ks > 0) place(bonds.velocity, [&](int p) { return Vec3(x[p] - tube.positions[p]); });
		bonds.compute(memory.state(), 1.);
		for (int p = 0; p < tube.particles(); ++p) force.push_back(bonds.force.get(p / tube.perRing, p % tube.perRing));
	}

	template <typename Value>
	void place(PaddedRings& field, const Value& value)
	{
		for (int k = 0; k < tube.rings; ++k) {
			for (int i = 0; i < tube.perRing; ++i) field.set(k, i, value(k * tube.perRing + i));
			field.wrap(k);
		}
	}

	double tension(double z) { return axialTension(tube, x, bondForces(bonds, memory.state()), {z})[0]; }
	/// Pull of the middle ring over its area.
	double pressure() const
	{
		const RingLoad load = ringLoads(tube, x, force, tube.sphereRadius)[tube.rings / 2];
		return load.force / load.area;
	}
	double innerRadius() const { return tube.innerRadius; }
};

} // namespace

class MembraneTension : public testing::TestWithParam<double> {};

TEST_P(MembraneTension, radialStretchGivesHoopForceOverRadius)
{
	const Sheet sheet{GetParam()};
	for (const double axial : {0., -sheet.poisson() * small}) { // length kept; no axial force
		Strained coarse(63, GetParam(), small, axial), fine(126, GetParam(), small, axial);
		const double hoop = sheet.force(small, axial);
		const double errorCoarse = coarse.pressure() * coarse.innerRadius() / hoop - 1, errorFine = fine.pressure() * fine.innerRadius() / hoop - 1;
		EXPECT_LT(std::abs(errorFine), 1e-3);
		EXPECT_NEAR(errorCoarse / errorFine, 4, 0.1); // nothing but the lattice's own second-order error
		const double pull = 2 * M_PI * 0.02 * sheet.force(axial, small);
		EXPECT_NEAR(fine.tension(0.0203), pull, 1e-3 * 2 * M_PI * 0.02 * hoop);
	}
}

TEST_P(MembraneTension, axialStretchGivesThePullOfTheTube)
{
	const Sheet sheet{GetParam()};
	for (const double hoop : {0., -sheet.poisson() * small}) { // radius kept; no hoop force
		Strained s(126, GetParam(), hoop, small);
		const double wanted = 2 * M_PI * 0.02 * sheet.force(small, hoop);
		for (const double z : {0.0101, 0.0203, 0.0287}) EXPECT_NEAR(s.tension(z) / wanted, 1, 1e-3);
		EXPECT_NEAR(s.pressure() * s.innerRadius() / sheet.force(small, 0), sheet.force(hoop, small) / sheet.force(small, 0), 1e-3);
	}
}

INSTANTIATE_TEST_SUITE_P(springs, MembraneTension, testing::Values(0., 210.));

TEST(MembraneTension, aPlaneSeesWhatActsOnAllParticlesAboveIt)
{
	// the bonds' forces are internal: their sum over the particles not below a plane is what crosses it, whatever the shape
	for (const double ks : {0., 210.}) {
		Strained s(20, ks, 0.02, -0.03);
		support::shake(s.x, 2e-3, 5);
		s.place(s.bonds.position, [&](int p) { return s.x[p]; });
		s.bonds.compute(s.memory.state(), 1.);
		for (const double z : {0.004, 0.0171, 0.03}) {
			double above = 0, size = 0;
			for (int p = 0; p < s.tube.particles(); ++p) {
				const double f = s.bonds.force.get(p / s.tube.perRing, p % s.tube.perRing)[2];
				size += std::abs(f);
				if (s.x[p][2] >= z) above += f;
			}
			EXPECT_NEAR(s.tension(z), -above, 1e-12 * size);
		}
	}
}

TEST(MembraneTension, nothingCrossesAPlaneBeyondTheTube)
{
	Strained s(20, 0., 0., 0.01);
	EXPECT_EQ(s.tension(-1.), 0.);
	EXPECT_EQ(s.tension(1.), 0.);
}

TEST(MembraneTension, brokenBondsPullNoMore)
{
	Strained s(20, 0., 0., 0.01);
	ASSERT_GT(s.tension(0.0203), 0);
	s.memory.broken.assign(s.tube.bondCount(), 1);
	EXPECT_EQ(s.tension(0.0203), 0.);
}
