# SPDX-License-Identifier: GPL-2.0-or-later
"""withoutPorts.py [YADE'S ARGUMENTS]: YADE's own program, but for the network ports that it opens.

YADE listens on all addresses: from port 9000 with a Python prompt whose cookie is one of 60,000, from port 21000 with XMLRPC without a password. Here
``yade.remote.runServers`` opens nothing. With HEXMEMBRANE_REMOTE=on it opens both on the loopback address, the prompt with a cookie of 128 bits. Every
user of the machine can then ask XMLRPC and stop the run by it.
"""

import importlib.abc
import importlib.machinery
import os
import secrets
import shutil
import signal
import sys
import xmlrpc.server

from launch import openStreams

LOOPBACK = "127.0.0.1"
#: Held back until YADE's libraries are there: an exception must not pass through them.
SIGNALS = {signal.SIGINT, signal.SIGTERM}


def nothing():
	"""In the place of YADE's servers."""


def onLoopback():
	"""YADE's servers, on the loopback address alone."""
	from yade import remote, runtime

	prompt = remote.GenericTCPServer(handler=remote.PythonConsoleSocketEmulator, title="TCP python prompt", cookie=False, host=LOOPBACK)
	prompt.server.authenticated = []
	prompt.server.cookie = runtime.cookie = secrets.token_hex(16)
	for port in range(21000, 22000):
		try:
			info = xmlrpc.server.SimpleXMLRPCServer((LOOPBACK, port), logRequests=False, allow_none=True)
			break
		except OSError:  # taken
			continue
	else:
		raise OSError("HEXMEMBRANE_REMOTE = on: no free port from 21000 to 21999; fix: leave it off")
	info.register_instance(remote.InfoProvider())
	remote._runInBackground(info.serve_forever)
	print(f"auth cookie {prompt.server.cookie}; XMLRPC info provider on http://{LOOPBACK}:{port}", file=sys.stderr)


class OtherServers(importlib.abc.MetaPathFinder):
	"""Imports ``yade.remote``, the last of YADE's start, with another ``runServers``."""

	def __init__(self, runServers):
		self.runServers = runServers

	def find_spec(self, name, path, target=None):
		if name != "yade.remote":
			return None
		spec = importlib.machinery.PathFinder.find_spec(name, path, target)
		execute = spec.loader.exec_module

		def exec_module(module):
			execute(module)
			module.runServers = self.runServers
			signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)

		spec.loader.exec_module = exec_module
		return spec


if __name__ == "__main__":
	signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
	openStreams()
	program = os.environ.get("YADE_EXECUTABLE") or shutil.which("yade-double")
	if not program:
		sys.exit("withoutPorts.py: yade-double is not in PATH")
	asked = os.environ.get("HEXMEMBRANE_REMOTE", "off")
	if asked not in ("on", "off"):
		sys.exit(f"HEXMEMBRANE_REMOTE = {asked}: unknown; fix: on or off")
	sys.meta_path.insert(0, OtherServers(onLoopback if asked == "on" else nothing))
	sys.argv[0] = __file__ = program
	with open(program, encoding="utf-8") as file:
		# here and not by runpy: YADE's libraries look for __main__ while they start
		exec(compile(file.read(), program, "exec"))
