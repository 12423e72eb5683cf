# SPDX-License-Identifier: GPL-2.0-or-later
"""How much of the confining pressure arrives at the study's specimen, over membrane sizes and pressures, with our settings and with the study's.

	scripts/yade -x examples/paper/pressure_study.py PACKING OUT [NAME ...] [--short]

PACKING: the packing.txt of a test of this folder. OUT: folder for the tests; those that are there are not run again, and ``table.md`` in it
is what pressure.md shows. NAME: of a test (ours-1.25mm-100kPa, say), to run only some.

Our settings are run to the end of shear, 5 minutes (1.25 mm) to 45 minutes (0.25 mm) of one core each. The study's are consolidated only, half a
minute to two minutes each: their loop is open, and what they press too hard does not change in shear but for the membrane's tension. --short is
for a packing of 300 grains: one membrane of 2.5 mm at 100 kPa, to 0.5 % of strain.
"""

import argparse
import pathlib
import math
import sys

import hexmembrane
import numpy
from hexmembrane import configuration
from hexmembrane.output import records
from hexmembrane.run import run, states
from hexmembrane.scene.handles import Scene
from yade import O

CONFIGURATION = pathlib.Path(hexmembrane.__file__).resolve().parents[2] / "examples" / "paper" / "flexible-100.yaml"
#: A sheet without bending stiffness between rough platens, both loops closed on the transmitted pressure: the study's membrane.
OURS = {
	"membrane": {"bendingStiffness": 0.0},
	"consolidation": {"axial": "platen", "radial": "transmitted"},
	"platens": {"consolidationFriction": None},
}
STUDY = configuration.merged(
	OURS,
	{
		"membrane": {"surface": "centre", "areaRule": "cube", "servoTime": math.inf, "pressureTime": math.inf, "platenRows": 2},
		"consolidation": {"tolerance": 0.3},
	},
)
SIZES = (1.25e-3, 1.0e-3, 0.75e-3, 0.5e-3, 0.25e-3)
PRESSURES = (5e4, 1e5, 1.5e5)
SHORT = {
	"membrane": {"thickness": 1.0e-3},
	"shear": {"strain": 0.005, "velocity": 0.08},
	"consolidation": {"unbalanced": 1e-2, "tolerance": 0.3},
	"output": {"records": 4, "checkpointEvery": 0},
}
HEADER = (
	"| R [mm] | R/r | sigma3 [kPa] | settings | main body | beside platens | whole | main body in shear | membrane's own share | the same in shear "
	"| main body without it | R/(Rc - R) |"
)


def paper(packing, short):
	"""The study's configuration with the packing from a file."""
	source = {"packing": str(packing.resolve()), "gradation": None, "grains": None, "cutBelow": None, "cutAbove": None}
	config = configuration.derived(configuration.load(CONFIGURATION), {"specimen": source, "output": {"vtkEvery": 0}})
	return configuration.derived(config, SHORT) if short else config


def tests(base, short):
	"""(name, configuration) of each test: all sizes at 100 kPa, all pressures at 0.75 mm, ours and the study's."""
	pairs = [(size, pressure) for size in SIZES for pressure in PRESSURES if pressure == 1e5 or size == 0.75e-3]
	for size, pressure in [(2.5e-3, 1e5)] if short else pairs:
		for label, settings in (("ours", OURS), ("study", STUDY)):
			changes = {"membrane": {"particleRadius": size}, "consolidation": {"pressure": pressure}}
			yield f"{label}-{1e3 * size:g}mm-{1e-3 * pressure:g}kPa", configuration.derived(base, configuration.merged(settings, changes))


def measured(config, out, until):
	"""The last row of the consolidation, the rows of shear (arrays by column), and the membrane's sphere radius [m]; the test is run if need be."""
	if not (out / f"{until}.yade.gz").is_file():
		O.reset()
		run(config, out, until="consolidation" if until == "consolidated" else "shear", quiet=True)
	table = records.read(out / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	last = int(numpy.flatnonzero(~shear)[-1])
	states.load(out / "consolidated.yade.gz")
	radius = Scene().lateralBoundary.membrane.sphereRadius
	numbers = {name: column for name, column in table.items() if name != "stage"}
	return {name: column[last] for name, column in numbers.items()}, {name: column[shear] for name, column in numbers.items()}, radius


def span(values):
	return f"{values.min():.2f} to {values.max():.2f} %" if len(values) else ""


def line(label, row, shear, radius):
	"""One line of the table."""
	target = row["sigma3_target"]
	share = [100 * row[f"sigma3_transmitted_{group}"] / target for group in ("group3", "group2", "all")]
	tension = 100 * row["sigma3_membrane"] / target
	smallest = min(O.bodies[i].shape.radius for i in Scene().grainIds())
	cells = [
		f"{1e3 * radius:.3g}",
		f"{radius / smallest:.2f}",
		f"{1e-3 * target:g}",
		label,
		*(f"{value:.2f} %" for value in share),
		span(100 * shear["sigma3_transmitted_group3"] / target),
		f"{tension:+.2f} %",
		span(100 * shear["sigma3_membrane"] / target),
		f"{share[0] - tension:.2f} %",
		f"{100 * radius / row['mean_radius']:.2f} %",
	]
	return "| " + " | ".join(cells) + " |"


def main(argv):
	parser = argparse.ArgumentParser(prog="pressure_study.py", description="Measures the pressure that arrives at the study's specimen.")
	parser.add_argument("packing", metavar="PACKING", type=pathlib.Path)
	parser.add_argument("out", metavar="OUT", type=pathlib.Path)
	parser.add_argument("names", metavar="NAME", nargs="*")
	parser.add_argument("--short", action="store_true", help="one membrane of 2.5 mm, to 0.5 %% of strain")
	arguments = parser.parse_args(argv)
	chosen = dict(tests(paper(arguments.packing, arguments.short), arguments.short))
	unknown = set(arguments.names) - set(chosen)
	if unknown:
		raise SystemExit(f"pressure_study.py: NAME = {', '.join(sorted(unknown))}: no such test; fix: one of {', '.join(chosen)}")
	lines = [HEADER, "| --- " * 12 + "|"]
	for name, config in chosen.items():
		if arguments.names and name not in arguments.names:
			continue
		label = name.split("-")[0]
		lines.append(line(label, *measured(config, arguments.out / name, "sheared" if label == "ours" else "consolidated")))
		print(lines[-1], flush=True)
		(arguments.out / "table.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
	main(sys.argv[1:])
