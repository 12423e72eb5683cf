# SPDX-License-Identifier: GPL-2.0-or-later
"""slurm.py submit JOBSCRIPT, slurm.py status JOB: what Snakemake calls to give a stage to Slurm and to ask what became of it; imports nothing of the package.

Snakemake's own way to Slurm wants its accounting (``sacct``), which many clusters and every small one do without; sbatch, squeue and scancel are everywhere.
In the private root the host's commands are out of sight, and on the host a job is outside the root: HEXMEMBRANE_ON_HOST and HEXMEMBRANE_BESIDE, which
``scripts/sweep`` sets, are the words before a command that runs on the host, and before one that runs beside YADE.
"""

import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

#: Jobs that were given to the queue, in the study's folder: a line 'ID STAGE' each.
GIVEN = "queue.txt"
#: States of Slurm after which a job does nothing any more, for good or for bad.
_DONE = ("COMPLETED",)
_ENDED = ("BOOT_FAIL", "CANCELLED", "DEADLINE", "FAILED", "NODE_FAIL", "OUT_OF_MEMORY", "TIMEOUT", "REVOKED")
#: How often Snakemake asks, over all jobs: the queue serves others as well.
_ASKED_PER_SECOND = 2


def onHost(*command):
	"""A command that runs on the host, finished: (exit code, output, errors). :raises OSError: it cannot be started."""
	ended = subprocess.run([*shlex.split(os.environ.get("HEXMEMBRANE_ON_HOST", "")), *command], stdin=subprocess.DEVNULL, capture_output=True, text=True)
	return ended.returncode, ended.stdout.strip(), ended.stderr.strip()


def version():
	"""What ``sbatch --version`` says; None: there is none on this host."""
	try:
		code, said, _ = onHost("sbatch", "--version")
	except OSError:
		return None
	return said if code == 0 else None


def options(snakemake):
	"""Snakemake's options for jobs in the queue.

	:param snakemake: its version, as '7.32.4'. From 8 on the way is a plugin, snakemake-executor-plugin-cluster-generic.
	"""
	submit, status = (f"{shlex.quote(sys.executable)} {shlex.quote(os.path.abspath(__file__))} {what}".replace("{", "{{").replace("}", "}}") for what in ("submit", "status"))
	if int(snakemake.partition(".")[0]) < 8:
		chosen = ["--cluster", submit, "--cluster-status", status]
	else:
		chosen = ["--executor", "cluster-generic", "--cluster-generic-submit-cmd", submit, "--cluster-generic-status-cmd", status]
	return [*chosen, "--max-status-checks-per-second", str(_ASKED_PER_SECOND)]


def _asked(resources):
	"""Options of sbatch from a job's resources, those of ``--snakemake=--default-resources`` among them."""
	asked = [f"--mem={resources['mem_mb']}M", f"--time={resources['runtime']}"]
	asked += [f"--{name}={resources[f'slurm_{name}']}" for name in ("account", "partition") if resources.get(f"slurm_{name}")]
	return asked + shlex.split(str(resources.get("slurm_extra") or ""))


def script(text):
	"""The batch script for a job script of Snakemake, which is the shell's argument there: the file itself is gone when Snakemake has ended."""
	return f"#!/bin/bash\nexec {os.environ.get('HEXMEMBRANE_BESIDE', '')} /bin/sh -c {shlex.quote(text)}\n"


def submit(path):
	"""Give a job script to the queue, from the study's folder; the job's number."""
	text = pathlib.Path(path).read_text(encoding="utf-8")
	properties = json.loads(re.search(r"^# properties = (.*)$", text, re.MULTILINE)[1])
	stage = pathlib.Path(properties["output"][0]).parent.absolute()
	stage.mkdir(parents=True, exist_ok=True)
	batch = stage / "batch.sh"
	batch.write_text(script(text), encoding="utf-8")
	named = ["--job-name", stage.name, "--chdir", os.getcwd(), "--output", str(stage / "slurm.txt"), "--open-mode=append", "--ntasks=1", f"--cpus-per-task={properties['threads']}", "--requeue"]
	code, said, wrong = onHost("sbatch", "--parsable", *named, *_asked(properties["resources"]), str(batch))
	if code:
		raise OSError(f"sbatch ended with the code {code}: {wrong}")
	number = said.partition(";")[0]
	with open(GIVEN, "a", encoding="utf-8") as given:
		given.write(f"{number} {stage.name}\n")
	return number


def given(folder="."):
	"""{number of a job: its stage} of all that a study's folder has given to the queue."""
	try:
		return dict(line.split() for line in pathlib.Path(folder, GIVEN).read_text(encoding="utf-8").splitlines())
	except FileNotFoundError:
		return {}


def status(number):
	"""'running', 'success' or 'failed'. A job that waits runs, and so does one whose queue does not answer: it is asked again."""
	code, state, wrong = onHost("squeue", "--noheader", "--states=all", "--format=%T", "--jobs", number)
	if code and "Invalid job id" not in wrong:
		return "running"
	if state in _DONE:
		return "success"
	if state in _ENDED:
		return "failed"
	if state:
		return "running"
	# Slurm has forgotten it, minutes after its end
	stage = given().get(number)
	return "success" if stage and (pathlib.Path("stages") / stage / "result.json").is_file() else "failed"


def cancel(folder):
	"""Take from the queue what a study's folder has given to it and what is still there; what has run goes on from its checkpoints when it is given anew."""
	if not (known := given(folder)):
		return
	_, said, _ = onHost("squeue", "--me", "--noheader", "--format=%i %j")
	# by number and name: a queue that was set up anew counts from one again
	if left := sorted(set(map(str.strip, said.splitlines())) & {f"{number} {stage}" for number, stage in known.items()}):
		onHost("scancel", *(line.split()[0] for line in left))
	pathlib.Path(folder, GIVEN).unlink()


if __name__ == "__main__":
	try:
		print({"submit": submit, "status": status}[sys.argv[1]](sys.argv[2]))
	except OSError as error:
		sys.exit(f"slurm.py: {error}")
