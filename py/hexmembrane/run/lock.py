# SPDX-License-Identifier: GPL-2.0-or-later
"""One run a folder: a lock that the kernel gives back when its process ends, however it ends. Uses nothing of YADE.

The lock is flock's on ``run.lock``, a file that says host, process and start of its owner. A clean end removes the file; one that a kill has
left locks nothing.
"""

import datetime
import errno
import fcntl
import os
import pathlib
import socket
import sys

NAME = "run.lock"
_MAGIC = "hexmembrane: "
_LONGEST = 400
#: What a file system without locks answers.
_NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)


class LockError(RuntimeError):
	"""Another run is in the folder."""


class FolderLock:
	"""The lock of a folder, held until ``release()``, the end of a ``with`` or the end of the process.

	:param folder: existing folder.
	:raises LockError: another run holds it, or the file is somebody else's; the message names the owner.
	:raises OSError: the file cannot be written.
	"""

	def __init__(self, folder):
		self.path = pathlib.Path(folder) / NAME
		self._file = None
		while self._file is None:
			self._file = self._taken()
		os.ftruncate(self._file, 0)
		began = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds")
		text = f"{_MAGIC}process {os.getpid()} on {socket.gethostname()} since {began}\n"
		try:
			os.pwrite(self._file, text.encode(), 0)
		except OSError as error:
			self.release()
			raise OSError(error.errno, error.strerror, str(self.path)) from None

	def _taken(self):
		"""Descriptor of the locked file; None when its owner removed it meanwhile."""
		file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
		try:
			self._lock(file)
			said = os.pread(file, _LONGEST, 0)
			if said and not said.startswith(_MAGIC.encode()):
				raise LockError(f"lock = '{self.path}': is a file of somebody else; fix: choose another folder, or move it away")
			if self.path.exists() and os.path.samestat(os.fstat(file), os.stat(self.path)):
				return file
		except BaseException:
			os.close(file)
			raise
		os.close(file)
		return None

	def _lock(self, file):
		try:
			fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
		except BlockingIOError:
			owner = os.pread(file, _LONGEST, 0).decode(errors="replace").removeprefix(_MAGIC).strip() or "another run"
			raise LockError(f"--out = '{self.path.parent}': {owner} is in this folder; fix: wait for it, end it, or choose another folder") from None
		except OSError as error:
			if error.errno not in _NO_LOCKS:
				raise
			print(f"WARNING: lock = '{self.path}': this file system has no locks; take care that no other run is in the folder", file=sys.stderr)

	def release(self):
		if self._file is None:
			return
		try:
			self.path.unlink(missing_ok=True)
		except OSError:
			pass  # a folder that has become read-only: the file locks nothing
		os.close(self._file)
		self._file = None

	def __enter__(self):
		return self

	def __exit__(self, *_):
		self.release()
