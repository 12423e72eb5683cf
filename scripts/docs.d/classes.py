# SPDX-License-Identifier: GPL-2.0-or-later
"""Pages of the C++ classes, from the plugin itself: each class with its text, its attributes with type and default, its methods."""

import inspect
import re

import yade
from sources import ROOT

#: Rooms of pkg in the order of the site, with their headings.
ROOMS = {
	"membrane": "Membrane",
	"boundary": "Platens and wall",
	"contact": "Contact law",
	"compact": "Compact tier",
	"specimen": "Specimen",
	"measure": "Measurement",
	"diagnostics": "Diagnostics",
}
DECLARED = re.compile(r"^\s*YADE_CLASS_BASE_DOC\w*\(\s*(\w+)\s*,\s*(\w+)", re.MULTILINE)
STATIC = re.compile(r"\.\. ystaticattr:: \w+\.(\w+)\(=([^)]*)\)\n\n\t(.*)")
MARKED = re.compile(r":y(default|attrtype|attrflags):`([^`]*)`")


def declared(room):
	"""Names of a room's classes that Python knows, in the order of files."""
	names = [match.group(1) for path in sorted((ROOT / "pkg" / room).glob("*.hpp")) for match in DECLARED.finditer(path.read_text(encoding="utf-8"))]
	return [name for name in names if hasattr(yade.wrapper, name)]


def _rst(text, known):
	"""Plain text of a class as reStructuredText: what would be a mark-up there is escaped, names of classes become links."""
	text = re.sub(r"(?<!`)``([^`]+)``(?!`)|(\*\*\w[^*]*\*\*)|([*_|`\\])", lambda m: m.group(0) if m.group(1) or m.group(2) else "\\" + m.group(3), text)
	pattern = r"(?<![\w.`'])(" + "|".join(sorted(known, key=len, reverse=True)) + r")(?![\w(`'])"
	return re.sub(pattern, r":py:class:`\1`", text)


def _paragraphs(text, known):
	"""Paragraphs of a class's text; what follows 'Example::' or is indented is code."""
	out, code = [], False
	for block in text.strip("\n").split("\n\n"):
		code = code and block.startswith("\t")
		if code or block.startswith("\t"):
			out.append("\n".join("   " + line.strip("\t") for line in block.split("\n")))
			continue
		code = block.rstrip().endswith("::")
		body = block.rstrip()[:-2] if code else block
		out.append(_rst(body.replace("\n* ", "\n\n* "), known) + ("::" if code else ""))
	return "\n\n".join(out)


def _attribute(name, member, value, known):
	doc = member.__doc__ or ""
	marks = dict(MARKED.findall(doc))
	text = _rst(MARKED.sub("", doc).strip(), known) or "(no text)"
	lines = [f"   .. py:attribute:: {name}"]
	if "attrtype" in marks:
		lines.append(f"      :type: {marks['attrtype']}")
		lines.append(f"      :value: {value!r}" if value is not None and len(repr(value)) < 60 and " at 0x" not in repr(value) else "")
	return "\n".join([line for line in lines if line] + ["", f"      {text}", ""])


def _method(name, member, known):
	"""Boost's text: name( (type)arg, ...) -> type : text, once for each overload; the first is shown."""
	doc = (member.__doc__ or "").strip("\n")
	head, _, text = doc.partition(" :\n")
	arguments = re.findall(r"\(\w+\)(\w+)(?:=([^,\])]+))?", head)
	shown = ", ".join(argument + (f"={value.strip()}" if value else "") for argument, value in arguments if argument != "arg1")
	paragraphs = inspect.cleandoc(text.partition("\n\n" + name)[0]).replace("\n", " ") or "(no text)"
	return f"   .. py:method:: {name}({shown})\n\n      {_rst(paragraphs, known)}\n"


def page(room, known):
	"""The page of a room as reStructuredText."""
	title = f"{ROOMS[room]}: classes"
	out = [title, "=" * len(title), "", ".. py:currentmodule:: yade.wrapper", ""]
	for name in declared(room):
		kind = getattr(yade.wrapper, name)
		base = kind.__mro__[1].__name__
		values = kind().dict() if hasattr(kind, "dict") else {}
		others = known - {name}
		base = _rst(base, known) if base in known else f"``{base}``"
		out += [name, "-" * len(name), "", f".. py:class:: {name}", "", f"   Base: {base}.", ""]
		text = kind.__doc__ or "(no text)"
		out += ["   " + line if line else "" for line in _paragraphs(STATIC.sub("", text), others).split("\n")] + [""]
		statics = STATIC.findall(text)
		for key, value, meaning in statics:
			out += [f"   .. py:attribute:: {key}", f"      :value: {value}", "", f"      {_rst(MARKED.sub('', meaning).strip(), others)}", ""]
		for key, member in vars(kind).items():
			if key.startswith("_") or key in [static[0] for static in statics]:
				continue
			if isinstance(member, property):
				out.append(_attribute(key, member, values.get(key), others))
			elif callable(getattr(kind, key)):
				out.append(_method(key, getattr(kind, key), others))
	return "\n".join(out) + "\n"


def pages():
	"""(room, text of its page) of all rooms that have classes."""
	known = {name for room in ROOMS for name in declared(room)}
	return [(room, page(room, known)) for room in ROOMS if declared(room)]
