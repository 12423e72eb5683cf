# SPDX-License-Identifier: GPL-2.0-or-later
"""The cylinder that the grains are packed into."""

import math
import pathlib

import pytest
from hexmembrane.configuration import Config, ConfigError
from hexmembrane.scene import specimen


def centred(particleRadius):
	return Config.of(
		{
			"specimen": {"radius": 0.02, "height": 0.08, "packing": __file__},
			"membrane": {"placement": "centred", "particleRadius": particleRadius},
			"consolidation": {"pressure": 1e5},
		}
	)


@pytest.mark.parametrize("particleRadius", [2.5e-3, 1e-3, 0.9e-3, 0.25e-3])
def test_soilRadiusIsTheMembranesInnerRadius(O, particleRadius):
	"""The closed form is what HexMembrane generates; the scene is left alone."""
	import yade

	O.materials.append(yade.FrictMat(density=1000))
	membrane = yade.HexMembrane(specimenRadius=0.02, specimenHeight=0.08, particleRadius=particleRadius, placement="centred")
	count = len(membrane.generate())
	assert specimen.soilRadius(centred(particleRadius)) == pytest.approx(membrane.innerRadius, rel=1e-14)
	assert len(O.bodies) == count


@pytest.mark.parametrize("particleRadius", [0.0115, 0.02, 0.5])
def test_tooCoarseToCloseARing(particleRadius):
	with pytest.raises(ConfigError, match="membrane.particleRadius = .*too coarse, a ring would have [05] spheres; fix: at most 0.01 m"):
		specimen.soilRadius(centred(particleRadius))


def frictionless(**specimen):
	here = pathlib.Path(__file__).resolve().parents[2] / "examples" / "data" / "toyoura.csv"
	keys = {"radius": 0.01, "height": 0.02, "gradation": str(here), "grains": 200, "friction": 0, "stress": 5e3, **specimen}
	return Config.of({"specimen": keys, "consolidation": {"pressure": 1e5}})


def test_withoutFrictionThePorosityIsThePackings(O):
	"""Smooth grains under a stress have one porosity; without the key it is taken as it comes, with it a wrong one is refused."""
	packing = specimen.make(frictionless(), lambda line: None)
	assert len(packing) == 200 and 0.36 < packing.porosity < 0.46 and not math.isclose(packing.porosity, 0.40, abs_tol=1e-3)
	with pytest.raises(RuntimeError, match="porosity = 0.5: grains without friction have one porosity at this stress.*; fix: "):
		specimen.make(frictionless(porosity=0.5), lambda line: None)
