// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/BandSearch.hpp"

#include <core/Omega.hpp>
#include <lib/serialization/Serializable.hpp>

#include <boost/python.hpp>

namespace yade {

/*! Least squares of planes of shear in a step, for the search of hexmembrane.measure.bands. Looks at arrays alone, at no scene. */
class BandSearch : public Serializable {
public:
	using Given = boost::python::object;
	void setGrains(const Given& positions, const Given& displacements, const Given& weights, const Given& strains);
	boost::python::object symmetricStrain() const;
	boost::python::tuple left(const Given& beside) const;
	boost::python::object unlikely(const Given& planes, const Given& beside) const;
	boost::python::tuple jump(const Given& plane, const Given& beside, bool uniform) const;
	boost::python::tuple excess(const Given& plane, const Given& beside) const;
	boost::python::object refined(const Given& plane, const Given& limits, const Given& beside, Real tolerance, int trials) const;
	boost::python::object likeliest(const Given& planes, const Given& limits, Real diameter, int rounds, Real tolerance, int trials) const;
	boost::python::object slab(const Given& plane, const Given& limits, const Given& beside) const;

private:
	const hexmembrane::BandGrains& required() const;
	hexmembrane::BandField field(const Given& beside) const;

	std::shared_ptr<const hexmembrane::BandGrains> grains;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(BandSearch,Serializable,
		"What displacements and strains of grains in a step say about planes of shear, by weighted least squares; "
		"what :mod:`hexmembrane.measure.bands` searches with, and of which it makes its verdict. It looks at arrays alone, at no scene, and is not saved.\n\n"
		"A plane is an array of four: dip [rad], azimuth [rad], offset along its upward normal [m], logarithm of its thickness over 1 m. "
		"With s the distance from it and t its thickness, the displacement is a part symmetric about the axis, an affine part and J erf(√6 s/t)/2; "
		"the deviatoric strain a symmetric part and A exp(-6 s²/t²), A not negative. Symmetric parts are powers of squared radius up to 2 times those of height up to 5. "
		"`beside`, (K, 4), at most 4: planes that are in the model already.\n\n"
		"Limits, (3, 4): the lowest and the highest plane, and the paces of the search in the four numbers.\n\n"
		"Errors: ``ValueError`` for arrays of other shapes, numbers that are not finite, negative weights, or before setGrains().\n\n"
		"Example::\n\n"
		"\tsearch=BandSearch()\n\tsearch.setGrains(x,u,volumes,deviatoric)\n\tjump,taken=search.jump((1.,0.,0.,-5.))",
		,/*ctor*/,
		.def("setGrains",&BandSearch::setGrains,(boost::python::arg("positions"),boost::python::arg("displacements"),boost::python::arg("weights"),boost::python::arg("strains")),
			"The step. :param positions: [m], (N, 3), the axis at x = y = 0, mid-height at z = 0. :param displacements: [m], (N, 3). "
			":param weights: (N,), 0 or more. :param strains: deviatoric strains [-], (N,).")
		.def("symmetricStrain",&BandSearch::symmetricStrain,"The part of each grain's strain that is symmetric about the axis, without any plane [-], (N,).")
		.def("left",&BandSearch::left,(boost::python::arg("beside")=boost::python::tuple()),
			"Weighted squares that are left, of displacements [m²] and of strains.")
		.def("unlikely",&BandSearch::unlikely,(boost::python::arg("planes"),boost::python::arg("beside")=boost::python::tuple()),
			"Of each plane, (M, 4), the logarithm of the product of the shares that it leaves of both, (M,): the least is the most likely plane.")
		.def("jump",&BandSearch::jump,(boost::python::arg("plane"),boost::python::arg("beside")=boost::python::tuple(),boost::python::arg("uniform")=false),
			"The jump across the plane that fits best [m], (3,), above less below, and the weighted squares that it takes of those left [m²]. "
			"uniform: of a slab of uniform shear, whose displacement is linear across it.")
		.def("excess",&BandSearch::excess,(boost::python::arg("plane"),boost::python::arg("beside")=boost::python::tuple()),
			"The strain in the slab's middle above that beside it that fits best, 0 at least, and the weighted squares that it takes of those left.")
		.def("refined",&BandSearch::refined,(boost::python::arg("plane"),boost::python::arg("limits"),boost::python::arg("beside")=boost::python::tuple(),
			boost::python::arg("tolerance")=0.02,boost::python::arg("trials")=200),
			"The most likely plane near a plane, within the limits. :param tolerance: in paces. :param trials: planes looked at, at most.")
		.def("likeliest",&BandSearch::likeliest,(boost::python::arg("planes"),boost::python::arg("limits"),boost::python::arg("diameter"),boost::python::arg("rounds")=3,
			boost::python::arg("tolerance")=0.02,boost::python::arg("trials")=200),
			"The planes, (K, 4), fitted in turn by generalised least squares: grains also move in vortices, whose size and strength are those of the greatest likelihood "
			"for what the planes leave (``kernels/measure/BandLikelihood.hpp``). "
			":param diameter: d50 [m], the unit of the lengths that are tried.")
		.def("slab",&BandSearch::slab,(boost::python::arg("plane"),boost::python::arg("limits"),boost::python::arg("beside")=boost::python::tuple()),
			"The slab of uniform shear, parallel to the plane, whose displacement fits best.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(BandSearch);

} // namespace yade
