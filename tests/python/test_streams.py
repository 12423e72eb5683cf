# SPDX-License-Identifier: GPL-2.0-or-later
"""Streams that fail do not end a test, and signals end it with the right code and message at any stage."""

import io
import os
import signal
import subprocess
import sys
import time

import pytest
from hexmembrane.output import records
from hexmembrane.run import checkpoints, command
from hexmembrane.run.progress import Progress, tell
from tinyTest import LAUNCHER, configure, environment
from tinyTest import command as tinyCommand

SHORT = {"shear": {"strain": 0.002}, "output": {"records": 4, "checkpointEvery": 1, "vtkEvery": 0}}
#: A shell's background job ignores SIGINT, and so would the tests in it.
HEEDED = ["env", "--default-signal=INT,TERM,HUP"]


class Failing(io.StringIO):
	"""A stream as it is when its disk is full, its reader has gone or it is closed."""

	def __init__(self, error):
		super().__init__()
		self.error = error

	def write(self, text):
		raise self.error

	def flush(self):
		raise self.error


class FailingTerminal(Failing):
	def isatty(self):
		return True


@pytest.mark.parametrize("stream", [Failing, FailingTerminal])
@pytest.mark.parametrize("error", [BrokenPipeError(), OSError(28, "full"), OSError(5, "hung up"), ValueError("closed")], ids=repr)
def test_failingStream(stream, error):
	tell("a line", stream(error))
	with Progress("shear", stream=stream(error)) as shown:
		shown.update(0.5, strain="6 %")
		shown.say("a line")
		shown.update(1.0)


def test_noStream(monkeypatch):
	"""Python has None for a stream without a file descriptor."""
	monkeypatch.setattr(sys, "stdout", None)
	monkeypatch.setattr(sys, "stderr", None)
	tell("a line")
	tell("a line", sys.stderr)


def shell(tmp_path, redirection, *arguments):
	"""A test with its streams redirected by a shell; its exit code and what is left of its output."""
	script = f'"$@" {redirection}; exit ${{PIPESTATUS[0]}}'
	return subprocess.run(["bash", "-c", script, "bash", *tinyCommand(*arguments)], env=environment(), stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)


def test_wholeTest(tmp_path):
	"""Both streams on a full disk; the title is no formula, though it looks like a wrong one."""
	result = shell(tmp_path, "> /dev/full 2> /dev/full", configure(tmp_path, title=r"50 $\foo$ & {x}_^", **SHORT), "--out", tmp_path / "out")
	assert result.returncode == 0, result.stderr
	table = records.read(tmp_path / "out" / "records.csv")
	assert table["stage"].count("shear") == 5 and (tmp_path / "out" / "test.png").is_file()


@pytest.mark.parametrize("redirection", ["<&- >&- 2>&-", "2>&1 | head -1"])
def test_shortTest(tmp_path, redirection):
	result = shell(tmp_path, redirection, configure(tmp_path), "--out", tmp_path / "out", "--until", "boundary")
	assert result.returncode == 0, result.stderr
	assert checkpoints.exist(tmp_path / "out")
	assert result.stdout.count("\n") == ("head" in redirection)


def test_badInput(tmp_path):
	assert shell(tmp_path, ">&- 2>&-", tmp_path / "nowhere.yaml").returncode == 2


@pytest.mark.parametrize("number, code, words", [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated"), (signal.SIGHUP, 129, "hung up")])
def test_whileYadeStarts(tmp_path, number, code, words):
	"""At moments over the start: no C++ library sees an exception."""
	script = tmp_path / "script.py"
	script.write_text("import time\nprint('started', flush=True)\ntime.sleep(100)\n")
	for moment in (0.1, 0.3, 0.45, 0.6):
		# as scripts/run does: Python itself, before it reads the launcher, would show a traceback
		arguments = [*HEEDED, "--block-signal=INT,TERM", sys.executable, str(LAUNCHER), "1", str(script)]
		process = subprocess.Popen(arguments, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
		time.sleep(moment)
		process.send_signal(number)
		said, error = process.communicate(timeout=60)
		# env itself, before it blocks signals, dies of one
		assert process.returncode in (code, -number) and error in ("", words + "\n"), error


@pytest.mark.parametrize("number, code, words", [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated"), (signal.SIGHUP, 129, "hung up")])
def test_inAStage(tmp_path, number, code, words):
	"""With a checkpoint the advice is to resume from it, and that can be done."""
	config, out = configure(tmp_path, output={"records": 400, "checkpointEvery": 2, "vtkEvery": 0}), tmp_path / "out"
	process = subprocess.Popen([*HEEDED, *tinyCommand(config, "--out", out)], env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
	while not checkpoints.exist(out):
		assert process.poll() is None, process.communicate()
		time.sleep(0.05)
	process.send_signal(number)
	said, error = process.communicate(timeout=60)
	assert process.returncode == code and error.splitlines()[-1] == words + ": --resume goes on from the last checkpoint"
	assert "Traceback" not in error and "terminate called" not in error


@pytest.mark.parametrize("raised, code, words", [(KeyboardInterrupt, 130, "interrupted"), (command.Terminated, 143, "terminated"), (command.HungUp, 129, "hung up")])
def test_beforeTheFirstCheckpoint(tmp_path, runHere, monkeypatch, raised, code, words):
	"""There is nothing to resume from, and the message does not advise it."""

	def packing(*_):
		raise raised

	monkeypatch.setattr("hexmembrane.scene.specimen.provide", packing)
	handled = signal.SIGTERM, signal.SIGHUP
	before = [signal.getsignal(number) for number in handled]
	assert runHere(configure(tmp_path), "--out", tmp_path / "out", "--quiet")[::2] == (code, words + ", there is no checkpoint yet\n")
	assert [signal.getsignal(number) for number in handled] == before


@pytest.mark.parametrize("number, code", [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_signalIsRaised(tmp_path, runHere, monkeypatch, number, code):
	before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
	try:
		monkeypatch.setattr("hexmembrane.scene.specimen.provide", lambda *_: os.kill(os.getpid(), number))
		assert runHere(configure(tmp_path), "--out", tmp_path / "out")[0] == code
	finally:
		signal.signal(signal.SIGHUP, before)


def test_ignoredHangUpStaysIgnored():
	"""Under nohup a closed terminal ends nothing."""
	before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
	try:
		with command._terminable():
			os.kill(os.getpid(), signal.SIGHUP)
		assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
	finally:
		signal.signal(signal.SIGHUP, before)
