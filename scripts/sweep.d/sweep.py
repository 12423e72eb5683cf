# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line ``scripts/sweep STUDY.yaml``: plans a study, lets Snakemake run it, gathers its results."""

import argparse
import contextlib
import fcntl
import importlib.metadata
import math
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import archive  # noqa: E402
import job
import plan as plans
import results
import slurm
import studyfile
from hexmembrane.configuration import ConfigError
from hexmembrane.report import page
from hexmembrane.report.libraries import LibraryError
from hexmembrane.run.progress import Progress, clock

#: Processor time [s] that this program has taken to start; bounds of its ratio to what the estimates are of.
_STARTED, _SLOWEST = time.process_time(), (0.3, 5.0)
HERE = pathlib.Path(__file__).resolve().parent
LOG = "snakemake.log"
#: The study's page, and how many tests it has at most: each has curves of its own there.
PAGE, _MOST_TESTS = "report.html", 200
#: How often Snakemake begins a job anew whose own program was ended.
_RESTARTS = 3
_LOOK = 0.3
#: Words of Snakemake's log that are shown when it has left stages out.
_LAST_WORDS = 30


def addRunning(parser):
	"""The options of how tests are run."""
	parser.add_argument("--cores", type=int, default=len(os.sched_getaffinity(0)), metavar="N", help="threads of all tests that run at a time, one each unless numerics.threads says more (default: one a processor)")
	parser.add_argument("--dry-run", action="store_true", help="check everything, say what it costs, run nothing")
	parser.add_argument("--again", action="store_true", help="try failed stages again")
	parser.add_argument("--slurm", action="store_true", help="jobs go to the queue of Slurm; --cores is then the number of jobs in it at a time")
	parser.add_argument("--profile", metavar="DIR", help="a profile of Snakemake, for a cluster")
	parser.add_argument("--snakemake", action="append", default=[], metavar="OPTION", help="an option for Snakemake, as --snakemake=--printshellcmds; may be repeated")


def _arguments(argv):
	parser = argparse.ArgumentParser(prog="scripts/sweep", description="Runs a study: a base configuration, axes and seeds.")
	parser.add_argument("study", metavar="STUDY", nargs="?", help="YAML file of the study, see examples/sweep/README.md")
	parser.add_argument("--out", metavar="DIR", help="folder of the study (default: out/sweep/NAME OF STUDY)")
	addRunning(parser)
	parser.add_argument("--verify", metavar="ARCHIVE", help="run a part of a study.tar.gz again and compare")
	parser.add_argument("--runs", type=int, default=1, metavar="N", help="with --verify: how many of its tests (1)")
	given = parser.parse_args(argv)
	if (given.study is None) == (given.verify is None):
		parser.error("give a STUDY, or --verify ARCHIVE")
	if given.cores < 1 or given.runs < 1:
		parser.error("--cores and --runs: a whole number of at least 1 is needed")
	return given


def _size(count):
	return f"{count / 1e9:.2g} GB" if count >= 1e9 else f"{max(count, 1e5) / 1e6:.2g} MB"


def coreHours(jobs):
	"""Core hours of jobs of a plan on this machine as it is now: it starts a stage as fast or slowly as it has started this program.

	Steps feel other programs on the machine less than starts do: by the root, as tests of 200 to 7,045 grains beside others have shown.
	"""
	slow = min(max(_STARTED / plans.SWEEP_START, _SLOWEST[0]), _SLOWEST[1])
	stepping = sum(job.get("stepping", 0) for job in jobs)
	return (slow * (sum(job["seconds"] for job in jobs) - stepping) + math.sqrt(slow) * stepping) / 3600


def announce(plan, folder, cores, say):
	"""Say what there is to do and what it will cost; the seconds by the clock that are stated, 0 when there is nothing."""
	left = {name: found for name, found in plan["jobs"].items() if plans.result(folder, name) is None}
	stages = ", ".join(f"{sum(found['stage'] == stage for found in plan['jobs'].values())} {name}" for stage, name in zip(job.PRODUCTS, ("packings", "consolidated states", "tests sheared")))
	say(f"{plan['title']}: {len(plan['runs'])} runs; {stages}")
	hours = coreHours(left.values())
	longest = max((coreHours([found]) / found["threads"] for found in left.values()), default=0)
	size, free = sum(found["bytes"] for found in left.values()), shutil.disk_usage(folder if folder.exists() else pathlib.Path.cwd()).free
	seconds = 3600 * max(hours / cores, longest)
	say(f"to do: {len(left)} stages, about {hours:.2g} core hours, {clock(seconds)} on {cores} cores, {_size(size)} on the disk of {_size(free)} free")
	if size > free:
		say("WARNING: the disk will be full before the study is done; fix: --out on another one")
	return seconds


def _snakemake(arguments):
	local = not arguments.slurm and not arguments.profile
	command = [sys.executable, "-W", "ignore", "-m", "snakemake", "--snakefile", str(HERE / "Snakefile"), "--keep-going", "--nolock", "--rerun-incomplete"]
	command += ["--rerun-triggers", "mtime", "--restart-times", str(_RESTARTS), "--scheduler", "greedy", "--latency-wait", "10" if local else "60", "--nocolor"]
	command += ["--cores", str(arguments.cores)] if local else ["--jobs", str(arguments.cores)]
	if arguments.slurm:
		command += slurm.options(importlib.metadata.version("snakemake"))
	if arguments.profile:
		command += ["--profile", os.path.abspath(arguments.profile)]
	return [*command, *arguments.snakemake]


def _end(child):
	"""End Snakemake and its jobs, which go on from their checkpoints when they are called again."""
	for number, patience in ((signal.SIGTERM, 10), (signal.SIGKILL, 10)):
		with contextlib.suppress(ProcessLookupError):
			os.killpg(child.pid, number)
		with contextlib.suppress(subprocess.TimeoutExpired):
			child.wait(patience)
			return


def _run(plan, folder, arguments, seconds):
	"""Snakemake over the plan, with a line of progress that begins with the ``seconds`` stated; its exit code."""
	weights = {name: found["seconds"] for name, found in plan["jobs"].items()}
	total = sum(weights.values())
	environment = {**os.environ, "PYTHONWARNINGS": "ignore"}
	if arguments.slurm:
		slurm.cancel(folder)  # of a call that was killed
	if not arguments.slurm and not arguments.profile:
		environment[job.RUNNER] = str(os.getpid())
	with open(folder / LOG, "ab") as log, Progress("sweep", expected=seconds) as progress:
		own = {"start_new_session": True, "preexec_fn": job.dieWithParent}
		child = subprocess.Popen(_snakemake(arguments), cwd=folder, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=environment, **own)
		ended = {}
		try:
			while True:
				over = child.poll() is not None
				for name in set(weights) - set(ended):
					found = plans.result(folder, name)
					if found:
						ended[name] = found["status"]
				failed = sum(said == "failed" for said in ended.values())
				progress.update(sum(weights[name] for name in ended) / total, stages=f"{len(ended)} of {len(weights)}", failed=failed)
				if over:
					return child.returncode
				time.sleep(_LOOK)
		finally:
			if child.poll() is None:
				_end(child)
			if arguments.slurm:
				slurm.cancel(folder)


def lock(folder):
	"""Hold the study's folder; the file stays open as long as this process lives."""
	file = open(folder / "lock", "wb")
	try:
		fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
	except BlockingIOError:
		raise ConfigError("--out", str(folder), "another run works there", "wait for it, or choose another folder") from None
	return file


def forget(plan, folder):
	"""Take away the results of failed stages."""
	for name in plan["jobs"]:
		if (found := plans.result(folder, name)) and found["status"] == "failed":
			(folder / plans.STAGES_FOLDER / name / plans.RESULT).unlink()


def _tell(table, folder, say):
	"""What became of the runs; the exit code."""
	column = table[0].index("status")
	odd = [row for row in table[1:] if row[column] != "done"]
	for row in odd:
		say(f"run {row[0]}: {row[column]}")
	pictures = "study.png" if (folder / "study.png").exists() else "study-SET.png"
	say(f"{len(table) - 1 - len(odd)} of {len(table) - 1} runs are done; {folder / results.RUNS}, {results.MEANS}, {results.RECORDS}, {pictures}, {results.PROVENANCE}, {archive.ARCHIVE}")
	if odd:
		say(f"what Snakemake said: {folder / LOG}; a stage's own words: {folder / plans.STAGES_FOLDER}/STAGE/log.txt; --again tries failed ones again")
	return 1 if odd else 0


def advance(plan, inputs, folder, arguments, say):
	"""Write a plan into its folder, whose lock the caller holds, and run what has not been run; nothing is gathered.

	:raises ConfigError: jobs are to go to a queue that is not there, or a test has more threads than there are cores for all.
	"""
	most = max((found["threads"] for found in plan["jobs"].values()), default=1)
	if most > arguments.cores and not arguments.slurm and not arguments.profile:
		raise ConfigError("--cores", arguments.cores, f"is less than numerics.threads = {most} of a test", f"--cores {most} or more, or fewer threads; results depend on them by rounding")
	if arguments.slurm and slurm.version() is None:
		raise ConfigError("--slurm", "sbatch", "is not found or does not answer on this machine", "call it where jobs are submitted, such as a cluster's login node, or leave --slurm out")
	plans.write(plan, inputs, folder)
	before = {name for name in plan["jobs"] if plans.result(folder, name)}
	if seconds := announce(plan, folder, arguments.cores, say):
		code = _run(plan, folder, arguments, seconds)
		took = [found for name in set(plan["jobs"]) - before if (found := plans.result(folder, name))]
		say(f"took {sum(found['processor_seconds'] for found in took) / 3600:.2g} core hours for {len(took)} stages")
		if any(plans.result(folder, name) is None for name in plan["jobs"]):
			lines = (folder / LOG).read_text(encoding="utf-8", errors="replace").split()
			say(f"Snakemake ended with the code {code}; its last words: {' '.join(lines[-_LAST_WORDS:])}")


def _page(plan, folder, say):
	"""Write the study's page, unless its key ``report`` says false; what is in the way is told of."""
	path = folder / PAGE
	if not studyfile.wantsPage(plan["study"]):
		return
	if len(plan["runs"]) > _MOST_TESTS:
		say(f"no {path}: it would have {len(plan['runs'])} tests, {_MOST_TESTS} are its most; fix: scripts/report with folders of some of them")
		return
	try:
		page.write(path, page.gather([folder]))
		say(f"wrote {path}")
	except LibraryError as error:
		say(f"no {path}: {error}, or report: false")


def execute(plan, inputs, folder, arguments, say):
	"""Run a plan in its folder, gather, and write its page; the exit code: 0, 1 when a run is not done."""
	folder.mkdir(parents=True, exist_ok=True)
	with lock(folder):
		if arguments.again:
			forget(plan, folder)
		if results.upToDate(plan, folder):
			say("nothing to do")
			if not (folder / PAGE).exists():
				_page(plan, folder, say)
			with open(folder / results.RUNS, encoding="utf-8", newline="") as file:
				return _tell(list(results.csv.reader(file)), folder, say)
		advance(plan, inputs, folder, arguments, say)
		try:
			table = results.gather(plan, folder)
			archive.write(plan, folder)
			_page(plan, folder, say)
		except OSError as error:
			for run in plan["runs"]:
				say(f"run {run['name']}: {results.status(folder, run)}")
			say(f"the tables cannot be written ({error}); fix: make room, then the same command with --again goes on")
			return 1
		return _tell(table, folder, say)


def verify(arguments, say):
	"""Run a part of an archived study again; 0: all equal, bit for bit or, on another processor or by YADE's own loop on several threads, nearly."""
	path = pathlib.Path(arguments.verify)
	folder = pathlib.Path(arguments.out or pathlib.Path("out", "sweep", "verify"))
	if (folder / plans.NAME).exists():
		raise ConfigError("--out", str(folder), "holds a study already", "choose another folder")
	old = folder / "archive"
	try:
		archive.unpack(path, old)
		whole = plans.read(old)
	except (OSError, archive.tarfile.TarError, EOFError) as error:
		raise ConfigError("--verify", str(path), f"cannot be read ({error})", "give a study.tar.gz of scripts/sweep") from None
	names = archive.chosen(whole, old, arguments.runs)
	if not names:
		raise ConfigError("--verify", str(path), "has no run that is done", "verify another archive")
	plan = plans.part(whole, names)
	archive.linked(plan, old, folder)
	say(f"runs {', '.join(names)} of {len(whole['runs'])} again")
	execute(plan, {}, folder, arguments, say)
	equal = True
	for name, found in plan["jobs"].items():
		worst, text = archive.compare(found, *(place / plans.STAGES_FOLDER / name for place in (old, folder)))
		before = plans.result(old, name)["processor"]
		# YADE's own loop sums in no fixed order on several threads; the compact tier does
		other = before != job.processor() or found["threads"] > 1 and found["config"]["tier"] == "reference"
		equal &= worst == 0 or other and worst <= archive.TOLERANCE
		say(f"{name}: {text}" + (f"; made on {before}, here is {job.processor()}" if other and worst != 0 else ""))
	say("verified" if equal else "NOT verified: see above")
	return 0 if equal else 1


def _stop(*_):
	raise KeyboardInterrupt


def guarded(does):
	"""Exit code of ``does(say)``, a command on tests that goes on when it is called again: 2 for bad input, 1 for another failure, 130 when interrupted."""
	signal.signal(signal.SIGTERM, _stop)
	signal.signal(signal.SIGINT, _stop)
	try:
		return does(lambda text: print(text, flush=True))
	except ConfigError as error:
		print(f"error: {error}", file=sys.stderr)
		return 2
	except (OSError, ValueError, RuntimeError) as error:
		print(f"error: {error}", file=sys.stderr)
		return 1
	except KeyboardInterrupt:
		print("interrupted: the same command goes on", file=sys.stderr)
		return 130


def main(argv):
	"""Exit code: 0; 1 when a run is not done or a verification fails; 2 for bad input; 130 when interrupted."""
	arguments = _arguments(argv)

	def study(say):
		if arguments.verify:
			return verify(arguments, say)
		plan, inputs = plans.make(studyfile.load(arguments.study))
		folder = pathlib.Path(arguments.out or pathlib.Path("out", "sweep", pathlib.Path(arguments.study).name.removesuffix(".yaml"))).absolute()
		if arguments.dry_run:
			announce(plan, folder, arguments.cores, say)
			return 0
		return execute(plan, inputs, folder, arguments, say)

	return guarded(study)


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
