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


def modules():
	"""Names of the package's modules, sub-package by sub-package, and whether it is a sub-package; the command line is none."""
	found = [(module.name, module.ispkg) for module in pkgutil.walk_packages(hexmembrane.__path__, "hexmembrane.")]
	return [(name, package) for name, package in found if not name.endswith(("__main__", "._load"))]


def pythonPage():
	title = "Python package"
	out = [title, "=" * len(title), "", "What a script imports. The map of the modules: :doc:`py/hexmembrane/README`.", ""]
	for name, package in modules():
		# what a sub-package hands on is shown where it is made
		out += [name, "-" * len(name), "", f".. automodule:: {name}", "" if package else "   :members:", ""]
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
	return build_main(["-W", "--keep-going", "-q", "-b", "html", "-c", str(HERE), "-d", str(work / ".doctrees"), str(work), str(out)])


if __name__ == "__main__":
	site = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "out" / "docs").resolve()
	code = main(site)
	if code == 0:
		print(f"site: {site / 'index.html'}")
	sys.exit(code)
