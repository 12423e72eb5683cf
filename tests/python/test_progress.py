# SPDX-License-Identifier: GPL-2.0-or-later
"""Progress: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

import io

import pytest
from hexmembrane.run import progress
from hexmembrane.run.progress import Progress, clock


class Terminal(io.StringIO):
	def isatty(self):
		return True


@pytest.fixture
def time(monkeypatch):
	"""A clock that the test sets."""
	now = [100.0]
	monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
	return now


def test_clock():
	assert [clock(s) for s in (0, 59.6, 61, 3600, 3725, None)] == ["0:00", "1:00", "1:01", "1:00:00", "1:02:05", "?"]


def test_plainLinesAtIntervals(time):
	stream = io.StringIO()
	with Progress("shear", stream=stream, every=5) as shown:
		for k in range(21):
			shown.update(k / 20, strain=f"{k} %")
			time[0] += 1
	lines = stream.getvalue().splitlines()
	assert len(lines) == 5 and "\r" not in stream.getvalue()
	assert lines[0] == "shear:   0.0 %, strain 0 %, ? left"
	assert lines[1] == "shear:  25.0 %, strain 5 %, 0:15 left"
	assert lines[-1] == "shear: 100.0 %, strain 20 %, 0:00 left"


def test_timeLeftOfResumedStage(time):
	"""What was done before a resume took none of this run's time."""
	shown = Progress("shear", stream=io.StringIO())
	shown.update(0.5)
	time[0] += 10
	assert shown.left(0.75) == pytest.approx(10)


def test_statedTimeComesFirst(time):
	"""The stated time is told until work is done, is no jump when a lump of it ends, and gives way to what was measured."""
	shown = Progress("sweep", stream=io.StringIO(), expected=1000.0)
	shown.update(0.2)
	assert shown.left(0.2) == pytest.approx(1000)
	time[0] += 20  # nothing has ended
	assert shown.left(0.2) == pytest.approx(1000 + 20 / progress.STATED_SHARE)
	time[0] += 780  # half of the rest took 800 s: 500 s more as stated, 800 s as measured
	assert 700 < shown.left(0.6) < 800
	assert shown.left(1.0) == 0


def test_barOnTerminal():
	stream = Terminal()
	with Progress("shear", stream=stream) as shown:
		shown.update(0.5, strain="6.00 %", q="210.0 kPa")
		shown.say("a line")
	text = stream.getvalue()
	assert "50.0 %" in text and "q 210.0 kPa" in text and "left" in text and "a line" in text and "\r" in text


def test_quiet():
	for stream in (io.StringIO(), Terminal()):
		with Progress("shear", quiet=True, stream=stream) as shown:
			shown.update(0.5, q="1 kPa")
			shown.say("a line")
		assert stream.getvalue() == ""
