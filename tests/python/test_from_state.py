# SPDX-License-Identifier: GPL-2.0-or-later
"""``--from``: what a configuration says otherwise than the state is applied or refused, never only written down."""

import re
import shutil

import numpy
import pytest
import yaml
from hexmembrane.configuration import Config
from hexmembrane.output import records
from tinyTest import configure, runOutside

LOOSE = {"friction": 0.2, "unbalanced": 0.05, "tolerance": 0.3}
SHORT = {"records": 2, "vtkEvery": 0, "checkpointEvery": 0, "consolidationSteps": 400}
WAY = {"strain": 0.002, "velocity": 0.2}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
	"""The folder of a whole test."""
	folder = tmp_path_factory.mktemp("whole")
	said = runOutside(configure(folder, consolidation=LOOSE, shear=WAY, output=SHORT), "--out", folder / "out")
	assert said.returncode == 0, said.stdout + said.stderr
	return folder / "out"


@pytest.fixture
def shearFrom(whole, tmp_path, runHere):
	"""Shear the state with changes of the configuration: (code, stdout, stderr)."""

	def run(state=None, **changes):
		changes = {"consolidation": LOOSE, "shear": WAY, "output": SHORT, **changes}
		shutil.rmtree(tmp_path / "out", ignore_errors=True)
		return runHere(configure(tmp_path, **changes), "--out", tmp_path / "out", "--from", state or whole / "consolidated.yade.gz")

	run.out, run.state = tmp_path / "out", whole / "consolidated.yade.gz"
	return run


@pytest.mark.parametrize(
	"changes, message",
	[
		({"specimen": {"emod": 3e7}}, "specimen.emod = 30000000.0: the state was made with 20000000.0; fix: give that value, leave the key out"),
		({"specimen": {"kn": 1e5, "ks": 1e5, "emod": None}}, "specimen.kn = 100000.0: the state was made with None"),
		({"specimen": {"density": 2000}}, "specimen.density = 2000.0: the state was made with 2650.0"),
		({"specimen": {"seed": 4}}, "specimen.seed = 4: the state was made with 3"),
		({"membrane": {"young": 4e6}}, "membrane.young = 4000000.0: the state was made with 3000000.0"),
		({"membrane": {"tensileStrength": 1.0}}, "membrane.tensileStrength = 1.0: the state was made with None"),
		({"consolidation": {"pressure": 5e4}}, "consolidation.pressure = 50000.0: the state was consolidated at 100000.0 Pa"),
		({"boundary": "wall"}, "boundary = 'wall': the state has a membrane"),
	],
)
def test_refused(shearFrom, changes, message):
	merged = {name: {**{"consolidation": LOOSE, "shear": WAY}.get(name, {}), **part} if isinstance(part, dict) else part for name, part in changes.items()}
	code, _, errors = shearFrom(**merged)
	assert code == 2 and re.search(message, errors) and "fix: " in errors, errors
	assert not (shearFrom.out / "records.csv").exists() and not (shearFrom.out / "config.yaml").exists()


def test_shearedStateIsNoConsolidatedOne(whole, shearFrom):
	code, _, errors = shearFrom(whole / "sheared.yade.gz")
	assert code == 2 and "sheared.yade.gz': is no state at the end of a consolidation: its grains have moved since its stage began; fix: give consolidated.yade.gz" in errors


def test_platensOfTheState(whole, O, tmp_path):
	from hexmembrane.configuration import ConfigError, load
	from hexmembrane.run import from_state, states
	from hexmembrane.scene.handles import Scene

	config = load(configure(tmp_path, consolidation=LOOSE, shear={"strain": 0.1}))
	O.reset()
	states.load(whole / "consolidated.yade.gz")
	from_state.require(config, "state")
	for drive in (Scene().bottomDrive, Scene().topDrive):
		O.bodies[drive.platen].shape.height = 0.003
	with pytest.raises(ConfigError, match="shear.strain = 0.1: the state's platens are 0.003 m thick, and grains would come behind them; fix: less than 0.0"):
		from_state.require(config, "state")


def test_appliedAndTakenOver(O, shearFrom, tmp_path):
	"""Frictions, damping, step and records are the configuration's; what it leaves out is the state's, in the written configuration too."""
	from hexmembrane.run.command import main
	from hexmembrane.scene.handles import Scene

	configure(tmp_path)
	given = yaml.safe_load((tmp_path / "tiny.yaml").read_text())
	given["specimen"] = {**given["specimen"], "friction": 0.7}
	del given["membrane"], given["specimen"]["emod"]
	path = tmp_path / "less.yaml"
	path.write_text(yaml.safe_dump({**given, "consolidation": {"pressure": 1e5}, "shear": WAY, "output": SHORT, "numerics": {"damping": 0.35, "safety": 0.25}}))
	before = shearFrom()
	assert before[0] == 0, before[2]
	step = O.dt
	O.reset()
	assert main([str(path), "--out", str(tmp_path / "less"), "--from", str(shearFrom.state)]) == 0
	written = Config.of(yaml.safe_load((tmp_path / "less" / "config.yaml").read_text()))
	assert (written.specimen.emod, written.membrane.young, written.consolidation.friction, written.numerics.damping) == (2e7, 3e6, 0.2, 0.35)
	assert O.materials["grain"].friction == pytest.approx(0.7) and O.materials["grain"].emod == 2e7 and O.dt == pytest.approx(step / 2)
	assert Scene().loop.damping == 0.35
	table = records.read(tmp_path / "less" / "records.csv")
	assert list(numpy.unique(table["stage"])) == ["shear"]


def test_stateAlone(whole, shearFrom, tmp_path):
	"""Without its folder a state tells itself what it is made of, and the log says that the rest was not compared."""
	alone = tmp_path / "alone.yade.gz"
	shutil.copy(whole / "consolidated.yade.gz", alone)
	code, said, errors = shearFrom(alone)
	assert code == 0, errors
	assert "WARNING: no config.yaml of its test lies beside the state" in said
	for changes, message in (
		({"specimen": {"emod": 3e7}}, "specimen.emod = 30000000.0: the state has 20000000.0"),
		({"membrane": {"thickness": 1e-3}}, "membrane.thickness = 0.001: the state has 0.0005"),
		({"specimen": {"grains": 190}}, "specimen.gradation = .*: the state has 200 grains of 2.908 to 4.35 mm, this gives 190 of"),
	):
		code, _, errors = shearFrom(alone, **changes)
		assert code == 2 and re.search(message, errors), errors
