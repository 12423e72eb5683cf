# SPDX-License-Identifier: GPL-2.0-or-later
"""job.py STAGE: runs one stage of the plan in this folder, in a YADE of its own on as many threads as the plan says, and writes its result; Snakemake's rules call it.

Whatever ends YADE, the stage is tried again from its last checkpoint, as often as the plan says; then its error is its result. A stage that is
stopped (SIGTERM, SIGINT, a queue's SIGUSR1, the end of whoever has started it) has no result: the next call goes on from its last checkpoint.
"""

import ctypes
import fcntl
import json
import os
import pathlib
import platform
import resource
import shutil
import signal
import subprocess
import sys
import time

import yaml

HERE = pathlib.Path(__file__).resolve().parent
LAUNCH = HERE.parent / "setup.d" / "launch.py"
MAIN = HERE.parent.parent / "py" / "hexmembrane" / "__main__.py"
#: Process that a study on one machine must not outlive: its scripts/sweep.
RUNNER = "HEXMEMBRANE_SWEEP_RUNNER"
#: What each stage leaves for the next, or for the tables.
PRODUCTS = {"specimen": "packing.txt", "consolidation": "consolidated.yade.gz", "shear": "records.csv"}
BAD_INPUT, STOPPED = 2, 143
_LOOK = 0.1
_DIE_WITH_PARENT = 1


class Stopped(Exception):
	"""The stage is to end now and has no result."""


def _stop(*_):
	raise Stopped


def processor():
	"""The processor's name."""
	try:
		lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
	except OSError:
		lines = []
	return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def dieWithParent():
	"""For a process that is about to start: it is killed when the one that starts it ends."""
	ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)


def hasCheckpoint(test):
	"""Whether a test's folder has a checkpoint to go on from."""
	if (test / "checkpoint.json").is_file():
		return True
	try:
		return bool(json.loads((test / "manifest.json").read_text(encoding="utf-8"))["checkpoints"])
	except (OSError, ValueError, KeyError, TypeError):
		return False


def _configuration(keys, folder):
	"""The job's configuration as YAML, files by their whole paths."""
	specimen = keys["specimen"]
	files = {name: str(folder / specimen[name]) for name in ("packing", "gradation", "balls") if specimen.get(name) is not None}
	return yaml.safe_dump({**keys, "specimen": {**specimen, **files}}, sort_keys=False)


class Job:
	"""One stage: ``plan``, ``name``, ``folder`` of its own, ``test`` folder inside."""

	def __init__(self, plan, name):
		self.plan, self.name, self.base = plan, name, pathlib.Path.cwd()
		self.job = plan["jobs"][name]
		self.stage = self.job["stage"]
		self.folder = self.base / "stages" / name
		self.test = self.folder / "test"

	def before(self):
		"""The result of the stage before, None for a specimen."""
		before = self.job["before"]
		return before and json.loads((self.base / "stages" / before / "result.json").read_text(encoding="utf-8"))

	def arguments(self, resume):
		staged = self.stage == "shear" and self.job["config"].get("stages") is not None
		how = [] if staged else ["--until", self.stage]
		if resume:
			how.append("--resume")
		elif self.stage == "shear" and not staged:
			how += ["--from", str(self.base / "stages" / self.job["before"] / "test" / PRODUCTS["consolidation"])]
		return [str(self.folder / "job.yaml"), "--out", str(self.test), "--quiet", *how]

	def once(self, resume):
		"""Run YADE: (exit code, last error)."""
		if not resume:
			shutil.rmtree(self.test, ignore_errors=True)
		parent, runner = os.getppid(), os.environ.get(RUNNER)
		threads = str(self.job["threads"])
		command = [sys.executable, str(LAUNCH), threads, str(MAIN), *self.arguments(resume)]
		environment = {**os.environ, "OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(MAIN.parent.parent)}
		said = self.folder / "log.txt"
		again = said.exists()
		with open(said, "ab") as log:
			if again:
				log.write(f"once more: {' '.join(self.arguments(resume)[1:])}\n".encode())
				log.flush()
			begun = log.tell()
			child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=environment, preexec_fn=dieWithParent)
			try:
				while child.poll() is None:
					time.sleep(_LOOK)
					if os.getppid() != parent or runner and not pathlib.Path("/proc", runner).exists():
						raise Stopped
			finally:
				if child.poll() is None:
					child.kill()
					child.wait()
		with open(said, encoding="utf-8", errors="replace") as log:
			log.seek(begun)
			lines = [line.strip() for line in log if line.strip()]
		errors = [line.removeprefix("error: ") for line in lines if line.startswith("error: ")] or lines[-1:]
		# places count from the study's folder, which may be moved
		return child.returncode, errors[-1].replace(f"{self.base}/", "") if errors else ""

	def run(self):
		"""Run the stage until it is done or has failed for good; its result."""
		before = self.before()
		if before and before["status"] == "failed":
			return {**self.result("failed", before["error"], 0, 0.0), "failed_in": before["failed_in"]}
		self.folder.mkdir(parents=True, exist_ok=True)
		(self.folder / "job.yaml").write_text(_configuration(self.job["config"], self.base), encoding="utf-8")
		started, anew, error = time.monotonic(), False, ""
		for attempt in range(1, self.plan["attempts"] + 1):
			resume = not anew and self.stage != "specimen" and hasCheckpoint(self.test)
			code, error = self.once(resume)
			if code == 0 and (self.test / PRODUCTS[self.stage]).is_file():
				return self.result("done", "", attempt, time.monotonic() - started)
			if code < 0:
				error = f"YADE was ended by {signal.Signals(-code).name}" + (f" ({error})" if error else "")
			if code == BAD_INPUT and not resume:
				break
			anew = code == BAD_INPUT  # its checkpoint cannot be used
		return self.result("failed", error or f"YADE ended with the code {code}", attempt, time.monotonic() - started)

	def result(self, status, error, attempts, seconds):
		product, made = self.test / PRODUCTS[self.stage], {}
		ended = resource.getrusage(resource.RUSAGE_CHILDREN)
		if status == "done":
			made = yaml.safe_load((self.test / "config.yaml").read_text(encoding="utf-8"))["made"]
			made = {name: value for name, value in made.items() if isinstance(value, (str, int))}
		return {
			"status": status,
			"error": error,
			"failed_in": self.stage if status == "failed" else "",
			"attempts": attempts,
			"seconds": round(seconds, 2),
			"processor_seconds": round(ended.ru_utime + ended.ru_stime, 2),
			"bytes": product.stat().st_size if product.is_file() else 0,
			"host": platform.node(),
			"processor": processor(),
			"made": made,
		}


def main(name):
	for number in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
		signal.signal(number, _stop)
	job = Job(json.loads(pathlib.Path("plan.json").read_text(encoding="utf-8")), name)
	job.folder.mkdir(parents=True, exist_ok=True)
	with open(job.folder / "lock", "wb") as lock:
		try:
			fcntl.flock(lock, fcntl.LOCK_EX)
			if (job.folder / "result.json").is_file():
				return 0  # another job of a queue, which was waited for, has done it
			result = job.run()
		except Stopped:
			return STOPPED
		part = job.folder / "result.json.part"
		part.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
		part.replace(job.folder / "result.json")
	return 0


if __name__ == "__main__":
	sys.exit(main(sys.argv[1]))
