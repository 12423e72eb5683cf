# SPDX-License-Identifier: GPL-2.0-or-later
"""What Platen and its Python helper refuse, and where the helper puts a platen."""

import math
import os
import subprocess
import sys

import pytest
from contactScene import material
from hexmembrane.scene.platens import platen
from yade import Platen, Vector3


@pytest.mark.parametrize("attribute", ("radius", "height"))
@pytest.mark.parametrize("value", (0, -1e-3, math.inf))
def test_sizesAreCheckedBeforeAnythingChanges(attribute, value):
	with pytest.raises(ValueError, match="Platen." + attribute):
		Platen(**{"radius": 0.01, "height": 0.01, attribute: value})
	good = Platen(radius=0.02, height=0.03)
	with pytest.raises(ValueError, match="Platen." + attribute):
		setattr(good, attribute, value)
	assert (good.radius, good.height) == (0.02, 0.03)


@pytest.mark.parametrize(
	"change, part",
	(
		({"radius": -1}, "platen.radius"),
		({"radius": math.nan}, "platen.radius"),
		({"height": 0}, "platen.height"),
		({"facing": 0}, "platen.facing"),
		({"facing": 2}, "platen.facing"),
		({"faceCentre": (0, 0)}, "platen.faceCentre"),
		({"faceCentre": (0, math.nan, 0)}, "platen.faceCentre"),
		({"material": "steel"}, "platen.material"),
		({"material": 7}, "platen.material"),
	),
)
def test_helperRefuses(O, change, part):
	material()
	with pytest.raises(ValueError, match=part):
		platen(**{"faceCentre": (0, 0, 0), "radius": 0.02, "height": 0.01, "facing": 1, **change})
	assert len(O.bodies) == 0


def test_helperNeedsAMaterial(O):
	with pytest.raises(ValueError, match="platen.material"):
		platen((0, 0, 0), 0.02, 0.01, 1)


def test_helperPlacesTheFace(O):
	material()
	below, above = platen((1, 2, 3), 0.02, 0.01, +1), platen((1, 2, 3), 0.02, 0.01, -1)
	assert below.state.pos == Vector3(1, 2, 2.995) and above.state.pos == Vector3(1, 2, 3.005)
	assert below.state.refPos == below.state.pos
	assert below.state.blockedDOFs == "xyzXYZ" and not below.dynamic
	assert below.material is not None and below.material.label == O.materials[0].label
	O.bodies.append([below, above])
	assert isinstance(O.bodies[1].shape, Platen)


def test_missingSizeEndsTheRunWithItsMessage():
	"""YADE calls bound functors in a parallel loop, out of which no exception comes: the program ends, with the message."""
	here = os.path.dirname(os.path.abspath(__file__))
	script = (
		"import sys; sys.path[:0] = [%r, %r]\n"
		"import conftest, yade, contactScene\n"
		"from yade import O\n"
		"contactScene.material()\n"
		"b = yade.Body(); b.shape = yade.Platen(radius=1); b.material = O.materials[0]; b.dynamic = False\n"
		"O.bodies.append(b)\n"
		"O.engines = contactScene.referenceEngines()\n"
		"O.step()\n"
	) % (os.path.dirname(here), here)
	run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)
	assert run.returncode != 0
	assert "Platen.height = nan: not given" in run.stderr + run.stdout
