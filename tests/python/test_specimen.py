# SPDX-License-Identifier: GPL-2.0-or-later
"""The cylinder that the grains are packed into."""

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
