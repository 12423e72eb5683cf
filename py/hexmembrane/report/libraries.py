# SPDX-License-Identifier: GPL-2.0-or-later
"""The libraries that a page has in it: D3 for curves, three.js for scenes, as Debian's packages install them. Uses nothing of YADE."""

import pathlib

#: Where packages install scripts for a browser.
FOLDERS = (pathlib.Path("/usr/share/nodejs"), pathlib.Path("/usr/share/javascript"))
#: Package -> files of it, under one of FOLDERS.
CURVES, SCENES = "node-d3", "libjs-three"
FILES = {CURVES: ("d3/dist/d3.min.js",), SCENES: ("three/three.min.js", "three/examples/js/controls/OrbitControls.js")}


class LibraryError(RuntimeError):
	"""A library that is not installed."""


def scripts(package):
	"""The texts of a package's files.

	:raises LibraryError: there is none.
	"""
	found = []
	for name in FILES[package]:
		path = next((folder / name for folder in FOLDERS if (folder / name).is_file()), None)
		if path is None:
			raise LibraryError(f"report.{package} = '{name}': is not below {' or '.join(map(str, FOLDERS))}; fix: apt-get install {package}")
		found.append(path.read_text(encoding="utf-8"))
	return found
