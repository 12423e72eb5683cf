// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/boundary/CylinderContact.hpp"

using namespace hexmembrane;

TEST(CylinderContact, closedForm)
{
	// 3-4-5: the centre is 5 from the axis
	const CylinderContact c = cylinderContact({1, 1, -7}, 6, {4, 5, 2}, 1.5);
	EXPECT_DOUBLE_EQ(c.penetration, 0.5);
	EXPECT_LT((c.normal - Vec3(-0.6, -0.8, 0)).norm(), 1e-15);
	EXPECT_LT((c.point - Vec3(1 + 0.6 * 6.25, 1 + 0.8 * 6.25, 2)).norm(), 1e-14) << "half way between the wall at 6 and the sphere's far side at 6.5";
}

TEST(CylinderContact, nearestPointOfTheWallByScan)
{
	// the overlap is the sphere's radius less the distance to the nearest point of the wall, for a centre inside
	for (const auto& centre : support::randomVectors(20, 0.6, 3)) {
		const CylinderContact c = cylinderContact(Vec3::Zero(), 1, centre, 0.3);
		double nearest = 10;
		for (int i = 0; i < 100000; ++i) {
			const double a = 2 * M_PI * i / 100000;
			nearest = std::min(nearest, (Vec3(std::cos(a), std::sin(a), centre[2]) - centre).norm());
		}
		EXPECT_NEAR(c.penetration, 0.3 - nearest, 1e-8);
	}
}

TEST(CylinderContact, centreOnTheAxisHasNoDirectionAndNoNan)
{
	const CylinderContact c = cylinderContact({0, 0, 0}, 1, {0, 0, 3}, 0.5);
	EXPECT_DOUBLE_EQ(c.penetration, -0.5);
	EXPECT_EQ(c.normal.norm(), 0);
	EXPECT_TRUE(c.point.allFinite());
}
