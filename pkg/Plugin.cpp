// SPDX-License-Identifier: GPL-2.0-or-later
/* The plugin as a Python extension module, `import libhexmembrane`, for a build that is not installed into YADE.
 *
 * YADE registers the classes of the plugins that lie in its own library folder once, at start, by Omega::buildDynlibDatabase, which is
 * private. A library loaded later has put its classes into the ClassFactory all the same; what is left is to make them known to Python
 * and to Omega's table of base classes (asked by the OpenGL renderer and by O.bodies' dispatchers for class names). That is done here; a
 * 3D view that is there already is told by LateView.cpp. */
#include "LateView.hpp"

#include <core/Omega.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <lib/serialization/Serializable.hpp>

#include <list>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace py = boost::python;
using Names = std::vector<std::string>;

std::size_t classesBeforeThisLibrary = 0;

// Runs before the constructors that YADE_PLUGIN defines (those have no priority and so come last): what the factory's list holds beyond
// this point are the classes of this library, in particular not the C++-only names among YADE's own.
__attribute__((constructor(101))) void rememberFactorySize() { classesBeforeThisLibrary = yade::ClassFactory::instance().pluginClasses.size(); }

Names classesUnknownTo(const py::object& wrapper)
{
	const std::list<std::string>& all = yade::ClassFactory::instance().pluginClasses;
	Names names;
	std::size_t index = 0;
	for (const std::string& name : all) {
		if (index++ < classesBeforeThisLibrary) continue;
		if (!PyObject_HasAttrString(wrapper.ptr(), name.c_str())) names.push_back(name);
	}
	return names;
}

std::string takePythonError()
{
	PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
	PyErr_Fetch(&type, &value, &trace);
	PyErr_NormalizeException(&type, &value, &trace);
	const py::handle<> typeHandle(py::allow_null(type)), valueHandle(py::allow_null(value)), traceHandle(py::allow_null(trace));
	if (!value) return "unknown error";
	return py::extract<std::string>(py::str(py::object(valueHandle)));
}

// Base classes must be registered before those derived from them; the list is not in that order, so go round until nothing is left. A
// round that registers nothing will never get further: its errors are the real ones.
void registerInPython(Names names, py::object& wrapper)
{
	while (!names.empty()) {
		Names failed;
		std::string errors;
		for (const std::string& name : names) {
			const auto object = boost::dynamic_pointer_cast<yade::Serializable>(yade::ClassFactory::instance().createShared(name));
			if (!object) throw std::runtime_error("hexmembrane: class " + name + " is in YADE_PLUGIN but is no Serializable");
			try {
				object->pyRegisterClass(wrapper);
			} catch (const py::error_already_set&) {
				failed.push_back(name);
				errors += "\n  " + name + ": " + takePythonError();
			} catch (const std::exception& error) {
				failed.push_back(name);
				errors += "\n  " + name + ": " + error.what();
			}
		}
		if (failed.size() == names.size()) throw std::runtime_error("hexmembrane: these classes could not be registered in Python:" + errors);
		names = failed;
	}
}

void registerInOmega(const Names& names)
{
	// Omega gives its table out as const only; the table itself is no const object.
	auto& table = const_cast<std::map<std::string, yade::DynlibDescriptor>&>(yade::Omega::instance().getDynlibsDescriptor());
	for (const std::string& name : names) {
		const auto object = yade::ClassFactory::instance().createShared(name);
		table[name].isSerializable = true;
		for (int i = 0; i < object->getBaseClassNumber(); i++) table[name].baseClasses.insert(object->getBaseClassName(i));
	}
}

// `from yade import *` may have run before: module yade gets the names (and lists them), and so does a script that YADE's own program
// runs, whose globals are those of __main__. A name that is taken there stays as it is.
void publish(const Names& names, const py::object& wrapper)
{
	py::object yadeModule = py::import("yade");
	py::object mainModule = py::import("__main__");
	py::list exported = py::extract<py::list>(yadeModule.attr("__all__"));
	const bool inYade = PyObject_HasAttrString(mainModule.ptr(), "yade") && mainModule.attr("yade") == yadeModule;
	for (const std::string& name : names) {
		const py::object cls = wrapper.attr(name.c_str());
		yadeModule.attr(name.c_str()) = cls;
		exported.append(name);
		if (inYade && !PyObject_HasAttrString(mainModule.ptr(), name.c_str())) mainModule.attr(name.c_str()) = cls;
	}
}

} // namespace

// Which package the plugin belongs to: asked for by its name in the library, since YADE loads an installed plugin without initialising the module.
extern "C" __attribute__((visibility("default"))) const char* hexmembraneVersion() { return HEXMEMBRANE_VERSION; }

extern "C" __attribute__((visibility("default"))) PyObject* PyInit_libhexmembrane()
{
	static PyModuleDef definition = {
	        PyModuleDef_HEAD_INIT, "libhexmembrane", "Registers hexmembrane's C++ classes in YADE.", -1, nullptr, nullptr, nullptr, nullptr, nullptr};
	try {
		py::object wrapper = py::import("yade.wrapper");
		const Names names = classesUnknownTo(wrapper);
		registerInPython(names, wrapper);
		registerInOmega(names);
		hexmembrane::registerInView(names);
		publish(names, wrapper);
		py::object module{py::handle<>(PyModule_Create(&definition))};
		py::list classes;
		for (const std::string& name : names) classes.append(name);
		module.attr("classes") = classes;
		return py::incref(module.ptr());
	} catch (const py::error_already_set&) {
		return nullptr; // Python's error is set
	} catch (const std::exception& error) {
		PyErr_SetString(PyExc_ImportError, error.what());
		return nullptr;
	}
}
