# SPDX-License-Identifier: GPL-2.0-or-later
"""How test_pages.py runs what stands on the pages."""

import dataclasses


@dataclasses.dataclass
class Run:
	"""Run here: the line, or ``instead`` of a synopsis, with ``more`` arguments for a short form; ``says``: what is printed; ``leaves``: what is there afterwards.

	``outside``: in a process of its own."""

	more: tuple = ()
	instead: str = ""
	says: str = ""
	leaves: tuple = ()
	code: int = 0
	outside: bool = False


@dataclasses.dataclass
class Elsewhere:
	"""Run by a test of ``file``, or by a command there, in which ``text`` stands."""

	file: str
	text: str


@dataclasses.dataclass
class Snippet:
	"""Python between ``before`` and ``after``, with texts of a long run replaced: ``short``."""

	before: str = ""
	after: str = ""
	short: tuple = ()


CHECKED = Run(more=("--check",), says="nothing was made")
PLANNED = Run(more=("--dry-run",), says="core hours")
TESTS = "tests/python/"
SITE = Elsewhere(TESTS + "test_docs.py", 'DOCS / "build.py"')
SUITE = Elsewhere(".ci/run", '"$scripts/test"')
SCRIPTS = Elsewhere(TESTS + "test_scripts.py", "def test_allAreTriedAndListed")
STUDIES = TESTS + "test_studies.py"
CONFIGURED = Elsewhere(TESTS + "test_find_yade.py", "YADE_SOURCE_DIR")
INSTALLED = Elsewhere(TESTS + "test_install.py", '"cmake", "--install"')
NAMES = Run(more=("--benchmark_list_tests",), says=r"^\w+")

QUICK = ("out/quick/sheared.yade.gz", "out/quick/test.png", "out/quick/report.html")

COMMANDS = {
	# README.md, CONTRIBUTING.md, scripts, scripts/packaging
	"scripts/run": Run(more=("--resume",), leaves=QUICK),
	"scripts/test": SUITE,
	"scripts/test tests/engines/test_platen.py": SUITE,
	"scripts/sanitize": Elsewhere(".ci/run", '"$scripts/sanitize"'),
	"scripts/sweep STUDY": Run(instead="scripts/sweep examples/sweep/friction.yaml --dry-run", says="core hours"),
	"scripts/report DIR...": Run(instead="scripts/report out/quick out/a", leaves=("out/quick/report.html",)),
	"scripts/yade SCRIPT [ARGS]": SCRIPTS,
	"scripts/pfc-check DIR": Run(instead="scripts/pfc-check state", says="equal within 1e-06"),
	"scripts/docs": SITE,
	"cmake -B build -DYADE_EXECUTABLE=/usr/bin/yade-double -DYADE_SOURCE_DIR=/path/to/yade/source -DHEXMEMBRANE_TESTS=OFF": CONFIGURED,
	"cmake --build build && cmake --install build": INSTALLED,
	# examples
	"scripts/run examples/quick.yaml --out DIR": Run(instead="scripts/run examples/quick.yaml --out NEW", more=("--until", "specimen"), leaves=("NEW/packing.txt",)),
	"scripts/run examples/quick.yaml --out DIR --resume": Run(leaves=("DIR/sheared.yade.gz",)),
	"scripts/run my.yaml": CHECKED,
	"scripts/run examples/paper/flexible-100.yaml": CHECKED,
	"scripts/run examples/paper/rigid-100.yaml": CHECKED,
	"scripts/run examples/paper/rigid-100.yaml --until specimen": CHECKED,
	"scripts/run examples/pfc/study.yaml": Run(more=("--check", "--out", "out/pfc"), says="unloading: to q = 0 kPa(.|\n)*nothing was made"),
	"scripts/yade -x examples/paper/scheme_figure.py": Elsewhere(STUDIES, "def test_schemeFigure"),
	"scripts/yade -x examples/paper/study/inside.py out/study out/inside": Elsewhere(STUDIES, "def test_insideTheStudysTests"),
	"scripts/yade -x examples/paper/study/compare.py out/study out/compare": Elsewhere(STUDIES, "def test_comparisonsOfTheStudy"),
	"scripts/yade -x examples/paper/study/tension.py": Run(more=("--strains", "0.002", "--radius", "3e-3"), says="0.33"),
	"scripts/yade -x examples/toyoura/predict.py out/toyoura --out out/toyoura/predicted": Elsewhere(TESTS + "test_toyoura.py", "def test_predictions"),
	"scripts/yade -x examples/toyoura/predict.py out/toyoura-1200 --calibration examples/toyoura/calibration-1200.yaml --out out/toyoura-1200/predicted": Elsewhere(
		TESTS + "test_toyoura.py", "def test_predictions"
	),
	"scripts/yade -x examples/toyoura/effects.py membrane out/toyoura --out out/toyoura/membrane --packings 16": Elsewhere(TESTS + "test_toyoura.py", "def test_membranesAreComparedByPairs"),
	"scripts/yade -x examples/toyoura/effects.py grains out/toyoura --out out/toyoura/grains --slower 2": Elsewhere(TESTS + "test_toyoura.py", "def test_scaledGrains"),
	"scripts/yade -x examples/toyoura/recovery.py out/toyoura": Elsewhere(TESTS + "test_toyoura.py", "def test_recovery"),
	"scripts/yade -x examples/toyoura/recovery.py out/own --make": Elsewhere(TESTS + "test_toyoura.py", "def test_ownCurves"),
	"scripts/yade -x examples/toyoura/recovery.py out/recovery --calibration examples/toyoura/recovery.yaml": Elsewhere(TESTS + "test_toyoura.py", "def test_recovery"),
	"scripts/yade -x examples/pfc/two_balls.py": Elsewhere(TESTS + "test_pfc_guide.py", "def test_twoBalls"),
	"scripts/yade -x pkg/specimen/packing_study.py": Elsewhere(STUDIES, "def test_packingStudy"),
	"scripts/yade -x tests/python/syntheticBands.py 100": Elsewhere(TESTS + "test_bands.py", "syntheticBands"),
	# what tests have left
	"scripts/pfc-histories out/study": Run(leaves=("out/study/histories.csv",)),
	"scripts/pfc-check state": Run(says="equal within 1e-06"),
	"scripts/pfc-check state --next state-one-cycle-later": Run(says="shear force of the step(.|\n)*equal within 1e-06"),
	"scripts/pfc-check state --state state.yade.gz --damping 0.7": Run(says="damping 0.7", leaves=("state.yade.gz",)),
	"scripts/report out/quick": Run(leaves=("out/quick/report.html",)),
	"scripts/report out/a out/b out/c --out three.html": Run(leaves=("three.html",)),
	"scripts/report out/study": Run(leaves=("out/study/report.html",)),
	"scripts/report out/quick --laboratory triaxial.csv": Run(leaves=("out/quick/report.html",)),
	"scripts/report out/quick --watch": Run(says=r"q \[kPa\]", leaves=("out/quick/report.html",)),
	"scripts/report out/quick --text": Run(says=r"q \[kPa\]"),
	# studies and calibrations: what they would do; tests/python/test_sweep.py and test_calibrate.py run small ones whole
	"scripts/sweep examples/sweep/friction.yaml": PLANNED,
	"scripts/sweep examples/sweep/friction.yaml --dry-run": Run(says="45 runs"),
	"scripts/sweep examples/paper/study/study.yaml --out out/study": Run(instead="scripts/sweep examples/paper/study/study.yaml --out out/plan", more=("--dry-run",), says="core hours"),
	"scripts/sweep examples/paper/study/study.yaml --out out/study --dry-run": Run(instead="scripts/sweep examples/paper/study/study.yaml --out out/plan --dry-run", says="core hours"),
	"scripts/calibrate examples/calibrate/tiny.yaml": PLANNED,
	"scripts/calibrate examples/calibrate/tiny.yaml --dry-run": Run(says="core hours"),
	"scripts/calibrate examples/toyoura/calibration.yaml --inside --out out/toyoura": PLANNED,
	"scripts/calibrate examples/toyoura/calibration-1200.yaml --inside --out out/toyoura-1200": PLANNED,
	"scripts/calibrate examples/toyoura/recovery.yaml --inside --out out/recovery": PLANNED,
	"scripts/yade-batch -j 2 --job-threads 1 --log out/batch/@.log examples/sweep/batch/table.txt examples/sweep/batch/triaxial.py": Run(
		instead="scripts/yade-batch -j 2 --job-threads 1 --dry-run --log out/@.log examples/sweep/batch/table.txt examples/sweep/batch/triaxial.py", outside=True, says="triaxial.py"
	),
	"scripts/yade-batch -j 2 --log out/@.log examples/scripts/table.txt examples/scripts/batch.py": Elsewhere(TESTS + "test_scripts.py", "def test_batchOfATable"),
	"scripts/yade-batch -j 2 examples/scripts/table.txt examples/scripts/batch.py": Elsewhere(TESTS + "test_scripts.py", "def test_batchOfATable"),
	# benchmarks
	"scripts/bench kernels": NAMES,
	"scripts/bench kernels --benchmark_filter='barrier|region/'": NAMES,
	"scripts/bench kernels --benchmark_filter='linear|rolling|motion'": NAMES,
	"scripts/bench kernels --benchmark_filter=Regions": NAMES,
	"scripts/bench accuracy": Elsewhere(TESTS + "test_accuracy.py", "def test_shortForm"),
	"scripts/bench accuracy --boundary wall": Elsewhere(TESTS + "test_accuracy.py", "def test_jobsInTheWall"),
	"scripts/bench cases": Elsewhere("tests/cases/test_hard_cases.py", "hardcases"),
}
_MEASURES = "measures for minutes on an idle machine"
#: Lines that no test runs, and why.
BY_HAND = {
	"scripts/package": "builds the plugin once more; ends with a trial of its own",
	"apt-get install ./out/package/yade-hexmembrane_0.2.0_amd64.deb": "changes the system; scripts/package lays the package over the system instead",
	"xvfb-run -a scripts/yade -x examples/scripts/view.py out/view.jpg": "needs Xvfb; test_scripts.py runs the script without a view, test_gl_view.py draws without a screen",
	**{f"scripts/bench {name}": _MEASURES for name in ("contact", "compact", "compact sheet", "compact threads", "membrane", "order", "robustness")},
	"scripts/bench lammps": "downloads LAMMPS, and " + _MEASURES,
}

_CLASSES = "import hexmembrane\nfrom yade import *\nfrom yade.wrapper import *\n"
_SPECIMEN = "import runpy, types, yade\nspecimen = types.SimpleNamespace(**runpy.run_path('examples/scripts/specimen.py'))\n" + _CLASSES
#: Python snippets by page and a piece of them.
SNIPPETS = {
	("README.md", "from yade.wrapper import HexMembrane"): Snippet(after="O.dt = 1e-7\nO.step()\nassert membrane.transmittedPressure(3) == 0\n"),
	("pkg/boundary/README.md", "PlatenDrive"): Snippet(
		before=_CLASSES + "O.materials.append(FrictMat())\nO.bodies.append(utils.sphere((0, 0, .04), 1e-3))\n", after="O.dt = 1e-6\nO.step()\ndrive.mode, drive.velocity = 'velocity', 0.005\nO.step()\nassert -0.005 <= O.bodies[top].state.vel[2] < 0\n"
	),
	("pkg/compact/README.md", "CompactLoop("): Snippet(
		before=_SPECIMEN + "s = specimen.build('compact')\nbonds, pressure, servo, bottom, top, oRings = s.loop.engines\n", after="assert O.iter == 1000 and O.interactions.countReal() > 100\n"
	),
	("pkg/contact/README.md", "label=\"smooth\""): Snippet(before=_CLASSES),
	("pkg/contact/README.md", "grain.setPair("): Snippet(before=_CLASSES + "grain = LinearMat(kn=1e6, ks=1e6, friction=.5, label='grain')\n", after="assert grain.pairs()['platen']['kn'] == 1e7\n"),
	("pkg/contact/README.md", "cement.bond("): Snippet(
		before=_CLASSES + "O.materials.append(LinearMat(kn=1e6, ks=1e6, friction=.5))\ngrains = O.bodies.append([utils.sphere((0, 0, z), 1e-3) for z in (0, 2e-3)])\n",
		short=(("[..., InteractionLoop(...), cement, ...]", "[ForceResetter(), cement, NewtonIntegrator()]"),),
		after="O.dt = 1e-6\nO.step()\nassert cement.count == 1\n",
	),
	("pkg/measure/README.md", "MeasureRegions.grid("): Snippet(before=_SPECIMEN + "s = specimen.build()\nm = s.membrane\nO.step()\n", short=(("0.08", "0.04"),), after="assert found['porosity'].min() < 1\n"),
	("pkg/measure/README.md", "LocalMeasure("): Snippet(
		before=_SPECIMEN + "s = specimen.build()\nm = s.membrane\n", short=(("bottomPlaten=0, topPlaten=1", "bottomPlaten=s.lower.platen, topPlaten=s.upper.platen"), ("10000", "20")),
		after="assert len(shear) == len(s.grains)\n",
	),
	("pkg/membrane/README.md", "MembraneSelfContact("): Snippet(
		before=_CLASSES, short=(("InteractionLoop(...)", "InteractionLoop([Ig2_Sphere_Sphere_LinearScGeom()], [Ip2_LinearMat_LinearMat_LinearPhys()], [Law2_ScGeom_LinearPhys_Linear()])"),),
		after="O.dt = 1e-7\nO.run(2, True)\n",
	),
	("py/hexmembrane/README.md", "import Gradation"): Snippet(),
	("py/hexmembrane/README.md", "Scene().measure.stress()"): Snippet(before=_SPECIMEN + "s = specimen.build()\nO.run(2, True)\n", after="assert stress['volume'] > 0\n"),
	("examples/README.md", "Config.of({"): Snippet(
		short=(('"grains": 500},', '"grains": 150, "porosity": 0.45, "emod": 1e7},\n    "shear": {"strain": 0.002, "velocity": 0.1}, "output": {"records": 5, "vtkEvery": 0},'), ('{"pressure": 50e3}', '{"pressure": 50e3, "unbalanced": 0.01, "tolerance": 0.3}')),
	),
	("examples/paper/README.md", "derived(study"): Snippet(
		before="SHORT = {'specimen': {'grains': 150, 'porosity': 0.46}, 'output': {'records': 5, 'vtkEvery': 0}, 'shear': {'strain': 0.002, 'velocity': 0.1}, 'consolidation': {'unbalanced': 0.01, 'tolerance': 0.3}}\n",
		short=(("run(derived(study,", "run(derived(derived(study, SHORT),"), ('{"velocity": 0.005}', '{"velocity": 0.1}')),
	),
	("examples/pfc/states.md", "continuation.resume("): Elsewhere(TESTS + "test_pfc_guide.py", "def test_scriptOfAState"),
}
#: Pages whose YAML another test takes.
YAMLS = {
	"examples/pfc/guide.md": Elsewhere(TESTS + "test_pfc_guide.py", "def test_theStudyIsWhatTheGuideSays"),
	"examples/sweep/README.md": Elsewhere(TESTS + "test_documentation.py", "def test_studiesAreSound"),
}
