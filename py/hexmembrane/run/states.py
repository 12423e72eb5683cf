# SPDX-License-Identifier: GPL-2.0-or-later
"""Saved states of YADE, on the way between memory and files.

YADE itself reads and writes a file in memory only. Its own writing of a compressed file does not end on a full disk, it may lose the end of an
uncompressed one unseen, and a damaged state may end the process. So Python writes the files, and checks them before YADE sees them.
"""

import errno
import gzip
import hashlib
import os
import pathlib
import resource
import sys
import zlib

from yade import O

from hexmembrane.run import manifest
from hexmembrane.run.manifest import CheckpointError, Entry

_COMPRESSED = ".gz"
#: Boost's archives have this near their beginning.
_SIGNATURE = b"serialization::archive"
_BLOCK = 1 << 18


class Image:
	"""A state in a file in memory, which is freed at the end of a ``with``."""

	def __init__(self):
		self._file = os.memfd_create("state")

	@classmethod
	def taken(cls):
		"""Of the scene in ``O``. :raises OSError: the process may not write as much."""
		image = cls()
		try:
			O.save(image._path, quiet=True)
			if os.fstat(image._file).st_size == resource.getrlimit(resource.RLIMIT_FSIZE)[0]:
				raise RuntimeError("the limit of a file's size is reached")
		except RuntimeError as error:
			image.close()
			raise OSError(errno.EFBIG, f"YADE cannot save its state: {error}", "a state in memory") from None
		return image

	@classmethod
	def read(cls, path, expected=None):
		"""Of a file ``.yade`` or ``.yade.gz``; ``expected``: its Entry, None when nothing is known but what gzip knows.

		:raises CheckpointError: the file is missing, not as expected, damaged or no state.
		"""
		path = pathlib.Path(path)
		image = cls()
		try:
			image._fill(path, expected)
		except BaseException:
			image.close()
			raise
		return image

	@property
	def _path(self):
		# without a suffix, so YADE neither compresses nor takes it for XML
		return f"/proc/self/fd/{self._file}"

	def _fill(self, path, expected):
		try:
			with open(path, "rb", buffering=0) as file:
				source = _Hashed(file)
				plain = gzip.GzipFile(fileobj=source) if path.name.endswith(_COMPRESSED) else source
				first = b""
				while block := plain.read(_BLOCK):
					first = first or block[:100]
					_writeAll(self._file, block)
				source.read()  # what follows a compressed state counts too
		except FileNotFoundError:
			raise CheckpointError(f"state = '{path}': there is no such file; fix: correct the path") from None
		except (gzip.BadGzipFile, EOFError, zlib.error) as error:
			raise CheckpointError(f"state = '{path}': is damaged ({error}); fix: give the file as it was written") from None
		except OSError as error:
			raise CheckpointError(f"state = '{path}': cannot be read ({error.strerror}); fix: make it readable") from None
		if expected is not None and source.entry() != expected:
			raise CheckpointError(f"state = '{path}': is not as it was written (its SHA-256 differs); fix: give the file as it was written")
		if _SIGNATURE not in first:
			raise CheckpointError(f"state = '{path}': is no state of YADE; fix: give a .yade or .yade.gz that was saved by this version")

	def load(self, path):
		"""Into ``O``; ``path``: what a message names. :raises CheckpointError: YADE cannot read it."""
		try:
			O.load(self._path, quiet=True)
		except RuntimeError as error:
			raise CheckpointError(f"state = '{path}': YADE cannot read it ({error}); fix: give a state saved by the same version") from None

	def write(self, path):
		"""Onto the disk, compressed where the name says so: temporary name, disk, rename; returns its Entry. :raises OSError: with the file's name."""
		path = pathlib.Path(path)
		part = path.with_name("part-" + path.name)
		try:
			with open(part, "wb", buffering=0) as file:
				target = _Hashed(file)
				if path.name.endswith(_COMPRESSED):
					with gzip.GzipFile(filename="", fileobj=target, mode="wb", compresslevel=6, mtime=0) as packer:
						self._copy(packer)
				else:
					self._copy(target)
				os.fsync(file.fileno())
			part.replace(path)
		except OSError as error:
			_remove(part)
			raise OSError(error.errno, error.strerror, str(path)) from None
		return target.entry()

	def _copy(self, target):
		done = 0
		while block := os.pread(self._file, _BLOCK, done):
			target.write(block)
			done += len(block)

	def close(self):
		os.close(self._file)

	def __enter__(self):
		return self

	def __exit__(self, *_):
		self.close()


class _Hashed:
	"""What is read from or written to a file, hashed on its way."""

	def __init__(self, file):
		self._file, self._digest, self._size = file, hashlib.sha256(), 0

	def _count(self, block):
		self._digest.update(block)
		self._size += len(block)

	def read(self, size=-1):
		block = self._file.read(size)
		self._count(block)
		return block

	def write(self, block):
		_writeAll(self._file.fileno(), block)
		self._count(block)
		return len(block)

	def flush(self):
		"""Nothing is kept back."""

	def entry(self):
		return Entry(self._size, self._digest.hexdigest())


def _writeAll(file, block):
	"""All of it: the system may write a part, the rest then fails with its reason."""
	left = memoryview(block)
	while left:
		left = left[os.write(file, left) :]


def _remove(path):
	try:
		path.unlink(missing_ok=True)
	except OSError:
		pass  # the first error is the one to tell


def load(path):
	"""Put a saved state into ``O``, checked against the manifest beside it where that names it, else against gzip's own checksum.

	:raises CheckpointError: no such file, damaged, no state, or the manifest beside it is damaged.
	"""
	path = pathlib.Path(path)
	expected = None
	if (path.parent / manifest.NAME).exists():
		expected = manifest.read(path.parent).states.get(path.name)
	with Image.read(path, expected) as image:
		if expected is None and not path.name.endswith(_COMPRESSED):
			print(f"WARNING: state = '{path}': has no checksum, so it could not be verified", file=sys.stderr)
		image.load(path)
