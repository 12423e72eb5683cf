# SPDX-License-Identifier: GPL-2.0-or-later
"""Specimens as PFC makes them: sizes by number, and a table of balls."""

import math
import re

import numpy
import pytest
import yaml
from hexmembrane.configuration import Config, ConfigError, balls, toDict
from hexmembrane.scene import packing_file
from hexmembrane.scene.number_sizes import NumberSizes
from hexmembrane.scene.specimen import radii
from tinyTest import TINY, configure

CYLINDER = {"radius": 0.02, "height": 0.05, "porosity": 0.45}


def table(folder, rows, header="id,x,y,z,r"):
	(folder / "balls.csv").write_text("\n".join([header, *(",".join(map(str, row)) for row in rows)]) + "\n")
	return folder / "balls.csv"


def config(folder, **specimen):
	return Config.of({**TINY, "specimen": specimen}, folder)


# Sizes by number


def test_uniform():
	"""All radii between two are as frequent, and the volume is that of the distribution."""
	found = numpy.sort(NumberSizes.uniform(1e-3, 3e-3).sample(1000, seed=2))
	assert abs(found - numpy.linspace(1e-3, 3e-3, 1000)).max() < 2e-6
	assert (found**3).mean() == pytest.approx((3e-3**4 - 1e-3**4) / (4 * 2e-3), rel=1e-12)


def test_gaussian():
	found = NumberSizes.gaussian(2e-3, 2e-4, 1.4e-3, 2.6e-3).sample(4000)
	assert found.mean() == pytest.approx(2e-3, rel=1e-3) and found.std() == pytest.approx(2e-4 * 0.9867, rel=1e-2)  # of a normal cut off at 3 sigma
	assert 1.4e-3 <= found.min() and found.max() <= 2.6e-3


def test_bins():
	"""Shares are of the volume; the smaller bin has the more grains."""
	found = NumberSizes.bins([[1e-3, 1.2e-3, 30], [2e-3, 2e-3, 70]]).sample(20000)
	small = found < 1.5e-3
	assert (found[small] ** 3).sum() / (found**3).sum() == pytest.approx(0.3, abs=2e-3)
	assert found[small].mean() == pytest.approx(1.1e-3, rel=1e-3) and set(found[found > 1.9e-3].round(9)) == {2e-3}


@pytest.mark.parametrize("sizes", [{"radiusRange": [1.5e-3, 3e-3]}, {"radiusMean": 2e-3, "radiusDeviation": 2e-4}, {"radiusBins": [[1.5e-3, 2e-3, 1], [2.5e-3, 3e-3, 2]]}])
def test_asManyAsFillTheCylinder(tmp_path, sizes):
	"""Sizes as they are, with the number that the porosity needs; or a wished number, scaled."""
	volume = math.pi * 0.02**2 * 0.05
	found = radii(config(tmp_path, **CYLINDER, **sizes).specimen, 0.02, 0.05)
	assert 1 - 4 / 3 * math.pi * (found**3).sum() / volume == pytest.approx(0.45, abs=2e-3)
	wished = radii(config(tmp_path, **CYLINDER, **sizes, grains=100).specimen, 0.02, 0.05)
	assert len(wished) == 100 and 1 - 4 / 3 * math.pi * (wished**3).sum() / volume == pytest.approx(0.45, abs=1e-9)
	assert wished.max() / wished.min() == pytest.approx(found.max() / found.min(), rel=0.2)


@pytest.mark.parametrize(
	"keys, message",
	[
		({}, "specimen.gradation = None: the grains need one source, nothing is given"),
		({"radiusRange": [1, 2], "balls": "b.csv"}, r"specimen.radiusRange = \[1.0, 2.0\]: the grains need one source, radiusRange, balls is given"),
		({"radiusRange": [2e-3, 1e-3]}, "specimen.radiusRange = .*: is not a least and a largest radius"),
		({"radiusRange": [-1e-3, 1e-3]}, r"specimen.radiusRange\[0\] = -0.001: is out of range"),
		({"radiusRange": 1e-3}, "specimen.radiusRange = 0.001: is not a list"),
		({"radiusMean": 2e-3}, "specimen.radiusDeviation = None: the distribution is given in half"),
		({"radiusMean": 2e-3, "radiusDeviation": 1e-3}, "specimen.radiusMean = 0.002: reaches down to radii below 0, 3 standard deviations are 0.003 m"),
		({"radiusMean": 2e-3, "radiusDeviation": 1e-3, "radiusRange": [3e-3, 4e-3]}, "specimen.radiusMean = 0.002: is not inside radiusRange"),
		({"radiusBins": [[1e-3, 2e-3]]}, r"specimen.radiusBins\[0\] = \[0.001, 0.002\]: is not a bin"),
		({"radiusBins": []}, r"specimen.radiusBins = \[\]: are no bins"),
	],
)
def test_sizesGivenWrongly(tmp_path, keys, message):
	with pytest.raises(ConfigError, match=f"^{message}.*fix: "):
		config(tmp_path, **CYLINDER, **keys)


# A table of balls


def test_columnsInAnyOrder(tmp_path):
	path = table(tmp_path, [("0.5", "7", "1", "2", "3", "x"), ("0.25", "8", "4", "5", "6", "y")], "Radius, ID ,x,y,z,group")
	found = balls.read(path, "mm")
	assert found.centres == pytest.approx(numpy.array([[1e-3, 2e-3, 3e-3], [4e-3, 5e-3, 6e-3]])) and found.radii == pytest.approx([5e-4, 2.5e-4])
	assert found.left == ("group",)


GOOD = [(1, 0, 0, 0, 1), (2, 3, 0, 0, 1)]


@pytest.mark.parametrize(
	"rows, header, message",
	[
		([], "id,x,y,z,r", "has a header and no ball"),
		([(1, 0, 0, 1)], "id,x,y,r", r"line 1: the header 'id,x,y,r' has no column z"),
		(GOOD, "id;x;y;z;r", "line 1: the header .* has no column x, y, z, r"),
		(GOOD, "id,x,y,z,z", "line 1: the column 'z' is there twice"),
		([*GOOD, (3, 0, 0, 5, -1)], "id,x,y,z,r", "line 4: r = -1 is not > 0"),
		([*GOOD, (3, 0, 0, "nan", 1)], "id,x,y,z,r", "line 4: z = 'nan' is not a finite number"),
		([*GOOD, (3, 0, 0, "5 mm", 1)], "id,x,y,z,r", "line 4: z = '5 mm' is not a finite number"),
		([*GOOD, (2, 0, 0, 5, 1)], "id,x,y,z,r", "line 4: the ball with id '2' is in line 3 already"),
		([*GOOD, (3, 3, 0, 0, 2)], "id,x,y,z,r", "line 4: the ball is at the same place as that in line 3"),
		([*GOOD, (3, 3, 0)], "id,x,y,z,r", "line 4: has 3 columns, the header 5"),
	],
)
def test_wrongTable(tmp_path, rows, header, message):
	with pytest.raises(ConfigError, match=rf"^specimen.balls = .*: {message}.*; fix: "):
		balls.read(table(tmp_path, rows, header), "m")


def test_noTable(tmp_path):
	(tmp_path / "no.csv").write_bytes(b"\xff\xfe\0")
	for path, message in ((tmp_path / "gone.csv", "cannot be read"), (tmp_path / "no.csv", "is no text")):
		with pytest.raises(ConfigError, match=message):
			balls.read(path, "m")


def test_cylinderRoundTheBalls():
	"""Balls that touch a cylinder of a given axis from inside have that cylinder, whatever is inside."""
	rng = numpy.random.default_rng(1)
	angle, size = rng.uniform(0, 2 * math.pi, 400), rng.uniform(0.5, 1.5, 400)
	place = rng.uniform(0, 10, 400) - size
	place[:200] = 10 - size[:200]
	centres = numpy.column_stack([3 + place * numpy.cos(angle), -4 + place * numpy.sin(angle), rng.uniform(5, 25, 400)])
	centres[:2, 2], size[:2] = (4, 26), 1
	place[:2] = 9
	centres[:2, :2] = [[3 + 9, -4], [3 - 9, -4]]
	found = balls.circumscribed(centres, size)
	assert [found.x, found.y, found.radius] == pytest.approx([3, -4, 10], abs=1e-4) and (found.z, found.height) == (3, 24)


@pytest.fixture
def packed(O, tmp_path_factory):
	"""A packing of the tiny test, as a table in mm, shifted, with overlaps of 2 %: (folder, packing)."""
	from hexmembrane.scene import specimen

	folder = tmp_path_factory.mktemp("packed")
	O.reset()
	made = specimen.make(Config.of({**TINY, "specimen": {**CYLINDER, "radiusRange": [2e-3, 3e-3]}}, folder), lambda line: None)
	centres, sizes = 1e3 * made.centres + [5, -7, 40], 1.02e3 * made.radii
	table(folder, [(k + 1, *x, r) for k, (x, r) in enumerate(zip(centres.tolist(), sizes.tolist()))])
	return folder, made


def test_ballsAsSpecimen(packed, tmp_path, runHere):
	"""The table is moved onto axis and floor, its size taken from the balls, and what was done is told; the written configuration runs again."""
	folder, made = packed
	path = configure(tmp_path)
	given = yaml.safe_load(path.read_text())
	given["specimen"] = {"balls": str(folder / "balls.csv"), "ballsUnit": "mm"}
	path.write_text(yaml.safe_dump(given))
	code, said, errors = runHere(path, "--out", tmp_path / "out", "--until", "boundary")
	assert code == 0, errors
	assert f"{len(made)} balls from" in said and "moved by (-0.00" in said and "largest overlap" in said and "% of the mean radius" in said
	found = packing_file.load(tmp_path / "out" / "packing.txt")
	assert found.radii == pytest.approx(1.02 * made.radii) and 0.01 < found.maxOverlap < 0.06
	assert found.centres - found.centres[0] == pytest.approx(made.centres - made.centres[0], abs=1e-9)
	written = yaml.safe_load((tmp_path / "out" / "config.yaml").read_text())
	assert written["specimen"]["radius"] == found.radius == pytest.approx(0.02, rel=0.01)
	assert toDict(Config.of(written))["specimen"] == written["specimen"]


def test_ballsDoNotFit(packed, tmp_path, runHere):
	folder, _ = packed
	path = configure(tmp_path)
	given = yaml.safe_load(path.read_text())
	for specimen, message in (
		({"ballsUnit": "mm", "radius": 0.015}, r"specimen.radius = 0.015: the balls need 0.02\d* m, they reach .* mean radii beyond; 0.1 is allowed; fix: specimen.radius: 0.02"),
		({"ballsUnit": "mm", "height": 0.04}, "specimen.height = 0.04: the balls need 0.05"),
	):
		given["specimen"] = {"balls": str(folder / "balls.csv"), **specimen}
		path.write_text(yaml.safe_dump(given))
		code, _, errors = runHere(path, "--out", tmp_path / "out", "--until", "boundary")
		assert code == 2 and re.search(message, errors), errors
