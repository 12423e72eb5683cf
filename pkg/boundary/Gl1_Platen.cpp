// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Gl1_Platen.hpp"

#ifdef YADE_OPENGL

#include "OpenGl.hpp"

#include <algorithm>
#include <cmath>

namespace yade {

YADE_PLUGIN((Gl1_Platen));

int Gl1_Platen::slices;

void Gl1_Platen::go(const shared_ptr<Shape>& shape, const shared_ptr<State>&, bool wire, const GLViewInfo&)
{
	using hexmembrane::OpenGl;
	const OpenGl& gl = OpenGl::get();
	const Platen& platen = static_cast<const Platen&>(*shape);
	const double radius = platen.radius, top = 0.5 * platen.height;
	const int count = std::clamp(slices, 3, 1000);
	const auto turn = [&](int i) { return 2 * 3.14159265358979323846 * i / count; };
	const auto rim = [&](int i, double z) { gl.vertex(radius * std::cos(turn(i)), radius * std::sin(turn(i)), z); };

	gl.color(platen.color[0], platen.color[1], platen.color[2]);
	if (wire || platen.wire) {
		gl.unlit([&] {
			for (const double z : {-top, top}) {
				gl.begin(OpenGl::lineLoop);
				for (int i = 0; i < count; i++) rim(i, z);
				gl.end();
			}
			gl.begin(OpenGl::lines);
			for (int i = 0; i < count; i += std::max(1, count / 12)) {
				rim(i, -top);
				rim(i, top);
			}
			gl.end();
		});
		return;
	}
	gl.begin(OpenGl::quadStrip);
	for (int i = 0; i <= count; i++) {
		gl.normal(std::cos(turn(i)), std::sin(turn(i)), 0);
		rim(i, top);
		rim(i, -top);
	}
	gl.end();
	for (const int side : {-1, 1}) {
		gl.begin(OpenGl::triangleFan);
		gl.normal(0, 0, side);
		gl.vertex(0, 0, side * top);
		// Counter-clockwise as seen from outside, so that neither face is culled.
		for (int i = 0; i <= count; i++) rim(side * i, side * top);
		gl.end();
	}
}

} // namespace yade

#endif
