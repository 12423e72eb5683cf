# SPDX-License-Identifier: GPL-2.0-or-later
"""What MemoryOrder brings to the reference tier: a step fresh, aged, and after its objects have been allocated anew along space.

The study's specimen (specimen.py): soil in the rigid wall with our law, and soil and membrane of R = 0.5 mm in stock YADE. ms a step of the whole and of
InteractionLoop, medians over windows; the same scene, one state after the other.
Arguments: folder of the results, steps of ageing (default 5000).
"""

import os
import statistics
import sys
import time

import hexmembrane  # noqa: F401
import yade
from yade import O, timing

sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE runs scripts without their __file__
import clock  # noqa: E402
from specimen import flexible, rigid  # noqa: E402
from study import packing  # noqa: E402
from table import write  # noqa: E402

WINDOW, WINDOWS = 20, 11


def measure():
	"""ms a step and ms a step in InteractionLoop."""
	loop = next(e for e in O.engines if isinstance(e, yade.InteractionLoop))
	timing.reset()
	whole = clock.windows(WINDOW, WINDOWS)
	return statistics.median(whole), loop.execTime / loop.execCount * 1e-6


def ordered():
	"""Re-orders at once; ms that it took, objects."""
	engine = yade.MemoryOrder()
	begun = time.perf_counter()
	engine()
	return 1e3 * (time.perf_counter() - begun), engine.moved


def main(folder, steps="5000"):
	packed, rows = packing(folder), []
	scenes = {
		"rigid wall, linear law with rolling resistance": lambda: rigid("reference", packed),
		"membrane of R = 0.5 mm, stock YADE": lambda: flexible("stock", packed, 0.5e-3),
	}
	for name, build in scenes.items():
		build()
		O.dt = 1e-6
		O.run(2 * WINDOW, True)
		O.timingEnabled = True
		for state in ("fresh", f"after {steps} steps", "re-ordered", f"{steps} steps later"):
			if "steps" in state:
				O.run(int(steps), True)
			if state == "re-ordered":
				print("re-ordering itself: %.0f ms, %d objects" % ordered(), flush=True)
			whole, contacts = measure()
			rows.append((name, state, O.interactions.countReal(), whole, contacts))
			print("%s, %s: %d contacts, %.2f ms a step, %.2f of them in InteractionLoop" % rows[-1], flush=True)
	write(os.path.join(folder, "order.csv"), ["scene", "state", "contacts", "step (ms)", "InteractionLoop (ms)"], rows)


main(*sys.argv[1:])
