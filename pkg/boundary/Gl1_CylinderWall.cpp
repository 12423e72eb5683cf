// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Gl1_CylinderWall.hpp"

#ifdef YADE_OPENGL

#include "OpenGl.hpp"

#include <algorithm>
#include <cmath>

namespace yade {

YADE_PLUGIN((Gl1_CylinderWall));

int Gl1_CylinderWall::slices;
int Gl1_CylinderWall::rings;

void Gl1_CylinderWall::go(const shared_ptr<Shape>& shape, const shared_ptr<State>& state, bool, const GLViewInfo&)
{
	using hexmembrane::OpenGl;
	const OpenGl& gl = OpenGl::get();
	const CylinderWall& wall = static_cast<const CylinderWall&>(*shape);
	const double radius = wall.radius, height = wall.height;
	const int count = std::clamp(slices, 3, 1000), last = std::clamp(rings, 2, 1000) - 1;
	// The view has turned its axes with the body; the wall stays upright.
	const Quaternionr upright = state->ori.conjugate();
	const auto draw = [&](int i, double z) {
		const double turn = 2 * 3.14159265358979323846 * i / count;
		const Vector3r point = upright * Vector3r(radius * std::cos(turn), radius * std::sin(turn), z);
		gl.vertex(point[0], point[1], point[2]);
	};

	gl.color(wall.color[0], wall.color[1], wall.color[2]);
	gl.unlit([&] {
		for (int ring = 0; ring <= last; ring++) {
			gl.begin(OpenGl::lineLoop);
			for (int i = 0; i < count; i++) draw(i, height * (double(ring) / last - 0.5));
			gl.end();
		}
		gl.begin(OpenGl::lines);
		for (int i = 0; i < count; i += std::max(1, count / 12)) {
			draw(i, -0.5 * height);
			draw(i, 0.5 * height);
		}
		gl.end();
	});
}

} // namespace yade

#endif
