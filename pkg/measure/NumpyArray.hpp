// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <boost/python.hpp>

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

} // namespace yade
