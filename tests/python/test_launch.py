# SPDX-License-Identifier: GPL-2.0-or-later
"""scripts/run's launcher: the script's exit code, its output alone, its arguments, and an interrupt that reaches it."""

import importlib.util
import pathlib
import signal
import subprocess
import sys

import pytest

LAUNCHER = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "setup.d" / "launch.py"


@pytest.fixture
def launcher(monkeypatch):
	"""The launcher as a module; what it changes in sys is put back."""
	spec = importlib.util.spec_from_file_location("launch", LAUNCHER)
	module = importlib.util.module_from_spec(spec)
	spec.loader.exec_module(module)
	monkeypatch.setattr(sys, "argv", list(sys.argv))
	return module


@pytest.mark.parametrize(
	"code, exitCode, error",
	[
		("pass", 0, ""),
		("import sys; sys.exit(3)", 3, ""),
		("import sys; sys.exit('a complaint')", 1, "a complaint\n"),
		("raise ValueError('wrong')", 1, "ValueError: wrong"),
		("syntax error here", 1, "SyntaxError"),
		("raise KeyboardInterrupt", 130, "interrupted"),
	],
)
def test_exitCode(launcher, tmp_path, capsys, code, exitCode, error):
	script = tmp_path / "script.py"
	script.write_text(code)
	assert launcher.run(str(script), ["argument"]) == exitCode
	complained = capsys.readouterr().err
	assert error in complained and (error or not complained)


def test_outputIsTheScriptsAlone(tmp_path):
	"""YADE is there with the threads asked for, __name__ and sys.argv are those of a program, and nothing else is printed."""
	script = tmp_path / "script.py"
	script.write_text("import sys, yade, os; print(__name__, sys.argv[1:], yade.O.numThreads, os.path.basename(sys.argv[0])); sys.exit(5)")
	command = [sys.executable, str(LAUNCHER), "2", str(script), "config.yaml", "--out", "a folder"]
	result = subprocess.run(command, capture_output=True, text=True, timeout=120)
	assert result.stdout == "__main__ ['config.yaml', '--out', 'a folder'] 2 script.py\n"
	assert result.returncode == 5, result.stderr


def test_interruptLetsTheScriptTidyUp(tmp_path):
	script = tmp_path / "script.py"
	script.write_text(
		"import time\ntry:\n\tprint('ready', flush=True)\n\ttime.sleep(100)\nexcept KeyboardInterrupt:\n\tprint('tidied', flush=True)\n\traise SystemExit(7)\n"
	)
	process = subprocess.Popen([sys.executable, str(LAUNCHER), "1", str(script)], stdout=subprocess.PIPE, text=True)
	assert process.stdout.readline() == "ready\n"
	process.send_signal(signal.SIGINT)
	assert process.communicate(timeout=60)[0] == "tidied\n" and process.returncode == 7
