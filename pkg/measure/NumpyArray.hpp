// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Check.hpp"

#include <lib/base/Math.hpp>

#include <boost/python.hpp>

#include <algorithm>
#include <vector>

namespace yade {

/*! A numpy array of its own memory with these values, read-only. `columns`: of an array of rows; 0: a plain array. */
template <typename T>
boost::python::object numpyArray(const std::vector<T>& values, const char* type, int columns = 0)
{
	namespace python = boost::python;
	const python::object bytes(
	        python::handle<>(PyBytes_FromStringAndSize(reinterpret_cast<const char*>(values.data()), static_cast<Py_ssize_t>(values.size() * sizeof(T)))));
	const python::object array = python::import("numpy").attr("frombuffer")(bytes, type);
	return columns ? array.attr("reshape")(-1, columns) : array;
}

/*! Tensors as numpy has them, (N, 3, 3), row by row. */
inline boost::python::object numpyTensors(const std::vector<Matrix3r>& tensors)
{
	std::vector<Real> rows;
	for (const Matrix3r& m : tensors)
		for (int i = 0; i < 3; ++i)
			for (int j = 0; j < 3; ++j) rows.push_back(m(i, j));
	return numpyArray(rows, "f8", 9).attr("reshape")(-1, 3, 3);
}

/*! The numbers of a list, a numpy array or one number, row by row. `columns`: of an array of rows; 0: a plain list. \throws FieldError for another shape */
inline std::vector<Real> numbersOf(const boost::python::object& given, const std::string& field, int columns = 0)
{
	namespace python = boost::python;
	const python::object numpy = python::import("numpy");
	python::object array;
	try {
		array = numpy.attr("ascontiguousarray")(given, "f8");
	} catch (const python::error_already_set&) {
		PyErr_Clear();
		hexmembrane::reject(field, std::string(python::extract<std::string>(python::str(given))), "not an array of numbers",
		                    "numbers, or a numpy array of them");
	}
	const long size = python::extract<long>(array.attr("size"));
	const int dimensions = python::extract<int>(array.attr("ndim"));
	if (size > 0 && (columns ? dimensions != 2 || python::extract<int>(array.attr("shape")[1]) != columns : dimensions != 1))
		hexmembrane::reject(field, std::string(python::extract<std::string>(python::str(array.attr("shape")))), "an array of the wrong shape",
		                    columns ? "one row of " + std::to_string(columns) + " numbers for each" : std::string("a list of numbers"));
	const python::object bytes = array.attr("tobytes")();
	const Real* first = reinterpret_cast<const Real*>(PyBytes_AS_STRING(bytes.ptr()));
	return {first, first + size};
}

} // namespace yade
