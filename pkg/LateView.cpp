// SPDX-License-Identifier: GPL-2.0-or-later
/* YADE started with a display makes its OpenGLRenderer at once, when it imports yade.qt, before any script runs. The renderer then looks up
 * the draw functors of all classes and sizes its tables of functors by the number of shapes (contact geometries, contact physics,
 * bounds) that are known at that moment. It never does so again. Each shape of a plugin loaded later has a class index beyond the table's
 * end: drawing one fails YADE's assertion and ends the program.
 *
 * OpenGLRenderer::init() cannot be called twice: its tables would hold new functors, while the scene is given to the first ones only.
 * So the tables are completed here. They are private and no function of the renderer gives them out; the explicit instantiations below may
 * name them nevertheless, by the rules of C++. */
#include "LateView.hpp"

#ifdef YADE_OPENGL

#include <core/Omega.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/OpenGLRenderer.hpp>

namespace {

template <typename Dispatcher, Dispatcher yade::OpenGLRenderer::* member>
struct PrivateDispatcher {
	friend Dispatcher& dispatcherOf(yade::OpenGLRenderer& renderer, const Dispatcher*) { return renderer.*member; }
};
yade::GlBoundDispatcher& dispatcherOf(yade::OpenGLRenderer&, const yade::GlBoundDispatcher*);
yade::GlShapeDispatcher& dispatcherOf(yade::OpenGLRenderer&, const yade::GlShapeDispatcher*);
yade::GlIGeomDispatcher& dispatcherOf(yade::OpenGLRenderer&, const yade::GlIGeomDispatcher*);
yade::GlIPhysDispatcher& dispatcherOf(yade::OpenGLRenderer&, const yade::GlIPhysDispatcher*);
template struct PrivateDispatcher<yade::GlBoundDispatcher, &yade::OpenGLRenderer::boundDispatcher>;
template struct PrivateDispatcher<yade::GlShapeDispatcher, &yade::OpenGLRenderer::shapeDispatcher>;
template struct PrivateDispatcher<yade::GlIGeomDispatcher, &yade::OpenGLRenderer::geomDispatcher>;
template struct PrivateDispatcher<yade::GlIPhysDispatcher, &yade::OpenGLRenderer::physDispatcher>;

template <typename Dispatcher>
void complete(yade::OpenGLRenderer& renderer, const std::vector<std::string>& names)
{
	Dispatcher& dispatcher = dispatcherOf(renderer, static_cast<const Dispatcher*>(nullptr));
	for (const std::string& name : names) {
		const auto functor = boost::dynamic_pointer_cast<typename Dispatcher::FunctorType>(yade::ClassFactory::instance().createShared(name));
		if (!functor) continue;
		functor->initgl();
		dispatcher.add(functor);
	}
	// Enters all functors anew, into a table of the present size: a contact of ours without a functor needs its place in it as well.
	dispatcher.postLoad(dispatcher);
}

} // namespace

void hexmembrane::registerInView(const std::vector<std::string>& names)
{
	namespace py = boost::python;
	const py::dict modules = py::extract<py::dict>(py::import("sys").attr("modules"));
	if (!modules.has_key("yade.qt._GLViewer")) return;
	yade::OpenGLRenderer& renderer = py::extract<yade::OpenGLRenderer&>(modules["yade.qt._GLViewer"].attr("Renderer")());
	complete<yade::GlBoundDispatcher>(renderer, names);
	complete<yade::GlShapeDispatcher>(renderer, names);
	complete<yade::GlIGeomDispatcher>(renderer, names);
	complete<yade::GlIPhysDispatcher>(renderer, names);
}

#else

void hexmembrane::registerInView(const std::vector<std::string>&) {}

#endif
