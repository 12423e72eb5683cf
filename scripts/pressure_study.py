# SPDX-License-Identifier: GPL-2.0-or-later
"""How much of the confining pressure arrives at the study's specimen, over membrane sizes and pressures, with our settings and with the study's.

	scripts/yade scripts/pressure_study.py PACKING OUT

PACKING: the packing.txt of a test of examples/paper. OUT: folder for the tests (those that are there are not run again); ``table.md`` in it is what
examples/paper/pressure.md shows. Each test is consolidated, in half a minute to a few minutes.
"""

import pathlib
import sys

import hexmembrane  # noqa: F401
from hexmembrane import config as configuration, records, scene, stages
from hexmembrane.run import run
from yade import O

STUDY = {"membrane": {"surface": "centre", "areaRule": "cube", "gain": 0.0, "pressureGain": 0.0, "platenRows": 2}}
SIZES = (1.25e-3, 1.0e-3, 0.75e-3, 0.5e-3, 0.25e-3)
PRESSURES = (5e4, 1e5, 1.5e5)


def tests(paper):
	"""(name, configuration) of each test: all sizes at 100 kPa, all pressures at 0.75 mm, ours and the study's."""
	for particleRadius in SIZES:
		for pressure in PRESSURES:
			if pressure != 1e5 and particleRadius != 0.75e-3:
				continue
			for label, settings in (("ours", {}), ("study", STUDY)):
				changes = configuration.merged(settings, {"membrane": {"particleRadius": particleRadius}, "consolidation": {"pressure": pressure, "tolerance": 0.3}})
				yield f"{label}-{1e3 * particleRadius:g}mm-{1e-3 * pressure:g}kPa", configuration.derived(paper, changes)


def consolidated(config, out):
	"""The last row of the consolidation, and the membrane's centre and inner radius then [m]."""
	if not (out / "consolidated.yade.gz").is_file():
		O.reset()
		run(config, out, until="consolidation", quiet=True)
	table = records.read(out / "records.csv")
	last = max(k for k, stage in enumerate(table["stage"]) if stage == "consolidation")
	stages.load(out / "consolidated.yade.gz")
	membrane = scene.Scene().lateral.membrane
	return {name: column[last] for name, column in table.items()}, membrane.sphereRadius


def main(packing, out):
	paper = configuration.load(pathlib.Path(sys.argv[0]).resolve().parents[1] / "examples" / "paper" / "flexible-100.yaml")
	own = {"packing": str(pathlib.Path(packing).resolve()), "gradation": None, "grains": None, "cutBelow": None, "cutAbove": None}
	paper = configuration.derived(paper, {"specimen": own, "membrane": {"thickness": 3e-4}, "output": {"energy": False, "vtkEvery": 0}})
	lines = [
		"| R [mm] | sigma3 [kPa] | settings | main body | beside platens | whole | membrane's own share | main body without it | R/(Rc - R) |",
		"| --- | --- | --- | --- | --- | --- | --- | --- | --- |",
	]
	for name, config in tests(paper):
		row, radius = consolidated(config, pathlib.Path(out) / name)
		target = row["sigma3_target"]
		share = [100 * row[f"sigma3_transmitted_{group}"] / target for group in ("group3", "group2", "all")]
		tension = 100 * row["sigma3_membrane"] / target
		expected = 100 * radius / row["mean_radius"]
		lines.append(
			f"| {1e3 * radius:.3g} | {1e-3 * target:g} | {name.split('-')[0]} | "
			+ " | ".join(f"{value:.2f} %" for value in share)
			+ f" | {tension:+.2f} % | {share[0] - tension:.2f} % | {expected:.2f} % |"
		)
		print(lines[-1], flush=True)
		(pathlib.Path(out) / "table.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
	main(*sys.argv[1:3])
