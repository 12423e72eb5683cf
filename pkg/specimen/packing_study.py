# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures the packings that README.md beside it reports.

	scripts/yade -x pkg/specimen/packing_study.py [--short]

Prints, for 7,045 grains of examples/data/toyoura.csv in 40 x 80 mm at a porosity of 0.389: time, overlap, porosity along radius and height,
near contacts, segregation and isotropy over several seeds; then which porosities are reached, without and under stress. Takes 15 minutes of
one core. With --short: 700 grains at 0.43, one seed, two porosities, seconds.
"""

import argparse
import dataclasses
import hashlib
import math
import pathlib
import sys
import time

import hexmembrane
import numpy
import yade
from hexmembrane.scene.gradation import Gradation
from scipy.spatial import cKDTree

RADIUS, HEIGHT = 0.02, 0.08
STRESSED = {"stress": 1e4, "emod": 6e7, "friction": 0.4}
CSV = pathlib.Path(hexmembrane.__file__).resolve().parents[2] / "examples" / "data" / "toyoura.csv"


@dataclasses.dataclass
class Study:
	"""What is packed.

	:param grains: number of grains of the packings that are measured.
	:param porosity: of the same.
	:param seeds: the last is the first again, to see that it gives the same bits.
	:param points: thrown into the cylinder to measure local porosity.
	:param sizes: numbers of grains whose reachable porosities are tried.
	:param loose: porosities tried without stress.
	:param stressed: porosities tried under stress.
	"""

	grains: int
	porosity: float
	seeds: tuple
	points: int
	sizes: tuple
	loose: tuple
	stressed: tuple


FULL = Study(
	7045, 0.389, (1, 2, 3, 1), 3000000, (1200, 7045), (0.60, 0.44, 0.41, 0.40, 0.39, 0.38, 0.36), (0.37, 0.389, 0.40, 0.41, 0.42, 0.43, 0.44, 0.48)
)
SHORT = Study(700, 0.43, (1, 1), 100000, (400,), (0.60, 0.36), (0.44,))


def pack(grains, porosity, seed, **stress):
	"""Gradation, packing and seconds that it took."""
	sand = Gradation.fromCsv(CSV).cutPercent(3, 97)
	volume = math.pi * RADIUS**2 * HEIGHT
	sand = sand.scaled(sand.scaleForGrains(grains, porosity, volume))
	packing = yade.CylinderPacking(radius=RADIUS, height=HEIGHT, radii=sand.sample(grains, seed).tolist(), porosity=porosity, seed=seed, **stress)
	start = time.process_time()
	packing.generate()
	return sand, packing, time.process_time() - start


def solidAt(points, centres, radii):
	"""Which points lie inside a sphere."""
	inside = numpy.zeros(len(points), dtype=bool)
	for near in cKDTree(points).query_ball_point(centres, radii):
		inside[near] = True
	return inside


def printProfile(name, at, solid, edges, unit):
	parts = []
	for low, high in zip(edges, edges[1:]):
		chosen = (at >= low) & (at < high)
		if chosen.any():
			parts.append(f"{low / unit:.2f}-{high / unit:.2f}: {1 - solid[chosen].mean():.4f}")
	print(f"  porosity against {name} (in d50): " + ", ".join(parts))


def printPorosity(x, r, d50, seed, count):
	"""Local porosity along radius and height."""
	numbers = numpy.random.Generator(numpy.random.PCG64(seed))
	points = numpy.column_stack([numbers.uniform(-RADIUS, RADIUS, (count, 2)), numbers.uniform(0, HEIGHT, count)])
	points = points[numpy.hypot(points[:, 0], points[:, 1]) < RADIUS]
	solid = solidAt(points, x, r)
	depth = RADIUS - numpy.hypot(points[:, 0], points[:, 1])
	ends = numpy.minimum(points[:, 2], HEIGHT - points[:, 2])
	inner, core = ends > 2 * d50, depth > 2 * d50
	printProfile("distance from the side", depth[inner], solid[inner], numpy.array([0, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4, 5, 6, 8]) * d50, d50)
	printProfile("distance from an end", ends[core], solid[core], numpy.array([0, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4, 6, 8, 12]) * d50, d50)
	cut = numpy.linspace(0, HEIGHT, 9)
	slices = [1 - solid[(points[:, 2] >= a) & (points[:, 2] < b) & core].mean() for a, b in zip(cut, cut[1:])]
	print("  core, eight slices from bottom to top: " + ", ".join(f"{n:.4f}" for n in slices))
	print(f"  core (2 d50 from every wall): porosity {1 - solid[core & inner].mean():.4f}")


def inCore(x, d50):
	"""Which points are 2 d50 from every wall."""
	return (numpy.hypot(x[:, 0], x[:, 1]) < RADIUS - 2 * d50) & (abs(x[:, 2] - HEIGHT / 2) < HEIGHT / 2 - 2 * d50)


def printContacts(x, r, d50):
	"""Near contacts, their fabric, and segregation."""
	pairs = cKDTree(x).query_pairs(2.2 * r.max(), output_type="ndarray")
	branch = x[pairs[:, 0]] - x[pairs[:, 1]]
	distance = numpy.linalg.norm(branch, axis=1)
	gap = distance - r[pairs].sum(axis=1)
	middle = inCore(x, d50)
	for share in (1e-3, 1e-2, 5e-2):
		count = numpy.bincount(pairs[gap < share * d50].ravel(), minlength=len(r))
		print(f"  neighbours within {share:g} d50 in the core: {count[middle].mean():.2f} ({(count[middle] == 0).mean():.3f} of the grains have none)")
	# contacts chosen by their middle: choosing both grains in a long core would favour its axis
	near = (gap < 5e-2 * d50) & inCore(x[pairs].mean(axis=1), d50)
	n = branch[near] / distance[near, None]
	fabric = n.T @ n / near.sum()
	print(
		f"  fabric of {near.sum()} near contacts (5 % d50, core): diagonal {numpy.diag(fabric).round(4).tolist()}, "
		f"eigenvalues {numpy.linalg.eigvalsh(fabric).round(4).tolist()}; chance alone scatters by {math.sqrt(4 / 45 / near.sum()):.4f}"
	)
	inside = numpy.flatnonzero(middle)
	along = numpy.corrcoef(r[inside], x[inside, 2])[0, 1]
	across = numpy.corrcoef(r[inside], numpy.hypot(x[inside, 0], x[inside, 1]))[0, 1]
	print(f"  correlation of size with height {along:+.4f}, with distance from the axis {across:+.4f}; chance alone {1 / math.sqrt(len(inside)):.4f}")


def measure(study, seed, **stress):
	"""Print what a packing is like; the digest of its centres."""
	sand, packing, seconds = pack(study.grains, study.porosity, seed, **stress)
	x, r = numpy.array([tuple(c) for c in packing.centres]), numpy.array(packing.sizes)
	d50 = sand.d50
	print(
		f"seed {seed}: {seconds:.1f} s of one core, porosity {packing.porosityReached:.9f}, max overlap {packing.maxOverlap:g}, shakes {packing.shakesUsed}, "
		f"d50 {d50 * 1e3:.3f} mm, D/d50 {2 * RADIUS / d50:.1f}, dmax/dmin {sand.largest / sand.smallest:.2f}"
	)
	printPorosity(x, r, d50, seed, study.points)
	printContacts(x, r, d50)
	return hashlib.sha256(x.tobytes()).hexdigest()[:16]


def report(grains, porosity, **stress):
	"""One line: what it took, or why it cannot be."""
	try:
		_, packing, seconds = pack(grains, porosity, 1, **stress)
	except RuntimeError as error:
		print(f"{grains} grains at {porosity}: {error}")
		return
	line = f"{grains} grains at {porosity}: {seconds:.1f} s of one core, porosity {packing.porosityReached:.5f}, shakes {packing.shakesUsed}"
	if stress:
		line += (
			f", stress radial {packing.radialStress:.0f} axial {packing.axialStress:.0f} Pa, coordination {packing.coordination:.2f}, "
			f"rattlers {packing.rattlers:.3f}, friction lowered to {packing.frictionReached:.3f}, max overlap {packing.maxOverlap:.1e}"
		)
	print(line)


def main(argv):
	parser = argparse.ArgumentParser(prog="packing_study.py", description="Measures packings of spheres in a cylinder.")
	parser.add_argument("--short", action="store_true", help="700 grains, one seed, two porosities")
	study = SHORT if parser.parse_args(argv).short else FULL
	digests = [measure(study, seed) for seed in study.seeds]
	print("under 10 kPa:")
	measure(study, 1, **STRESSED)
	print(f"digests of the centres for seeds {', '.join(map(str, study.seeds))}:", *digests)
	for grains in study.sizes:
		for porosity in study.loose:
			report(grains, porosity)
	for grains in study.sizes:
		for porosity in study.stressed:
			report(grains, porosity, **STRESSED)


if __name__ == "__main__":
	main(sys.argv[1:])
