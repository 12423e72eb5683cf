# SPDX-License-Identifier: GPL-2.0-or-later
"""faults.py FOLDER [options]: trials of harm, each with a verdict that is kept in FOLDER/faults.csv; see scripts/faults."""

import argparse
import collections
import csv
import json
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

import tiny

HERE = pathlib.Path(__file__).parent
FIELDS = ("trial", "verdict", "seconds", "what")
FULL = (16, 64, 96, 128, 192, 256, 320, 384, 448, 512, 640, 768, 896, 1024, 1280)
ROWS = (1, 3, 5, 8, 11)
EARLY = "not tried: the test was over too early"


class Trials:
	"""The trials of one kind of test in one folder.

	:param folder: for everything; results of before are in its faults.csv.
	:param kind: one of tiny.KINDS.
	:param only: do trials whose name has this in it.
	"""

	def __init__(self, folder, kind, only=""):
		self.folder, self.kind, self.only = folder / kind, kind, only
		self.table = folder / "faults.csv"
		self.config = tiny.prepare(self.folder, kind)
		self.whole = self.folder / "whole"
		self.well = {row["trial"] for row in read(self.table) if row["verdict"] == "well"}
		if not (self.whole / "sheared.yade.gz").is_file():
			shutil.rmtree(self.whole, ignore_errors=True)
			code, errors = tiny.run(tiny.command(self.config, self.whole, killAt=0))
			if code != 0:
				raise RuntimeError(f"the unharmed test ends with {code}: {tiny.tail(errors)}")
		self.expected = tiny.rows(self.whole)
		self.acts = int((self.folder / "whole.acts").read_text())

	def wanted(self, name):
		return f"{self.kind} {name}" not in self.well and self.only in name

	def keep(self, name, odd, seconds):
		verdict = "not tried" if odd.startswith("not tried") else "BAD" if odd else "well"
		new = not self.table.exists()
		with open(self.table, "a", newline="") as file:
			writer = csv.writer(file)
			if new:
				writer.writerow(FIELDS)
			writer.writerow((f"{self.kind} {name}", verdict, f"{seconds:.1f}", odd))
		print(f"{self.kind} {name}: {verdict} {odd}", flush=True)

	def trial(self, name, does):
		"""Do one trial in an empty folder: ``does(out)`` says what is odd."""
		if not self.wanted(name):
			return
		work = self.folder / "work"
		shutil.rmtree(work, ignore_errors=True)
		work.mkdir()
		begun = time.monotonic()
		odd = does(work / "out")
		self.keep(name, odd, time.monotonic() - begun)

	# Kills

	def kills(self, count):
		"""Half of them aimed, evenly over all acts on the folder, the others at random moments."""
		aimed = min(self.acts, (count + 1) // 2)
		for k in range(aimed):
			act = 1 + k * self.acts // aimed
			self.trial(f"kill at act {act}", lambda out, act=act: self.killedAt(out, act))
		for k in range(count - aimed):
			self.trial(f"kill at random {k}", lambda out, k=k: self._killedAfter(out, random.Random(k).random()))

	def killedAt(self, out, act):
		code, errors = tiny.run(tiny.command(self.config, out, killAt=act))
		if code not in (0, -signal.SIGKILL):
			return f"exit code {code} before the kill: {tiny.tail(errors)}"
		return "" if code == 0 else tiny.goOn(self.config, out, self.expected)

	def _killedAfter(self, out, share):
		"""``share`` of the time that the test has taken since it made its folder."""
		test = tiny.start(tiny.command(self.config, out))
		while test.poll() is None and not out.exists():
			time.sleep(0.005)
		time.sleep(share * float(self._span()))
		test.kill()
		test.communicate()
		return tiny.goOn(self.config, out, self.expected)

	def _span(self):
		"""Wall clock of the unharmed test, from its last row [s]."""
		lines = (self.whole / "records.csv").read_text().split("\n")
		return lines[-2].split(",")[lines[0].split(",").index("elapsed [s]")]

	# One bit

	def stopped(self):
		"""The folder of a test that was killed in its shear, made once."""
		stopped = self.folder / "stopped"
		if not stopped.exists():
			code, errors = tiny.run(tiny.command(self.config, stopped, killAt=int(0.8 * self.acts)))
			if code != -signal.SIGKILL or not tiny.hasCheckpoint(stopped):
				raise RuntimeError(f"the test that was to be stopped ends with {code}: {tiny.tail(errors)}")
		return stopped

	def flips(self, count):
		stopped = self.stopped()
		todo = [k for k in range(count) if self.wanted(f"flip {k}")]
		while todo:
			todo = todo[self._flipSome(stopped, todo) :]

	def _flipSome(self, stopped, todo):
		"""Trials in one process, as far as it comes; how many were done."""
		count = next((i for i in range(1, len(todo)) if todo[i] != todo[i - 1] + 1), len(todo))
		work = self.folder / "work"
		shutil.rmtree(work, ignore_errors=True)
		work.mkdir()
		words = [sys.executable, tiny.LAUNCH, "1", HERE / "flips.py", self.kind, todo[0], count, self.config, stopped, work]
		with open(self.folder / "flips.log", "w") as log:
			process = subprocess.Popen([*map(str, words)], env=tiny.environment(), stdout=subprocess.PIPE, stderr=log, text=True)
		done, place, begun = 0, None, time.monotonic()
		for line in process.stdout:
			found = json.loads(line)
			if "code" not in found:
				place = found
				continue
			self._judgeFlip(found, place, time.monotonic() - begun)
			done, place, begun = done + 1, None, time.monotonic()
		if process.wait() != 0 and place is None and done < count:
			raise RuntimeError(f"flips.py ends with {process.returncode}, see {self.folder / 'flips.log'}")
		if place is not None:
			self.keep(f"flip {place['number']}", f"{place['file']} bit {place['bit']}: the process ends with {process.returncode}", 0)
			done += 1
		return done

	def _judgeFlip(self, found, place, seconds):
		code, errors = found["code"], found["errors"]
		odd = ""
		if code == 0:
			odd = "" if found["rows"] == self.expected else "goes on to other rows"
		elif code != 2 or place["file"] not in errors or "Traceback" in errors or "fix: " not in errors:
			odd = f"exit code {code}: {tiny.tail(errors)}"
		self.keep(f"flip {found['number']}", f"{place['file']} bit {place['bit']}: {odd}" if odd else "", seconds)

	# The folder

	def disks(self):
		for fault, numbers in (("full", FULL), ("read-only", ROWS)):
			for number in numbers:
				self.trial(f"{fault} {number}", lambda out, fault=fault, number=number: self._mounted(fault, number, out.parent))

	def _mounted(self, fault, number, work):
		words = [sys.executable, HERE / "folders.py", fault, number, self.config, work, self.whole]
		done = subprocess.run([*map(str, words)], env=tiny.environment(), capture_output=True, text=True, timeout=600)
		return done.stdout.strip() if done.returncode == 0 else tiny.tail(done.stderr)

	def gone(self):
		for count in ROWS:
			self.trial(f"renamed after {count}", lambda out, count=count: self._renamed(out, count))
			self.trial(f"removed after {count}", lambda out, count=count: self._removed(out, count))

	def _renamed(self, out, count):
		test = tiny.start(tiny.command(self.config, out))
		if not tiny.awaitRows(test, out, count):
			return EARLY
		out.rename(out.with_name("away"))
		odd = tiny.told(*tiny.awaitEnd(test), 1, ("removed or renamed",))
		out.with_name("away").rename(out)
		return odd or tiny.goOn(self.config, out, self.expected)

	def _removed(self, out, count):
		test = tiny.start(tiny.command(self.config, out))
		if not tiny.awaitRows(test, out, count):
			return EARLY
		shutil.rmtree(out, ignore_errors=True)
		odd = tiny.told(*tiny.awaitEnd(test), 1, ("removed or renamed",))
		shutil.rmtree(out, ignore_errors=True)
		return odd or tiny.goOn(self.config, out, self.expected)

	# Others

	def two(self):
		for count in ROWS:
			for more in ((), ("--resume",)):
				self.trial(f"two at once after {count} {' '.join(more)}".strip(), lambda out, count=count, more=more: self._two(out, count, more))

	def _two(self, out, count, more):
		test = tiny.start(tiny.command(self.config, out))
		if not tiny.awaitRows(test, out, count):
			return EARLY
		test.send_signal(signal.SIGSTOP)  # a tiny test would end before the second has started
		if (out / "sheared.yade.gz").exists():
			test.kill()
			test.communicate()
			return EARLY
		code, errors = tiny.run(tiny.command(self.config, out, *more))
		test.send_signal(signal.SIGCONT)
		odd = "" if code == 2 and f"process {test.pid} on " in errors else f"the second ends with {code}: {tiny.tail(errors)}"
		first, _, errors = tiny.awaitEnd(test)
		odd = odd or ("" if first == 0 else f"the first ends with {first}: {tiny.tail(errors)}")
		return odd or ("" if tiny.rows(out) == self.expected else "the rows differ")

	def signals(self):
		for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
			for count in ROWS:
				self.trial(f"{number.name} after {count}", lambda out, number=number, count=count: self._signalled(out, number, count))

	def _signalled(self, out, number, count):
		test = tiny.start(tiny.command(self.config, out))
		if not tiny.awaitRows(test, out, count):
			return EARLY
		over = (out / "sheared.yade.gz").exists()
		test.send_signal(number)
		code, seconds, _ = tiny.awaitEnd(test)
		if over and code == 0:
			return EARLY
		if code in (None, 0) or seconds > tiny.PATIENCE:
			return f"exit code {code} after {seconds:.0f} s"
		return tiny.goOn(self.config, out, self.expected)


def read(table):
	"""The last result of each trial."""
	if not table.exists():
		return []
	with open(table, newline="") as file:
		return list({row["trial"]: row for row in csv.DictReader(file)}.values())


def summary(rows):
	"""Lines of a table: how many trials of each sort were well."""
	found = collections.Counter((" ".join(word for word in row["trial"].split() if not word.isdecimal()), row["verdict"]) for row in rows)
	lines = ["| trials | verdict | number |", "| --- | --- | --- |"]
	return lines + [f"| {name} | {verdict} | {count} |" for (name, verdict), count in sorted(found.items())]


def main(argv):
	parser = argparse.ArgumentParser(prog="scripts/faults", description="Does harm to tiny tests and looks what becomes of them.")
	parser.add_argument("folder", metavar="FOLDER", type=pathlib.Path)
	parser.add_argument("--kills", type=int, default=200, metavar="N", help="of both kinds together (200)")
	parser.add_argument("--flips", type=int, default=1000, metavar="N", help="of both kinds together (1000)")
	parser.add_argument("--only", default="", metavar="TEXT", help="trials whose name has this in it, such as flip, kill or full")
	parser.add_argument("--kinds", default=",".join(tiny.KINDS), help="kinds of tests (%(default)s)")
	arguments = parser.parse_args(argv)
	kinds = arguments.kinds.split(",")
	folder = arguments.folder.resolve()
	folder.mkdir(parents=True, exist_ok=True)
	for kind in kinds:
		trials = Trials(folder, kind, arguments.only)
		trials.flips(arguments.flips // len(kinds))
		trials.disks()
		trials.gone()
		trials.two()
		trials.signals()
		trials.kills(arguments.kills // len(kinds))
	rows = read(folder / "faults.csv")
	print("\n".join(summary(rows)))
	return 1 if any(row["verdict"] == "BAD" for row in rows) else 0


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
