// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#ifdef YADE_OPENGL

#include "Platen.hpp"

#include <pkg/common/GLDrawFunctors.hpp>

namespace yade {

class Gl1_Platen : public GlShapeFunctor {
public:
	void go(const shared_ptr<Shape>& shape, const shared_ptr<State>& state, bool wire, const GLViewInfo& view) override;
	RENDERS(Platen);
	// clang-format off
	YADE_CLASS_BASE_DOC_STATICATTRS(Gl1_Platen,GlShapeFunctor,
		"Draws a Platen in the 3D view: solid, or its edges and some lines of the side where the body or the view is set to wire.",
		((int,slices,48,,"Number of flat strips that the round side is drawn with, 3 to 1000."))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(Gl1_Platen);

} // namespace yade

#endif
