// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/boundary/PlatenContact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace hexmembrane;

constexpr double pi = 3.14159265358979323846;

// Upright platen at the origin.
SolidCylinder upright(double radius, double halfHeight) { return {Vec3::Zero(), Vec3::UnitZ(), radius, halfHeight}; }

// Least value of a function with one minimum between a and b, by golden section.
template <typename Function>
double goldenMinimum(const Function& f, double a, double b)
{
	const double ratio = (std::sqrt(5.) - 1) / 2;
	double c = b - ratio * (b - a), d = a + ratio * (b - a), fc = f(c), fd = f(d), least = std::min({f(a), f(b), fc, fd});
	for (int i = 0; i < 60; i++) {
		if (fc < fd) {
			b = d;
			d = c;
			fd = fc;
			c = b - ratio * (b - a);
			fc = f(c);
		} else {
			a = c;
			c = d;
			fc = fd;
			d = a + ratio * (b - a);
			fd = f(d);
		}
		least = std::min({least, fc, fd});
	}
	return least;
}

// Slow oracle that knows nothing of regions: the surface is swept by straight lines (the diameters of both ends, the lines up the mantle), each at an angle;
// the distance is minimised along each line, then over the angle (a scan, then the neighbourhood of its best). Returns the unsigned distance.
double searchedDistance(const SolidCylinder& solid, const Vec3& x)
{
	const Vec3 u = anyPerpendicular(solid.axis), v = solid.axis.cross(u);
	double best = std::numeric_limits<double>::infinity();
	for (int patch = 0; patch < 3; patch++) {
		const auto toLine = [&](double angle) {
			const Vec3 out = solid.radius * (std::cos(angle) * u + std::sin(angle) * v);
			const Vec3 up = solid.halfHeight * solid.axis;
			const Vec3 mid = solid.centre + (patch == 0 ? up : patch == 1 ? Vec3(-up) : out);
			const Vec3 half = patch == 2 ? up : out;
			return goldenMinimum([&](double s) { return (mid + s * half - x).norm(); }, -1, 1);
		};
		const int scan = 90;
		int least = 0;
		for (int i = 1; i < scan; i++)
			if (toLine(2 * pi * i / scan) < toLine(2 * pi * least / scan)) least = i;
		best = std::min(best, goldenMinimum(toLine, 2 * pi * (least - 1) / scan, 2 * pi * (least + 1) / scan));
	}
	return best;
}

bool inside(const SolidCylinder& solid, const Vec3& x)
{
	const double z = (x - solid.centre).dot(solid.axis);
	return std::abs(z) < solid.halfHeight && (x - solid.centre - z * solid.axis).norm() < solid.radius;
}

Vec3 randomUnit(std::mt19937& random)
{
	std::normal_distribution<double> gauss;
	return Vec3(gauss(random), gauss(random), gauss(random)).normalized();
}

TEST(PlatenContact, FaceClosedForm)
{
	const SolidCylinder solid = upright(2, 0.5);
	for (const double sign : {1., -1.}) {
		const Vec3 x(0.3, -1.2, sign * 0.9);
		const PlatenContact contact = platenContact(solid, x, 0.5);
		EXPECT_EQ(contact.region, PlatenRegion::face);
		EXPECT_NEAR(contact.penetration, 0.1, 1e-15);
		EXPECT_EQ(contact.normal, Vec3(0, 0, sign));
		// Overlap from z = 0.4 (sphere) to 0.5 (face): half way is 0.45.
		EXPECT_LT((contact.point - Vec3(0.3, -1.2, sign * 0.45)).norm(), 1e-15);
		EXPECT_LT((closestOnPlaten(solid, x).point - Vec3(0.3, -1.2, sign * 0.5)).norm(), 1e-15);
	}
}

TEST(PlatenContact, SideClosedForm)
{
	const SolidCylinder solid = upright(2, 0.5);
	const Vec3 radial(std::cos(0.7), std::sin(0.7), 0);
	const Vec3 x = 2.3 * radial + Vec3(0, 0, -0.2);
	const PlatenContact contact = platenContact(solid, x, 0.5);
	EXPECT_EQ(contact.region, PlatenRegion::side);
	EXPECT_NEAR(contact.penetration, 0.2, 1e-15);
	EXPECT_LT((contact.normal - radial).norm(), 1e-15);
	EXPECT_LT((contact.point - (1.9 * radial + Vec3(0, 0, -0.2))).norm(), 1e-15);
}

TEST(PlatenContact, RimClosedForm)
{
	// 3-4-5: 0.3 beyond the side, 0.4 above the face, hence 0.5 from the edge.
	const SolidCylinder solid = upright(2, 0.5);
	const Vec3 x(-2.3, 0, 0.9);
	const PlatenContact contact = platenContact(solid, x, 0.6);
	EXPECT_EQ(contact.region, PlatenRegion::rim);
	EXPECT_NEAR(contact.penetration, 0.1, 1e-15);
	EXPECT_LT((contact.normal - Vec3(-0.6, 0, 0.8)).norm(), 1e-15);
	EXPECT_LT((closestOnPlaten(solid, x).point - Vec3(-2, 0, 0.5)).norm(), 1e-15);
	EXPECT_LT((contact.point - (x - 0.55 * Vec3(-0.6, 0, 0.8))).norm(), 1e-15);
}

TEST(PlatenContact, GapIsNegativePenetration)
{
	const PlatenContact contact = platenContact(upright(2, 0.5), Vec3(0, 0, 1.5), 0.25);
	EXPECT_NEAR(contact.penetration, -0.75, 1e-15);
	EXPECT_LT((contact.point - Vec3(0, 0, 0.875)).norm(), 1e-15); // half way through the gap, 0.5 to 1.25
}

TEST(PlatenContact, CentreInsideIsPushedOutThroughTheNearestSurface)
{
	const SolidCylinder flat = upright(2, 0.5);
	const PlatenContact low = platenContact(flat, Vec3(0.1, 0.2, -0.4), 0.3);
	EXPECT_EQ(low.region, PlatenRegion::face);
	EXPECT_EQ(low.normal, Vec3(0, 0, -1));
	EXPECT_NEAR(low.penetration, 0.4, 1e-15);
	const PlatenContact edge = platenContact(flat, Vec3(0, -1.9, 0.2), 0.3);
	EXPECT_EQ(edge.region, PlatenRegion::side);
	EXPECT_LT((edge.normal - Vec3(0, -1, 0)).norm(), 1e-15);
	EXPECT_NEAR(edge.penetration, 0.4, 1e-15);
}

TEST(PlatenContact, TiesHaveOneAnswer)
{
	// Equally near to face and side: the face. Half way between the ends: the end of positive z, for -0.0 too.
	EXPECT_EQ(closestOnPlaten(upright(2, 2), Vec3(1.5, 0, 1.5)).region, PlatenRegion::face);
	EXPECT_EQ(closestOnPlaten(upright(2, 0.5), Vec3(0, 0, 0)).normal, Vec3(0, 0, 1));
	EXPECT_EQ(closestOnPlaten(upright(2, 0.5), Vec3(0, 0, -0.)).normal, Vec3(0, 0, 1));
	// On the axis of a tall cylinder every direction is equally near; one at right angles to the axis is taken, and always the same.
	std::mt19937 random(3);
	for (int i = 0; i < 100; i++) {
		const SolidCylinder tall{Vec3(1, 2, 3), randomUnit(random), 0.25, 3};
		const PlatenSurfacePoint nearest = closestOnPlaten(tall, tall.centre), again = closestOnPlaten(tall, tall.centre);
		EXPECT_EQ(nearest.region, PlatenRegion::side);
		EXPECT_NEAR(nearest.distance, -0.25, 1e-15);
		EXPECT_NEAR(nearest.normal.dot(tall.axis), 0, 1e-15);
		EXPECT_NEAR(nearest.normal.norm(), 1, 1e-15);
		EXPECT_EQ(nearest.normal, again.normal);
	}
}

TEST(PlatenContact, CentreOnTheSurface)
{
	// Distance 0 leaves no direction from the point itself; the normal must still be the surface's.
	EXPECT_EQ(platenContact(upright(2, 0.5), Vec3(1, 0, 0.5), 0.25).normal, Vec3(0, 0, 1));
	EXPECT_EQ(platenContact(upright(2, 0.5), Vec3(0, 2, 0.1), 0.25).normal, Vec3(0, 1, 0));
	const PlatenContact edge = platenContact(upright(2, 0.5), Vec3(2, 0, -0.5), 0.25);
	EXPECT_EQ(edge.normal, Vec3(0, 0, -1));
	EXPECT_NEAR(edge.penetration, 0.25, 1e-15);
}

TEST(PlatenContact, EqualsSearchOfTheSurface)
{
	std::mt19937 random(20240511);
	std::uniform_real_distribution<double> uniform(-1, 1);
	int seen[3] = {0, 0, 0}, insideSeen = 0;
	for (int trial = 0; trial < 150; trial++) {
		const double radius = 1 + 0.9 * uniform(random), halfHeight = 1 + 0.9 * uniform(random);
		const SolidCylinder solid{Vec3(uniform(random), uniform(random), uniform(random)), randomUnit(random), radius, halfHeight};
		const Vec3 x = solid.centre + 1.5 * (radius + halfHeight) * uniform(random) * randomUnit(random);
		const PlatenSurfacePoint nearest = closestOnPlaten(solid, x);
		const double sign = inside(solid, x) ? -1 : 1;
		// Golden section finds a minimum's place to the root of the rounding error, its value to the rounding error.
		EXPECT_NEAR(nearest.distance, sign * searchedDistance(solid, x), 1e-12) << "trial " << trial;
		EXPECT_NEAR((nearest.point - x).norm(), std::abs(nearest.distance), 1e-13);
		EXPECT_NEAR(nearest.normal.norm(), 1, 1e-14);
		EXPECT_LT((x - nearest.point - nearest.distance * nearest.normal).norm(), 1e-13);
		seen[static_cast<int>(nearest.region)]++;
		insideSeen += sign < 0;
	}
	EXPECT_GT(seen[0], 10);
	EXPECT_GT(seen[1], 10);
	EXPECT_GT(seen[2], 10);
	EXPECT_GT(insideSeen, 10);
}

TEST(PlatenContact, OracleSeesAWrongDistance)
{
	const SolidCylinder solid = upright(2, 0.5);
	const Vec3 x(-2.3, 0, 0.9);
	EXPECT_NEAR(searchedDistance(solid, x), 0.5, 1e-9);
	EXPECT_GT(std::abs(searchedDistance(upright(1.99, 0.5), x) - 0.5), 1e-3);
}

TEST(PlatenContact, NormalIsTheGradientOfTheDistance)
{
	std::mt19937 random(7);
	std::uniform_real_distribution<double> uniform(-1, 1);
	int tried = 0;
	for (int trial = 0; trial < 400; trial++) {
		const SolidCylinder solid{Vec3::Zero(), randomUnit(random), 1, 0.6};
		const Vec3 x = 2.5 * uniform(random) * randomUnit(random);
		if (inside(solid, x)) continue; // kinks of the medial axis; the oracle above covers it
		const double step = 1e-6;
		if (closestOnPlaten(solid, x).distance < 10 * step) continue;
		for (int i = 0; i < 3; i++) {
			const Vec3 delta = step * Vec3::Unit(i);
			const double gradient = (closestOnPlaten(solid, x + delta).distance - closestOnPlaten(solid, x - delta).distance) / (2 * step);
			EXPECT_NEAR(gradient, closestOnPlaten(solid, x).normal[i], 1e-5);
		}
		tried++;
	}
	EXPECT_GT(tried, 100);
}

TEST(PlatenContact, ContinuousAcrossTheRegions)
{
	// Round the edge at a distance of 0.1, from above the face to beside the side: no step of the normal may exceed the turn of the path.
	const SolidCylinder solid = upright(2, 0.5);
	const int steps = 20000;
	Vec3 before;
	PlatenRegion region = PlatenRegion::face;
	int changes = 0;
	for (int i = 0; i <= steps; i++) {
		const double s = 4. * i / steps - 2; // arc length from the edge's start: s < 0 over the face, then a quarter circle, then down the side
		const double quarter = 0.1 * pi / 2;
		Vec3 x;
		if (s < 0)
			x = Vec3(2 + s * 0.5, 0, 0.6);
		else if (s < quarter)
			x = Vec3(2 + 0.1 * std::sin(s / 0.1), 0, 0.5 + 0.1 * std::cos(s / 0.1));
		else
			x = Vec3(2.1, 0, 0.5 - (s - quarter) * 0.5);
		const PlatenSurfacePoint nearest = closestOnPlaten(solid, x);
		EXPECT_NEAR(nearest.distance, 0.1, 1e-14);
		if (i > 0) {
			EXPECT_LT((nearest.normal - before).norm(), 2.001e-3); // 4/20000 of arc over a radius of 0.1
			changes += nearest.region != region;
		}
		region = nearest.region;
		before = nearest.normal;
	}
	EXPECT_EQ(changes, 2);
	// Through a face and through the side the penetration is continuous although the case changes.
	for (const Vec3& out : {Vec3(0, 0, 1), Vec3(1, 0, 0)}) {
		const Vec3 surface = out[2] > 0 ? Vec3(0.4, 0.1, 0.5) : Vec3(2, 0, 0.1);
		const double above = platenContact(solid, surface + 1e-9 * out, 0.3).penetration;
		const double below = platenContact(solid, surface - 1e-9 * out, 0.3).penetration;
		EXPECT_NEAR(below - above, 2e-9, 1e-14);
	}
}

TEST(PlatenContact, MovesAndTurnsWithTheBody)
{
	std::mt19937 random(11);
	std::uniform_real_distribution<double> uniform(-1, 1);
	for (int trial = 0; trial < 300; trial++) {
		const Vec3 x = 2.5 * Vec3(uniform(random), uniform(random), uniform(random));
		const SolidCylinder solid = upright(1.2, 0.4);
		const Eigen::Matrix3d turn =
		        Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), uniform(random)).normalized().toRotationMatrix();
		const Vec3 shift(uniform(random), uniform(random), uniform(random));
		const SolidCylinder moved{shift, turn.col(2), 1.2, 0.4};
		const PlatenContact here = platenContact(solid, x, 0.3), there = platenContact(moved, shift + turn * x, 0.3);
		EXPECT_NEAR(here.penetration, there.penetration, 1e-14);
		EXPECT_LT((turn * here.normal - there.normal).norm(), 1e-12);
		EXPECT_LT((shift + turn * here.point - there.point).norm(), 1e-13);
		// Turned upside down it is the same solid; mirrored in its middle plane so is the contact.
		const PlatenContact over = platenContact({shift, -turn.col(2), 1.2, 0.4}, shift + turn * x, 0.3);
		EXPECT_NEAR(over.penetration, there.penetration, 1e-15);
		const PlatenContact mirrored = platenContact(solid, Vec3(x[0], x[1], -x[2]), 0.3);
		EXPECT_EQ(mirrored.penetration, here.penetration);
		EXPECT_EQ(mirrored.normal, Vec3(here.normal[0], here.normal[1], -here.normal[2]));
	}
}

TEST(PlatenContact, NanStaysNan)
{
	const double nan = std::numeric_limits<double>::quiet_NaN();
	EXPECT_TRUE(std::isnan(platenContact(upright(2, 0.5), Vec3(0, nan, 0), 0.3).penetration));
	EXPECT_TRUE(std::isnan(platenContact(upright(2, 0.5), Vec3(0, 0, nan), 0.3).penetration));
}

TEST(PlatenContact, BoundIsTightForAnyOrientation)
{
	EXPECT_EQ(platenHalfExtent(upright(2, 0.5)), Vec3(2, 2, 0.5));
	std::mt19937 random(5);
	for (int trial = 0; trial < 20; trial++) {
		const SolidCylinder solid{Vec3::Zero(), randomUnit(random), 1.3, 0.7};
		const Vec3 u = anyPerpendicular(solid.axis), v = solid.axis.cross(u);
		Vec3 reach = Vec3::Zero();
		for (int j = 0; j < 40000; j++) {
			const double angle = 2 * pi * j / 40000;
			const Vec3 edge = 1.3 * (std::cos(angle) * u + std::sin(angle) * v) + 0.7 * solid.axis;
			reach = reach.cwiseMax(edge).cwiseMax(-edge);
		}
		for (int i = 0; i < 3; i++) {
			EXPECT_GE(platenHalfExtent(solid)[i], reach[i] - 1e-14);
			EXPECT_NEAR(platenHalfExtent(solid)[i], reach[i], 1e-7); // 1 - cos(pi / 40000) = 3e-9
		}
	}
}

} // namespace
