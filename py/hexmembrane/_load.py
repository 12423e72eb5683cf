# SPDX-License-Identifier: GPL-2.0-or-later
"""Makes hexmembrane's C++ classes known to YADE.

A plugin that is installed in YADE's library folder is loaded by YADE itself at start: nothing is left to do. From a build folder,
the library is a Python extension module whose import registers its classes; the environment variable HEXMEMBRANE_BUILD names
that folder (scripts/yade, scripts/run and scripts/test set it).
"""

import ctypes
import importlib.machinery
import importlib.util
import os
import signal
import sys

import hexmembrane

_MODULE = "libhexmembrane"
#: The plugin's classes are registered together; this one every script needs.
_CLASS = "HexMembrane"


def _refuseAnother(folder):
	"""A build that is asked for must not be replaced unseen by an installed one, which may be older."""
	loaded = loadedLibrary()
	if folder and loaded and os.path.realpath(loaded) != os.path.realpath(os.path.join(folder, _MODULE + ".so")):
		raise ImportError(
			"HEXMEMBRANE_BUILD = %s: YADE has loaded the plugin %s at start, and it can hold one only; fix: remove the installed one, or run YADE's own "
			"program, without HEXMEMBRANE_BUILD and not by scripts/" % (folder, loaded)
		)


def loadedLibrary():
	"""Path of the plugin's library in this process, None when it is not loaded."""
	with open("/proc/self/maps") as maps:
		for line in maps:
			path = line.rstrip("\n").partition("/")[2]
			if os.path.basename(path) == _MODULE + ".so":
				return "/" + path
	return None


def versionOf(path):
	"""Version that the library at `path` states, which this process has loaded; None when it states none."""
	try:
		function = ctypes.CDLL(path, mode=os.RTLD_NOLOAD).hexmembraneVersion
	except AttributeError:
		return None
	function.restype = ctypes.c_char_p
	return function().decode()


def _refuseAnotherVersion(path):
	"""Package and plugin are made for each other: attributes and engines of another version are not those that the scripts set."""
	version = versionOf(path)
	if version != hexmembrane.__version__:
		raise ImportError(
			"%s = version %s: the Python package %s is version %s; fix: build and install both from one checkout (scripts/test, or cmake --build "
			"and cmake --install)" % (path, version or "unknown", os.path.dirname(os.path.abspath(__file__)), hexmembrane.__version__)
		)


def load():
	"""Loads the plugin unless it is loaded; raises ImportError saying what to do when that cannot be."""
	try:
		import yade.wrapper
	except ImportError as error:
		raise ImportError(
			"hexmembrane works inside YADE, which this Python cannot import (%s). Run the script with scripts/yade SCRIPT "
			"(or with your own YADE's program)." % error
		) from error
	folder = os.environ.get("HEXMEMBRANE_BUILD")
	if hasattr(yade.wrapper, _CLASS):
		_refuseAnother(folder)
		_refuseAnotherVersion(loadedLibrary())
		return
	if not folder:
		raise ImportError(
			"hexmembrane's C++ plugin is not loaded: it is not installed in YADE's library folder, and HEXMEMBRANE_BUILD does not "
			"name the folder of libhexmembrane.so. Run the script with scripts/yade SCRIPT, or install the plugin: cmake --install build."
		)
	path = os.path.join(os.path.abspath(folder), _MODULE + ".so")
	if not os.path.isfile(path):
		raise ImportError("HEXMEMBRANE_BUILD = %s: there is no %s.so in it. Build the plugin: cmake --build %s." % (folder, _MODULE, folder))
	# An interrupt's exception must not pass through the libraries' initialisation: it is held back until they are there.
	masked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
	try:
		# YADE's classes are shared with the plugin, so its symbols must be global ones, as for every plugin of YADE.
		ctypes.CDLL(path, mode=os.RTLD_NOW | os.RTLD_GLOBAL)
		_refuseAnotherVersion(path)
		loader = importlib.machinery.ExtensionFileLoader(_MODULE, path)
		module = importlib.util.module_from_spec(importlib.util.spec_from_file_location(_MODULE, path, loader=loader))
		loader.exec_module(module)
	except OSError as error:
		raise ImportError("%s could not be loaded into YADE: %s. Rebuild it against this very YADE." % (path, error)) from error
	finally:
		signal.pthread_sigmask(signal.SIG_SETMASK, masked)
	sys.modules[_MODULE] = module
