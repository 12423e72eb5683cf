// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <lib/serialization/Serializable.hpp>

#include <boost/python.hpp>

namespace yade {

/*! What bodies are and do as whole numpy arrays, one row a body. */
class BodyArrays : public Serializable {
public:
	static boost::python::object positions(const vector<Body::id_t>& ids);
	static boost::python::object displacements(const vector<Body::id_t>& ids);
	static boost::python::object velocities(const vector<Body::id_t>& ids);
	static boost::python::object forces(const vector<Body::id_t>& ids);
	static boost::python::object radii(const vector<Body::id_t>& ids);
	static boost::python::object masses(const vector<Body::id_t>& ids);
	static void setReference();

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(BodyArrays,Serializable,
		"Bodies' states as whole numpy arrays, one row for each id of a list, for scripts that look at many bodies: "
		"no loop over ``O.bodies`` in Python. The arrays are copies and read-only. "
		"They hold what ``O.bodies`` and ``O.forces`` do, in either tier.\n\n"
		"Errors: ``RuntimeError`` for a body that does not exist, or one without a radius, with its id.\n\n"
		"Example::\n\n\tx=BodyArrays.positions(membrane.ids)",
		,/*ctor*/,
		.def("positions",&BodyArrays::positions,boost::python::arg("ids"),"Centres [m], (N, 3).").staticmethod("positions")
		.def("displacements",&BodyArrays::displacements,boost::python::arg("ids"),"Centres less ``state.refPos`` [m], (N, 3).").staticmethod("displacements")
		.def("velocities",&BodyArrays::velocities,boost::python::arg("ids"),"Velocities [m/s], (N, 3).").staticmethod("velocities")
		.def("forces",&BodyArrays::forces,boost::python::arg("ids"),"Sums of all forces in the last step [N], (N, 3).").staticmethod("forces")
		.def("radii",&BodyArrays::radii,boost::python::arg("ids"),"Radii of spheres [m], (N,).").staticmethod("radii")
		.def("masses",&BodyArrays::masses,boost::python::arg("ids"),"Masses [kg], (N,).").staticmethod("masses")
		.def("setReference",&BodyArrays::setReference,
			"Makes the present places and orientations of all bodies those that displacements count from (``refPos``, ``refOri``).").staticmethod("setReference")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(BodyArrays);

} // namespace yade
