# SPDX-License-Identifier: GPL-2.0-or-later
"""Sphinx' configuration of the site; the sources are made by site.py."""

import re

import hexmembrane

project = "hexmembrane"
copyright = "its maintainers; GPL-2.0-or-later"
version = release = hexmembrane.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "mathml"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
root_doc = "index"
myst_enable_extensions = ["dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 5
html_theme = "alabaster"
html_theme_options = {"page_width": "1150px", "sidebar_width": "260px", "description": "Flexible-membrane triaxial tests for YADE", "fixed_sidebar": True}
html_sidebars = {"**": ["about.html", "searchfield.html", "navigation.html", "relations.html"]}
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
highlight_language = "none"
nitpicky = True
# types of C++, which have no pages
nitpick_ignore_regex = [("py:class", r"Real|string|std::string|bool|int|long|Vector3r|Body::id_t|.*<.*>")]


def plainDocument(app, what, name, thing, options, lines):
	"""The package's documents as Sphinx reads them: |m| is an absolute value; fields may share a line, and parameters a field."""
	out = []
	for line in lines:
		indent = line[: len(line) - len(line.lstrip())]
		for field in re.split(r" (?=:(?:param|raises|return)\b)", line.strip()) if line.lstrip().startswith(":param") else [line.strip()]:
			shared = re.match(r":param ([\w, *]+): (.*)", field)
			fields = [f":param {each.strip()}: {shared.group(2)}" for each in shared.group(1).split(",")] if shared else [field]
			out += [indent + re.sub(r"(``.*?``)|\|", lambda match: match.group(1) or "\\|", each) for each in fields]
	lines[:] = out


def setup(app):
	app.connect("autodoc-process-docstring", plainDocument)
