# SPDX-License-Identifier: GPL-2.0-or-later
"""How a benchmark writes and reads its figures: a CSV whose first line names date and machine."""

import csv
import os
import platform
import time


def processor():
	"""The machine's processor as it calls itself."""
	with open("/proc/cpuinfo") as file:
		for line in file:
			if line.startswith("model name"):
				return line.split(":", 1)[1].strip()
	return platform.machine()


def write(path, header, rows):
	"""Write rows under a header, by temporary name and rename."""
	os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
	with open(path + ".part", "w", newline="") as file:
		writer = csv.writer(file)
		machine = "%s, %s, %d processors, OMP_NUM_THREADS %s" % (time.strftime("%Y-%m-%d"), processor(), os.cpu_count(), os.environ.get("OMP_NUM_THREADS"))
		writer.writerow(["# " + machine])
		writer.writerow(header)
		writer.writerows(rows)
	os.replace(path + ".part", path)
	print("machine: %s\nwritten: %s" % (machine, path))


def read(path):
	"""Rows of a table as dicts of text."""
	with open(path, newline="") as file:
		file.readline()
		return list(csv.DictReader(file))
