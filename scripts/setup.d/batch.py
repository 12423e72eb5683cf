# SPDX-License-Identifier: GPL-2.0-or-later
"""batch.py [YADE-BATCH'S ARGUMENTS]: YADE's own yade-batch, but for the web page that it serves to all addresses; its runs open no ports either."""

import http.server
import os
import runpy
import shlex
import shutil
import sys

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
	sys.argv = [program + "-batch", "--executable", runs, *sys.argv[1:]]
	runpy.run_path(program + "-batch", run_name="__main__")
