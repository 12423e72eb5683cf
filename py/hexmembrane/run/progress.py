# SPDX-License-Identifier: GPL-2.0-or-later
"""How far a run is: a bar (tqdm) on a terminal, plain lines elsewhere. A stream that fails never ends a test."""

import sys
import time


class Steady:
	"""A text stream that loses what cannot be written: its reader has gone, its disk is full, its terminal has hung up."""

	def __init__(self, stream):
		self._stream = stream

	def write(self, text):
		try:
			return self._stream.write(text)
		except (OSError, ValueError, AttributeError):  # ValueError: closed; AttributeError: None, Python's stream without a file descriptor
			return len(text)

	def flush(self):
		try:
			self._stream.flush()
		except (OSError, ValueError, AttributeError):
			pass

	def __getattr__(self, name):
		return getattr(self._stream, name)


def tell(text, stream=None):
	"""Print a line to ``stream``, by default standard output; one that fails loses the line, and the test goes on."""
	print(text, file=Steady(sys.stdout if stream is None else stream), flush=True)


def clock(seconds):
	"""Seconds as 'm:ss' or 'h:mm:ss'; '?' when not known."""
	if seconds is None:
		return "?"
	minutes, seconds = divmod(int(round(seconds)), 60)
	hours, minutes = divmod(minutes, 60)
	return f"{hours}:{minutes:02d}:{seconds:02d}" if hours else f"{minutes}:{seconds:02d}"


#: Share of the work that a stated time counts as; work that comes in lumps is then no jump in the time left.
STATED_SHARE = 0.1


class Progress:
	"""One stage's progress.

	:param stage: name shown.
	:param quiet: show nothing (messages by :meth:`say` included).
	:param stream: where to; a terminal gets a bar.
	:param every: seconds between plain lines, at least.
	:param expected: seconds that all of what is left at the first :meth:`update` was stated to take, if they were.
	"""

	def __init__(self, stage, quiet=False, stream=None, every=5.0, expected=None):
		self.stage, self.quiet, self.every, self.expected = stage, quiet, every, expected
		self.stream = Steady(sys.stderr if stream is None else stream)
		self.started = time.monotonic()
		self.begun = None
		self.said = -float("inf")
		self.bar = None
		if not quiet and getattr(self.stream, "isatty", lambda: False)():
			from tqdm import tqdm

			self.bar = tqdm(
				total=1.0,
				desc=stage,
				file=self.stream,
				leave=True,
				dynamic_ncols=True,
				bar_format="{desc} |{bar}|",
			)

	def left(self, done):
		"""Seconds left when a share ``done`` of the stage is behind us, None when not known yet; a resumed share costs nothing.

		A time that was stated counts as STATED_SHARE of the work, done at that pace.
		"""
		if self.begun is None:
			return None
		stated = STATED_SHARE * (1 - self.begun) if self.expected is not None else 0.0
		behind = done - self.begun + stated
		if behind <= 0:
			return None
		took = time.monotonic() - self.started + (STATED_SHARE * self.expected if stated else 0.0)
		return took * (1 - done) / behind

	def update(self, done, **state):
		"""Show the share ``done`` (0..1) and the values in ``state`` (name -> text)."""
		done = min(max(done, 0.0), 1.0)
		if self.begun is None:
			self.begun = done
		if self.quiet:
			return
		text = ", ".join(f"{name} {value}" for name, value in state.items())
		line = f"{self.stage}: {100 * done:5.1f} %, {text}, {clock(self.left(done))} left"
		if self.bar is not None:
			self.bar.n = done
			self.bar.set_description_str(line, refresh=True)
			return
		now = time.monotonic()
		if now - self.said >= self.every or done == 1.0:
			self.said = now
			tell(line, self.stream)

	def say(self, text):
		"""A line of its own, above the bar if there is one."""
		if self.quiet:
			return
		if self.bar is not None:
			self.bar.write(text, file=self.stream)
		else:
			tell(text, self.stream)

	def close(self):
		if self.bar is not None:
			self.bar.close()
			self.bar = None

	def __enter__(self):
		return self

	def __exit__(self, *_):
		self.close()
