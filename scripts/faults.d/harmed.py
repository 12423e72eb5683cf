# SPDX-License-Identifier: GPL-2.0-or-later
"""harmed.py N OUT MAIN ARGS: the command line MAIN in this process, which is killed at its N-th act on the folder OUT (0: never).

Acts are what Python's audit hooks and the patched functions of ``os`` see; a write is cut in its middle. At its end an unharmed run writes the
number of its acts into the file OUT.acts.
"""

import os
import runpy
import signal
import sys

EVENTS = ("open", "os.rename", "os.remove", "os.mkdir", "os.truncate")
PATCHED = ("fsync", "write", "pwrite", "ftruncate")


class Killer:
	def __init__(self, at, out):
		self.at, self.out, self.acts = at, os.path.realpath(out), 0

	def act(self):
		self.acts += 1
		if self.acts == self.at:
			os.kill(os.getpid(), signal.SIGKILL)

	def audit(self, event, arguments):
		if event in EVENTS and any(isinstance(given, (str, os.PathLike)) and os.path.abspath(given).startswith(self.out + os.sep) for given in arguments):
			self.act()

	def patch(self, name):
		true = getattr(os, name)

		def patched(file, *more):
			if os.readlink(f"/proc/self/fd/{file}").startswith(self.out):
				if name == "write" and self.acts + 1 == self.at:
					true(file, bytes(more[0])[: len(more[0]) // 2])
				self.act()
			return true(file, *more)

		setattr(os, name, patched)


def main(arguments):
	killer = Killer(int(arguments[0]), arguments[1])
	sys.addaudithook(killer.audit)
	for name in PATCHED:
		killer.patch(name)
	sys.argv = arguments[2:]
	code = 0
	try:
		runpy.run_path(sys.argv[0], run_name="__main__")
	except SystemExit as exit:
		code = exit.code
	if killer.at == 0:
		with open(arguments[1] + ".acts", "w") as file:
			file.write(f"{killer.acts}\n")
	return code


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
