// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Gl1_Platen.hpp"

#ifdef YADE_OPENGL

#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <stdexcept>
#include <string>

namespace yade {

YADE_PLUGIN((Gl1_Platen));

int Gl1_Platen::slices;

namespace {

// The few functions of OpenGL 1.1 that are needed, taken from the library that the 3D view has loaded. So neither a build without OpenGL's headers nor
// a run without a screen needs any of it.
struct OpenGl {
	void (*begin)(unsigned);
	void (*end)();
	void (*color)(double, double, double);
	void (*normal)(double, double, double);
	void (*vertex)(double, double, double);

	OpenGl()
	{
		find("glBegin", begin);
		find("glEnd", end);
		find("glColor3d", color);
		find("glNormal3d", normal);
		find("glVertex3d", vertex);
	}

private:
	template <typename Function>
	static void find(const char* name, Function& function)
	{
		void* symbol = dlsym(RTLD_DEFAULT, name);
		if (!symbol) {
			void* library = dlopen("libGL.so.1", RTLD_LAZY);
			symbol = library ? dlsym(library, name) : nullptr;
		}
		if (!symbol) throw std::runtime_error(std::string("Gl1_Platen: OpenGL's ") + name + " was not found; fix: install libGL.so.1");
		function = reinterpret_cast<Function>(symbol);
	}
};

constexpr unsigned glLines = 1, glLineLoop = 2, glTriangleFan = 6, glQuadStrip = 8; // from OpenGL's specification

} // namespace

void Gl1_Platen::go(const shared_ptr<Shape>& shape, const shared_ptr<State>&, bool wire, const GLViewInfo&)
{
	static const OpenGl gl;
	const Platen& platen = static_cast<const Platen&>(*shape);
	const double radius = platen.radius, top = 0.5 * platen.height;
	const int count = std::clamp(slices, 3, 1000);
	const auto turn = [&](int i) { return 2 * 3.14159265358979323846 * i / count; };
	const auto rim = [&](int i, double z) { gl.vertex(radius * std::cos(turn(i)), radius * std::sin(turn(i)), z); };

	gl.color(platen.color[0], platen.color[1], platen.color[2]);
	if (wire || platen.wire) {
		for (const double z : {-top, top}) {
			gl.begin(glLineLoop);
			for (int i = 0; i < count; i++) rim(i, z);
			gl.end();
		}
		gl.begin(glLines);
		for (int i = 0; i < count; i += std::max(1, count / 12)) {
			rim(i, -top);
			rim(i, top);
		}
		gl.end();
		return;
	}
	gl.begin(glQuadStrip);
	for (int i = 0; i <= count; i++) {
		gl.normal(std::cos(turn(i)), std::sin(turn(i)), 0);
		rim(i, top);
		rim(i, -top);
	}
	gl.end();
	for (const int side : {-1, 1}) {
		gl.begin(glTriangleFan);
		gl.normal(0, 0, side);
		gl.vertex(0, 0, side * top);
		// Counter-clockwise as seen from outside, so that neither face is culled.
		for (int i = 0; i <= count; i++) rim(side * i, side * top);
		gl.end();
	}
}

} // namespace yade

#endif
