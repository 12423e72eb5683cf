# SPDX-License-Identifier: GPL-2.0-or-later
"""No command of ours leaves a network port open; YADE's own are opened on the loopback address alone, and only when asked for."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SETUP = ROOT / "scripts" / "setup.d"
LOOK = """
import os, pathlib
inodes = set()
for name in os.listdir("/proc/self/fd"):
	try:
		inodes.add(os.readlink(f"/proc/self/fd/{name}"))
	except OSError:
		pass
listening = []
for table in ("tcp", "tcp6", "udp", "udp6"):
	for line in pathlib.Path("/proc/self/net", table).read_text().splitlines()[1:] if os.path.exists(f"/proc/self/net/{table}") else ():
		cells = line.split()
		if f"socket:[{cells[9]}]" in inodes and (cells[3] == "0A" or table.startswith("udp")):
			listening.append(cells[1])
print("listening", *sorted(listening), flush=True)
"""
RESTART = """
from yade import O
from hexmembrane.run import command
command._restartWithThreads(2)
print("threads", O.numThreads)
"""


def listening(tmp_path, command, code=LOOK, **variables):
	"""Addresses on which the command's process listens while its script runs, as /proc has them, and all that it has said."""
	script = tmp_path / "look.py"
	script.write_text(code)
	environment = {**os.environ, "PYTHONPATH": str(ROOT / "py"), **variables}
	result = subprocess.run([sys.executable, *map(str, command), str(script)], env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
	assert result.returncode == 0, result.stderr
	return re.search(r"^listening ?(.*)$", result.stdout, re.MULTILINE).group(1).split(), result.stdout + result.stderr


@pytest.mark.parametrize("command", [[SETUP / "launch.py", "1"], [SETUP / "withoutPorts.py", "-n", "-x"]], ids=["scripts/run", "scripts/yade"])
def test_noneOpen(tmp_path, command):
	assert listening(tmp_path, command)[0] == []


def test_noneAfterARestartWithOtherThreads(tmp_path):
	found, said = listening(tmp_path, [SETUP / "launch.py", "1"], RESTART + LOOK)
	assert found == [] and "threads 2" in said


def test_onlyLoopbackWhenAskedFor(tmp_path):
	"""Two servers, both on 127.0.0.1; the cookie is no longer one of YADE's 60,000."""
	found, said = listening(tmp_path, [SETUP / "withoutPorts.py", "-n", "-x"], HEXMEMBRANE_REMOTE="on")
	assert len(found) == 2 and all(address.startswith("0100007F:") for address in found)
	assert re.search("auth cookie [0-9a-f]{32};", said)


def test_unknownSwitch(tmp_path):
	command = [sys.executable, str(SETUP / "withoutPorts.py"), "-n", "-x", "any.py"]
	result = subprocess.run(command, env={**os.environ, "HEXMEMBRANE_REMOTE": "yes"}, capture_output=True, text=True, timeout=60)
	assert result.returncode == 1 and "HEXMEMBRANE_REMOTE = yes: unknown; fix: on or off" in result.stderr


def test_commandsDoNotStartYadesOwnProgram():
	"""It opens its ports whoever starts it, so no command does."""
	for path in (ROOT / "scripts").iterdir():
		assert path.is_dir() or "runBeside yade" not in path.read_text()


def test_withoutALauncherThreadsAreTheUsersMatter(monkeypatch):
	from hexmembrane.configuration import ConfigError
	from hexmembrane.run import command
	from yade import O

	monkeypatch.delenv("HEXMEMBRANE_LAUNCHER", raising=False)
	with pytest.raises(ConfigError, match=rf"numerics.threads = {O.numThreads + 1}: YADE runs with .*; fix: start YADE with -j {O.numThreads + 1}"):
		command._restartWithThreads(O.numThreads + 1)
