# SPDX-License-Identifier: GPL-2.0-or-later
"""The files of an output folder: may a test begin here, from where does it go on, what is written at a checkpoint. Uses nothing of YADE.

Order of a checkpoint: its state, its rows, the manifest. What the manifest does not name yet does not count, so a kill between two of them
leaves the checkpoint before.
"""

import errno
import pathlib
import re

from hexmembrane.configuration import ConfigError
from hexmembrane.output import records
from hexmembrane.run import manifest
from hexmembrane.run.manifest import KEPT, CheckpointError, Manifest

RECORDS = "records.csv"
PICTURE, REPORT = "test.png", "report.html"
#: What ``measure`` writes, and all that a test writes besides manifest, lock and checkpoints.
_INSIDE = ("regions.csv", "profile.csv", "bands.csv", "fields.h5")
_OWN = ("config.yaml", "packing.txt", RECORDS, PICTURE, REPORT, "vtk", *_INSIDE, "generated.yade.gz", "consolidated.yade.gz", "sheared.yade.gz", "checkpoint.json")
_NUMBERED = re.compile(r"checkpoint-([0-9]+)\.yade")
#: Names under which files are written before they are renamed.
_PARTS = ("part-*.yade", "part-*.yade.gz", "config.yaml.part", "packing.txt.*.part", "test.png.part", "report.html.part", "fields.h5.part", "manifest.json.part", "vtk/*.part")

_REASONS = {
	errno.ENOSPC: "free space on the disk",
	errno.EDQUOT: "free space within your quota",
	errno.EFBIG: "raise the limit of a file's size (ulimit -f)",
	errno.EROFS: "make the folder writable",
	errno.EACCES: "make the folder writable",
	errno.EPERM: "make the folder writable",
	errno.ENOENT: "the folder or file was removed or renamed: put it back",
	errno.ENOTDIR: "the folder was replaced by a file: put it back",
}


class FolderError(RuntimeError):
	"""The folder cannot be written any more: full, removed, read-only, broken."""

	def __init__(self, error, folder, safe):
		path = error.filename or folder
		fix = _REASONS.get(error.errno, "see that the folder can be written")
		after = "; then --resume goes on from the last checkpoint" if safe else ""
		super().__init__(f"file = '{path}': cannot be written ({error.strerror or error}); fix: {fix}{after}")


class Resumed:
	"""A checkpoint that was found whole.

	Attributes: ``checkpoint``; ``rows``, of its stage so far; ``last``, the last row (by column), None without rows; ``warnings``, texts.
	"""

	def __init__(self, checkpoint, kept, warnings):
		self.checkpoint, self.warnings = checkpoint, warnings
		self.rows, self.last = kept.count(checkpoint.stage), kept.last()


class Store:
	"""The files of one folder, held by one run.

	:param folder: existing folder, locked by the caller where others may come.
	:param content: its :class:`hexmembrane.run.manifest.Manifest`; None: an empty one.
	"""

	def __init__(self, folder, content=None):
		self.folder = pathlib.Path(folder)
		self.manifest = Manifest() if content is None else content

	@classmethod
	def begin(cls, folder):
		"""For a test that begins; files of a run that ended before its first checkpoint are given up, those of others are refused.

		:raises ConfigError: the folder holds a test, or files that the test would write over.
		:raises CheckpointError: its manifest is damaged or of another version.
		"""
		folder = pathlib.Path(folder)
		if (folder / manifest.NAME).exists():
			found = manifest.read(folder)
			if found.checkpoints or found.files:
				raise ConfigError("--out", str(folder), "holds a test already", "choose another folder, empty this one, or give --resume")
			cls(folder).removeLeft()
		else:
			_refuseForeign(folder)
		made = cls(folder)
		made.write()
		return made

	@classmethod
	def existing(cls, folder):
		""":raises CheckpointError: there is no manifest, or a wrong one."""
		return cls(folder, manifest.read(folder))

	@property
	def begun(self):
		"""Whether there is a checkpoint."""
		return bool(self.manifest.checkpoints)

	def seal(self, *names):
		"""Take files that are written once into the manifest, which the next checkpoint writes."""
		self.manifest.files.update({name: manifest.entry(self.folder / name) for name in names if (self.folder / name).is_file()})

	def write(self):
		manifest.write(self.folder, self.manifest)

	def require(self, name):
		""":raises CheckpointError: a file of the manifest is missing or not as it was written."""
		entry = self.manifest.files.get(name)
		wrong = "is not in the manifest" if entry is None else entry.fault(self.folder / name)
		if wrong:
			raise CheckpointError(f"file = '{self.folder / name}': {wrong}; fix: put it back as it was, or run without --resume in another folder")

	def last(self):
		"""The last checkpoint that is whole, as :class:`Resumed`; nothing is changed.

		:raises CheckpointError: none is; the message says what is wrong with each.
		"""
		faults = []
		for checkpoint in reversed(self.manifest.checkpoints):
			wrong, kept = self._fault(checkpoint)
			if not wrong:
				used = f"; the checkpoint before, at step {checkpoint.step}, is used"
				return Resumed(checkpoint, kept, [fault + used for fault in faults] + self._unused(checkpoint) + self._others())
			faults.append(wrong)
		raise CheckpointError(
			f"checkpoint = '{self.folder}': no checkpoint is whole ({'; '.join(faults)}); "
			"fix: put the files back as they were, or run without --resume in another folder"
		)

	def _fault(self, checkpoint):
		"""(what is wrong with a checkpoint or '', its rows as :class:`hexmembrane.output.records.Kept`)."""
		path = self.folder / checkpoint.state
		if wrong := self.manifest.states[checkpoint.state].fault(path):
			return f"state '{path}' {wrong}", None
		path, expected = self.folder / RECORDS, checkpoint.records
		try:
			kept = records.Kept(path, expected.size)
			if kept.sha256 != expected.sha256:
				return f"'{path}' is not as it was written up to the checkpoint (its SHA-256 differs)", None
			kept.last()
			return "", kept
		except ValueError as error:
			return str(error), None

	def _unused(self, checkpoint):
		"""Warnings of damaged files that the test does not need to go on; removed ones are nobody's fault."""
		others = {**self.manifest.files, **self.manifest.states}
		needed = {checkpoint.state, *(other.state for other in self.manifest.checkpoints)}
		paths = {name: self.folder / name for name in others if name not in needed}
		faults = {name: others[name].fault(path) for name, path in paths.items() if path.exists()}
		return [f"file '{paths[name]}' {wrong}; the test goes on without it" for name, wrong in faults.items() if wrong]

	def _others(self):
		now, before = Manifest().versions, self.manifest.versions
		return [f"the test was begun with {name} {before.get(name)}, this is {now[name]}" for name in now if before.get(name) != now[name]]

	def goOnFrom(self, resumed):
		"""Give up checkpoints after this one, and what earlier runs have left unfinished."""
		checkpoints = self.manifest.checkpoints
		self.manifest.checkpoints = checkpoints[: checkpoints.index(resumed.checkpoint) + 1]
		self.removeLeft()

	def stateName(self, name=None):
		"""Of the next state to write: ``name``.yade.gz, or one that no checkpoint in the folder has."""
		if name:
			return f"{name}.yade.gz"
		numbers = [int(found[1]) for found in map(_NUMBERED.fullmatch, self.manifest.states) if found]
		return f"checkpoint-{max(numbers, default=0) + 1}.yade"

	def isLast(self, state, step, size):
		"""Whether this state, at this step and with so many bytes of rows, is the last checkpoint already."""
		last = self.manifest.checkpoints[-1:]
		return bool(last) and (last[0].state, last[0].step, last[0].records.size) == (state, step, size)

	def add(self, checkpoint, entry):
		"""Make a checkpoint, whose state is on the disk, the last one; states that are no longer needed go."""
		self.manifest.states[checkpoint.state] = entry
		before = [other for other in self.manifest.checkpoints if other.state != checkpoint.state]
		self.manifest.checkpoints = [*before, checkpoint][-KEPT:]
		needed = {other.state for other in self.manifest.checkpoints}
		gone = [name for name in self.manifest.states if _NUMBERED.fullmatch(name) and name not in needed]
		for name in gone:
			del self.manifest.states[name]
		self.write()
		for name in gone:
			(self.folder / name).unlink(missing_ok=True)

	def removeLeft(self):
		"""Remove what runs that were stopped while writing have left, and checkpoints that the manifest does not name."""
		left = [path for pattern in _PARTS for path in self.folder.glob(pattern)]
		left += [path for path in self.folder.glob("checkpoint-*.yade") if _NUMBERED.fullmatch(path.name) and path.name not in self.manifest.states]
		for path in left:
			path.unlink(missing_ok=True)


def _refuseForeign(folder):
	for name in _OWN:
		path = folder / name
		if path.is_dir() and not any(path.iterdir()):
			continue
		if path.exists() or path.is_symlink():
			what = "holds a test of a version before manifests" if name == "checkpoint.json" else f"has a file {name} already, which no test of ours has begun"
			raise ConfigError("--out", str(folder), what, f"choose another folder, or move {name} away")


def exist(folder):
	"""Whether a folder has a test to resume: a checkpoint, or a damaged manifest, which --resume then tells."""
	try:
		return (pathlib.Path(folder) / manifest.NAME).exists() and bool(manifest.read(folder).checkpoints)
	except CheckpointError:
		return True


def differences(old, new, path=""):
	"""Key paths whose values differ between two nested dictionaries."""
	paths = []
	for name in sorted(set(old) | set(new)):
		at = f"{path}.{name}" if path else name
		a, b = old.get(name), new.get(name)
		if isinstance(a, dict) and isinstance(b, dict):
			paths += differences(a, b, at)
		elif a != b:
			paths.append(at)
	return paths
