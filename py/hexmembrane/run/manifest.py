# SPDX-License-Identifier: GPL-2.0-or-later
"""``manifest.json`` of an output folder: which files a test has written, their sizes and SHA-256, and its last two checkpoints. Uses nothing of YADE.

It is written last and whole, so a kill at any moment leaves the one before. Its last key is the SHA-256 of all bytes before that key.
One without checkpoints marks a folder in which a test was begun.
"""

import dataclasses
import hashlib
import json
import math
import os
import pathlib
import re
import sys
import typing

import hexmembrane

NAME = "manifest.json"
#: Of the manifest itself.
FORMAT = 2
#: Raised when states of before cannot be read any more. 3: materials have pairs.
STATES = 3
#: Checkpoints that are kept.
KEPT = 2
_STAGE = re.compile(r"generated|[a-z]{1,20}(-[0-9]{1,6})?")
_ENERGIES = ("elastic", "membrane", "kinetic", "friction", "damping", "work")
_STATE = re.compile(r"[a-z]{1,20}(-[0-9]{1,6})?\.yade\.gz|checkpoint-[0-9]{1,18}\.yade")
_SEAL = b',\n "sha256": "'
_BEFORE = "checkpoint.json"
_LARGEST = 2**63
_ANEW = "put the file back as it was, or run without --resume in another folder"


class CheckpointError(RuntimeError):
	"""A manifest, checkpoint or state that is missing, damaged, or of another version or test."""


@dataclasses.dataclass(frozen=True)
class Entry:
	"""What a file was when it was written: bytes and SHA-256 (hexadecimal)."""

	size: int
	sha256: str

	def fault(self, path):
		"""What is wrong with the file now, '' when it is as it was written."""
		try:
			found = entry(path)
		except OSError as error:
			return "is missing" if isinstance(error, FileNotFoundError) else f"cannot be read ({error.strerror})"
		if found.size != self.size:
			return f"has {found.size} bytes, {self.size} were written"
		return "" if found == self else "is not as it was written (its SHA-256 differs)"


@dataclasses.dataclass(frozen=True)
class Checkpoint:
	"""From where a test goes on.

	:param state: name of its state.
	:param stage: label of the stage, 'generated' before the first.
	:param step: YADE's step.
	:param begun: step, time [s] and axial strain at which the stage began.
	:param records: size and SHA-256 of records.csv at that moment.
	:param frames: (time [s], number) of each VTK frame.
	:param reference: fields of :class:`hexmembrane.measure.rows.Reference`.
	:param elapsed: wall clock so far [s].
	:param inside: what :meth:`hexmembrane.run.inside.Inside.position` gave, None: nothing was measured inside.
	"""

	state: str
	stage: str
	step: int
	begun: dict
	records: Entry
	frames: list
	reference: dict
	elapsed: float
	inside: typing.Optional[dict] = None


@dataclasses.dataclass
class Manifest:
	"""The checked content: ``files`` and ``states`` (name -> Entry), ``checkpoints`` (older first), ``versions`` of what wrote it."""

	files: dict = dataclasses.field(default_factory=dict)
	states: dict = dataclasses.field(default_factory=dict)
	checkpoints: list = dataclasses.field(default_factory=list)
	versions: dict = dataclasses.field(default_factory=lambda: _versions())


def _versions():
	found = {"hexmembrane": hexmembrane.__version__}
	if "yade.config" in sys.modules:
		found["yade"] = sys.modules["yade.config"].version
	return found


def entry(path):
	"""The :class:`Entry` of a file, which is on the disk when this returns. :raises OSError: it cannot be read."""
	digest, size = hashlib.sha256(), 0
	with open(path, "rb", buffering=0) as file:
		os.fsync(file.fileno())
		while block := file.read(1 << 20):
			digest.update(block)
			size += len(block)
	return Entry(size, digest.hexdigest())


def syncFolder(folder):
	"""What was renamed in the folder is on the disk when this returns."""
	handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
	try:
		os.fsync(handle)
	finally:
		os.close(handle)


def write(folder, manifest):
	"""Write the folder's manifest: temporary name, disk, rename. :raises OSError: with the file's name."""
	path = pathlib.Path(folder) / NAME
	content = {"format": FORMAT, "states_version": STATES, **dataclasses.asdict(manifest)}
	body = json.dumps(content, indent=1, allow_nan=False).removesuffix("\n}").encode()
	part = path.with_name(NAME + ".part")
	try:
		with open(part, "wb") as file:
			file.write(body + _SEAL + hashlib.sha256(body).hexdigest().encode() + b'"\n}\n')
			file.flush()
			os.fsync(file.fileno())
		part.replace(path)
		syncFolder(folder)
	except OSError as error:
		raise OSError(error.errno, error.strerror, str(path)) from None


def read(folder):
	"""The folder's manifest, checked.

	:raises CheckpointError: there is none, it is damaged or of another version, or a value in it is wrong; the message says key, value and fix.
	"""
	folder = pathlib.Path(folder)
	path = folder / NAME
	try:
		data = path.read_bytes()
	except FileNotFoundError:
		if (folder / _BEFORE).exists():
			raise CheckpointError(
				f"checkpoint = '{folder / _BEFORE}': is of a version before manifests, this one cannot go on from it; "
				"fix: run without --resume in another folder, or resume with the version that wrote it"
			) from None
		raise CheckpointError(f"manifest = '{path}': there is none; fix: run without --resume") from None
	except OSError as error:
		raise CheckpointError(f"manifest = '{path}': cannot be read ({error.strerror}); fix: make it readable") from None
	return parse(data, path)


def parse(data, path):
	"""The :class:`Manifest` that the bytes of the file ``path`` are. :raises CheckpointError: as :func:`read`."""
	body, seal, rest = data.rpartition(_SEAL)
	if not seal or rest != hashlib.sha256(body).hexdigest().encode() + b'"\n}\n':
		raise CheckpointError(f"manifest = '{path}': is damaged (it is not as it was written); fix: {_ANEW}")
	return _Reader(path).manifest(body + b"\n}")


class _Reader:
	"""From JSON to a :class:`Manifest`, each value checked."""

	def __init__(self, path):
		self.path = path

	def wrong(self, key, value, what, fix=_ANEW):
		raise CheckpointError(f"manifest = '{self.path}', {key} = {repr(value)[:60]}: {what}; fix: {fix}")

	def manifest(self, text):
		def unique(pairs):
			if len(dict(pairs)) < len(pairs):
				raise ValueError("a key stands twice")
			return dict(pairs)

		try:
			content = json.loads(text, object_pairs_hook=unique)
		except (ValueError, RecursionError) as error:
			raise CheckpointError(f"manifest = '{self.path}': is no JSON ({error}); fix: {_ANEW}") from None
		for key, version in (("format", FORMAT), ("states_version", STATES)):
			if not isinstance(content, dict) or content.get(key) != version or isinstance(content.get(key), bool):
				found = content.get(key) if isinstance(content, dict) else content
				self.wrong(key, found, f"this version reads {version}", "resume with the version that wrote it, or run without --resume in another folder")
		self.keys("", content, ("format", "states_version", "files", "states", "checkpoints", "versions"))
		versions = content["versions"]
		if not isinstance(versions, dict) or not all(isinstance(value, str) for value in versions.values()):
			self.wrong("versions", versions, "are not names with texts")
		states = self.entries("states", content["states"])
		for name in states:
			if not _STATE.fullmatch(name):
				self.wrong(f"states.{name}", name, "is no name of a state")
		checkpoints = content["checkpoints"]
		if not isinstance(checkpoints, list) or len(checkpoints) > KEPT:
			self.wrong("checkpoints", checkpoints, f"is not a list of {KEPT} at most")
		made = [self.checkpoint(f"checkpoints[{k}]", found, states) for k, found in enumerate(checkpoints)]
		return Manifest(self.entries("files", content["files"]), states, made, versions)

	def keys(self, key, value, names):
		if not isinstance(value, dict):
			self.wrong(key, value, "is no JSON object")
		for name in sorted(set(value) ^ set(names)):
			self.wrong(f"{key}.{name}".lstrip("."), value.get(name), "is missing" if name not in value else "is not known")

	def entries(self, key, value):
		if not isinstance(value, dict):
			self.wrong(key, value, "is no JSON object")
		for name in value:
			if not name or name != pathlib.PurePath(name).name or "\0" in name:
				self.wrong(f"{key}.{name}", name, "is not the name of a file in the folder")
		return {name: self.entry(f"{key}.{name}", found) for name, found in value.items()}

	def entry(self, key, value):
		self.keys(key, value, ("size", "sha256"))
		self.whole(f"{key}.size", value["size"])
		if not isinstance(value["sha256"], str) or not re.fullmatch("[0-9a-f]{64}", value["sha256"]):
			self.wrong(f"{key}.sha256", value["sha256"], "is no SHA-256")
		return Entry(value["size"], value["sha256"])

	def whole(self, key, value):
		if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < _LARGEST:
			self.wrong(key, value, "is not a whole number >= 0")

	def number(self, key, value, low=-math.inf):
		isNumber = isinstance(value, (int, float)) and not isinstance(value, bool)
		if not isNumber or abs(value) > sys.float_info.max or not low <= value < math.inf:
			self.wrong(key, value, "is not a finite number" + (f" >= {low:g}" if low > -math.inf else ""))

	def checkpoint(self, key, value, states):
		self.keys(key, value, [field.name for field in dataclasses.fields(Checkpoint)])
		if not isinstance(value["state"], str) or value["state"] not in states:
			self.wrong(f"{key}.state", value["state"], "is not one of the states")
		if not isinstance(value["stage"], str) or not _STAGE.fullmatch(value["stage"]):
			self.wrong(f"{key}.stage", value["stage"], "is no label of a stage, such as consolidation, shear, unloading-2")
		self.whole(f"{key}.step", value["step"])
		self.keys(f"{key}.begun", value["begun"], ("step", "time", "strain"))
		self.whole(f"{key}.begun.step", value["begun"]["step"])
		self.number(f"{key}.begun.time", value["begun"]["time"], 0)
		self.number(f"{key}.begun.strain", value["begun"]["strain"])
		if value["begun"]["step"] > value["step"]:
			self.wrong(f"{key}.begun.step", value["begun"]["step"], f"is after the checkpoint's step {value['step']}")
		self.frames(f"{key}.frames", value["frames"])
		self.reference(f"{key}.reference", value["reference"])
		self.number(f"{key}.elapsed", value["elapsed"], 0)
		if not (value["inside"] is None or isinstance(value["inside"], dict)):
			self.wrong(f"{key}.inside", value["inside"], "is no JSON object")
		return Checkpoint(**{**value, "records": self.entry(f"{key}.records", value["records"])})

	def frames(self, key, value):
		if not isinstance(value, list):
			self.wrong(key, value, "is no list")
		for k, frame in enumerate(value):
			if not isinstance(frame, list) or len(frame) != 2 or type(frame[1]) is not int or frame[1] != k:
				self.wrong(f"{key}[{k}]", frame, f"is not a time and the number {k}")
			self.number(f"{key}[{k}][0]", frame[0], 0)

	def reference(self, key, value):
		self.keys(key, value, ("height", "radius", "volume", "energies"))
		for name in ("height", "radius", "volume"):
			self.number(f"{key}.{name}", value[name], sys.float_info.min)
		self.keys(f"{key}.energies", value["energies"], _ENERGIES)
		for name, found in value["energies"].items():
			self.number(f"{key}.energies.{name}", found)
