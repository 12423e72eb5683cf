// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#ifdef YADE_OPENGL

#include "CylinderWall.hpp"

#include <pkg/common/GLDrawFunctors.hpp>

namespace yade {

class Gl1_CylinderWall : public GlShapeFunctor {
public:
	void go(const shared_ptr<Shape>& shape, const shared_ptr<State>& state, bool wire, const GLViewInfo& view) override;
	RENDERS(CylinderWall);
	// clang-format off
	YADE_CLASS_BASE_DOC_STATICATTRS(Gl1_CylinderWall,GlShapeFunctor,
		"Draws a CylinderWall in the 3D view: always as lines, since a solid wall would hide the specimen inside.",
		((int,slices,48,,"Number of straight lines that a ring is drawn with, 3 to 1000."))
		((int,rings,5,,"Number of rings, the two ends included, 2 to 1000."))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(Gl1_CylinderWall);

} // namespace yade

#endif
