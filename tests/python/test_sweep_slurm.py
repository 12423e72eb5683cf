# SPDX-License-Identifier: GPL-2.0-or-later
"""Studies in a queue, with programs in the place of Slurm's. A true queue: scripts/sweep.d/slurm-test."""

import json
import os
import pathlib
import subprocess
import sys

import pytest

FOLDER = pathlib.Path(__file__).parents[2] / "scripts" / "sweep.d"
sys.path.insert(0, str(FOLDER))
import slurm  # noqa: E402

#: A program that keeps its arguments, one a line, and says what the file beside it says.
FAKE = """#!/bin/sh
printf '%s\\n' "$@" >"$0.given"
cat "$0.says"
cat "$0.errs" >&2
exit $(cat "$0.code")
"""
JOBSCRIPT = """#!/bin/sh
# properties = {properties}
echo "it's $HEXMEMBRANE_TRIED" > stages/shear-1/ran
"""


@pytest.fixture
def queue(tmp_path, monkeypatch):
	"""``queue(program, says, errs, code)`` sets what a program of Slurm does; ``queue.given(program)`` are the arguments that it had."""
	monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
	monkeypatch.setenv("HEXMEMBRANE_ON_HOST", "/usr/bin/env 'A=a b'")
	monkeypatch.setenv("HEXMEMBRANE_BESIDE", "/usr/bin/env HEXMEMBRANE_TRIED=beside")
	monkeypatch.chdir(tmp_path)

	def program(name, says="", errs="", code=0):
		for suffix, text in (("", FAKE), (".says", says), (".errs", errs), (".code", str(code))):
			(tmp_path / f"{name}{suffix}").write_text(text)
		(tmp_path / name).chmod(0o755)

	program.given = lambda name: (tmp_path / f"{name}.given").read_text().splitlines()
	return program


def submit(folder, **resources):
	properties = {"output": ["stages/shear-1/result.json"], "threads": 2, "resources": {"mem_mb": 2000, "runtime": 30, **resources}}
	(folder / "job.sh").write_text(JOBSCRIPT.replace("{properties}", json.dumps(properties)))
	return slurm.submit(folder / "job.sh")


def test_submit(queue, tmp_path):
	"""The batch script needs no file of Snakemake's, and enters the place beside YADE."""
	queue("sbatch", "17;cluster\n")
	assert submit(tmp_path, slurm_account="sand", slurm_extra="--qos=long '--comment=a b'") == "17"
	given = queue.given("sbatch")
	assert {"--parsable", "--requeue", "--mem=2000M", "--time=30", "--account=sand", "--qos=long", "--comment=a b", "--cpus-per-task=2"} <= set(given)
	assert given[given.index("--job-name") + 1] == "shear-1" and slurm.given() == {"17": "shear-1"}
	(tmp_path / "job.sh").unlink()
	subprocess.run(["/bin/sh", given[-1]], check=True)
	assert (tmp_path / "stages/shear-1/ran").read_text() == "it's beside\n"


def test_refused(queue, tmp_path):
	queue("sbatch", errs="no such partition", code=1)
	with pytest.raises(OSError, match="sbatch ended with the code 1: no such partition"):
		submit(tmp_path)
	assert slurm.given() == {}


@pytest.mark.parametrize(
	"says, errs, code, status",
	[
		("PENDING", "", 0, "running"),
		("REQUEUED", "", 0, "running"),
		("COMPLETED", "", 0, "success"),
		("TIMEOUT", "", 0, "failed"),
		("", "slurm_load_jobs error: Unable to contact slurm controller", 1, "running"),
		("", "slurm_load_jobs error: Invalid job id specified", 1, "failed"),
		("", "", 0, "failed"),
	],
)
def test_status(queue, says, errs, code, status):
	queue("squeue", says, errs, code)
	assert slurm.status("17") == status


def test_forgottenJob(queue, tmp_path):
	"""A job of which Slurm knows nothing any more has done what its stage's result says."""
	queue("sbatch", "17\n")
	submit(tmp_path)
	queue("squeue", errs="Invalid job id specified", code=1)
	assert slurm.status("17") == "failed"
	(tmp_path / "stages/shear-1/result.json").write_text("{}")
	assert slurm.status("17") == "success"


def test_leftJobsAreCancelled(queue, tmp_path):
	"""Those of this folder that are still there, and no job of another that has the same number or the same name."""
	queue("scancel")
	slurm.cancel(tmp_path)
	assert not (tmp_path / "scancel.given").exists()
	(tmp_path / slurm.GIVEN).write_text("17 shear-1\n18 shear-2\n19 shear-3\n")
	queue("squeue", "17 shear-1\n18 another\n20 shear-3\n")
	slurm.cancel(tmp_path)
	assert queue.given("scancel") == ["17"] and slurm.given() == {}


def test_versionsOfSnakemake():
	old, new = slurm.options("7.32.4"), slurm.options("8.4.1")
	assert old[0] == "--cluster" and old[1].endswith(" submit") and old[2:4][0] == "--cluster-status"
	assert new[:2] == ["--executor", "cluster-generic"] and old[1] == new[3]


def test_noQueue(monkeypatch):
	monkeypatch.delenv("HEXMEMBRANE_ON_HOST", raising=False)
	monkeypatch.setenv("PATH", "/nowhere")
	assert slurm.version() is None
