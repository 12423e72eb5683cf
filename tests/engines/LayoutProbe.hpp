// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/PartialEngine.hpp>

namespace yade {

/*! Shows what this plugin's C++ reads and writes in YADE's own objects.
 *
 * YADE installs no headers, so the plugin is compiled from a source tree with definitions derived from the program's feature list
 * (scripts/cmake/FindYADE.cmake). Were one of them wrong, members would lie at other offsets than in YADE's libraries. The test writes here and
 * reads through YADE's own Python bindings, and the other way round. */
class LayoutProbe : public PartialEngine {
public:
	void action() override;

	//! Every checked member as C++ sees it, by its Python name.
	boost::python::dict readBody(Body::id_t id) const;
	boost::python::dict readScene() const;
	boost::python::dict readInteraction(Body::id_t id1, Body::id_t id2) const;
	boost::python::dict readSelf() const;
	//! Gives every checked member a value of its own, counted up from `base`, and returns what was written.
	boost::python::dict writeBody(Body::id_t id, Real base);
	boost::python::dict writeScene(Real base);
	boost::python::dict writeInteraction(Body::id_t id1, Body::id_t id2, Real base);
	boost::python::dict writeSelf(Real base);

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(LayoutProbe,PartialEngine,
		"Diagnostic: reads and writes members of YADE's objects from this plugin's C++, to prove that the plugin was compiled with the class layouts of the YADE that has loaded it. "
		"Every ``read...`` returns a dict of member name (that of the Python attribute) and value as C++ sees it; every ``write...(..., base)`` gives these members values of their own, counted up from *base*, and returns them. "
		"As an engine it counts its steps. Errors: ``ValueError`` for a body or interaction that is not there.\n\nExample: ``LayoutProbe().readScene()['dt'] == O.dt``.",
		((long,steps,0,,"Number of steps run by this engine [-]."))
		((Vector3r,resultant,Vector3r::Zero(),Attr::readonly,"Sum of the forces on the bodies :yref:`ids<PartialEngine.ids>` at the last step [N].")),
		/*ctor*/,
		.def("readBody",&LayoutProbe::readBody,boost::python::arg("id"),"Members of the body, its state, shape (a sphere), bound and material.")
		.def("readScene",&LayoutProbe::readScene,"Members of the scene and its cell.")
		.def("readInteraction",&LayoutProbe::readInteraction,(boost::python::arg("id1"),boost::python::arg("id2")),"Members of the interaction, its ScGeom and FrictPhys.")
		.def("readSelf",&LayoutProbe::readSelf,"Members inherited from Engine and PartialEngine.")
		.def("writeBody",&LayoutProbe::writeBody,(boost::python::arg("id"),boost::python::arg("base")),"Writes what :yref:`LayoutProbe.readBody` reads.")
		.def("writeScene",&LayoutProbe::writeScene,boost::python::arg("base"),"Writes what :yref:`LayoutProbe.readScene` reads.")
		.def("writeInteraction",&LayoutProbe::writeInteraction,(boost::python::arg("id1"),boost::python::arg("id2"),boost::python::arg("base")),"Writes what :yref:`LayoutProbe.readInteraction` reads, except the ids.")
		.def("writeSelf",&LayoutProbe::writeSelf,boost::python::arg("base"),"Writes what :yref:`LayoutProbe.readSelf` reads.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(LayoutProbe);

} // namespace yade
