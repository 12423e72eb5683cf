// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "BandSearch.hpp"

#include "NumpyArray.hpp"

#include "base/NamedFields.hpp"
#include "kernels/measure/BandLikelihood.hpp"

namespace yade {

YADE_PLUGIN((BandSearch));

namespace {

using hexmembrane::BandField;
using hexmembrane::BandPlane;
using Given = BandSearch::Given;

vector<Vector3r> vectorsOf(const Given& given, const string& name)
{
	vector<Vector3r> found;
	const vector<Real> rows = numbersOf(given, name, 3);
	for (size_t i = 0; i < rows.size(); i += 3) found.emplace_back(rows[i], rows[i + 1], rows[i + 2]);
	return found;
}

vector<BandPlane> planesOf(const Given& given, const string& name)
{
	vector<BandPlane> found;
	const vector<Real> rows = numbersOf(given, name, 4);
	for (size_t i = 0; i < rows.size(); i += 4) found.emplace_back(rows[i], rows[i + 1], rows[i + 2], rows[i + 3]);
	return found;
}

BandPlane planeOf(const Given& given)
{
	const vector<Real> four = numbersOf(given, "plane");
	if (four.size() != 4) hexmembrane::reject("plane", int(four.size()), "numbers are no plane", "dip, azimuth, offset, logarithm of the thickness");
	return BandPlane(four[0], four[1], four[2], four[3]);
}

hexmembrane::BandLimits limitsOf(const Given& given)
{
	const vector<BandPlane> rows = planesOf(given, "limits");
	if (rows.size() != 3) hexmembrane::reject("limits", int(rows.size()), "rows are no limits", "the lowest plane, the highest, the paces");
	return {rows[0], rows[1], rows[2]};
}

Given arrayOf(const BandPlane& plane) { return numpyArray(vector<Real>(plane.data(), plane.data() + 4), "f8"); }

template <typename Call>
auto asked(Call&& call)
{
	return named("BandSearch", {}, call);
}

} // namespace

const hexmembrane::BandGrains& BandSearch::required() const
{
	if (!grains) hexmembrane::reject("grains", string("None"), "there is no step to look at", "call setGrains() first");
	return *grains;
}

BandField BandSearch::field(const Given& beside) const { return BandField(required(), planesOf(beside, "beside")); }

void BandSearch::setGrains(const Given& positions, const Given& displacements, const Given& weights, const Given& strains)
{
	asked([&] {
		grains = std::make_shared<const hexmembrane::BandGrains>(vectorsOf(positions, "positions"), vectorsOf(displacements, "displacements"),
		                                                         numbersOf(weights, "weights"), numbersOf(strains, "strains"));
	});
}

Given BandSearch::symmetricStrain() const
{
	return asked([&] { return numpyArray(required().symmetricStrain(), "f8"); });
}

boost::python::tuple BandSearch::left(const Given& beside) const
{
	return asked([&] {
		const auto rest = field(beside).left();
		return boost::python::make_tuple(rest[0], rest[1]);
	});
}

Given BandSearch::unlikely(const Given& planes, const Given& beside) const
{
	return asked([&] {
		const BandField of = field(beside);
		vector<Real> found;
		for (const BandPlane& plane : planesOf(planes, "planes")) found.push_back(of.unlikely(plane));
		return numpyArray(found, "f8");
	});
}

boost::python::tuple BandSearch::jump(const Given& plane, const Given& beside, bool uniform) const
{
	return asked([&] {
		const auto found = field(beside).jump(planeOf(plane), uniform ? BandField::Profile::uniform : BandField::Profile::smooth);
		return boost::python::make_tuple(numpyArray(vector<Real>(found.jump.data(), found.jump.data() + 3), "f8"), found.taken);
	});
}

boost::python::tuple BandSearch::excess(const Given& plane, const Given& beside) const
{
	return asked([&] {
		const auto found = field(beside).excess(planeOf(plane));
		return boost::python::make_tuple(found.strain, found.taken);
	});
}

Given BandSearch::refined(const Given& plane, const Given& limits, const Given& beside, Real tolerance, int trials) const
{
	return asked([&] { return arrayOf(hexmembrane::refinedPlane(field(beside), limitsOf(limits), planeOf(plane), tolerance, trials)); });
}

Given BandSearch::likeliest(const Given& planes, const Given& limits, Real diameter, int rounds, Real tolerance, int trials) const
{
	return asked([&] {
		const vector<BandPlane> start = planesOf(planes, "planes");
		const hexmembrane::BandLikelihood likelihood(required(), start, diameter);
		vector<Real> rows;
		for (const BandPlane& plane : likelihood.refined(start, limitsOf(limits), rounds, tolerance, trials))
			rows.insert(rows.end(), plane.data(), plane.data() + 4);
		return numpyArray(rows, "f8", 4);
	});
}

Given BandSearch::slab(const Given& plane, const Given& limits, const Given& beside) const
{
	return asked([&] { return arrayOf(hexmembrane::slabOf(field(beside), limitsOf(limits), planeOf(plane))); });
}

} // namespace yade
