# SPDX-License-Identifier: GPL-2.0-or-later
"""Sphinx extension: equations as MathML, which browsers draw themselves; no script is loaded from anywhere."""

import re

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util.math import get_node_equation_number


def _made(node, block):
	"""The equation; Greek letters upright: browsers make others of a single letter, which only fonts for mathematics have."""
	return re.sub(r"<mi( class=\"[\w-]+\")?>(?=[\u0391-\u03f5]</mi>)", '<mi mathvariant="normal">', tex2mathml(node.astext(), as_block=block))


def inline(self, node):
	self.body.append(_made(node, False))
	raise nodes.SkipNode


def display(self, node):
	self.body.append(self.starttag(node, "div", CLASS="math"))
	if node["number"]:
		number = get_node_equation_number(self, node)
		self.body.append(f'<span class="eqno">({number})')
		self.add_permalink_ref(node, "Link to this equation")
		self.body.append("</span>")
	self.body.append(_made(node, True))
	self.body.append("</div>\n")
	raise nodes.SkipNode


def setup(app):
	app.add_html_math_renderer("mathml", (inline, None), (display, None))
	return {"parallel_read_safe": True, "parallel_write_safe": True}
