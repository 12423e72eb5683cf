# SPDX-License-Identifier: GPL-2.0-or-later
"""The command scripts/pfc-check: a state of PFC against the laws here, contact by contact; the same state for a script to go on from.

Exit codes: 0, all within the tolerance; 1, differences, or a file cannot be written; 2, bad input.
"""

import argparse
import pathlib
import sys

from yade import O

import hexmembrane  # noqa: F401
from hexmembrane.configuration import ConfigError
from hexmembrane.exchange import comparison, continuation, tables
from hexmembrane.run.states import Image

_SUFFIXES = (".yade", ".yade.gz")


def _arguments(argv):
	parser = argparse.ArgumentParser(prog="scripts/pfc-check", description="Compare a state of PFC, as scripts/pfc.d/export_pfc.py writes it, with the contact laws here.")
	parser.add_argument("folder", type=pathlib.Path, help="folder with balls.csv and contacts.csv; walls.csv is read where it is there")
	parser.add_argument("--next", type=pathlib.Path, metavar="FOLDER", help="the same one cycle later: increments of shear force and moment are compared")
	parser.add_argument("--tolerance", type=_share, default=1e-6, help="largest difference, as a share of the contact's force (default: %(default)g)")
	parser.add_argument("--state", type=pathlib.Path, metavar="FILE", help="write the state for a script to go on from, a .yade or .yade.gz")
	parser.add_argument("--damping", type=_damping, default=0.0, help="of that state: PFC's damp (default: %(default)g)")
	return parser.parse_args(argv)


def _share(text):
	return _number(text, 0, 1)


def _damping(text):
	return _number(text, -1e-300, 1)


def _number(text, low, high):
	try:
		value = float(text)
	except ValueError:
		value = high
	if not low < value < high:
		raise argparse.ArgumentTypeError(f"{text!r} is no number from 0 to below 1")
	return value


def main(argv):
	"""The command; returns its exit code."""
	given = _arguments(argv)
	if given.state is not None and not given.state.name.endswith(_SUFFIXES):
		print(f"pfc-check: --state = '{given.state}': is no name of a state; fix: a name that ends with .yade or .yade.gz", file=sys.stderr)
		return 2
	try:
		state = tables.read(given.folder)
		then = tables.read(given.next) if given.next else None
		O.reset()
		found = comparison.compare(state, then)
		print("\n".join(found.lines(given.tolerance)))
		if given.state is not None:
			_write(then or state, given)
	except ConfigError as error:
		print(f"pfc-check: {error}", file=sys.stderr)
		return 2
	except OSError as error:
		print(f"pfc-check: --state = '{given.state}': cannot be written ({error.strerror}); fix: choose another file or free space", file=sys.stderr)
		return 1
	many = found.beyond(given.tolerance)
	print(f"differs: {many} values beyond {given.tolerance:g}" if many else f"equal within {given.tolerance:g}")
	return 1 if many else 0


def _write(state, given):
	O.reset()
	continuation.resume(state, given.damping)
	image = Image.taken()
	try:
		image.write(given.state)
	finally:
		image.close()
	print(f"{given.state}: {len(state.balls)} balls, {O.interactions.countReal()} contacts, damping {given.damping:g}, time step {O.dt:.4g} s")


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
