# SPDX-License-Identifier: GPL-2.0-or-later
"""The plain YADE scripts of examples/scripts, each in its short form (SHORT), one after the other in one YADE as scripts/yade starts it."""

import ast
import os
import pathlib
import re
import subprocess
import sys

import pytest
import specimenScene
import tiers
from hexmembrane.measure.rows import Grains, Reference, row
from hexmembrane.output.records import COLUMNS
from hexmembrane.scene.handles import Scene

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "examples" / "scripts"
SETUP = ROOT / "scripts" / "setup.d"
DRIVER = """
import sys
from yade import O, plot
for path in sys.argv[1:]:
	O.reset()
	plot.reset()
	print("=== " + path.rpartition("/")[2], flush=True)
	sys.argv = [path]
	exec(compile(open(path).read(), path, "exec"), globals())
print("=== end", flush=True)
"""
#: What each script says at its end.
SAYS = {
	"triaxial": r"strain 0\.00\d+, q \S+ Pa, pressure on the soil [\d.e+]+ Pa",
	"compact": r"(?s)reference: .* axial (?P<a>\S+) Pa, radial (?P<r>\S+) Pa.*compact: .* axial (?P=a) Pa, radial (?P=r) Pa.*O.interactions: 0\nafter.*: [1-9]\d+",
	"packing": r"\d{3} grains, wall of 25 mm now 2[0-4][\d.]* mm",
	"clumps": r"60 clumps, pressure that arrives [3-6]\S*e\+04 Pa",
	"frictmat": r"axial [3-6]\S*e\+04 Pa, radial [3-6]\S*e\+04 Pa",
	"periodic": r"porosity 0\.7\d+",
	"body": r"1200 spheres, 2396 triangles, [1-9]\S* Pa on [45]\S+ cm2, resultant \S+e-1[3-9] N",
	"servo": r"mean [4-7]\S*e\+04 Pa of 50000 Pa",
	"cycles": r"\d+ points, strain 0\.00\d+, q from -\S+ to [1-9]\S+ Pa",
	"state": r"the same stress to the last bit: True\n.*critical time step \S+e-05 s",
	"rows": r"(?:[3-9]\d) columns, q \S+ Pa",
	"views": r"(?s)of two grains \d+\n.*spheres\.\d+\.vtu",
	"view": r"tension of the membrane's bonds from \S+ to \d\S* N",
	"batch": r"friction 0\.5: axial \S+ Pa",
}


def run(*command, **variables):
	environment = {**os.environ, "PYTHONPATH": str(ROOT / "py"), "SHORT": "1", **variables}
	return subprocess.run([sys.executable, *map(str, command)], env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)


@pytest.fixture(scope="module")
def said(tmp_path_factory):
	"""What each script has printed, by its name."""
	driver = tmp_path_factory.mktemp("scripts") / "driver.py"
	driver.write_text(DRIVER)
	result = run(SETUP / "withoutPorts.py", "-n", "-x", driver, *(SCRIPTS / f"{name}.py" for name in SAYS))
	parts = re.split(r"^=== (\w+)(?:\.py)?\n", result.stdout, flags=re.MULTILINE)
	found = dict(zip(parts[1::2], parts[2::2]))
	assert result.returncode == 0 and "end" in found, list(found)[-1:] + [result.stderr[-2000:]]
	return found


@pytest.mark.parametrize("name", SAYS)
def test_script(said, name):
	assert re.search(SAYS[name], said[name]), said[name]


def test_noneUsesItsFile():
	"""YADE runs a script with its own program's ``__file__``: a place beside the script is told by sys.argv[0], one in the checkout by the package."""
	for path in (SCRIPTS.parent).rglob("*.py"):
		names = [node.id for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Name)]
		assert "__file__" not in names, path


def test_allAreTriedAndListed():
	"""Every script but what they share is run here, is short, and has its row in the README."""
	names = {path.stem for path in SCRIPTS.glob("*.py")} - {"specimen"}
	text = (SCRIPTS / "README.md").read_text(encoding="utf-8")
	assert names == set(SAYS) and all(f"[{name}.py]({name}.py)" in text for name in names)
	assert all(len((SCRIPTS / f"{name}.py").read_text(encoding="utf-8").splitlines()) <= 100 for name in names)


def test_batchOfATable(tmp_path):
	"""yade-batch runs the script for a line of the table; neither it nor the run opens a port."""
	result = run(SETUP / "batch.py", "--lines", "4", "--log", tmp_path / "@.log", SCRIPTS / "table.txt", SCRIPTS / "batch.py")
	(log,) = tmp_path.glob("*.log")
	text = log.read_text()
	assert result.returncode == 0 and "shows batch summary" not in result.stdout, result.stdout + result.stderr
	assert re.search(r"friction 0\.5: axial \S+ Pa", text) and "XMLRPC" not in text, text


def test_aRowOfASceneOfOnesOwn(O, tier):
	"""No guard, no builder: the parts that Scene names are enough for all columns of the records."""
	specimenScene.build(tier, grains=60, porosity=0.5, particleRadius=4e-3, swell=1.0)
	tiers.run(20)
	scene = Scene()
	found = row(scene, Grains.of(scene.grainIds()), Reference.of(scene), "shear", elapsed=0)
	assert scene.guard is None and set(found) == {column.name for column in COLUMNS}
	with pytest.raises(RuntimeError, match="MembranePressure: 1 expected; fix: add one"):
		(tiers.loop() or O).engines = [engine for engine in (tiers.loop() or O).engines if type(engine).__name__ != "MembranePressure"]
		Scene()
