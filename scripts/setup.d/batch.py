# SPDX-License-Identifier: GPL-2.0-or-later
"""batch.py [YADE-BATCH'S ARGUMENTS]: YADE's own yade-batch, but for the web page that it serves to all addresses; its runs open no ports either."""

import http.server
import os
import shlex
import shutil
import sys
import warnings

from launch import openStreams


def noServer(address, handler):
	"""In the place of its web server: yade-batch takes each port for one that is taken, and goes on without."""
	raise OSError("no port is opened")


if __name__ == "__main__":
	openStreams()
	program = os.environ.get("YADE_EXECUTABLE") or shutil.which("yade-double")
	if not program or not os.path.isfile(program + "-batch"):
		sys.exit(f"batch.py: {program or 'yade-double'}-batch is not there")
	http.server.HTTPServer = noServer
	runs = f"{shlex.quote(sys.executable)} {shlex.quote(os.path.join(os.path.dirname(os.path.abspath(__file__)), 'withoutPorts.py'))}"
	warnings.simplefilter("ignore", SyntaxWarning)  # of its own source
	sys.argv = [program + "-batch", "--executable", runs, *sys.argv[1:]]
	__file__ = program + "-batch"
	with open(__file__, encoding="utf-8") as source:
		code = compile(source.read(), __file__, "exec")
	exec(code, globals())  # YADE's libraries look for the running program in __main__, where runpy would put another
