// SPDX-License-Identifier: GPL-2.0-or-later
/* Stands in for the screen in test_gl_view.py, which loads it before YADE (LD_PRELOAD): GLUT starts without a display, and the corners that are
 * drawn are kept with the number of the body that they belong to. OpenGL's other functions do nothing as long as there is no window. */
#include <array>
#include <vector>

namespace {
std::vector<std::array<double, 4>> corners; // body, x, y, z
unsigned currentBody = 0;
} // namespace

extern "C" {
// freeglut's own functions end the program where there is no display.
void glutInit(int*, char**) {}
void glutSolidSphere(double, int, int) {}
void glutWireSphere(double, int, int) {}

void glPushName(unsigned body) { currentBody = body; }
void glVertex3d(double x, double y, double z) { corners.push_back({double(currentBody), x, y, z}); }

int recordedCorners() { return int(corners.size()); }
double recordedCorner(int i, int component) { return corners[i][component]; }
}
