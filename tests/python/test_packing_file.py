# SPDX-License-Identifier: GPL-2.0-or-later
"""Packings and their file: what is written comes back bit by bit, and nothing else is read."""

import json
import math
import os
import random

import numpy
import pytest

from hexmembrane.scene import packing_file
from hexmembrane.scene.packing_file import Packing


def column(count=5, radius=0.3, **more):
	"""Touching spheres, one on the other, in a tube of their own size."""
	centres = [(1, 2, 3 + radius * (2 * i + 1)) for i in range(count)]
	return Packing(centres, [radius] * count, radius, 2 * radius * count, origin=(1, 2, 3), **more)


@pytest.fixture
def file(tmp_path):
	path = tmp_path / "column.packing"
	packing_file.save(column(seed=7, gradation="one size", extra={"program": "test", "stress": [1, 2]}), path)
	return path


def test_porosityOfAColumn():
	assert column().porosity == pytest.approx(1 / 3, rel=1e-14)
	assert column().maxOverlap < 1e-14 and len(column()) == 5


def test_roundTripIsExact(tmp_path):
	numbers = numpy.random.Generator(numpy.random.PCG64(3))
	radii = numbers.uniform(0.001, 0.002, 200)
	centres = numpy.column_stack([numbers.uniform(-1, 1, 200) / 3, numbers.uniform(-1, 1, 200) / 3, numpy.linspace(0.1, 0.9, 200)])
	packing = Packing(centres, radii, 0.5, 1.0, seed=12, gradation="sand", extra={"note": "ä"}, maxOverlap=1)
	packing_file.save(packing, tmp_path / "a")
	again = packing_file.load(tmp_path / "a")
	assert (again.centres == packing.centres).all() and (again.radii == packing.radii).all() and (again.origin == packing.origin).all()
	assert (again.radius, again.height, again.seed, again.gradation, again.extra) == (0.5, 1.0, 12, "sand", {"note": "ä"})
	assert again.porosity == packing.porosity and again.maxOverlap == packing.maxOverlap
	packing_file.save(again, tmp_path / "b")
	assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_overlapsAreFoundAsByBruteForce():
	numbers = numpy.random.Generator(numpy.random.PCG64(5))
	radii = numbers.uniform(0.02, 0.1, 120)
	centres = numbers.uniform(-0.4, 0.4, (120, 3)) + (0, 0, 0.5)
	gaps = [radii[i] + radii[j] - math.dist(centres[i], centres[j]) for i in range(120) for j in range(i)]
	assert packing_file._pairOverlap(centres, radii) == pytest.approx(max(gaps), rel=1e-12) and max(gaps) > 0.01


def test_savedAtOnceOrNotAtAll(file, tmp_path, monkeypatch):
	before = file.read_bytes()

	def fail(*_):
		raise OSError("disk full")

	monkeypatch.setattr(os, "fsync", fail)
	with pytest.raises(OSError, match="disk full"):
		packing_file.save(column(3), file)
	assert file.read_bytes() == before and os.listdir(tmp_path) == [file.name]


def test_missingFolderAndFile(tmp_path):
	with pytest.raises(OSError):
		packing_file.save(column(), tmp_path / "no" / "where")
	with pytest.raises(OSError):
		packing_file.load(tmp_path / "nothing")


@pytest.mark.parametrize(
	"change, message",
	[
		({"centres": [(0, 0, 1)] * 2}, "centres"),
		({"radii": [0.5, 0.5, -1]}, r"radii\[2\] = -1"),
		({"radii": [0.5, math.nan, 0.5]}, r"radii\[1\] = nan"),
		({"centres": [(0, 0, 0.5), (0, 0, math.inf), (0, 0, 2.5)]}, r"centres\[1\]"),
		({"centres": [(0, 0, 0.5), (0, 0, 1.5), (0.1, 0, 2.5)]}, r"centres\[2\].*beyond the cylinder"),
		({"centres": [(0, 0, 0.4), (0, 0, 1.5), (0, 0, 2.5)]}, r"centres\[0\].*beyond the cylinder"),
		({"centres": [(0, 0, 0.5), (0, 0, 1.4), (0, 0, 2.5)]}, "two spheres overlap"),
		({"radius": 0}, "radius = 0"),
		({"height": math.nan}, "height = nan"),
		({"radius": "wide"}, "radius = wide"),
		({"origin": (0, 0)}, "origin"),
		({"centres": numpy.zeros((0, 3)), "radii": []}, "centres"),
	],
)
def test_badPackings(change, message):
	good = {"centres": [(0, 0, 0.5), (0, 0, 1.5), (0, 0, 2.5)], "radii": [0.5] * 3, "radius": 0.5, "height": 3.0}
	assert len(Packing(**good)) == 3
	with pytest.raises(ValueError, match=message):
		Packing(**{**good, **change})


def edited(file, edit):
	lines = file.read_text(encoding="utf-8").split("\n")
	file.write_text("\n".join(edit(lines) or lines), encoding="utf-8")
	return file


def setLine(number, text):
	def edit(lines):
		lines[number - 1] = text

	return edit


def setHeader(**changes):
	def edit(lines):
		header = json.loads(lines[1])
		header.update(changes)
		lines[1] = json.dumps({k: v for k, v in header.items() if v is not ...})

	return edit


@pytest.mark.parametrize(
	"edit, message",
	[
		(setLine(1, "hexmembrane packing 2"), "line 1: version '2'"),
		(setLine(1, "x y z r"), "line 1: not a packing"),
		(setLine(2, "{"), "line 2: the header is not a JSON"),
		(setLine(2, "[]"), "line 2: the header is not a JSON object"),
		(setLine(2, "[" * 5000), "line 2: the header is not"),
		(setLine(2, " " * 200000), "line 2: the header is longer"),
		(setLine(2, '{"radius": 1, "radius": 2}'), "stands twice"),
		(setHeader(radius=...), "no 'radius'"),
		(setHeader(radius=math.nan), "NaN is no number"),
		(setHeader(radius=0), "radius = 0"),
		(setHeader(height="tall"), "'height' is 'tall'"),
		(setHeader(radius=10**400), "'radius' is"),
		(setHeader(grains=6), "no line 'end 6'"),
		(setHeader(grains=-1), "'grains' is -1"),
		(setHeader(grains=True), "'grains' is True"),
		(setHeader(origin=[0, 0]), "'origin' is"),
		(setHeader(origin=[1, 2, 3.01]), "beyond the cylinder"),
		(setHeader(units="mm"), "units 'mm'"),
		(setHeader(units="9" * 2000), r"units '9+ \.\.\. 9+', only 'm' is known"),
		(setHeader(porosity=0.4), "line 2: porosity 0.4, the spheres make 0.333"),
		(setHeader(maxOverlap=-1), "'maxOverlap' is -1"),
		(setHeader(radius=0.29), "beyond the cylinder"),
		(setLine(4, "1 2 3.9"), "line 4: 3 columns"),
		(setLine(4, "1 2 3.9 0.3 0"), "line 4: 5 columns"),
		(setLine(4, "1 2 nan 0.3"), "line 4: 'nan' is not a finite"),
		(setLine(4, "1 2 1e999 0.3"), "line 4: '1e999' is not a finite"),
		(setLine(4, "1 2 3_9 0.3"), "line 4: '3_9' is not"),
		(setLine(4, "1 2 3,9 0.3"), "line 4: '3,9' is not"),
		(setLine(4, "1 2 3.9 -0.3"), "line 4: a radius of -0.3"),
		(setLine(4, "1 2 3.9 0"), "line 4: a radius of 0"),
		(setLine(4, "1 2 3.8 0.3"), "two spheres overlap"),
		(setLine(4, "1 2 3.9 0.29"), "porosity"),
		(lambda lines: lines[:4] + lines[5:], "4 spheres, the header says 5"),
		(lambda lines: lines[:-2], "no line 'end 5'"),
		(lambda lines: lines[:-1], "cut off"),
		(lambda lines: lines + ["more"], "cut off or joined"),
	],
)
def test_badFiles(file, edit, message):
	assert len(packing_file.load(file)) == 5
	with pytest.raises(ValueError, match=message):
		packing_file.load(edited(file, edit))


def test_everyCutOffFileIsRefused(file):
	whole = file.read_bytes()
	for length in range(len(whole)):
		file.write_bytes(whole[:length])
		with pytest.raises(ValueError):
			packing_file.load(file)


def test_fuzzedFilesAreRefusedOrSound(file):
	"""Random damage: a ValueError that names the file, or a packing that holds what a packing promises."""
	whole, numbers, read = file.read_bytes(), random.Random(11), 0
	for _ in range(2000):
		data = bytearray(whole)
		for _ in range(numbers.randint(1, 3)):
			at = numbers.randrange(len(data))
			kind = numbers.randrange(4)
			if kind == 0:
				data[at] = numbers.randrange(256)
			elif kind == 1:
				del data[at : at + numbers.randint(1, 30)]
			elif kind == 2:
				data[at:at] = data[numbers.randrange(len(data)) :][: numbers.randint(1, 30)]
			else:
				data[at] = ord(numbers.choice("0123456789.-+eE \n\x00"))
		file.write_bytes(bytes(data))
		try:
			packing = packing_file.load(file)
		except ValueError as error:
			assert str(file) in str(error)
			continue
		read += 1
		assert numpy.isfinite(packing.centres).all() and (packing.radii > 0).all() and 0 < packing.porosity < 1
		assert packing.porosity == pytest.approx(json.loads(data.split(b"\n")[1])["porosity"], abs=1e-8)
		assert (packing._wallOverlap() <= 1.01 * max(packing.maxOverlap, 1e-8) * packing.radii.mean()).all()
	assert read < 1000  # most damage is seen; what is not, stands in free text or in the last digits
