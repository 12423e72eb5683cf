# SPDX-License-Identifier: GPL-2.0-or-later
"""Draws schemes.png: stress along the specimen's height for three ways of putting the confining pressure on a membrane.

	scripts/yade -x examples/paper/scheme_figure.py [FOLDER] [--picture FILE] [--short]

FOLDER (out/schemes) keeps the tests and the numbers of schemes.md; FILE is by default the picture of this folder, with --short one in
FOLDER. A scheme whose folder has its result is not run again. It takes under a minute of one core; --short, with 150 grains and next to no
strain, takes seconds.

three-stage: O-ring rows ride with the platens, a radial force on the rows beside the platens, pressure on the triangles of the main body.
main body only: nothing presses on the rows beside the platens.
ends held: the rows beside the platens are held where they are, radially; they move along the axis with the membrane.
"""

import argparse
import json
import math
import pathlib
import sys

import hexmembrane
import numpy
from hexmembrane import configuration
from hexmembrane.measure import profile
from hexmembrane.run.stages import TriaxialTest
from hexmembrane.scene import builder, specimen
from hexmembrane.scene.handles import Scene
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from yade import O

EXAMPLES = pathlib.Path(hexmembrane.__file__).resolve().parents[2] / "examples"
SCHEMES = {"three-stage": "three-stage", "main": "pressure on the main body only", "held": "ends held"}
SETTINGS = {
	"specimen": {"grains": 1000},
	# Open loops, a sheet without bending stiffness, the platen's force and rough platens: what a scheme does by itself.
	"membrane": {"servoTime": math.inf, "pressureTime": math.inf, "bendingStiffness": 0.0},
	"consolidation": {"axial": "platen"},
	"platens": {"consolidationFriction": None},
	"shear": {"strain": 0.06},
	"output": {"records": 24, "vtkEvery": 0, "checkpointEvery": 0},
}
SHORT = {
	"specimen": {"grains": 150, "porosity": 0.46},
	"membrane": {"particleRadius": 2.5e-3, "thickness": 2e-3},
	"consolidation": {"unbalanced": 0.08, "tolerance": 0.3, "rampTime": 0.004},
	"shear": {"strain": 0.002, "velocity": 0.2},
	"output": {"records": 2},
}
HEADER = (
	"| scheme | state | rows beside the platens | main body | soil radial: end slices | middle half | axial: end slices | middle half "
	"| q of the platens | q of the soil |"
)
#: The force that holds rows in their place is unbalanced for YADE, 0.0095 of the mean contact force at rest.
HELD_UNBALANCED = 0.011


def apply(name):
	"""Change the scene of the three-stage scheme to the named one. A dead engine is passed over by YADE."""
	boundary = Scene().lateralBoundary
	boundary.radialServo.dead = name != "three-stage"
	for i, group in zip(boundary.membrane.ids, boundary.membrane.groups):
		if group == 2 and name == "held":
			O.bodies[i].state.blockedDOFs = "xyXYZ"


def profileAndRow(test, slices):
	"""The profile of the test's scene and the last row of its records, as JSON takes them."""
	test.advance(1)  # a loaded state has contacts but no forces of bonds yet
	stress = profile.measure(test.scene, slices)
	lists = {key: value.tolist() if isinstance(value, numpy.ndarray) else value for key, value in vars(stress).items()}
	membrane = test.scene.lateralBoundary.membrane
	return {**lists, "group": list(membrane.groups)[:: membrane.perRing], "row": test.lastRow}


def compute(name, folder, settings, slices):
	"""Both profiles of a scheme: consolidated and sheared."""
	config = configuration.derived(configuration.load(EXAMPLES / "quick.yaml"), settings)
	if name == "held":
		config.consolidation.unbalanced = max(HELD_UNBALANCED, config.consolidation.unbalanced)
	folder.mkdir(parents=True)
	packing = specimen.provide(config, folder, print)
	O.reset()
	builder.build(config, packing, print)
	apply(name)
	test = TriaxialTest(config, folder)
	with test.records:
		test.proceed("consolidation")
		profiles = [profileAndRow(test, slices)]
		test.proceed()
		profiles.append(profileAndRow(test, slices))
	return profiles


def drawPanel(axes, state):
	"""Stress along the height of one scheme in one state."""
	top = state["height"]
	edges, rows = numpy.array(state["edges"]) / top, numpy.array(state["rowHeight"]) / top
	inside = numpy.array(state["group"]) != 1
	for name, colour in (("axial", "#1f4e79"), ("radial", "#b5541c")):
		stress = 1e-3 * numpy.array(state[name])
		axes.stairs(stress, edges, orientation="horizontal", baseline=None, color=colour, lw=1.6, label=f"soil, {name}")
	pressure = 1e-3 * numpy.array(state["rowPressure"])
	axes.plot(pressure[inside], rows[inside], color="0.3", lw=1.0, marker="o", ms=2.6, label="membrane on soil, row by row")
	axes.axvline(1e-3 * state["row"]["sigma3_target"], color="k", lw=1.2, ls=":", label="pressure asked for", zorder=3)
	axes.set_ylim(0, 1)
	axes.grid(color="0.92")
	axes.set_axisbelow(True)
	axes.spines[["top", "right"]].set_visible(False)


def draw(results, states, path):
	"""Two rows of panels, one for each state, a column for each scheme."""
	figure = Figure(figsize=(9.0, 7.6), layout="constrained")
	FigureCanvasAgg(figure)
	panels = figure.subplots(2, 3, sharey=True, sharex="row")
	for column, (name, title) in enumerate(SCHEMES.items()):
		for line, state in enumerate(states):
			axes = panels[line][column]
			drawPanel(axes, results[name][line])
			if line == 0:
				axes.set_title(title)
			else:
				axes.set_xlabel("stress [kPa], compression positive")
			if column == 0:
				axes.set_ylabel(f"{state}\nheight over the bottom platen / h")
	handles, labels = panels[0][0].get_legend_handles_labels()
	figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
	figure.savefig(path, dpi=100, metadata={"Software": "hexmembrane"})


def table(results, states, slices):
	"""Numbers of the text: means over the platen rows, the main body, end slices and the middle half [kPa]."""
	lines = [HEADER, "| --- " * 10 + "|"]
	middle = slice(slices // 4, slices - slices // 4)
	for scheme, title in SCHEMES.items():
		for name, state in zip(states, results[scheme]):
			values = [1e-3 * state["row"][f"sigma3_transmitted_group{group}"] for group in (2, 3)]
			for key in ("radial", "axial"):
				stress = 1e-3 * numpy.array(state[key])
				values += [0.5 * (stress[0] + stress[-1]), stress[middle].mean()]
			values += [1e-3 * state["row"][column] for column in ("q_cell", "q")]
			lines.append(f"| {title} | {name} | " + " | ".join(f"{value:.1f}" for value in values) + " |")
	return "\n".join(lines)


def main(argv):
	parser = argparse.ArgumentParser(prog="scheme_figure.py", description="Draws stress along the height for three loading schemes.")
	parser.add_argument("folder", metavar="FOLDER", nargs="?", type=pathlib.Path, default=pathlib.Path("out/schemes"))
	parser.add_argument("--picture", metavar="FILE", type=pathlib.Path)
	parser.add_argument("--short", action="store_true", help="150 grains and 0.2 %% of strain")
	arguments = parser.parse_args(argv)
	folder, slices = arguments.folder, 4 if arguments.short else 12
	settings = configuration.merged(SETTINGS, SHORT) if arguments.short else SETTINGS
	folder.mkdir(parents=True, exist_ok=True)
	results = {}
	for name in SCHEMES:
		file = folder / f"{name}.json"
		if not file.is_file():
			file.write_text(json.dumps(compute(name, folder / name, settings, slices)))
		results[name] = json.loads(file.read_text())
	states = ("after consolidation", f"at {100 * settings['shear']['strain']:g} % axial strain")
	draw(results, states, arguments.picture or (folder if arguments.short else EXAMPLES / "paper") / "schemes.png")
	print(table(results, states, slices))


if __name__ == "__main__":
	main(sys.argv[1:])
