# SPDX-License-Identifier: GPL-2.0-or-later
"""A whole test in the compact tier is the test of the reference tier, and a test may change tier on the way."""

import pathlib

import numpy
import pytest
from hexmembrane import configuration
from hexmembrane.output import records
from hexmembrane.run import states
from hexmembrane.scene import packing_file, specimen
from hexmembrane.scene.builder import setTier
from hexmembrane.scene.handles import Scene
from hexmembrane.run import run

QUICK = pathlib.Path(__file__).parents[2] / "examples" / "quick.yaml"
SMALL = {
	"specimen": {"grains": 150, "porosity": 0.46},
	"membrane": {"particleRadius": 2.5e-3, "thickness": 1e-3},
	"consolidation": {"unbalanced": 1e-2, "tolerance": 0.15, "rampTime": 0.004},
	"shear": {"strain": 0.005, "velocity": 0.2},
	"numerics": {"dt": 8e-6},  # else each tier takes its own measure of the critical one
	"output": {"records": 10, "vtkEvery": 0, "checkpointEvery": 0},
}


@pytest.fixture(scope="module")
def packing(tmp_path_factory):
	"""The packing that all tests here start from."""
	import yade

	yade.O.reset()
	path = tmp_path_factory.mktemp("packing") / "packing.txt"
	packing_file.save(specimen.make(configuration.derived(configuration.load(QUICK), SMALL), lambda text: None), path)
	yade.O.reset()
	return path


def small(packing, **changes):
	given = configuration.merged(configuration.toDict(configuration.load(QUICK)), configuration.merged(SMALL, changes))
	for key in ("gradation", "grains", "cutBelow", "cutAbove"):
		given["specimen"][key] = None
	given["specimen"]["packing"] = str(packing)
	return configuration.Config.of(given)


def sheared(O, config, out):
	O.reset()
	run(config, out, quiet=True)
	table = records.read(out / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	return {name: table[name][shear] for name in ("q", "volumetric_strain_volume", "step")}


def test_agreeWithinAPerturbationOfTheStart(O, packing, tmp_path):
	"""q and volumetric strain differ between the tiers by no more than between two reference runs whose grains start 1e-12 m apart."""
	start = packing_file.load(packing)
	nudge = 1e-12 * numpy.random.default_rng(1).uniform(-1, 1, start.centres.shape)
	nudged = packing_file.Packing(start.centres + nudge, start.radii, start.radius, start.height)
	other = tmp_path / "nudged.txt"
	packing_file.save(nudged, other)
	reference = sheared(O, small(packing, tier="reference"), tmp_path / "reference")
	perturbed = sheared(O, small(other, tier="reference"), tmp_path / "perturbed")
	compact = sheared(O, small(packing, tier="compact"), tmp_path / "compact")
	assert (compact["step"] == reference["step"]).all()
	for name in ("q", "volumetric_strain_volume"):
		noise = numpy.abs(perturbed[name] - reference[name]).max()
		assert numpy.abs(compact[name] - reference[name]).max() <= 3 * noise, name
		assert noise < 0.2 * numpy.abs(reference[name]).max()  # else this says nothing


@pytest.mark.parametrize("first, then", [("reference", "compact"), ("compact", "reference")])
def test_changesTierOnResume(O, packing, tmp_path, first, then):
	"""Consolidated in one tier, sheared in the other."""
	whole = sheared(O, small(packing, tier=first), tmp_path / "whole")
	O.reset()
	run(small(packing, tier=first), tmp_path / "out", until="consolidation", quiet=True)
	O.reset()
	run(small(packing, tier=then), tmp_path / "out", resume=True, quiet=True)
	table = records.read(tmp_path / "out" / "records.csv")
	shear = numpy.array([stage == "shear" for stage in table["stage"]])
	assert numpy.abs(table["q"][shear] - whole["q"]).max() < 0.02 * numpy.abs(whole["q"]).max()
	states.load(tmp_path / "out" / "sheared.yade.gz")
	assert ("CompactLoop" in [type(engine).__name__ for engine in O.engines]) == (then == "compact")


def test_referenceStepIsALowerBound(O, packing, tmp_path):
	"""Of the compact tier's, which is the true one: on the same contacts, for grains whose rotations are the fastest motion."""
	config = small(packing, tier="reference", specimen={"kratio": 1.2, "rollingFriction": 0.2}, numerics={"dt": 5e-6})
	O.reset()
	run(config, tmp_path / "out", until="consolidation", quiet=True)
	steps = {}
	for tier in ("reference", "compact"):
		setTier(configuration.derived(config, {"tier": tier}))
		O.step()
		steps[tier] = Scene().criticalTimeStep()
	assert 0.8 * steps["compact"] < steps["reference"] < steps["compact"]
