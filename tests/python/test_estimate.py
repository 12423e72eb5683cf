# SPDX-License-Identifier: GPL-2.0-or-later
"""What a test needs is estimated to a factor of two, said first, and refused beyond the machine, before a folder is made."""

import copy
import math
import os
import re

import numpy
import pytest
from hexmembrane.configuration import Config, ConfigError
from hexmembrane.run import estimate
from hexmembrane.run.estimate import Estimate, Machine
from tinyTest import GRADATION, TINY, configure

LARGE = Machine(processors=4, memory=1e12, disk=1e13)


@pytest.fixture
def tiny(tmp_path):
	"""A configuration with changes by section, and radii of its grains."""
	(tmp_path / "sand.csv").write_text(GRADATION)

	def make(radius=2.5e-3, **changes):
		given = copy.deepcopy(TINY)
		for name, part in changes.items():
			given[name] = {**given.get(name, {}), **part} if isinstance(part, dict) else part
		return Config.of(given, tmp_path), numpy.full(given["specimen"]["grains"], radius)

	return make


def test_againstATest(tmp_path, runHere):
	"""The line comes first; its spheres and steps, and the disk, are those of the test to a factor of two."""
	code, said, error = runHere(configure(tmp_path), "--out", tmp_path / "out")
	assert code == 0, error
	# what test_pressure_watch.py has of other tests: here the pressure is held
	assert "pressureTolerance" not in error and "% from its target at most, at " in error and "not held" not in error
	found = re.match(r"work: ([\d,]+) spheres, about ([\d,]+) steps of consolidation and ([\d,]+) of shear, [\d:]+ for the steps on one thread; memory \d+ MB, disk ([\d.]+) MB\n", said)
	spheres, consolidation, shear, disk = (float(text.replace(",", "")) for text in found.groups())
	rows = [row.split(",")[:2] for row in (tmp_path / "out" / "records.csv").read_text().splitlines()[1:]]
	last = int([step for stage, step in rows if stage == "consolidation"][-1])
	assert 0.9 < spheres / 550 < 1.1
	assert 0.5 < consolidation / last < 2
	assert 0.8 < shear / (int(rows[-1][1]) - last) < 1.25
	used = sum(path.stat().st_size for path in (tmp_path / "out").rglob("*") if path.is_file())
	assert 0.5 < disk * 1e6 / used < 6


def test_moreWork(tiny):
	"""Steps go with the inverse velocity, spheres and step with the inverse size; the reference tier is slower; a wall has no membrane."""
	base = Estimate.of(*tiny())
	assert Estimate.of(*tiny(shear={"velocity": 0.008})).shear == pytest.approx(10 * base.shear)
	fine = Estimate.of(*tiny(membrane={"sizeRatio": 0.5}))
	assert 3 < fine.membrane / base.membrane < 5 and fine.step < base.step
	assert Estimate.of(*tiny(tier="reference")).seconds > 20 * base.seconds
	assert Estimate.of(*tiny(membrane={"poisson": 0.2})).seconds > 1.5 * base.seconds
	wall = Estimate.of(*tiny(boundary="wall"))
	assert wall.membrane == 0 and wall.memory < base.memory and wall.disk < base.disk
	assert Estimate.of(*tiny(numerics={"dt": 1e-6})).step == 1e-6
	assert Estimate.of(*tiny(output={"vtkEvery": 1})).disk > base.disk > Estimate.of(*tiny(output={"vtkEvery": 0})).disk


@pytest.mark.parametrize(
	"changes, radius, key, words",
	[
		({"shear": {"velocity": 1e-9}}, 2.5e-3, "shear.velocity = 1e-09", "at least 6"),
		({"consolidation": {"rampTime": 1e6}}, 2.5e-3, "consolidation.rampTime = 1000000.0", "at most 1"),
		({}, 1e-9, "consolidation.rampTime = None|membrane.sizeRatio = 1.0: makes|shear.velocity", "larger"),
		({"membrane": {"particleRadius": 1e-7}, "numerics": {"dt": 1e-6}}, 2.5e-3, "membrane.particleRadius = 1e-07: makes", "larger one, or fewer"),
		({"boundary": "wall", "specimen": {"grains": 1000000}}, 2.5e-3, "specimen.grains = 1000000: 1,000,000 grains: the test needs about 6.4 GB of memory, and 1 GB", "fewer"),
		({"output": {"vtkEvery": 1, "records": 100000}}, 2.5e-3, "output.vtkEvery = 1: .* on the disk, and 1 GB are free", "--out"),
	],
)  # fmt: skip
def test_refused(tiny, changes, radius, key, words):
	config, radii = tiny(radius, **changes)
	with pytest.raises(ConfigError) as caught:
		Estimate.of(config, radii).require(config, Machine(processors=1, memory=1e9, disk=1e9))
	message = str(caught.value)
	assert re.match(key, message) and words in message.partition("; fix: ")[2]


def test_fixOfSlowShearDoes(tiny):
	config, radii = tiny(shear={"velocity": 1e-9})
	with pytest.raises(ConfigError) as caught:
		Estimate.of(config, radii).require(config, LARGE)
	config.shear.velocity = 1.01 * float(re.search(r"at least (\S+) m/s", str(caught.value)).group(1))
	Estimate.of(config, radii).require(config, LARGE)


def test_threads(tiny):
	config, _ = tiny(numerics={"threads": 16})
	estimate.requireThreads(config, LARGE)
	config.numerics.threads = 17
	with pytest.raises(ConfigError, match="numerics.threads = 17: is more than 4 a processor, and 4 are there; fix: at most 16"):
		estimate.requireThreads(config, LARGE)


def test_softContacts(tiny):
	"""A tenth of a diameter is the most that grains overlap; the fix does."""
	config, _ = tiny(consolidation={"pressure": 1e7}, specimen={"emod": 4e7})
	with pytest.raises(ConfigError, match=r"specimen.emod = 40000000.0: gives kn/\(p d\) = 3.14 at 1e\+07 Pa.*; fix: at least 1.27e\+08 Pa, 3.82e\+09 Pa for small") :
		estimate.requireStiffness(config, 1e-3)
	config.specimen.emod = 1.28e8
	estimate.requireStiffness(config, 1e-3)


@pytest.mark.parametrize("moving, least", [("top", 1e-3), ("both", 0.5e-3)])
def test_thinPlatens(tiny, moving, least):
	config, _ = tiny(platens={"thickness": 1.01 * least}, shear={"moving": moving})
	estimate.requireTravel(config)
	config.platens.thickness = least
	with pytest.raises(ConfigError, match=f"platens.thickness = {least}: is no more than the {least:g} m that a platen travels; fix: more than"):
		estimate.requireTravel(config)


@pytest.mark.parametrize("changes", [{"platens": {"thickness": 5e-4}}, {"specimen": {"emod": 1e5}}, {"shear": {"velocity": 1e-10}}, {"numerics": {"threads": 1024}}])
def test_refusedBeforeAnythingIsMade(tmp_path, runHere, changes):
	code, said, error = runHere(configure(tmp_path, **changes), "--out", tmp_path / "deep" / "out")
	assert code == 2 and error.startswith("error: ") and "; fix: " in error and not (tmp_path / "deep").exists()


def test_thisMachine(tmp_path):
	here = Machine.here(tmp_path / "not" / "yet")
	assert here.processors == len(os.sched_getaffinity(0)) and 1e6 < here.memory < math.inf and here.disk > 0
