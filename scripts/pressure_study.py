# SPDX-License-Identifier: GPL-2.0-or-later
"""How much of the confining pressure arrives at the study's specimen, over membrane sizes and pressures, with our settings and with the study's.

	scripts/yade -x scripts/pressure_study.py PACKING OUT [NAME ...]

NAME: of a test (ours-1.25mm-100kPa, say), to run only some. PACKING: the packing.txt of a test of examples/paper. OUT: folder for the tests (those that are there are not run again); ``table.md`` in it is what
examples/paper/pressure.md shows. Our settings are run to the end of shear, 5 minutes (1.25 mm) to 45 minutes (0.25 mm) of one core each; the study's are consolidated
only, half a minute to two minutes each: their loop is open, and what they press too hard does not change in shear but for the membrane's tension.
"""

import pathlib
import sys

import hexmembrane  # noqa: F401
import numpy
from hexmembrane import configuration
from hexmembrane.output import records
from hexmembrane.run import stages
from hexmembrane.scene import SCENE
from hexmembrane.run import run
from yade import O

OURS = {}
STUDY = {
	"membrane": {"surface": "centre", "areaRule": "cube", "gain": 0.0, "pressureGain": 0.0, "platenRows": 2},
	"consolidation": {"tolerance": 0.3},
}
SIZES = (1.25e-3, 1.0e-3, 0.75e-3, 0.5e-3, 0.25e-3)
PRESSURES = (5e4, 1e5, 1.5e5)


def tests(paper):
	"""(name, configuration) of each test: all sizes at 100 kPa, all pressures at 0.75 mm, ours and the study's."""
	for particleRadius in SIZES:
		for pressure in PRESSURES:
			if pressure != 1e5 and particleRadius != 0.75e-3:
				continue
			for label, settings in (("ours", OURS), ("study", STUDY)):
				changes = {"membrane": {"particleRadius": particleRadius}, "consolidation": {"pressure": pressure}}
				yield f"{label}-{1e3 * particleRadius:g}mm-{1e-3 * pressure:g}kPa", configuration.derived(paper, configuration.merged(settings, changes))


def measured(config, out, until):
	"""The last row of the consolidation, the rows of shear (arrays by column), and the membrane's sphere radius [m]."""
	if not (out / f"{until}.yade.gz").is_file():
		O.reset()
		run(config, out, until="consolidation" if until == "consolidated" else "shear", quiet=True)
	table = records.read(out / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	last = int(numpy.flatnonzero(~shear)[-1])
	stages.load(out / "consolidated.yade.gz")
	radius = scene.Scene().lateral.membrane.sphereRadius
	numbers = {name: column for name, column in table.items() if name != "stage"}
	return {name: column[last] for name, column in numbers.items()}, {name: column[shear] for name, column in numbers.items()}, radius


def within(values):
	return f"{values.min():.2f} to {values.max():.2f} %" if len(values) else ""


def main(packing, out, *names):
	paper = configuration.load(pathlib.Path(sys.argv[0]).resolve().parents[1] / "examples" / "paper" / "flexible-100.yaml")
	own = {"packing": str(pathlib.Path(packing).resolve()), "gradation": None, "grains": None, "cutBelow": None, "cutAbove": None}
	paper = configuration.derived(paper, {"specimen": own, "output": {"vtkEvery": 0}})
	lines = [
		"| R [mm] | R/r | sigma3 [kPa] | settings | main body | beside platens | whole | main body in shear | membrane's own share | the same in shear | main body without it | R/(Rc - R) |",
		"| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
	]
	unknown = set(names) - {name for name, _ in tests(paper)}
	if unknown:
		raise SystemExit(f"pressure_study.py: no test {', '.join(sorted(unknown))}; fix: one of {', '.join(name for name, _ in tests(paper))}")
	for name, config in tests(paper):
		if names and name not in names:
			continue
		label = name.split("-")[0]
		row, shear, radius = measured(config, pathlib.Path(out) / name, "sheared" if label == "ours" else "consolidated")
		target = row["sigma3_target"]
		share = [100 * row[f"sigma3_transmitted_{group}"] / target for group in ("group3", "group2", "all")]
		tension = 100 * row["sigma3_membrane"] / target
		smallest = min(O.bodies[i].shape.radius for i in scene.Scene().grainIds())
		cells = [
			f"{1e3 * radius:.3g}",
			f"{radius / smallest:.2f}",
			f"{1e-3 * target:g}",
			label,
			*(f"{value:.2f} %" for value in share),
			within(100 * shear["sigma3_transmitted_group3"] / target),
			f"{tension:+.2f} %",
			within(100 * shear["sigma3_membrane"] / target),
			f"{share[0] - tension:.2f} %",
			f"{100 * radius / row['mean_radius']:.2f} %",
		]
		lines.append("| " + " | ".join(cells) + " |")
		print(lines[-1], flush=True)
		(pathlib.Path(out) / "table.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
	main(*sys.argv[1:])
