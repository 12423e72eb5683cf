# SPDX-License-Identifier: GPL-2.0-or-later
"""Wall clock of steps, taken inside a run: O.run itself waits for its end in naps of 40 ms, as long as thousands of cheap steps."""

import statistics
import time

from yade import O, PyRunner

stamps = []


def stamp():
	stamps.append((time.perf_counter(), O.iter))


def windows(window, count):
	"""ms a step of `count` windows of about `window` steps each (whole iterations). One more is run before them, which ends what begins with O.run, and one after."""
	runner = PyRunner(iterPeriod=window, command="import clock; clock.stamp()")
	O.engines = O.engines + [runner]
	stamps.clear()
	O.run(window * (count + 2), True)
	O.engines = O.engines[:-1]
	assert len(stamps) > count, "%d stamps of %d: the run has stopped at step %d" % (len(stamps), count + 1, O.iter)
	return [(after[0] - before[0]) / (after[1] - before[1]) * 1e3 for before, after in zip(stamps, stamps[1:])]


def median(window, count):
	return statistics.median(windows(window, count))
