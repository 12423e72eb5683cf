# SPDX-License-Identifier: GPL-2.0-or-later
"""Makes hexmembrane's C++ classes known to YADE.

A plugin that is installed in YADE's library folder is loaded by YADE itself at start: nothing is left to do. From a build folder,
the library is a Python extension module whose import registers its classes; the environment variable HEXMEMBRANE_BUILD names
that folder (scripts/yade, scripts/run and scripts/test set it).
"""

import importlib.machinery
import importlib.util
import os
import sys

#: The class by which one sees that the plugin is loaded.
_MARK = "LayoutProbe"
_MODULE = "libhexmembrane"


def load():
	"""Loads the plugin unless it is loaded; raises ImportError saying what to do when that cannot be."""
	try:
		import yade.wrapper
	except ImportError as error:
		raise ImportError(
			"hexmembrane works inside YADE, which this Python cannot import (%s). Run the script with scripts/yade SCRIPT "
			"(or with your own YADE's program)." % error
		) from error
	if hasattr(yade.wrapper, _MARK):
		return
	folder = os.environ.get("HEXMEMBRANE_BUILD")
	if not folder:
		raise ImportError(
			"hexmembrane's C++ plugin is not loaded: it is not installed in YADE's library folder, and HEXMEMBRANE_BUILD does not "
			"name the folder of libhexmembrane.so. Run the script with scripts/yade SCRIPT, or install the plugin: cmake --install build."
		)
	path = os.path.join(os.path.abspath(folder), _MODULE + ".so")
	if not os.path.isfile(path):
		raise ImportError("HEXMEMBRANE_BUILD = %s: there is no %s.so in it. Build the plugin: cmake --build %s." % (folder, _MODULE, folder))
	# YADE's classes are shared with the plugin, so its symbols must be global ones, as for every plugin of YADE.
	flags = sys.getdlopenflags()
	sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)
	try:
		loader = importlib.machinery.ExtensionFileLoader(_MODULE, path)
		spec = importlib.util.spec_from_file_location(_MODULE, path, loader=loader)
		module = importlib.util.module_from_spec(spec)
		loader.exec_module(module)
	except ImportError as error:
		raise ImportError("%s could not be loaded into YADE: %s. Rebuild it against this very YADE." % (path, error)) from error
	finally:
		sys.setdlopenflags(flags)
	sys.modules[_MODULE] = module
