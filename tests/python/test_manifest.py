# SPDX-License-Identifier: GPL-2.0-or-later
"""The manifest of an output folder: whole or refused, value by value; which checkpoint is used; whose files are whose; one run a folder."""

import copy
import fcntl
import hashlib
import json
import os
import random

import pytest
from hexmembrane.configuration import ConfigError
from hexmembrane.output.records import Records
from hexmembrane.run import checkpoints, manifest
from hexmembrane.run.checkpoints import Store
from hexmembrane.run.lock import FolderLock, LockError
from hexmembrane.run.manifest import Checkpoint, CheckpointError, Entry
from test_records import rowOf

#: Mutations of the fuzzer; HEXMEMBRANE_FUZZ makes it so many.
MUTATIONS = int(os.environ.get("HEXMEMBRANE_FUZZ", 5000))
REFERENCE = {"height": 0.1, "radius": 0.02, "volume": 1e-4, "energies": dict.fromkeys(("elastic", "membrane", "kinetic", "friction", "damping", "work"), 0.5)}


def add(store, made, stage="shear", name=None):
	"""A checkpoint with a state of its own after the rows so far."""
	state = store.stateName(name)
	(store.folder / state).write_bytes(f"state {state} {made.size}".encode())
	entry = manifest.entry(store.folder / state)
	store.add(Checkpoint(state, stage, 7, {"step": 3, "time": 0.5, "strain": 0.0}, Entry(made.position(), made.sha256), [[0.25, 0]], REFERENCE, 1.5), entry)
	return state


@pytest.fixture
def folder(tmp_path):
	"""A folder with three checkpoints after one row each, the first of them a kept one, and a row after the last."""
	(tmp_path / "config.yaml").write_text("a: 1\n")
	store = Store(tmp_path)
	store.seal("config.yaml", "packing.txt")
	with Records(tmp_path / "records.csv") as made:
		for k, name in enumerate(("consolidated", None, None)):
			made.append(rowOf(k))
			add(store, made, name=name)
		made.append(rowOf(3))
	return tmp_path


def sealed(content):
	body = json.dumps(content, indent=1).removesuffix("\n}").encode()
	return body + b',\n "sha256": "' + hashlib.sha256(body).hexdigest().encode() + b'"\n}\n'


def contentOf(folder):
	content = json.loads((folder / "manifest.json").read_text())
	del content["sha256"]
	return content


def test_roundTrip(folder):
	found = manifest.read(folder)
	assert set(found.files) == {"config.yaml"} and set(found.states) == {"consolidated.yade.gz", "checkpoint-1.yade", "checkpoint-2.yade"}
	assert [c.state for c in found.checkpoints] == ["checkpoint-1.yade", "checkpoint-2.yade"]
	assert found.checkpoints[1].reference == REFERENCE and found.versions["hexmembrane"]
	store = Store.existing(folder)
	assert checkpoints.exist(folder)
	assert store.last().rows == 3 and store.last().last == rowOf(2) and store.last().warnings == []
	names = ["checkpoint-1.yade", "checkpoint-2.yade", "config.yaml", "consolidated.yade.gz", "manifest.json", "records.csv"]
	assert sorted(p.name for p in folder.iterdir()) == names


def test_ofAnotherVersion(folder):
	content = contentOf(folder)
	content["versions"] = {"hexmembrane": "0.0.9"}
	(folder / "manifest.json").write_bytes(sealed(content))
	assert "the test was begun with hexmembrane 0.0.9, this is " in Store.existing(folder).last().warnings[0]


def test_twoAreKept(folder):
	store = Store.existing(folder)
	with Records(folder / "records.csv", store.last().checkpoint.records.size) as made:
		add(store, made)
	assert sorted(p.name for p in folder.glob("*.yade*")) == ["checkpoint-2.yade", "checkpoint-3.yade", "consolidated.yade.gz"]


def test_everyBitOfTheManifest(folder):
	"""A flipped bit anywhere in it is refused, and so is every beginning of it."""
	path = folder / "manifest.json"
	whole = path.read_bytes()
	for bit in range(8 * len(whole)):
		data = bytearray(whole)
		data[bit // 8] ^= 1 << bit % 8
		with pytest.raises(CheckpointError, match="manifest.json.*is damaged.*; fix: "):
			manifest.parse(bytes(data), path)
	for size in range(len(whole)):
		with pytest.raises(CheckpointError, match="is damaged"):
			manifest.parse(whole[:size], path)


def mutated(value, choice):
	"""A copy of nested JSON with one thing in it changed."""
	odd = (None, True, False, 0, -1, 1.5, 2**70, 10**400, 1e308, float("nan"), float("inf"), "", "x", "../../a", "\0", "a/b", [], {}, [[]], {"a": 1}, "é" * 500)
	value = copy.deepcopy(value)
	places, todo = [], [value]
	while todo:
		parent = todo.pop()
		for key in parent if isinstance(parent, dict) else range(len(parent)):
			places.append((parent, key))
			if isinstance(parent[key], (dict, list)):
				todo.append(parent[key])
	parent, key = choice.choice(places)
	how = choice.randrange(4)
	if how == 0:
		del parent[key]
	elif how == 1 and isinstance(parent, dict):
		parent[choice.choice(["new", "state", "", "../x"])] = parent.pop(key)
	elif how == 2 and isinstance(parent, list):
		parent.insert(0, parent[key])
	else:
		parent[key] = copy.deepcopy(choice.choice([*odd, choice.choice(places)[0]]))
	return value


def test_wrongValues(folder):
	"""Whatever is in a manifest with a true checksum: it is refused with file, key, value and fix, or it is a manifest."""
	whole, path = contentOf(folder), folder / "manifest.json"
	refused = 0
	for seed in range(MUTATIONS):
		try:
			text = sealed(mutated(whole, random.Random(seed)))
		except (ValueError, RecursionError):
			continue  # circular
		try:
			Store(folder, manifest.parse(text, path)).last()
		except CheckpointError as error:
			assert "fix: " in str(error) and str(folder) in str(error), seed
			refused += 1
	assert refused > 0.5 * MUTATIONS


@pytest.mark.parametrize(
	"key, value, message",
	[
		("format", 99, "format = 99: this version reads 2"),
		("states_version", 1, "states_version = 1: this version reads 3"),
		("checkpoints.0.stage", "rest 1", r"checkpoints\[0\].stage = 'rest 1': is no label of a stage"),
		("checkpoints.1.state", "gone.yade", r"checkpoints\[1\].state = 'gone.yade': is not one of the states"),
		("checkpoints.1.records", None, r"checkpoints\[1\].records = None: is no JSON object"),
		("checkpoints.1.reference.height", -1, r"reference.height = -1: is not a finite number >= "),
		("checkpoints.1.begun.step", 8, "is after the checkpoint's step 7"),
		("files.config\0yaml", {"size": 1, "sha256": 64 * "0"}, "is not the name of a file"),
	],
)
def test_wrongValueIsNamed(folder, key, value, message):
	content = contentOf(folder)
	parent, names = content, key.split(".")
	for name in names[:-1]:
		parent = parent[int(name) if isinstance(parent, list) else name]
	parent[int(names[-1]) if isinstance(parent, list) else names[-1]] = value
	(folder / "manifest.json").write_bytes(sealed(content))
	with pytest.raises(CheckpointError, match=message):
		manifest.read(folder)


def test_noneAndBefore(tmp_path):
	with pytest.raises(CheckpointError, match="there is none; fix: run without --resume"):
		manifest.read(tmp_path)
	assert not checkpoints.exist(tmp_path)
	(tmp_path / "checkpoint.json").write_text("{}")
	with pytest.raises(CheckpointError, match="checkpoint.json': is of a version before manifests.*fix: "):
		manifest.read(tmp_path)
	with pytest.raises(ConfigError, match="holds a test of a version before manifests"):
		Store.begin(tmp_path)


def damage(path):
	data = bytearray(path.read_bytes())
	data[len(data) // 2] ^= 4
	path.write_bytes(data)


@pytest.mark.parametrize("how", ["damaged", "shorter", "gone", "records"])
def test_theOneBeforeIsUsed(folder, how):
	"""A damaged checkpoint is told; the one before it goes on from its own rows."""
	store = Store.existing(folder)
	path = folder / "checkpoint-2.yade"
	if how == "damaged":
		damage(path)
	elif how == "shorter":
		path.write_bytes(path.read_bytes()[:-1])
	elif how == "gone":
		path.unlink()
	else:
		rows = (folder / "records.csv").read_bytes().split(b"\n")
		rows[3] = rows[3].replace(b"1", b"2", 1)
		(folder / "records.csv").write_bytes(b"\n".join(rows))
	found = store.last()
	assert found.checkpoint.state == "checkpoint-1.yade" and (found.rows, found.last) == (2, rowOf(1))
	assert len(found.warnings) == 1 and ("records.csv" if how == "records" else "checkpoint-2.yade") in found.warnings[0]
	assert "the checkpoint before, at step 7, is used" in found.warnings[0]
	store.goOnFrom(found)
	assert [c.state for c in store.manifest.checkpoints] == ["checkpoint-1.yade"] and store.stateName() == "checkpoint-3.yade"


def test_noneIsWhole(folder):
	damage(folder / "checkpoint-2.yade")
	(folder / "checkpoint-1.yade").unlink()
	with pytest.raises(CheckpointError, match="no checkpoint is whole .*checkpoint-2.yade' is not as it was written.*checkpoint-1.yade' is missing.*; fix: "):
		Store.existing(folder).last()


def test_withoutRows(folder):
	(folder / "records.csv").unlink()
	with pytest.raises(CheckpointError, match="no checkpoint is whole .*records.csv': has 0 bytes, its checkpoint was taken at"):
		Store.existing(folder).last()


def test_whatIsNotNeeded(folder):
	"""A damaged state that the test does not need is told, the configuration is required."""
	store = Store.existing(folder)
	store.require("config.yaml")
	damage(folder / "consolidated.yade.gz")
	assert "consolidated.yade.gz' is not as it was written" in store.last().warnings[0]
	damage(folder / "config.yaml")
	with pytest.raises(CheckpointError, match="config.yaml': is not as it was written.*fix: "):
		store.require("config.yaml")
	with pytest.raises(CheckpointError, match="packing.txt': is not in the manifest"):
		store.require("packing.txt")


@pytest.mark.parametrize("name", ["config.yaml", "packing.txt", "records.csv", "test.png", "sheared.yade.gz", "vtk/a.vtp"])
def test_filesOfOthersStay(tmp_path, name):
	path = tmp_path / name
	path.parent.mkdir(exist_ok=True)
	path.write_text("mine")
	with pytest.raises(ConfigError, match=f"has a file {name.split('/')[0]} already.*; fix: choose another folder, or move"):
		Store.begin(tmp_path)
	assert path.read_text() == "mine" and not (tmp_path / "manifest.json").exists()


def test_begunAnew(tmp_path):
	"""What a run left that was stopped before its first checkpoint is written over; what is not ours stays."""
	(tmp_path / "notes.part").write_text("mine")
	Store.begin(tmp_path)
	for name in ("config.yaml", "packing.txt", "records.csv", "part-checkpoint-1.yade", "checkpoint-1.yade", "config.yaml.part"):
		(tmp_path / name).write_text("ours")
	Store.begin(tmp_path)
	assert sorted(p.name for p in tmp_path.iterdir()) == ["config.yaml", "manifest.json", "notes.part", "packing.txt", "records.csv"]


def test_aTestIsNotBegunOver(folder):
	with pytest.raises(ConfigError, match="holds a test already"):
		Store.begin(folder)


def test_lock(tmp_path):
	with FolderLock(tmp_path):
		text = (tmp_path / "run.lock").read_text()
		assert f"process {os.getpid()} on " in text
		with pytest.raises(LockError, match=f"process {os.getpid()} on .* since .* is in this folder; fix: "):
			FolderLock(tmp_path)
	assert not (tmp_path / "run.lock").exists()
	(tmp_path / "run.lock").write_text(text)  # as a kill leaves it
	FolderLock(tmp_path).release()
	(tmp_path / "run.lock").write_text("mine")
	with pytest.raises(LockError, match="is a file of somebody else; fix: "):
		FolderLock(tmp_path)
	assert (tmp_path / "run.lock").read_text() == "mine"


def test_lockOfAnOwnerWhoIsEnding(tmp_path, monkeypatch):
	"""A file that its owner has removed between opening and locking is no lock."""
	first, true = [], fcntl.flock

	def flock(file, how):
		if not first:
			first.append(file)
			(tmp_path / "run.lock").unlink()
		return true(file, how)

	monkeypatch.setattr(fcntl, "flock", flock)
	with FolderLock(tmp_path):
		assert (tmp_path / "run.lock").exists()


def test_differences():
	old = {"a": 1, "b": {"c": 2, "d": [1, 2]}, "e": 1}
	assert checkpoints.differences(old, old) == []
	assert checkpoints.differences(old, {"a": 1, "b": {"c": 3, "d": [1, 2]}, "f": 0}) == ["b.c", "e", "f"]
