# SPDX-License-Identifier: GPL-2.0-or-later
"""flips.py SEED FIRST COUNT CONFIG STOPPED WORK: in one YADE, flips one bit in a copy of the folder STOPPED and resumes it, so many times.

For each trial a line of JSON: number, exit code, file, place, standard error, records. A crash ends the process; the caller goes on after it.
"""

import contextlib
import io
import json
import pathlib
import random
import shutil
import sys

from yade import O

sys.path.insert(0, str(pathlib.Path(__file__).parent))

import tiny  # noqa: E402

from hexmembrane.run.command import main  # noqa: E402


def flipped(folder, choice):
	"""Flip a bit of a file: (name, bit). Each file is as likely as any other."""
	files = sorted(path for path in folder.rglob("*") if path.is_file() and path.stat().st_size)
	path = choice.choice(files)
	data = bytearray(path.read_bytes())
	bit = choice.randrange(8 * len(data))
	data[bit // 8] ^= 1 << bit % 8
	path.write_bytes(data)
	return path.name, bit


def trial(number, seed, config, stopped, work):
	out = work / "out"
	shutil.rmtree(out, ignore_errors=True)
	shutil.copytree(stopped, out)
	name, bit = flipped(out, random.Random(f"{seed} {number}"))
	print(json.dumps({"number": number, "file": name, "bit": bit}), flush=True)
	O.reset()
	errors = io.StringIO()
	with contextlib.redirect_stderr(errors):
		code = main([str(config), "--out", str(out), "--resume", "--quiet"])
	print(json.dumps({"number": number, "code": code, "errors": errors.getvalue(), "rows": tiny.rows(out)}), flush=True)


def run(seed, first, count, config, stopped, work):
	for number in range(int(first), int(first) + int(count)):
		trial(number, seed, pathlib.Path(config), pathlib.Path(stopped), pathlib.Path(work))


if __name__ == "__main__":
	run(*sys.argv[1:])
