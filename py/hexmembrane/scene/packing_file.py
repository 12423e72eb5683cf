# SPDX-License-Identifier: GPL-2.0-or-later
"""A packing of spheres in a vertical cylinder, and the file that keeps it. Lengths in m.

The file is plain text (UTF-8)::

	hexmembrane packing 1
	{"radius": 0.02, "height": 0.08, "origin": [0, 0, 0], "grains": 2, "porosity": 0.99, "maxOverlap": 0, "units": "m", "seed": 1, ...}
	x y z r
	...
	end 2

* line 1: what it is and the version of the format;
* line 2: one JSON object. ``radius``, ``height``, ``origin`` (centre of the bottom face), ``grains``, ``porosity`` (1 - volume of the spheres over
  that of the cylinder), ``maxOverlap`` (largest overlap of two spheres or of one with the wall, over the mean radius) and ``units`` ("m") are
  required and checked against what follows; ``seed`` and ``gradation`` say where the packing comes from; any other key is kept as it is;
* a line ``x y z r`` for each sphere, written with all digits, so that reading gives the same bits;
* the last line with the number of spheres once more: a file that was cut off has none.

Written under a temporary name and renamed, so that there is either the whole file or none. Needs no YADE.
"""

import json
import math
import os
import tempfile

import numpy

from hexmembrane.configuration.schema import shown

MAGIC = "hexmembrane packing"
VERSION = 1
#: A header longer than this is no header.
_LONGEST_HEADER = 100000
#: Bytes of a file at most: a million lines of four numbers with all digits, and a header.
_LONGEST = 120_000_000
#: What rounding may change in a porosity, and in an overlap over the mean radius.
_ROUNDING = 1e-9


class Packing:
	"""Spheres in a cylinder with axis +z.

	:param centres: m, N x 3.
	:param radii: m, N.
	:param radius: of the cylinder, m.
	:param height: of the cylinder, m.
	:param origin: centre of its bottom face, m.
	:param seed: of the random numbers that made it, or None.
	:param gradation: where the sizes come from, a text, or None.
	:param extra: further facts to keep with it, a dict that JSON can hold.
	:param maxOverlap: largest overlap allowed (of two spheres or with the wall, over the mean radius); more is an error.
	:raises ValueError: naming entry, value and what to do.
	"""

	def __init__(self, centres, radii, radius, height, origin=(0, 0, 0), seed=None, gradation=None, extra=None, maxOverlap=1e-3):
		self.centres = numpy.array(centres, dtype=float)
		self.radii = numpy.array(radii, dtype=float)
		self.radius = _positive("radius", radius)
		self.height = _positive("height", height)
		self.origin = numpy.array(origin, dtype=float)
		self.seed, self.gradation, self.extra = seed, gradation, dict(extra or {})
		if self.radii.ndim != 1 or len(self.radii) == 0 or self.centres.shape != (len(self.radii), 3):
			_reject("centres", self.centres.shape, f"not one place for each of {self.radii.shape} radii", "N x 3 centres, N radii, N >= 1")
		if self.origin.shape != (3,) or not numpy.isfinite(self.origin).all():
			_reject("origin", origin, "not three finite numbers", "x, y, z in m")
		for wrong in numpy.flatnonzero(~(numpy.isfinite(self.radii) & (self.radii > 0)))[:1]:
			_reject(f"radii[{wrong}]", self.radii[wrong], "not a finite number > 0", "radii in m")
		for wrong in numpy.flatnonzero(~numpy.isfinite(self.centres).all(axis=1))[:1]:
			_reject(f"centres[{wrong}]", self.centres[wrong].tolist(), "not finite", "three coordinates in m")
		mean = self.radii.mean()
		beyond = self._wallOverlap() / mean
		worst = int(beyond.argmax())
		if not beyond[worst] <= maxOverlap + _ROUNDING:
			_reject(
				f"centres[{worst}]",
				self.centres[worst].tolist(),
				f"the sphere of radius {self.radii[worst]:.6g} reaches {beyond[worst]:.3g} mean radii beyond the cylinder, {maxOverlap:.3g} is allowed",
				"another place, or the cylinder's right size and origin",
			)
		pair = _pairOverlap(self.centres, self.radii) / mean
		if not pair <= maxOverlap + _ROUNDING:
			_reject("maxOverlap", pair, f"two spheres overlap by more than {maxOverlap:.3g} mean radii", "a packing without locked-in overlaps")
		#: Largest overlap (of two spheres, or with the wall) over the mean radius; 0 when there is none.
		self.maxOverlap = max(0.0, float(beyond[worst]), float(pair))
		if not self.porosity > 0:
			_reject("radii", f"{len(self.radii)} spheres", "more volume than the cylinder has", "radii and cylinder in m")
		for array in (self.centres, self.radii, self.origin):
			array.flags.writeable = False

	@classmethod
	def of(cls, generator, gradation=None, extra=None):
		"""From a generated ``CylinderPacking``."""
		return cls(
			[tuple(c) for c in generator.centres],
			generator.sizes,
			generator.radius,
			generator.height,
			tuple(generator.origin),
			generator.seed,
			gradation,
			extra,
			generator.maxOverlap + _ROUNDING,
		)

	@property
	def porosity(self):
		"""1 - volume of the spheres over that of the cylinder."""
		return 1 - 4 / 3 * float((self.radii**3).sum()) / (self.radius**2 * self.height)

	def __len__(self):
		return len(self.radii)

	def _wallOverlap(self):
		"""How far each sphere reaches beyond the cylinder (m, negative inside)."""
		x, y, z = (self.centres - self.origin).T
		return numpy.maximum.reduce([numpy.hypot(x, y) + self.radii - self.radius, self.radii - z, z + self.radii - self.height])


def _reject(what, value, wrong, fix):
	raise ValueError(f"Packing.{what} = {value}: {wrong}; fix: {fix}")


def _positive(what, value):
	if isinstance(value, bool) or not isinstance(value, (int, float, numpy.number)) or not (math.isfinite(value) and value > 0):
		_reject(what, value, "not a finite number > 0", "a length in m")
	return float(value)


def _pairOverlap(centres, radii):
	"""Largest overlap of two spheres (m, 0 if none): neighbours in the order of height, as far apart as two largest spheres reach."""
	order = numpy.argsort(centres[:, 2], kind="stable")
	x, r = centres[order], radii[order]
	reach, worst = 2 * r.max(), 0.0
	for step in range(1, len(r)):
		rise = x[step:, 2] - x[:-step, 2]
		near = rise < reach
		if not near.any():
			break
		distance = numpy.sqrt(((x[step:][near] - x[:-step][near]) ** 2).sum(axis=1))
		worst = max(worst, float((r[step:][near] + r[:-step][near] - distance).max()))
	return worst


def save(packing, path):
	"""Writes ``packing`` to ``path``, replacing what is there at once or not at all. :raises OSError: when it cannot be written."""
	header = dict(packing.extra)
	header.update(
		radius=packing.radius,
		height=packing.height,
		origin=packing.origin.tolist(),
		grains=len(packing),
		porosity=packing.porosity,
		maxOverlap=packing.maxOverlap,
		units="m",
		seed=packing.seed,
		gradation=packing.gradation,
	)
	lines = [f"{MAGIC} {VERSION}", json.dumps(header, allow_nan=False)]
	lines += [" ".join(repr(v) for v in row) for row in numpy.column_stack([packing.centres, packing.radii]).tolist()]
	lines.append(f"end {len(packing)}\n")
	path = os.path.abspath(path)
	handle, temporary = tempfile.mkstemp(prefix=os.path.basename(path) + ".", suffix=".part", dir=os.path.dirname(path))
	try:
		with os.fdopen(handle, "w", encoding="utf-8") as file:
			file.write("\n".join(lines))
			file.flush()
			os.fsync(file.fileno())
		mask = os.umask(0)
		os.umask(mask)
		os.chmod(temporary, 0o666 & ~mask)
		os.replace(temporary, path)
	except BaseException:
		os.unlink(temporary)
		raise


def load(path):
	"""The :class:`Packing` kept in ``path``.

	:raises ValueError: naming file, line and what is wrong, for anything that :func:`save` would not have written: another format or version,
		a missing or contradicting header entry, a line without four finite numbers, a radius that is not positive, spheres outside the
		cylinder or overlapping by more than the header states, a file that was cut off. :raises OSError: when it cannot be read.
	"""
	def wrong(line, what, fix="take the file as it was written, or make the packing again"):
		raise ValueError(f"{os.fspath(path)}, line {line}: {what}; fix: {fix}")

	with open(path, "rb") as file:
		data = file.read(_LONGEST + 1)
	if len(data) > _LONGEST:
		wrong(1, f"longer than {_LONGEST} bytes, which is enough for a million grains")

	try:
		lines = data.decode("utf-8").split("\n")
	except UnicodeDecodeError as error:
		wrong(data[: error.start].count(b"\n") + 1, "not text")
	if not lines[0].startswith(MAGIC + " "):
		wrong(1, f"not a packing, which begins with '{MAGIC}'")
	if lines[0] != f"{MAGIC} {VERSION}":
		wrong(1, f"version {lines[0][len(MAGIC) + 1 :][:20]!r} of the format, this program reads {VERSION}", "the program that wrote it, or a later one")
	header = _header(lines[1] if len(lines) > 1 else "", wrong)
	count = header["grains"]
	if len(lines) < 4 or lines[-1] != "" or lines[-2] != f"end {count}":
		wrong(len(lines), f"no line 'end {count}' with its line end: the file was cut off or joined")
	if len(lines) != count + 4:
		wrong(len(lines) - 1, f"{len(lines) - 4} spheres, the header says {count}")
	rows = numpy.empty((count, 4))
	for i, text in enumerate(lines[2:-2]):
		fields = text.split(" ")
		if len(fields) != 4:
			wrong(i + 3, f"{len(fields)} columns, not the four of 'x y z r'")
		for k, field in enumerate(fields):
			try:
				# float() would take '1_0' and 'nan' as well
				rows[i, k] = float(field) if set(field) <= set("0123456789+-.eE") else math.nan
			except ValueError:
				rows[i, k] = math.nan
			if not math.isfinite(rows[i, k]):
				wrong(i + 3, f"{field[:40]!r} is not a finite number")
		if rows[i, 3] <= 0:
			wrong(i + 3, f"a radius of {rows[i, 3]:.6g}, not > 0")
	known = ("radius", "height", "origin", "grains", "porosity", "maxOverlap", "units", "seed", "gradation")
	try:
		packing = Packing(
			rows[:, :3],
			rows[:, 3],
			header["radius"],
			header["height"],
			header["origin"],
			header.get("seed"),
			header.get("gradation"),
			{key: value for key, value in header.items() if key not in known},
			header["maxOverlap"],
		)
	except ValueError as error:
		raise ValueError(f"{os.fspath(path)}: {error}") from error
	if not abs(packing.porosity - header["porosity"]) <= _ROUNDING:
		wrong(2, f"porosity {header['porosity']:.9g}, the spheres make {packing.porosity:.9g}")
	return packing


def _header(text, wrong):
	"""The checked JSON object of line 2."""
	if len(text) > _LONGEST_HEADER:
		wrong(2, "the header is longer than a header is")

	def unique(pairs):
		keys = [key for key, _ in pairs]
		if len(set(keys)) < len(keys):
			raise ValueError("a key stands twice")
		return dict(pairs)

	def noConstant(name):
		raise ValueError(f"{name} is no number")

	try:
		header = json.loads(text, object_pairs_hook=unique, parse_constant=noConstant)
	except (ValueError, RecursionError) as error:
		wrong(2, f"the header is not a JSON object ({error})")
	if not isinstance(header, dict):
		wrong(2, "the header is not a JSON object")
	for key in ("radius", "height", "porosity", "maxOverlap", "grains", "origin", "units"):
		if key not in header:
			wrong(2, f"the header has no '{key}'")
	for key in ("radius", "height", "porosity", "maxOverlap"):
		if not _isNumber(header[key]) or header[key] < 0:
			wrong(2, f"'{key}' is {shown(header[key])}, not a finite number >= 0")
	if isinstance(header["grains"], bool) or not isinstance(header["grains"], int) or header["grains"] < 1:
		wrong(2, f"'grains' is {shown(header['grains'])}, not a number of spheres")
	if not isinstance(header["origin"], list) or len(header["origin"]) != 3 or not all(_isNumber(v) for v in header["origin"]):
		wrong(2, f"'origin' is {shown(header['origin'])}, not three finite numbers")
	if header["units"] != "m":
		wrong(2, f"units {shown(header['units'])}, only 'm' is known")
	return header


def _isNumber(value):
	if isinstance(value, bool) or not isinstance(value, (int, float)):
		return False
	try:
		return math.isfinite(value)
	except OverflowError:  # an integer beyond all floats
		return False
