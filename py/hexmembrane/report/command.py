# SPDX-License-Identifier: GPL-2.0-or-later
"""The command ``scripts/report DIR... [--out FILE]``. Uses nothing of YADE."""

import argparse
import pathlib
import sys
import time

from hexmembrane.report import page, runs, terminal
from hexmembrane.report.libraries import LibraryError

#: The page's name in a test's folder.
_NAME = "report.html"
#: Seconds between two looks at a running test.
_SECONDS = 10.0


def _arguments(argv):
	parser = argparse.ArgumentParser(prog="scripts/report", description="One page of HTML from tests and studies, that opens from the disk without a network.")
	parser.add_argument("folders", nargs="+", metavar="DIR", help="output folder of scripts/run or scripts/sweep")
	parser.add_argument("--out", metavar="FILE", help=f"page to write (default: {_NAME} in the first DIR)")
	parser.add_argument("--laboratory", action="append", default=[], metavar="CSV", help="a laboratory's curve to lay under: axial_strain [unit], stress_ratio or q [unit], volumetric_strain [unit]")
	parser.add_argument("--text", action="store_true", help="print curves on the terminal and write no page")
	parser.add_argument("--watch", type=float, nargs="?", const=_SECONDS, metavar="SECONDS", help="renew page and terminal until the tests are at their end")
	given = parser.parse_args(argv)
	if given.watch is not None and not 1 <= given.watch <= 3600:
		parser.error(f"--watch = {given.watch:g}: must be 1 to 3600 seconds")
	return given


def _wait(folders, seconds):
	"""Until there is something in each folder: a test makes its own a while after it was begun."""
	for folder in map(pathlib.Path, folders):
		told = False
		while not (folder.is_dir() and any(folder.iterdir())):
			if not told:
				print(f"waiting for a test in {folder}", flush=True)
			told = True
			time.sleep(seconds)


def _seen(folders):
	"""What changes when a test goes on."""
	found = []
	for folder in folders:
		for path in (folder / "records.csv", folder / "vtk" / "grains.pvd", folder / "plan.json"):
			try:
				found.append((str(path), path.stat().st_mtime_ns, path.stat().st_size))
			except OSError:
				found.append((str(path), 0, 0))
	return found


def _once(given, out):
	"""Write and print once; whether all tests are at their end, and the page no longer renews itself."""
	found = runs.gather(given.folders)
	ended = all(run.ended for run in found)
	if given.text or given.watch is not None:
		for run in found:
			print("\n".join(terminal.lines(run)), flush=True)
	if not given.text:
		page.write(out, page.gather(given.folders, given.laboratory, None if ended else given.watch))
	return ended


def main(argv):
	"""The command; returns its exit code: 0, 1 for what is not there or cannot be written, 130 when interrupted."""
	given = _arguments(argv)
	out = pathlib.Path(given.out or pathlib.Path(given.folders[0]) / _NAME)
	try:
		if given.watch is not None:
			_wait(given.folders, given.watch)
		before, ended = None, False
		while not ended:
			seen = _seen([run.folder for run in runs.gather(given.folders)])
			if seen != before:
				ended = _once(given, out)
				before = seen
			if given.watch is None:
				break
			if not ended:
				time.sleep(given.watch)
		if not given.text:
			print(out)
	except (runs.ReportError, LibraryError) as error:
		print(f"report: {error}", file=sys.stderr)
		return 1
	except OSError as error:
		print(f"report: --out = '{out}': cannot be written ({error.strerror}); fix: choose another file or free space", file=sys.stderr)
		return 1
	except KeyboardInterrupt:
		return 130
	return 0


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
