# SPDX-License-Identifier: GPL-2.0-or-later
"""The package's import graph: the sub-packages stand in one order, no module is in a circle, and what needs no YADE imports none."""

import ast
import pathlib

import pytest

PACKAGE = pathlib.Path(__file__).parents[2] / "py" / "hexmembrane"
#: A sub-package imports from itself and from those before it. This is the order of py/hexmembrane/README.md.
ORDER = ("configuration", "scene", "measure", "output", "laboratory", "report", "run", "exchange")
WITHOUT_YADE = (
	"configuration.json_schema",
	"configuration.lab",
	"configuration.pfc",
	"configuration.specimen",
	"configuration.stages",
	"configuration.stiffness",
	"configuration.schema",
	"configuration.config",
	"configuration.reader",
	"configuration.balls",
	"scene.gradation",
	"scene.number_sizes",
	"scene.packing_file",
	"scene.timestep",
	"scene.geometry",
	"scene.membrane_loads",
	"scene.sheet_state",
	"output.tables",
	"output.fields",
	"output.inside",
	"output.clouds",
	"output.groups",
	"output.histories",
	"output.records",
	"output.vtk",
	"output.plots",
	"laboratory.curve",
	"laboratory.misfit",
	"report.chains",
	"report.command",
	"report.curves",
	"report.encode",
	"report.laboratories",
	"report.libraries",
	"report.page",
	"report.profiles",
	"report.runs",
	"report.sections",
	"report.spatial",
	"report.summary",
	"report.terminal",
	"report.verdict",
	"run.checkpoints",
	"run.estimate",
	"run.pressure_watch",
	"run.lock",
	"run.manifest",
	"run.progress",
	"exchange.tables",
)


def nameOf(path):
	"""Dotted name in the package, '' for the package itself; a sub-package's own file has the sub-package's name."""
	parts = path.relative_to(PACKAGE).with_suffix("").parts
	return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {nameOf(path): path for path in PACKAGE.rglob("*.py")}


def imported(path):
	"""Full names of the modules that a file imports, by any import statement in it, inside functions too."""
	names = set()
	for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
		if isinstance(node, ast.Import):
			names |= {alias.name for alias in node.names}
		elif isinstance(node, ast.ImportFrom):
			assert node.level == 0, f"{path}: relative import"
			for alias in node.names:
				whole = f"{node.module}.{alias.name}"
				names.add(whole if whole.removeprefix("hexmembrane.") in MODULES else node.module)
	return names


def arrows():
	"""Module -> modules of the package that it imports."""
	graph = {}
	for name, path in MODULES.items():
		targets = {full.removeprefix("hexmembrane.") for full in imported(path) if full.startswith("hexmembrane.")}
		assert targets <= set(MODULES), f"{name}: imports {sorted(targets - set(MODULES))}"
		graph[name] = targets
	return graph


def test_everySubPackageIsInTheOrder():
	assert {path.parent.name for path in PACKAGE.glob("*/__init__.py")} == set(ORDER)
	text = (PACKAGE / "README.md").read_text(encoding="utf-8")
	assert " <- ".join(f"`{name}`" for name in ORDER) in text


@pytest.mark.parametrize("name", sorted(MODULES))
def test_arrowsGoOneWay(name):
	own = name.split(".")[0]
	allowed = ORDER[: ORDER.index(own) + 1] if own in ORDER else ORDER
	assert {target for target in arrows()[name] if target.split(".")[0] not in (*allowed, "_load")} == set()


def test_noCircle():
	graph, done = arrows(), set()

	def visit(name, above):
		assert name not in above, " -> ".join((*above, name))
		if name not in done:
			for target in sorted(graph[name]):
				visit(target, (*above, name))
			done.add(name)

	for name in sorted(graph):
		visit(name, ())


@pytest.mark.parametrize("name", WITHOUT_YADE)
def test_needsNoYade(name):
	"""Neither itself nor through what it imports of the package."""
	graph, seen = arrows(), set()

	def visit(module):
		seen.add(module)
		for target in graph[module] - seen:
			visit(target)

	visit(name)
	# the resolved configuration writes YADE's version where YADE runs
	assert {m for m in seen for full in imported(MODULES[m]) if full.split(".")[0] == "yade"} <= {"configuration.files"}
