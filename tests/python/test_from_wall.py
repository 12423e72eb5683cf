# SPDX-License-Identifier: GPL-2.0-or-later
"""From wall to membrane as a stage: what stays, what is refused, and how a test goes on from either side of it."""

import copy
import csv

import numpy
import pytest
from hexmembrane.configuration import Config, ConfigError
from hexmembrane.configuration.stages import boundaries, boundariesIn, plan
from hexmembrane.output import records
from hexmembrane.report import runs
from tinyTest import TINY, configure

STAGES = [{"kind": "consolidation"}, {"kind": "membrane", "time": 0.008}, {"kind": "shear", "strain": 0.002, "records": 2}]
LOOSE = {"consolidation": {"friction": 0.2, "unbalanced": 0.02, "tolerance": 0.1}, "output": {"records": 2, "vtkEvery": 1, "consolidationSteps": 400, "report": False}}


def config(folder, stages, **changes):
	configure(folder)
	return Config.of({**copy.deepcopy(TINY), "boundary": "wall", **changes, "stages": stages}, folder)


def rowsOf(folder):
	with open(folder / "records.csv", newline="", encoding="utf-8") as file:
		rows = [{name.split(" ")[0]: value for name, value in row.items()} for row in csv.DictReader(file)]
	return [{name: value for name, value in row.items() if name != "elapsed"} for row in rows]


def test_plan(tmp_path):
	made = config(tmp_path, [*STAGES[:2], {"kind": "consolidation", "pressure": 2e5}, STAGES[2]])
	stage = plan(made)[1]
	assert (stage.label, stage.state, stage.pressure, stage.before, stage.chain) == ("membrane", "membrane", 1e5, 1e5, ())
	assert boundaries(made) == ("wall", "membrane") and boundaries(config(tmp_path, STAGES[:1])) == ("wall",)
	assert [boundariesIn(made, label) for label in ("generated", "consolidation", "membrane", "consolidation-2", "shear")] == [
		("wall",), ("wall",), ("wall", "membrane"), ("membrane",), ("membrane",),
	]  # fmt: skip


@pytest.mark.parametrize(
	"stages, changes, message",
	[
		(STAGES, {"boundary": "membrane"}, r"stages\[1\].kind = 'membrane': there is no wall .*; fix: boundary: wall"),
		(STAGES, {"membrane": {"placement": "centred", "particleRadius": 2e-3}}, "membrane.placement = 'centred': the membrane comes onto the grains where the wall was"),
		([*STAGES[:2], *STAGES[1:]], {}, r"stages\[2\].kind = 'membrane': the membrane comes once"),
		([STAGES[0], STAGES[2], STAGES[1]], {}, r"stages\[2\].kind = 'membrane': .*before the platens shear"),
		([{"kind": "membrane"}], {}, "stages = 'membrane': the first stage is no consolidation"),
		([STAGES[0], {"kind": "membrane", "pressure": 1e5}], {}, r"stages\[1\].pressure = 100000.0: means nothing in a stage of kind membrane; fix: its keys are time"),
	],
)
def test_refusedPlans(tmp_path, stages, changes, message):
	with pytest.raises(ConfigError, match=message):
		config(tmp_path, stages, **changes)


class Watch:
	"""What the grains are when they are held and when they are released."""

	def __init__(self, monkeypatch):
		from hexmembrane.scene import exchange

		self.seen = []
		begin, release = exchange.Held.__init__, exchange.Held.release

		def held(instance, scene):
			self.seen.append(self.look(scene))
			begin(instance, scene)

		def released(instance, scene):
			self.seen.append(self.look(scene))
			release(instance, scene)

		monkeypatch.setattr(exchange.Held, "__init__", held)
		monkeypatch.setattr(exchange.Held, "release", released)

	@staticmethod
	def look(scene):
		from yade import BodyArrays, O

		ids = set(scene.grainIds())
		scene.exportContacts()
		contacts = {tuple(sorted((c.id1, c.id2))): (1 if c.id1 < c.id2 else -1) * numpy.array(c.phys.shearForce) for c in O.interactions if ids.issuperset((c.id1, c.id2)) and c.isReal}
		return BodyArrays.positions(sorted(ids)), contacts


@pytest.mark.parametrize("tier", ["compact", "reference"])
def test_wholeTest(O, tmp_path, runHere, monkeypatch, tier):
	"""A membrane that cannot be made leaves the state in the wall; from there the test goes on with another, and nothing of the grains is lost."""
	from hexmembrane.scene.handles import Scene

	watch = Watch(monkeypatch)
	coarse = configure(tmp_path, tier=tier, boundary="wall", stages=STAGES, membrane={"particleRadius": 0.03}, **LOOSE)
	code, _, said = runHere(coarse, "--out", tmp_path / "coarse")
	assert code == 1 and "stages[1]: " in said and "too coarse" in said and f"the state in the wall is in '{tmp_path / 'coarse'}'" in said
	watch.seen.clear()
	file = configure(tmp_path, tier=tier, boundary="wall", stages=STAGES, **LOOSE)
	state = tmp_path / "coarse" / "consolidated.yade.gz"
	code, _, said = runHere(file, "--out", tmp_path / "out", "--from", state)
	assert code == 0, said
	assert "in the wall, " in said and "in the membrane, which transmits " in said
	(places, contacts), (after, contactsAfter) = watch.seen
	assert numpy.array_equal(places, after) and len(contacts) > 300
	both = contacts.keys() & contactsAfter.keys()  # contacts are as of the step before, so some few may open or close by the grains' last way
	assert len(both) > 0.99 * len(contacts) and len(both) > 0.99 * len(contactsAfter)
	mean = numpy.mean([numpy.linalg.norm(shear) for shear in contacts.values()])
	assert max(numpy.linalg.norm(contacts[pair] - contactsAfter[pair]) for pair in both) < 0.02 * mean

	rows, scene = rowsOf(tmp_path / "out"), Scene()
	assert list(dict.fromkeys(row["stage"] for row in rows)) == ["membrane", "shear"]
	assert abs(float(rows[0]["sigma3_transmitted_group3"]) / 1e5 - 1) < 0.12 and abs(float(rows[0]["axial_strain"])) < 1e-4
	assert max(abs(float(row["energy_error"])) for row in rows) < 1e-3
	assert scene.lateralBoundary.name == "membrane" and "wall" not in {body.mat.label for body in O.bodies}
	assert O.bodies[scene.topDrive.platen].shape.radius == pytest.approx(scene.lateralBoundary.membrane.innerRadius, rel=1e-12)
	assert {"grains.pvd", "membrane.pvd"} <= {path.name for path in (tmp_path / "out" / "vtk").glob("*.pvd")} and not list((tmp_path / "out" / "vtk").glob("wall*"))
	of = runs.read(tmp_path / "out")
	assert of.boundary == "membrane" and len(of.sheared()["step"]) == 3 and records.sheared(records.read(tmp_path / "out" / "records.csv"))[0] == len(rows) - 3

	# stopped at the membrane and resumed: the same rows
	code, _, errors = runHere(file, "--out", tmp_path / "parts", "--from", state, "--until", "membrane")
	assert code == 0, errors
	code, _, errors = runHere(file, "--out", tmp_path / "parts", "--resume")
	assert code == 0, errors
	assert rowsOf(tmp_path / "parts") == rows

	# the state in the membrane goes on with the shear; its sheet is not another's
	code, _, errors = runHere(file, "--out", tmp_path / "shear", "--from", tmp_path / "parts" / "membrane.yade.gz", "--until", "shear")
	assert code == 0, errors
	other = configure(tmp_path, tier=tier, boundary="wall", stages=STAGES, membrane={"young": 4e6}, **LOOSE)
	code, _, errors = runHere(other, "--out", tmp_path / "refused", "--from", tmp_path / "parts" / "membrane.yade.gz")
	assert code == 2 and "membrane.young = 4000000.0: the state was made with 3000000.0" in errors
	code, _, errors = runHere(configure(tmp_path, tier=tier, **LOOSE), "--out", tmp_path / "refused", "--from", state)
	assert code == 2 and "give boundary: wall, with '- {kind: membrane}' among the stages" in errors
