# SPDX-License-Identifier: GPL-2.0-or-later
"""build.py [OUT]: builds the site into OUT (out/docs by default), inside YADE, whose plugin it reads. Warnings are errors."""

import pathlib
import pkgutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import classes  # noqa: E402
import hexmembrane  # noqa: E402
from sources import ROOT, Sources  # noqa: E402
from sphinx.cmd.build import build_main  # noqa: E402

CSS = """div.math { margin: 1em 0 1em 2em; }
div.math span.eqno { float: right; }
table.docutils td, table.docutils th { font-size: 90%; vertical-align: top; }
div.body { max-width: none; }
"""


def modules():
	"""Names of the package's modules, sub-package by sub-package; the command line is none."""
	found = [module.name for module in pkgutil.walk_packages(hexmembrane.__path__, "hexmembrane.")]
	return [name for name in found if not name.endswith("__main__") and not name.endswith("._load")]


def pythonPage():
	title = "Python package"
	out = [title, "=" * len(title), "", "What a script imports. The map of the modules: :doc:`py/hexmembrane/README`.", ""]
	for name in modules():
		out += [name, "-" * len(name), "", f".. automodule:: {name}", "   :members:", ""]
	return "\n".join(out)


def main(out):
	work = out.parent / (out.name + "-sources")
	sources = Sources(work)
	sources.checkout()
	sources.own()
	rooms = classes.pages()
	for room, text in rooms:
		sources.write(f"classes/{room}.rst", text)
	sources.write("python.rst", pythonPage())
	sources.write("_static/site.css", CSS)
	return build_main(["-W", "--keep-going", "-q", "-b", "html", "-c", str(HERE), "-d", str(work / ".doctrees"), str(work), str(out)])


if __name__ == "__main__":
	code = main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "docs").resolve())
	if code == 0:
		print("site: " + str(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "docs").resolve() / "index.html"))
	sys.exit(code)
