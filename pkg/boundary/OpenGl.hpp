// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <dlfcn.h>
#include <stdexcept>
#include <string>

namespace hexmembrane {

// The few functions of OpenGL 1.1 that the shapes are drawn with, taken from the library that the 3D view has loaded. So neither a build without
// OpenGL's headers nor a run without a screen needs any of it.
struct OpenGl {
	static constexpr unsigned lines = 1, lineLoop = 2, triangleFan = 6, quadStrip = 8; // from OpenGL's specification
	static constexpr unsigned lighting = 0x0B50, enableBit = 0x2000;

	void (*begin)(unsigned);
	void (*end)();
	void (*color)(double, double, double);
	void (*normal)(double, double, double);
	void (*vertex)(double, double, double);
	void (*disable)(unsigned);
	void (*pushAttrib)(unsigned);
	void (*popAttrib)();

	// Found when something is drawn for the first time.
	static const OpenGl& get()
	{
		static const OpenGl functions;
		return functions;
	}

	// Lines in one colour: with lighting they would take the shade of the last normal that something else was drawn with.
	template <typename Draw>
	void unlit(const Draw& draw) const
	{
		pushAttrib(enableBit);
		disable(lighting);
		draw();
		popAttrib();
	}

private:
	OpenGl()
	{
		find("glBegin", begin);
		find("glEnd", end);
		find("glColor3d", color);
		find("glNormal3d", normal);
		find("glVertex3d", vertex);
		find("glDisable", disable);
		find("glPushAttrib", pushAttrib);
		find("glPopAttrib", popAttrib);
	}

	template <typename Function>
	static void find(const char* name, Function& function)
	{
		void* symbol = dlsym(RTLD_DEFAULT, name);
		if (!symbol) {
			void* library = dlopen("libGL.so.1", RTLD_LAZY);
			symbol = library ? dlsym(library, name) : nullptr;
		}
		if (!symbol) throw std::runtime_error(std::string("hexmembrane: OpenGL's ") + name + " was not found; fix: install libGL.so.1");
		function = reinterpret_cast<Function>(symbol);
	}
};

} // namespace hexmembrane
