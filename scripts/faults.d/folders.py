# SPDX-License-Identifier: GPL-2.0-or-later
"""folders.py FAULT NUMBER CONFIG WORK EXPECTED: one test on a small file system of its own, which fills up or becomes read-only.

Mounts in a mount namespace of this process, so nothing is seen from outside or left behind. Prints what is odd, nothing when all is well.
``full``: NUMBER is the size of the file system in KiB; ``read-only``: the rows after which it becomes so. EXPECTED: the folder of a whole test.
"""

import ctypes
import os
import pathlib
import sys

import tiny

_NEWNS, _NEWUSER = 0x00020000, 0x10000000
_RDONLY, _REMOUNT, _BIND, _REC, _PRIVATE = 1, 32, 4096, 16384, 1 << 18
_libc = ctypes.CDLL(None, use_errno=True)


def _checked(result):
	if result != 0:
		raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def ownMounts():
	"""From here on this process has mounts of its own; as an ordinary user it becomes root of a user namespace.

	:raises OSError: the machine does not allow it.
	"""
	uid = os.getuid()
	try:
		_checked(_libc.unshare(_NEWNS))
	except PermissionError:
		_checked(_libc.unshare(_NEWNS | _NEWUSER))
		pathlib.Path("/proc/self/uid_map").write_text(f"0 {uid} 1")
	mount(b"none", "/", None, _REC | _PRIVATE)


def mount(what, where, kind, flags, options=None):
	_checked(_libc.mount(what, os.fsencode(where), kind, flags, options))


def full(size, config, work, expected):
	"""What is odd in a test on a disk that fills up, which has room again afterwards. Room is taken once it has begun: it looks for room before."""
	mount(b"tmpfs", work, b"tmpfs", 0, b"size=100m")
	out = work / "out"
	test = tiny.start(tiny.command(config, out))
	while test.poll() is None and not out.exists():
		tiny.time.sleep(0.002)
	mount(b"tmpfs", work, b"tmpfs", _REMOUNT, f"size={size}k".encode())
	while test.poll() is None and not _isFull(work):
		tiny.time.sleep(0.01)
	code, seconds, errors = tiny.awaitEnd(test)
	if code == 0:
		return "" if tiny.rows(out) == expected else "the rows differ"
	odd = tiny.told(code, seconds, errors, 1, ("No space left", "space on the disk"))
	mount(b"tmpfs", work, b"tmpfs", _REMOUNT, b"size=100m")
	return odd or tiny.goOn(config, out, expected)


def _isFull(folder):
	found = os.statvfs(folder)
	return found.f_bavail * found.f_bsize < 8192


def readOnly(count, config, work, expected):
	"""The same for a folder that becomes read-only after so many rows."""
	out = work / "out"
	test = tiny.start(tiny.command(config, out))
	if not tiny.awaitRows(test, out, count):
		return "not tried: the test was over too early"
	mount(os.fsencode(out), out, None, _BIND)
	mount(b"none", out, None, _BIND | _REMOUNT | _RDONLY)
	code, seconds, errors = tiny.awaitEnd(test)
	odd = tiny.told(code, seconds, errors, 1, ("Read-only",))
	code, errors = tiny.run(tiny.command(config, out, "--resume"))
	odd = odd or tiny.told(code, 0, errors, 1, ("Read-only",))
	_checked(_libc.umount2(os.fsencode(out), 0))
	return odd or tiny.goOn(config, out, expected)


def main(fault, number, config, work, expected):
	work = pathlib.Path(work)
	work.mkdir(parents=True, exist_ok=True)
	try:
		ownMounts()
	except OSError as error:
		return f"not tried: this machine allows no mounts ({error.strerror})"
	does = {"full": full, "read-only": readOnly}[fault]
	return does(int(number), pathlib.Path(config), work, tiny.rows(pathlib.Path(expected)))


if __name__ == "__main__":
	print(main(*sys.argv[1:]))
