# SPDX-License-Identifier: GPL-2.0-or-later
"""Draws examples/paper/schemes.png: stress along the specimen's height for three ways of putting the confining pressure on a membrane.

Run it with: scripts/yade -x scripts/scheme_figure.py [FOLDER]. Takes some 5 minutes of one core; FOLDER (out/schemes) keeps the tests and
the numbers of examples/paper/schemes.md. A scheme whose folder has its result is not run again.

three-stage: O-ring rows ride with the platens, a radial force on the rows beside the platens, pressure on the triangles of the main body.
main body only: nothing presses on the rows beside the platens.
ends held: the rows beside the platens are held where they are, radially; they move along the axis with the membrane.
"""

import json
import pathlib
import sys

import numpy
from yade import O

import hexmembrane
from hexmembrane import configuration
from hexmembrane.measure import profile
from hexmembrane.run import stages
from hexmembrane.scene import SCENE, specimen

ROOT = pathlib.Path(hexmembrane.__file__).resolve().parents[2]
SCHEMES = {"three-stage": "three-stage", "main": "pressure on the main body only", "held": "ends held"}
STATES = ("after consolidation", "at 6 % axial strain")
STRAIN, GRAINS, SLICES = 0.06, 1000, 12
#: The force that holds rows in their place is unbalanced for YADE, 0.0095 of the mean contact force at rest.
HELD_UNBALANCED = 0.011


def apply(name):
	"""Change the scene of the default scheme to the named one. A dead engine is passed over by YADE."""
	handles = scene.Scene().lateral
	handles.servo.dead = name != "three-stage"
	for i, group in zip(handles.membrane.ids, handles.membrane.groups):
		if group == 2 and name == "held":
			O.bodies[i].state.blockedDOFs = "xyXYZ"


def taken(test):
	"""The profile of the test's scene and what stands beside it, as JSON takes it."""
	test.advance(1)  # a loaded state has contacts but no forces of bonds yet
	found = profile.measure(test.scene, test.grains.ids, SLICES)
	lists = {key: value.tolist() if isinstance(value, numpy.ndarray) else value for key, value in vars(found).items()}
	membrane = test.scene.lateral.membrane
	return {**lists, "group": list(membrane.groups)[:: membrane.perRing], "row": test.last}


def compute(name, folder):
	"""Both profiles of a scheme: consolidated and sheared."""
	settings = config.load(ROOT / "examples" / "quick.yaml")
	settings.specimen.grains, settings.shear.strain = GRAINS, STRAIN
	settings.membrane.pressureGain = 0.0  # what a scheme does, not what a closed loop makes of it
	settings.output.records, settings.output.vtkEvery, settings.output.checkpointEvery = 24, 0, 0
	if name == "held":
		settings.consolidation.unbalanced = HELD_UNBALANCED
	folder.mkdir(parents=True)
	packing = specimen.provide(settings, folder, print)
	O.reset()
	scene.build(settings, packing, print)
	apply(name)
	test = stages.Test(settings, folder)
	with test.records:
		test.consolidate()
		result = [taken(test)]
		test.shear()
		result.append(taken(test))
	return result


def draw(results, path):
	"""Two rows of panels, one for each state, a column for each scheme."""
	from matplotlib.backends.backend_agg import FigureCanvasAgg
	from matplotlib.figure import Figure

	figure = Figure(figsize=(9.0, 7.6), layout="constrained")
	FigureCanvasAgg(figure)
	panels = figure.subplots(2, 3, sharey=True, sharex="row")
	for column, (name, title) in enumerate(SCHEMES.items()):
		for line, state in enumerate(STATES):
			axes, found = panels[line][column], results[name][line]
			top = found["height"]
			edges, rows = numpy.array(found["edges"]) / top, numpy.array(found["rowHeight"]) / top
			held = numpy.array(found["group"]) != 1
			axes.stairs(1e-3 * numpy.array(found["axial"]), edges, orientation="horizontal", baseline=None, color="#1f4e79", lw=1.6, label="soil, axial")
			axes.stairs(1e-3 * numpy.array(found["radial"]), edges, orientation="horizontal", baseline=None, color="#b5541c", lw=1.6, label="soil, radial")
			pressure = 1e-3 * numpy.array(found["rowPressure"])
			axes.plot(pressure[held], rows[held], color="0.3", lw=1.0, marker="o", ms=2.6, label="membrane on soil, row by row")
			axes.axvline(1e-3 * found["row"]["sigma3_target"], color="k", lw=1.2, ls=":", label="pressure asked for", zorder=3)
			axes.set_ylim(0, 1)
			axes.grid(color="0.92")
			axes.set_axisbelow(True)
			axes.spines[["top", "right"]].set_visible(False)
			if line == 0:
				axes.set_title(title)
			else:
				axes.set_xlabel("stress [kPa], compression positive")
			if column == 0:
				axes.set_ylabel(f"{state}\nheight over the bottom platen / h")
	handles, labels = panels[0][0].get_legend_handles_labels()
	figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
	figure.savefig(path, dpi=100, metadata={"Software": "hexmembrane"})


def table(results):
	"""Numbers of the text: means over the platen rows, the main body, end slices and the middle half [kPa]."""
	lines = ["| scheme | state | rows beside the platens | main body | soil radial: end slices | middle half | axial: end slices | middle half | q | q corrected |"]
	lines.append("| --- " * 10 + "|")
	for scheme, title in SCHEMES.items():
		for state, found in zip(STATES, results[scheme]):
			middle = slice(SLICES // 4, SLICES - SLICES // 4)
			row = [1e-3 * found["row"][f"sigma3_transmitted_group{g}"] for g in (2, 3)]
			for key in ("radial", "axial"):
				stress = 1e-3 * numpy.array(found[key])
				row += [0.5 * (stress[0] + stress[-1]), stress[middle].mean()]
			row += [1e-3 * found["row"][name] for name in ("q", "q_corrected")]
			lines.append(f"| {title} | {state} | " + " | ".join(f"{value:.1f}" for value in row) + " |")
	return "\n".join(lines)


def main(folder):
	results = {}
	for name in SCHEMES:
		file = folder / f"{name}.json"
		if not file.is_file():
			folder.mkdir(parents=True, exist_ok=True)
			file.write_text(json.dumps(compute(name, folder / name)))
		results[name] = json.loads(file.read_text())
	target = ROOT / "examples" / "paper"
	target.mkdir(exist_ok=True)
	draw(results, target / "schemes.png")
	print(table(results))


if __name__ == "__main__":
	main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/schemes"))
