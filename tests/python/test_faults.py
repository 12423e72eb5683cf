# SPDX-License-Identifier: GPL-2.0-or-later
"""Harm done to a tiny test, in a short form: kills, flipped bits, two at once, disk and folder. The long form is ``scripts/faults``."""

import errno
import gzip
import os
import pathlib
import resource
import shutil
import sys

import pytest
from hexmembrane.run import checkpoints, manifest, stages, states
from hexmembrane.run.lock import FolderLock
from hexmembrane.run.manifest import CheckpointError
from tinyTest import configure

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "scripts" / "faults.d"))

import faults  # noqa: E402
import tiny  # noqa: E402


@pytest.fixture(scope="module")
def trials(tmp_path_factory):
	"""The trials of the compact tier, its unharmed test done."""
	return faults.Trials(tmp_path_factory.mktemp("faults"), "compact")


def verdicts(trials):
	return {row["trial"]: row["what"] for row in faults.read(trials.table) if row["verdict"] != "well"}


def test_flippedBits(trials):
	trials.flips(8)
	assert verdicts(trials) == {} and len(faults.read(trials.table)) == 8


def test_killedAtAWrite(trials, tmp_path):
	shutil.copytree(trials.stopped(), tmp_path / "out")
	assert tiny.goOn(trials.config, tmp_path / "out", trials.expected) == ""


@pytest.mark.parametrize("more", [(), ("--resume",)])
def test_twoAtOnce(trials, runHere, more):
	"""Nothing is changed in a folder whose lock another run has."""
	stopped = trials.stopped()
	before = {path: path.read_bytes() for path in stopped.glob("*.*") if path.name != "run.lock"}
	with FolderLock(stopped):
		code, _, errors = runHere(trials.config, "--out", stopped, *more)
	assert code == 2 and f"process {os.getpid()} on " in errors and "is in this folder; fix: " in errors
	assert {path: path.read_bytes() for path in stopped.glob("*.*")} == before


@pytest.fixture
def harmedHere(trials, tmp_path, runHere):
	"""A test in this YADE that is harmed: (exit code, its errors); afterwards ``goOn()`` says whether it has the whole test's rows."""

	class Harmed:
		out = tmp_path / "out"

		def run(self, *more):
			return runHere(trials.config, "--out", self.out, "--quiet", *more)[::2]

		def goOn(self):
			found = tiny.rows(self.out)
			assert found == trials.expected[: len(found)]
			code, errors = self.run(*(["--resume"] if checkpoints.exist(self.out) else []))
			assert code == 0, errors
			return tiny.rows(self.out) == trials.expected

	return Harmed()


@pytest.mark.parametrize("size", [4000, 120000])
def test_noRoom(harmedHere, size):
	"""A limit of a file's size acts as a full disk does, on each kind of file in its turn."""
	before = resource.getrlimit(resource.RLIMIT_FSIZE)
	resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
	try:
		code, errors = harmedHere.run()
	finally:
		resource.setrlimit(resource.RLIMIT_FSIZE, before)
	assert code == 1 and "cannot be written" in errors and "fix: raise the limit of a file's size" in errors
	assert not checkpoints.exist(harmedHere.out)
	code, errors = harmedHere.run("--resume")
	assert code == 2 and "there is none yet; fix: the same command without --resume, which begins anew" in errors
	assert harmedHere.goOn()


def after(monkeypatch, count, harm):
	"""Do ``harm()`` when a test has written so many rows."""
	true = stages.TriaxialTest.row

	def row(test):
		found = true(test)
		if len(tiny.rows(test.out)) == count + 1:
			harm()
		return found

	monkeypatch.setattr(stages.TriaxialTest, "row", row)


def test_folderGone(harmedHere, tmp_path, monkeypatch):
	after(monkeypatch, 10, lambda: harmedHere.out.rename(tmp_path / "away"))
	code, errors = harmedHere.run()
	assert code == 1 and "No such file" in errors and "fix: the folder or file was removed or renamed: put it back" in errors
	(tmp_path / "away").rename(harmedHere.out)
	monkeypatch.undo()
	assert harmedHere.goOn()


def test_folderRemoved(harmedHere, monkeypatch):
	after(monkeypatch, 3, lambda: shutil.rmtree(harmedHere.out))
	code, errors = harmedHere.run()
	assert code == 1 and "records.csv': cannot be written (it was removed while the test was running); fix: " in errors
	monkeypatch.undo()
	assert harmedHere.goOn()


def test_readOnly(harmedHere, monkeypatch):
	"""The system's answer for a read-only folder, to whoever makes a file in it."""
	true = os.open

	def refuse(path, flags, *more):
		if flags & os.O_CREAT and str(path).startswith(str(harmedHere.out)):
			raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))
		return true(path, flags, *more)

	def harm():
		monkeypatch.setattr(os, "open", refuse)
		monkeypatch.setattr("builtins.open", lambda path, mode="r", *more, **named: _opened(path, mode, *more, **named))

	opened = open

	def _opened(path, mode, *more, **named):
		if mode[0] in "wax" and str(path).startswith(str(harmedHere.out)):
			raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))
		return opened(path, mode, *more, **named)

	after(monkeypatch, 8, harm)
	code, errors = harmedHere.run()
	assert code == 1 and "Read-only file system" in errors and "fix: make the folder writable; then --resume" in errors
	code, errors = harmedHere.run("--resume")
	assert code == 1 and "run.lock': cannot be written (Read-only file system); fix: make the folder writable" in errors
	monkeypatch.undo()
	assert harmedHere.goOn()


# States


def test_theStateOfAnotherTest(trials, harmedHere):
	"""Put under a checkpoint, it is told and not used; the checkpoint before goes on to the same rows."""
	shutil.copytree(trials.stopped(), harmedHere.out)
	last = manifest.read(harmedHere.out).checkpoints[-1].state
	(harmedHere.out / last).write_bytes(gzip.decompress((trials.whole / "sheared.yade.gz").read_bytes()))
	code, errors = harmedHere.run("--resume")
	assert code == 0 and f"WARNING: state '{harmedHere.out / last}' has " in errors and "the checkpoint before" in errors
	assert tiny.rows(harmedHere.out) == trials.expected


def test_changedConfiguration(trials, harmedHere):
	shutil.copytree(trials.stopped(), harmedHere.out)
	before = (harmedHere.out / "records.csv").read_bytes()
	with open(harmedHere.out / "config.yaml", "a") as file:
		file.write("#\n")
	code, errors = harmedHere.run("--resume")
	assert code == 2 and "config.yaml': has" in errors and "fix: " in errors
	assert (harmedHere.out / "records.csv").read_bytes() == before


def test_statesThatAreLoaded(trials, tmp_path, capsys, O):
	"""With a manifest beside them by its SHA-256, alone by gzip's checksum, else with a word."""
	kept = trials.whole / "consolidated.yade.gz"
	shutil.copy(kept, tmp_path / "a.yade.gz")
	states.load(tmp_path / "a.yade.gz")
	assert len(O.bodies) > 200 and capsys.readouterr().err == ""
	(tmp_path / "a.yade").write_bytes(gzip.decompress(kept.read_bytes()))
	states.load(tmp_path / "a.yade")
	assert "a.yade': has no checksum, so it could not be verified" in capsys.readouterr().err
	data = bytearray(kept.read_bytes())
	data[len(data) // 2] ^= 1
	(tmp_path / "a.yade.gz").write_bytes(data)
	with pytest.raises(CheckpointError, match="a.yade.gz': is damaged .*; fix: "):
		states.load(tmp_path / "a.yade.gz")
	shutil.copy(trials.whole / "manifest.json", tmp_path)
	# sound for gzip, but of another test than the manifest's
	with gzip.open(tmp_path / "consolidated.yade.gz", "wb") as file:
		file.write((tmp_path / "a.yade").read_bytes())
	with pytest.raises(CheckpointError, match="is not as it was written .*; fix: "):
		states.load(tmp_path / "consolidated.yade.gz")
	(tmp_path / "b.yade").write_bytes(b"no state")
	for name, message in (("b.yade", "is no state of YADE"), ("gone.yade", "there is no such file"), ("", "cannot be read")):
		with pytest.raises(CheckpointError, match=f"{message}.*; fix: "):
			states.load(tmp_path / name)


# The user's files, and rows


def test_theUsersFilesStay(tmp_path, runHere):
	"""The very configuration in the output folder, or a packing, is not written over."""
	out = tmp_path / "out"
	out.mkdir()
	path = configure(out).rename(out / "config.yaml")
	before = path.read_bytes()
	code, _, errors = runHere(path, "--out", out)
	assert code == 2 and "has a file config.yaml already" in errors and "fix: " in errors
	assert path.read_bytes() == before and sorted(p.name for p in out.iterdir()) == ["config.yaml", "sand.csv"]


def test_rowsFinerThanSteps(trials, tmp_path, runHere):
	"""Refused before the consolidation with the most that can be; as many as that have a step each."""
	path = configure(tmp_path, output={"records": 100000})
	code, _, errors = runHere(path, "--out", tmp_path / "out")
	assert code == 2 and "output.records = 100000: is finer than the steps of shear" in errors
	most = int(errors.split("at most ")[1].split(",")[0])
	assert not (tmp_path / "out" / "records.csv").exists() and 10 < most < 5000
	short = {"strain": 0.0005, "rampStrain": 0.0001}
	path = configure(tmp_path, shear=short, output={"records": 100000, "checkpointEvery": 3, "vtkEvery": 0})
	code, _, errors = runHere(path, "--out", tmp_path / "from", "--from", trials.whole / "consolidated.yade.gz")
	most = int(errors.split("at most ")[1].split(",")[0])
	path = configure(tmp_path, shear=short, output={"records": most, "checkpointEvery": 3, "vtkEvery": 0})
	code, _, errors = runHere(path, "--out", tmp_path / "from", "--from", trials.whole / "consolidated.yade.gz", "--quiet")
	assert (code, errors) == (0, "")
	steps = [row[1] for row in tiny.rows(tmp_path / "from")[1:]]
	assert len(set(steps)) == len(steps) == most + 1
