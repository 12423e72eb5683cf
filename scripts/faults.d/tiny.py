# SPDX-License-Identifier: GPL-2.0-or-later
"""Tiny tests to do harm to: how they are run, and what is looked at afterwards. Needs no YADE in this process."""

import json
import pathlib
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "py"), str(ROOT / "tests" / "python")]

from tinyTest import MAIN, configure, environment  # noqa: E402

LAUNCH = ROOT / "scripts" / "setup.d" / "launch.py"
HARMED = pathlib.Path(__file__).with_name("harmed.py")
#: Kinds of tests: the compact tier in the membrane, the reference tier in the rigid wall.
KINDS = {"compact": {}, "reference": {"tier": "reference", "boundary": "wall"}}
#: Seconds within which a test ends whose folder cannot be written.
PATIENCE = 10.0


def prepare(folder, kind):
	"""The configuration of a kind of test, in a folder of its own."""
	folder.mkdir(parents=True, exist_ok=True)
	return configure(folder, **KINDS[kind])


def command(config, out, *more, killAt=None):
	"""Words that run a test; ``killAt``: the act at which it is killed, 0 to count them."""
	harm = [] if killAt is None else [str(HARMED), str(killAt), str(out)]
	return [sys.executable, str(LAUNCH), "1", *harm, str(MAIN), str(config), "--out", str(out), *more]


def _heedSignals():
	"""A shell's background job, or nohup, would have a test ignore them."""
	for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
		signal.signal(number, signal.SIG_DFL)


def start(words):
	return subprocess.Popen(words, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=_heedSignals)


def run(words):
	"""(exit code, standard error) of a command."""
	done = subprocess.run(words, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=600)
	return done.returncode, done.stderr


def rows(out):
	"""The rows of a folder, each without the wall clock; a torn last one is left out."""
	path = out / "records.csv"
	if not path.is_file():
		return []
	lines = path.read_text(errors="replace").split("\n")[:-1]
	if not lines:
		return []
	clock = lines[0].split(",").index("elapsed [s]")
	return [[cell for k, cell in enumerate(line.split(",")) if k != clock] for line in lines]


def awaitRows(test, out, count, limit=300):
	"""Wait until a running test has written so many rows. :returns: whether it still runs."""
	until = time.monotonic() + limit
	while test.poll() is None and time.monotonic() < until:
		if len(rows(out)) > count:
			break
		time.sleep(0.01)
	return test.poll() is None


def awaitEnd(test):
	"""(exit code, seconds waited, standard error) of a test that is to end by itself; one that hangs is killed and has no code."""
	begun = time.monotonic()
	try:
		_, errors = test.communicate(timeout=60)
	except subprocess.TimeoutExpired:
		test.kill()
		_, errors = test.communicate()
		return None, 60.0, errors
	return test.returncode, time.monotonic() - begun, errors


def goOn(config, out, expected):
	"""What is odd after a stopped test was resumed, or begun anew where it had written nothing; '' when it has the expected rows."""
	found = rows(out)
	if found != expected[: len(found)]:
		return f"{len(found)} rows are no prefix"
	resumed = hasCheckpoint(out)
	code, errors = run(command(config, out, *(["--resume"] if resumed else []), "--quiet"))
	if code != 0:
		return f"{'--resume' if resumed else 'the same command'} ends with {code}: {tail(errors)}"
	return "" if rows(out) == expected else "the rows differ"


def hasCheckpoint(out):
	path = out / "manifest.json"
	return path.exists() and bool(json.loads(path.read_text())["checkpoints"])


def tail(errors):
	lines = errors.strip().splitlines()
	return lines[-1][:300] if lines else ""


def told(code, seconds, errors, wanted, words):
	"""What is odd in how a test has ended: code, time, message."""
	if code is None or seconds > PATIENCE:
		return f"did not end within {PATIENCE:g} s"
	if code != wanted:
		return f"exit code {code}, {wanted} expected: {tail(errors)}"
	if "Traceback" in errors or "fix: " not in errors or not any(word in errors for word in words):
		return f"message: {tail(errors)}"
	return ""
