# SPDX-License-Identifier: GPL-2.0-or-later
"""Cost of a step in the compact tier against stock YADE, on the study's specimen (specimen.py); how it ages, scales with size and with threads.

ms a step by the clock inside a run, medians over windows of steps after warming up; the number of contacts is printed beside, the two laws differ in details
of stiffness. What is compared is measured in one process, in turns where the scene allows.
Arguments: folder of the results, parts to run (default: all):
  membrane   flexible against stock, R = 0.5 and 0.25 mm, and against the rigid wall
  age        the flexible scene of R = 0.5 mm fresh, after 5,000 and after 50,000 steps
  sheet      the flexible scene of R = 0.5 mm without and with bending stiffness, self-contact and facets of its sheet
  threads    the flexible and the rigid scene with one thread, two, four, up to the process' own (yade -jN)
  size       soil alone, 7,000 to 1,000,000 spheres; and the memory that the tier takes beside YADE's bodies
"""

import math
import os
import resource
import statistics
import sys

import hexmembrane  # noqa: F401
import numpy
import yade
from yade import O, utils

sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE runs scripts without their __file__
import clock  # noqa: E402
from specimen import contacts, flexible, material, rigid  # noqa: E402
from study import packing  # noqa: E402
from table import write  # noqa: E402

WARM, WINDOW, WINDOWS = 5000, 200, 11
STOCK_WINDOW = 20


def measure(warm, window=WINDOW, windows=WINDOWS):
	"""Median ms a step after `warm` steps."""
	if warm:
		O.run(warm, True)
	return clock.median(window, windows)


def membranes(packed, rows):
	compact = {}
	for radius in (0.5e-3, 0.25e-3):
		particles = flexible("compact", packed, radius)
		step = O.dt
		compact[radius], touching = measure(WARM), contacts()
		flexible("stock", packed, radius)
		assert O.dt == step
		stock, theirs = measure(WARM, STOCK_WINDOW), contacts() - len(O.engines[-2].membrane.bonds)
		ratio = stock / compact[radius]
		rows.append(("flexible, R = %.2f mm" % (1e3 * radius), len(packed.radii) + particles, touching, compact[radius], stock, ratio))
		print("R = %.2f mm, %d particles: compact %.3f ms, %d contacts; stock %.1f ms, %d contacts; %.1f times" % (1e3 * radius, particles, compact[radius], touching, stock, theirs, ratio), flush=True)
	# flexible against rigid, in turns: the two are near each other
	shares = []
	for _ in range(3):
		flexible("compact", packed, 0.5e-3)
		step, mine = O.dt, measure(WARM)
		rigid("compact", packed)
		O.dt = step
		wall = measure(WARM)
		shares.append(mine / wall)
		print("membrane of R = 0.5 mm %.3f ms, rigid wall %.3f ms, %d contacts: %.2f times" % (mine, wall, contacts(), shares[-1]), flush=True)
	rows.append(("rigid", len(packed.radii), contacts(), wall, "", statistics.median(shares)))


def age(packed, rows):
	flexible("compact", packed, 0.5e-3)
	for steps in (500, 5000, 50000):
		O.run(steps - O.iter, True)
		value = measure(0)
		rows.append(("flexible, R = 0.50 mm, after %d steps" % steps, "", contacts(), value, "", value * 1e6 / contacts()))
		print("after %6d steps: %.3f ms, %d contacts" % (steps, value, contacts()), flush=True)


def sheet(packed, rows):
	"""One scene whose engines take turns to be dead, so that the machine's mood and the contacts are the same for all."""
	bending, contact = (lambda m: yade.MembraneBending(membrane=m, stiffness=5e-5)), (lambda m: yade.MembraneSelfContact(membrane=m))
	flexible("compact", packed, 0.5e-3, (bending, contact, lambda m: yade.MembraneFacetContact(membrane=m)))
	_, *extra = O.engines[1].engines[:4]
	scenes = {"bonds alone": (0, 0, 0), "bending": (1, 0, 0), "self-contact": (0, 1, 0), "bending and self-contact": (1, 1, 0), "facets": (0, 0, 1), "all": (1, 1, 1)}
	times = {name: [] for name in scenes}
	O.run(WARM, True)
	for _ in range(15):
		for name, alive in scenes.items():
			for engine, lives in zip(extra, alive):
				engine.dead = not lives
			times[name].append(measure(0, WINDOW, 3))
	for name, values in times.items():
		share = statistics.median(mine / plain for mine, plain in zip(values, times["bonds alone"]))
		rows.append(("flexible, R = 0.50 mm, sheet with " + name, "", contacts(), statistics.median(values), "", share))
		print("sheet with %s: %.3f ms, %.3f times" % (name, statistics.median(values), share), flush=True)


def threads(packed, rows):
	"""One thread, two, four, and so on up to the process' own in turns on the same scene; and what it takes to hand the scene over, once an iteration."""
	counts = [2**k for k in range(O.numThreads.bit_length()) if 2**k <= O.numThreads]
	scenes = {"flexible, R = 0.50 mm": lambda: flexible("compact", packed, 0.5e-3), "flexible, R = 0.25 mm": lambda: flexible("compact", packed, 0.25e-3), "rigid": lambda: rigid("compact", packed)}
	for name, build in scenes.items():
		build()
		O.dt = 1e-6
		O.run(1000, True)
		times = {count: [] for count in counts}
		for _ in range(7):
			for count, values in times.items():
				O.engines[1].ompThreads = count
				values.append(measure(0, WINDOW, 3))
		for count, values in times.items():
			ratio = statistics.median(one / other for one, other in zip(times[1], values))
			rows.append(("%s, %d threads" % (name, count), "", contacts(), statistics.median(values), "", ratio if count > 1 else ""))
			print("%s, %d threads: %.3f ms, %.2f times" % (name, count, statistics.median(values), ratio), flush=True)
		for count in (1, counts[-1]):
			O.engines[1].ompThreads = count
			whole = []
			for substeps in (1, WINDOW):
				O.engines[1].substeps = substeps
				whole.append(measure(0, WINDOW, 5))
			handing = (whole[0] - whole[1]) * WINDOW / (WINDOW - 1)
			rows.append(("%s, %d threads, scene handed over" % (name, count), "", contacts(), handing, "", handing / whole[1]))
			print("%s, %d threads: handing the scene over %.3f ms, %.1f steps" % (name, count, handing, handing / whole[1]), flush=True)


def resident():
	"""Memory of this process (bytes)."""
	with open("/proc/self/statm") as file:
		return int(file.read().split()[1]) * resource.getpagesize()


def sizes(rows):
	"""A face-centred lattice of spheres that overlap a little, at random slow speeds: the same surroundings for every sphere and size."""
	for wished in (7000, 30000, 100000, 300000, 1000000):
		O.reset()
		material("compact", "grain", 0.4, 0.5)
		random = numpy.random.default_rng(1)
		n = round((wished / 4) ** (1 / 3))
		spacing = 1e-3 * math.sqrt(2) * 1.998
		for shift in ((0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)):
			grid = (numpy.stack(numpy.meshgrid(*[numpy.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3) + shift) * spacing
			for place in grid:
				body = utils.sphere(tuple(place), 1e-3, material="grain")
				body.state.vel = tuple(1e-3 * random.uniform(-1, 1, 3))
				O.bodies.append(body)
		window = max(100, 400000 // len(O.bodies))  # at least the default of CompactLoop.substeps
		O.engines = [yade.ForceResetter(), yade.CompactLoop(damping=0.2, substeps=window)]
		O.dt = 1e-9  # an unconfined lattice must not fly apart while it is measured
		before = resident()
		O.step()
		memory = (resident() - before) / len(O.bodies)
		value = measure(0, window, 3)
		perSphere = value * 1e6 / len(O.bodies)
		rows.append(("soil alone, lattice", len(O.bodies), contacts(), value, "", perSphere))
		print("%7d spheres, %.2f contacts a sphere: %.2f ms, %.0f ns a sphere and step; its own memory %.0f bytes a sphere" % (len(O.bodies), contacts() / len(O.bodies), value, perSphere, memory), flush=True)


def main(arguments):
	folder = arguments[0] if arguments else "bench"
	parts = arguments[1:] or ["membrane", "age", "size"]
	os.makedirs(folder, exist_ok=True)
	rows = []
	for part in parts:
		if part == "size":
			sizes(rows)
		else:
			{"membrane": membranes, "age": age, "sheet": sheet, "threads": threads}[part](packing(folder), rows)
	write(os.path.join(folder, "compact-%s-%d.csv" % ("-".join(parts), O.numThreads)), ["scene", "spheres", "contacts", "compact (ms)", "stock (ms)", "ratio, or ns a sphere"], rows)


main(sys.argv[1:])
