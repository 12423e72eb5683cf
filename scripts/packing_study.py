# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures the packings that pkg/specimen/README.md reports. Run it with: scripts/yade scripts/packing_study.py

Prints, for 7,045 grains of examples/data/toyoura.csv in 40 x 80 mm at a porosity of 0.389: time, overlap, porosity along radius and height,
near contacts, segregation and isotropy over several seeds; then which porosities are reached, without and under stress. Takes 15 minutes.
"""

import hashlib
import math
import os
import time

import numpy
import yade
from scipy.spatial import cKDTree

import hexmembrane
from hexmembrane.scene.gradation import Gradation

RADIUS, HEIGHT, GRAINS, POROSITY = 0.02, 0.08, 7045, 0.389
STRESSED = {"stress": 1e4, "young": 6e7, "friction": 0.4}
CSV = os.path.join(os.path.dirname(hexmembrane.__file__), "..", "..", "examples", "data", "toyoura.csv")


def pack(grains, porosity, seed, **more):
	sand = Gradation.fromCsv(CSV).cutPercent(3, 97)
	volume = math.pi * RADIUS**2 * HEIGHT
	sand = sand.scaled(sand.scaleForGrains(grains, porosity, volume))
	packing = yade.CylinderPacking(radius=RADIUS, height=HEIGHT, radii=sand.sample(grains, seed).tolist(), porosity=porosity, seed=seed, **more)
	start = time.process_time()
	packing.generate()
	return sand, packing, time.process_time() - start


def solidAt(points, centres, radii):
	"""Which points lie inside a sphere."""
	inside = numpy.zeros(len(points), dtype=bool)
	for near in cKDTree(points).query_ball_point(centres, radii):
		inside[near] = True
	return inside


def profile(name, at, solid, edges, unit):
	parts = []
	for low, high in zip(edges, edges[1:]):
		chosen = (at >= low) & (at < high)
		parts.append(f"{low / unit:.2f}-{high / unit:.2f}: {1 - solid[chosen].mean():.4f}")
	print(f"  porosity against {name} (in d50): " + ", ".join(parts))


def measure(seed, digest, **more):
	sand, packing, seconds = pack(GRAINS, POROSITY, seed, **more)
	x, r = numpy.array([tuple(c) for c in packing.centres]), numpy.array(packing.sizes)
	digest.update(x.tobytes())
	d50 = sand.d50
	print(
		f"seed {seed}: {seconds:.1f} s of one core, porosity {packing.porosityReached:.9f}, max overlap {packing.maxOverlap:g}, shakes {packing.shakesUsed}, "
		f"d50 {d50 * 1e3:.3f} mm, D/d50 {2 * RADIUS / d50:.1f}, dmax/dmin {sand.largest / sand.smallest:.2f}"
	)
	numbers = numpy.random.Generator(numpy.random.PCG64(seed))
	points = numpy.column_stack([numbers.uniform(-RADIUS, RADIUS, (3000000, 2)), numbers.uniform(0, HEIGHT, 3000000)])
	points = points[numpy.hypot(points[:, 0], points[:, 1]) < RADIUS]
	solid = solidAt(points, x, r)
	depth = RADIUS - numpy.hypot(points[:, 0], points[:, 1])
	ends = numpy.minimum(points[:, 2], HEIGHT - points[:, 2])
	inner = ends > 2 * d50
	profile("distance from the side", depth[inner], solid[inner], numpy.array([0, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4, 5, 6, 8]) * d50, d50)
	core = depth > 2 * d50
	profile("distance from an end", ends[core], solid[core], numpy.array([0, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4, 6, 8, 12]) * d50, d50)
	cut = numpy.linspace(0, HEIGHT, 9)
	slices = [1 - solid[(points[:, 2] >= a) & (points[:, 2] < b) & core].mean() for a, b in zip(cut, cut[1:])]
	print("  core, eight slices from bottom to top: " + ", ".join(f"{n:.4f}" for n in slices))
	print(f"  core (2 d50 from every wall): porosity {1 - solid[core & inner].mean():.4f}")

	pairs = cKDTree(x).query_pairs(2.2 * r.max(), output_type="ndarray")
	d = x[pairs[:, 0]] - x[pairs[:, 1]]
	dist = numpy.linalg.norm(d, axis=1)
	gap = dist - r[pairs].sum(axis=1)
	middle = (numpy.hypot(x[:, 0], x[:, 1]) < RADIUS - 2 * d50) & (abs(x[:, 2] - HEIGHT / 2) < HEIGHT / 2 - 2 * d50)
	for share in (1e-3, 1e-2, 5e-2):
		near = gap < share * d50
		count = numpy.bincount(pairs[near].ravel(), minlength=GRAINS)
		print(f"  neighbours within {share:g} d50 in the core: {count[middle].mean():.2f} ({(count[middle] == 0).mean():.3f} of the grains have none)")
	# contacts chosen by their middle: choosing both grains in a long core would favour its axis
	at = x[pairs].mean(axis=1)
	near = (gap < 5e-2 * d50) & (numpy.hypot(at[:, 0], at[:, 1]) < RADIUS - 2 * d50) & (abs(at[:, 2] - HEIGHT / 2) < HEIGHT / 2 - 2 * d50)
	n = d[near] / dist[near, None]
	fabric = n.T @ n / near.sum()
	spread = math.sqrt(4 / 45 / near.sum())
	print(
		f"  fabric of {near.sum()} near contacts (5 % d50, core): diagonal {numpy.diag(fabric).round(4).tolist()}, "
		f"eigenvalues {numpy.linalg.eigvalsh(fabric).round(4).tolist()}; chance alone scatters by {spread:.4f}"
	)
	inside = numpy.flatnonzero(middle)
	along = numpy.corrcoef(r[inside], x[inside, 2])[0, 1]
	across = numpy.corrcoef(r[inside], numpy.hypot(x[inside, 0], x[inside, 1]))[0, 1]
	print(f"  correlation of size with height {along:+.4f}, with distance from the axis {across:+.4f}; chance alone {1 / math.sqrt(len(inside)):.4f}")


def main():
	digests = []
	for seed in (1, 2, 3, 1):
		digest = hashlib.sha256()
		measure(seed, digest)
		digests.append(digest.hexdigest()[:16])
	print("under 10 kPa:")
	measure(1, hashlib.sha256(), **STRESSED)
	print("digests of the centres for seeds 1, 2, 3, 1:", *digests)
	for grains in (1200, GRAINS):
		for porosity in (0.60, 0.44, 0.41, 0.40, 0.39, 0.38, 0.36):
			report(grains, porosity)
	for grains in (1200, GRAINS):
		for porosity in (0.37, 0.389, 0.40, 0.41, 0.42, 0.43, 0.44, 0.48):
			report(grains, porosity, **STRESSED)


def report(grains, porosity, **more):
	"""One line: what it took, or why it cannot be."""
	try:
		_, packing, seconds = pack(grains, porosity, 1, **more)
	except RuntimeError as error:
		print(f"{grains} grains at {porosity}: {error}")
		return
	line = f"{grains} grains at {porosity}: {seconds:.1f} s of one core, porosity {packing.porosityReached:.5f}, shakes {packing.shakesUsed}"
	if more:
		line += (
			f", stress radial {packing.radialStress:.0f} axial {packing.axialStress:.0f} Pa, coordination {packing.coordination:.2f}, "
			f"rattlers {packing.rattlers:.3f}, friction lowered to {packing.frictionReached:.3f}, max overlap {packing.maxOverlap:.1e}"
		)
	print(line)


main()
