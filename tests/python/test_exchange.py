# SPDX-License-Identifier: GPL-2.0-or-later
"""States of PFC: tables, exporters, the laws contact by contact, and going on. Tables are of our own states, or of a stand-in of PFC's module."""

import importlib.util
import math
import pathlib
import re
import sys

import contactScene
import numpy
import pytest
import standInItasca
import tiers
import yade
from exchangeScene import DAMP, SPEED, cycles
from hexmembrane.configuration import Config, ConfigError
from hexmembrane.exchange import command, comparison, continuation, scenes, tables
from hexmembrane.scene.platens import platen
from tinyTest import TINY
from yade import utils

ROOT = pathlib.Path(__file__).parents[2]
EXPORTER = ROOT / "scripts" / "pfc.d" / "export_pfc.py"
#: Direct stiffness with rolling resistance; a modulus with contact bonds; parallel bonds.
ROLLING, BONDED, CEMENTED = "rolling", "bonded", "cemented"


@pytest.fixture(scope="module", params=[ROLLING, BONDED, CEMENTED])
def exported(request, tmp_path_factory):
	"""Folders of two states, a cycle apart, and the balls' motion after the next motion and 100 steps on."""
	from yade import O

	folder = tmp_path_factory.mktemp("exported")
	bonds = request.param == BONDED
	springs = {"emod": 1e8, "kratio": 2} if bonds else {"kn": 2e5, "ks": 1e5}
	cycles(O, springs, bonds, request.param == CEMENTED, (folder / "1", folder / "2"))
	engines = list(O.engines)
	O.engines = [yade.NewtonIntegrator(damping=DAMP, warnNoForceReset=False)]
	O.step()
	O.engines = engines
	motions = [motion(O)]
	for _ in range(100):
		O.step()
	motions.append(motion(O))
	O.reset()
	return folder / "1", folder / "2", motions


def motion(O):
	"""Places and velocities of the balls."""
	return numpy.array([[*body.state.pos, *body.state.vel] for body in O.bodies if isinstance(body.shape, yade.Sphere)])


# The laws, contact by contact


def test_sameLawInEachContact(O, exported):
	"""A state that these laws made is told to be theirs, to rounding."""
	state = tables.read(exported[0])
	found = comparison.compare(state)
	names = {quantity.name for quantity in found.quantities}
	assert len(state.contacts) > 30 and found.left == {} and found.beyond(1e-9) == 0
	assert {"gap, by radii", "normal force, kn u", "shear force within mu Fn"} <= names and names & {"rolling moment within its limit", "bond holds", "parallel bond holds"}


def test_incrementsOfACycle(O, exported):
	"""From one export to the next: the shear force's and the moment's increments are this law's."""
	found = comparison.compare(tables.read(exported[0]), tables.read(exported[1]))
	(shear,) = [quantity for quantity in found.quantities if quantity.name == "shear force of the step"]
	before = numpy.linalg.norm(scenes.split(tables.read(exported[0]).contacts)[1], axis=1)
	assert found.beyond(1e-6) == 0 and abs(shear.here[: len(before)] - before[: len(shear.here)]).max() > 1e-4


@pytest.mark.parametrize(
	"exported, column, factor, name",
	[
		(ROLLING, "fx", 1.01, "normal force, kn u"),
		(ROLLING, "fric", 1e-3, "shear force within mu Fn"),
		(ROLLING, "gap", 1.01, "gap, by radii"),
		(ROLLING, "rr_kr", 1.01, "rolling stiffness, ks Rm^2"),
		(ROLLING, "rr_fric", 1e-6, "rolling moment within its limit"),
		(BONDED, "emod", 1.01, "kn, by emod"),
		(BONDED, "cb_shearf", 1e-9, "bond holds"),
		(CEMENTED, "pb_mcf", 0.5, "parallel bond's normal stress"),
		(CEMENTED, "pb_tau", 1.01, "parallel bond's shear stress"),
		(CEMENTED, "pb_coh", 1e-9, "parallel bond holds"),
	],
	indirect=["exported"],
)
def test_otherLawIsFound(O, exported, column, factor, name):
	"""A number of the table that is not this law's is told, with the contact."""
	state = tables.read(exported[0])
	if column == "emod":
		state.contacts.columns["emod"] = state.contacts["kn"] / comparison.units(state)
		assert comparison.compare(state).beyond(1e-9) == 0
		O.reset()
	table = state.bonds if column.startswith("pb_") else state.contacts
	table.columns[column] = table[column] * factor
	found = comparison.compare(state)
	(quantity,) = [quantity for quantity in found.quantities if quantity.name == name]
	assert (quantity.difference > 1e-6).any()
	assert any(line.startswith(f"{name}: contact ") and " there, " in line for line in found.lines(1e-6))


def test_whatCannotBeCompared(O, exported):
	state = tables.read(exported[0])
	state.contacts["model"][:2] = ["hertz", "softbond"]
	for name, place, value in (("dp_nratio", 2, 0.2), ("lin_mode", 3, 1), ("rgap", 4, 1e-6)):
		state.contacts[name][place] = value
	found = comparison.compare(state)
	assert sum(found.left.values()) == 5 and len(found.left) == 5 and "model hertz" in found.left
	assert "left out 5; 1: model hertz" in found.lines(1e-6)[1]


@pytest.mark.parametrize("exported", [ROLLING], indirect=True)
def test_forcesOnTheOtherEnd(O, exported):
	"""An export that tells forces on end 1 is turned, and that is told."""
	state = tables.read(exported[0])
	for name in ("fx", "fy", "fz", "mx", "my", "mz"):
		state.contacts.columns[name] = -state.contacts[name]
	found = comparison.compare(state)
	assert found.beyond(1e-9) == 0 and "so the table has them on end 1" in found.lines(1e-6)[2]


def test_tablesOfEitherTier(O, tier, tmp_path):
	"""After whole steps the places are those that the forces were computed for; balls alone may be chosen."""
	contactScene.springs(rollingFriction=0.2)
	for place in range(3):
		contactScene.sphere((0, 0, 1.99e-3 * place), 1e-3)
		O.bodies[-1].state.vel, O.bodies[-1].state.angVel = (5e-3 * place, 0, -0.1), (0, 10, 0)
	contactScene.floor(1.0, 0.1, (0, 0, -0.99e-3))
	cement = yade.GrainBonds(kn=1e10, ks=4e9, tensileStrength=1e9, cohesion=1e9)
	assert cement.bond(range(3)) == 2
	O.engines = tiers.engines(tier, [cement])
	O.dt = 1e-6
	tiers.run(20)
	places = [body.state.pos for body in O.bodies]
	scenes.write(tmp_path, ids=range(3))
	assert [body.state.pos for body in O.bodies] == places
	force = {tuple(ids): tuple(force) for ids, force in zip(cement.bonds()["ids"].tolist(), cement.bonds()["force"].tolist())}
	O.reset()
	state = tables.read(tmp_path)
	found = comparison.compare(state)
	assert len(state.contacts) == 3 and len(state.walls) == 1 and found.left == {} and found.beyond(1e-6) == 0
	assert {(int(one), int(two)): tuple(load) for one, two, load in zip(state.bonds["end1"], state.bonds["end2"], state.bonds.vectors("pb_f").tolist())} == force
	scenes.write(tmp_path, ids=[0], moved=False)
	assert len(tables.read(tmp_path).balls) == 1


# Going on


def test_goesOnFromTheVeryState(O, exported):
	"""Balls, contacts, bonds and walls of the tables go on as those that the tables were written of."""
	state = tables.read(exported[1])
	bodies = continuation.resume(state, damping=DAMP)
	assert O.interactions.countReal() == len(state.contacts) and list(bodies.values()) == list(range(64))
	size = numpy.array(3 * [1e-3] + 3 * [SPEED])
	assert (abs(motion(O) - exported[2][0]) / size).max() < 1e-5
	for _ in range(100):
		O.step()
	assert (abs(motion(O) - exported[2][1]) / size).max() < 1e-2  # each step turns the loads: see exchangeScene
	assert O.materials["grain"].friction == pytest.approx(0.4) and O.materials["wall-64"].kn == pytest.approx(1e6)


def test_goesOnWithStiffnessByPair(O, tier, tmp_path):
	"""Two groups of grains and a floor: what contacts have beyond the rules of series and minimum, as by PFC's contact cmat, is that of the pair again."""
	for label, kn in (("soft", 1e5), ("stiff", 4e5), ("lone", 3e5)):
		contactScene.springs(kn, kn / 2, friction=0.3, label=label)
	contactScene.springs(2e5, 1e5, friction=0.2, label="floor")
	soft, stiff = (O.materials[label] for label in ("soft", "stiff"))
	soft.setPair("stiff", kn=3e6, ks=1e6, friction=0.6)
	soft.setPair("floor", kn=2e6, ks=1e6, friction=0.7)
	for place, label in enumerate(("soft", "soft", "stiff", "stiff")):
		O.bodies.append(utils.sphere((0, 0, 1.99e-3 * place), 1e-3, material=label))
	for x, label in ((4e-3, "stiff"), (8e-3, "soft")):
		O.bodies.append(utils.sphere((x, 0, 0), 1e-3, material=label))
	O.bodies.append(platen((0, 0, -0.999e-3), 0.1, 0.1, facing=1, material="floor"))
	O.engines = tiers.engines(tier)
	O.dt = 1e-7
	tiers.run(2)
	scenes.write(tmp_path)
	O.reset()
	state = tables.read(tmp_path)
	bodies = continuation.resume(state, damping=0.1)
	assert len(state.contacts) == 6 and O.materials["grain-soft"].pairFriction(O.materials["grain-stiff"]) == pytest.approx(0.6)
	assert set(O.materials["grain-soft"].pairs()) == {"grain-stiff", "wall-6"} and O.materials["grain-stiff"].pairs() == {}
	for row in range(6):
		first = bodies[state.contacts["end1"][row]]
		ball = state.contacts["kind"][row] == tables.BALL_BALL
		(phys,) = [contact.phys for contact in O.interactions if first in (contact.id1, contact.id2) and (bodies[state.contacts["end2"][row]] in (contact.id1, contact.id2) if ball else max(contact.id1, contact.id2) > 5)]
		assert (phys.kn, phys.ks, phys.tangensOfFrictionAngle) == pytest.approx([state.contacts[name][row] for name in ("kn", "ks", "fric")], rel=1e-9)
	state.balls["group"][4] = "lone"
	O.reset()
	with pytest.raises(ConfigError, match="balls of the group 'lone' touch no other balls"):
		continuation.resume(state)


@pytest.mark.parametrize(
	"table, column, values, message",
	[
		("contacts", "fric", [0.3], "fric is from 0.3 to 0.4 in contacts of grain and grain; fix: contacts of two groups"),
		("contacts", "model", ["hertz"], "has a contact model that is not here"),
		("balls", "vx", [math.nan], "has balls without vx"),
		("contacts", "kind", 500 * [tables.BALL_FACET], "has no contact of two balls"),
		("contacts", "kn", [4e7], r"kn/\(pi .* is from .* in contacts of grain and grain"),
	],
)
def test_cannotGoOn(O, exported, table, column, values, message):
	state = tables.read(exported[0])
	found = getattr(state, table).columns[column]
	place = state.contacts["kind"].index(tables.BALL_BALL)
	values = values[: len(found) - place]
	found[place : place + len(values)] = values
	with pytest.raises(ConfigError, match=message):
		continuation.resume(state)


def loadsByPair(table, letter):
	"""Loads of pairs of balls on the one with the higher number."""
	ends = numpy.column_stack([table["end1"], table["end2"]])
	signs = numpy.where(ends[:, :1] < ends[:, 1:], 1, -1)
	pairs = numpy.array([kind in ("", tables.BALL_BALL) for kind in table["kind"]], dtype=bool)
	return {tuple(sorted(pair)): load for pair, load in zip(ends[pairs].tolist(), (signs * table.vectors(letter))[pairs])}


@pytest.mark.parametrize("exported", [CEMENTED], indirect=True)
def test_bondsComeBack(O, exported, tmp_path):
	"""A sheared cemented state, written, read and written again: forces and moments of contacts and bonds are the same to rounding."""
	state = tables.read(exported[1])
	bonds = state.bonds
	assert 20 < len(bonds) and {*state.contacts["model"]} == {"linear", tables.PARALLEL} and (bonds["pb_ten"] == math.inf).any() and (bonds["pb_fa"] > 0).any()
	assert (numpy.linalg.norm(bonds.vectors("pb_m"), axis=1) > 0).all() and not set(bonds["id"]) <= set(state.contacts["id"])
	continuation.resume(state, damping=DAMP)
	scenes.write(tmp_path)
	again = tables.read(tmp_path)
	for name, letter in (("contacts", "f"), ("bonds", "pb_f"), ("bonds", "pb_m")):
		there, here = (loadsByPair(getattr(one, name), letter) for one in (state, again))
		size = max(numpy.linalg.norm(load) for load in there.values())
		assert len(there) > 20 and there.keys() == here.keys() and max(abs(there[pair] - here[pair]).max() for pair in there) < 1e-12 * size
	strengths = [sorted(zip(*(one.bonds[name].tolist() for name in ("pb_ten", "pb_coh", "pb_fa", "pb_mcf")))) for one in (state, again)]
	assert strengths[0] == pytest.approx(strengths[1])


# Tables


@pytest.mark.parametrize(
	"name, old, new, message",
	[
		("balls", "hexmembrane-tables=1", "hexmembrane-tables=2", "balls.csv = .*: is balls of format 2; fix: balls of format 1: export it anew"),
		("balls", "# hexmembrane", "hexmembrane", "its first line .* names no format"),
		("balls", "cycle=1", "cycle=9", "the tables are of different cycles, balls of 9, contacts of 1"),
		("balls", ",r,", ",s,", "line 2: no column r"),
		("contacts", "ball-ball", "ball-pebble", r"line \d+: kind = 'ball-pebble'; fix: ball-ball or ball-facet; clumps are not known here"),
		("contacts", r"ball-ball,(\d+),\d+,", r"ball-ball,\1,\1,", r"line \d+: balls \d+ and \d+ are one; fix: each pair of balls once"),
		("contacts", r"\n(\d+,ball-ball,.*)", r"\n\1\n\1", r"line \d+: balls \d+ and \d+ are in line \d+ already"),
		("contacts", "ball-ball,", "ball-ball,9", r"line \d+: there is no ball 9"),
		("contacts", ",linear", ",x,linear", r"line \d+: has 32 columns, the header 31"),
		("contacts", r"ball-ball,\d+,", "ball-ball,one,", "line .*: end1 = 'one' is no number"),
		("contacts", ",linear,", ",linearpbond,", "bonds.csv = .*: is missing, and contacts.csv has the model linearpbond in line 3; fix: export it anew"),
	],
)
def test_wrongTable(exported, tmp_path, name, old, new, message):
	for other in ("balls", "contacts", "walls"):
		text = (exported[0] / f"{other}.csv").read_text()
		(tmp_path / f"{other}.csv").write_text(re.sub(old, new, text, count=1) if other == name else text)
	with pytest.raises(ConfigError, match=message):
		tables.read(tmp_path)


def test_noTable(tmp_path):
	with pytest.raises(ConfigError, match="balls.csv = .*: cannot be read .*; fix: give the folder"):
		tables.read(tmp_path)


def test_ballsAreASpecimen(exported, tmp_path):
	"""The exported balls are a table that specimen.balls takes."""
	config = Config.of({**TINY, "specimen": {"balls": str(exported[0] / "balls.csv")}}, tmp_path)
	assert config.specimen.radius == pytest.approx(6e-3, rel=0.5)


def test_tableOfColumns():
	"""The files' columns as the documentation has them."""
	assert tables.markdown() in (ROOT / "examples" / "pfc" / "states.md").read_text(encoding="utf-8")


# Exporters


@pytest.mark.parametrize("exported, facetsFirst", [(ROLLING, False), (BONDED, True), (CEMENTED, True)], indirect=["exported"])
def test_exporterInPfc(exported, tmp_path, monkeypatch, capsys, facetsFirst):
	"""The exporter, run on a stand-in of PFC's module with the state's numbers, writes the state's tables."""
	state = tables.read(exported[0])
	monkeypatch.setitem(sys.modules, "itasca", standInItasca.made(state, facetsFirst))
	spec = importlib.util.spec_from_file_location("export_pfc", EXPORTER)
	exporter = importlib.util.module_from_spec(spec)
	spec.loader.exec_module(exporter)
	written = exporter.export(str(tmp_path))
	lone = ~numpy.isin(state.bonds["id"], state.contacts["id"])  # PFC has a contact for each bond
	state.bonds = tables.Table(state.bonds.head, {name: column[~lone] for name, column in state.bonds.columns.items()}, state.bonds.lines[: (~lone).sum()])
	assert written == {"balls": 64, "contacts": len(state.contacts), "bonds": len(state.bonds), "walls": 2, "measures": 1} and "left out {'BallPebbleContact': 1}" in capsys.readouterr().out
	again = tables.read(tmp_path)
	for name in ("balls", "contacts", "bonds", "walls"):
		there, here = getattr(state, name), getattr(again, name)
		assert [there.head[key] for key in ("cycle", "timestep", "time")] == [here.head[key] for key in ("cycle", "timestep", "time")]
		for column in tables.COLUMNS[name]:
			if isinstance(there[column], list):
				assert there[column] == here[column]
			else:
				size = abs(there[column][numpy.isfinite(there[column])]).max(initial=0)
				numpy.testing.assert_allclose(here[column], there[column], rtol=1e-12, atol=1e-15 * size, err_msg=column)
	assert again.measures["sxx"] == [-1e5] and numpy.isnan(again.measures["syy"]).all()


def test_exportersWriteTheColumns():
	"""Both exporters name the columns that are read, in their order; the one in Python is sound for PFC 5's Python 2.7."""
	python, fish = (EXPORTER.with_suffix(suffix).read_text(encoding="utf-8") for suffix in (".py", ".fis"))
	for name, wanted in tables.COLUMNS.items():
		assert ",".join(wanted) in python and ",".join(wanted) in fish.replace("' + '", "").replace("emod,')\n", "").replace("emod,'\n    hx_begin('contacts',first + '", "emod,")
	assert f"VERSION = {tables.VERSION}" in python and f"hexmembrane-tables={tables.VERSION} " in fish
	assert not re.search(r"\bf['\"]|:=|nonlocal|print [^(]", python)
	assert fish.count("\ndefine ") == fish.count("\nend\n") + (not fish.endswith("\nend\n"))


# The command


def test_command(O, exported, tmp_path, capsys):
	state = tmp_path / "on.yade.gz"
	assert command.main([str(exported[0]), "--next", str(exported[1]), "--state", str(state), "--damping", "0.2"]) == 0
	said = capsys.readouterr().out
	assert re.search(r"64 balls, \d+ contacts: \d+ of balls, \d+ with walls(; \d+ parallel bonds)?; cycle 2", said) and said.endswith("equal within 1e-06\n") and state.is_file()
	assert command.main([str(exported[0]), "--tolerance", "1e-18"]) == 1 and "differs: " in capsys.readouterr().out
	assert command.main([str(tmp_path)]) == 2 and "balls.csv" in capsys.readouterr().err
	assert command.main([str(exported[0]), "--next", str(exported[0])]) == 2 and "fix: export, one cycle, export" in capsys.readouterr().err
	assert command.main([str(exported[0]), "--state", str(tmp_path / "on.txt")]) == 2
	O.load(str(state), quiet=True)
	O.step()
	assert len(O.bodies) > 64
