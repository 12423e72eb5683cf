# SPDX-License-Identifier: GPL-2.0-or-later
"""The libraries that a page has in it: D3 for curves, three.js for scenes, as Debian 13's packages install them. Uses nothing of YADE.

A page runs what is in it, so the files are those that pages have been tried with, to the bit.
"""

import hashlib
import pathlib

#: Where packages install scripts for a browser.
FOLDERS = (pathlib.Path("/usr/share/nodejs"), pathlib.Path("/usr/share/javascript"))
#: Package -> files of it, under one of FOLDERS, with the SHA-256 of each.
CURVES, SCENES = "node-d3", "libjs-three"
FILES = {
	CURVES: {"d3/dist/d3.min.js": "0b1a0ce718cfd108f5b32e0bea1fc81c0868b5ebb006a519908d5844eaef1e4c"},
	SCENES: {
		"three/three.min.js": "58adf53c787d8d845399ebf57a977fe6bc7d8b3c6b05cc09a02d373999be1e38",
		"three/examples/js/controls/OrbitControls.js": "3d182559eb1c2bce66796a14c5cef723aa0b3698ea8a0703b77b9fd37951c483",
	},
}


class LibraryError(RuntimeError):
	"""A library that is not installed, or is another one."""


def scripts(package):
	"""The texts of a package's files.

	:raises LibraryError: one is not there, or is not the file that is known.
	"""
	found = []
	for name, known in FILES[package].items():
		path = next((folder / name for folder in FOLDERS if (folder / name).is_file()), None)
		if path is None:
			raise LibraryError(f"report.{package} = '{name}': is not below {' or '.join(map(str, FOLDERS))}; fix: apt-get install {package}")
		content = path.read_bytes()
		if (digest := hashlib.sha256(content).hexdigest()) != known:
			raise LibraryError(
				f"report.{package} = '{path}': is not the file that pages are tried with (SHA-256 {digest}); fix: {package} of Debian 13, or look at pages with this one by "
				"scripts/report.d/look and put its digest into hexmembrane/report/libraries.py"
			)
		found.append(content.decode())
	return found
