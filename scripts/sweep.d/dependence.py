# SPDX-License-Identifier: GPL-2.0-or-later
"""Which stage of a test depends on which key of its configuration, stated once; a stage's folder has its name from the keys that it depends on.

A key belongs to the first stage that it acts in. Later stages depend on it through the stage before them. Keys that say only how a result
is reached or shown belong to none, whatever else ``free`` means: a free key of the consolidation's end is no reason to stop a resumed test, yet another
value gives another state.
"""

import dataclasses
import hashlib
import json
import math
import pathlib
from typing import Callable, Optional

from hexmembrane.configuration import toDict
from hexmembrane.configuration import stages as lists
from hexmembrane.configuration.specimen import PATHS

SPECIMEN, CONSOLIDATION, SHEAR = STAGES = ("specimen", "consolidation", "shear")
#: Raised when the same keys name another result, so that no folder of before is taken for it.
_FORMAT = 1


@dataclasses.dataclass(frozen=True)
class At:
	"""A stage that a key acts in first, in the configurations for which ``when(config)`` holds; None: in all."""

	stage: str
	when: Optional[Callable] = None


def _made(config):
	return config.specimen.made


def _stressed(config):
	return _made(config) and config.specimen.stress is not None


def _centred(config):
	return config.membrane.placement == "centred"


def _membrane(config):
	return "membrane" in lists.boundaries(config)


def _wall(config):
	return "wall" in lists.boundaries(config)


def _reference(config):
	return config.tier == "reference"


def _compact(config):
	return config.tier == "compact"


_ALWAYS = {stage: (At(stage),) for stage in STAGES}
_PACKED = (At(SPECIMEN, _made),)
_STIFFNESS = (At(SPECIMEN, _stressed), At(CONSOLIDATION))
_SHEET = (At(CONSOLIDATION, _membrane),)
_RIGID = (At(CONSOLIDATION, _wall),)
#: Key or, with a dot and a star, all other keys of a section -> where it acts, the first that holds; (): in no stage.
TABLE = {
	"title": (),
	"accuracy": (),  # what it chooses is settled before anything is named
	"tier": _ALWAYS[CONSOLIDATION],
	"boundary": _ALWAYS[CONSOLIDATION],
	"stages": _ALWAYS[CONSOLIDATION],
	"specimen.radius": _ALWAYS[SPECIMEN],
	"specimen.height": _ALWAYS[SPECIMEN],
	"specimen.packing": _ALWAYS[SPECIMEN],
	"specimen.balls": _ALWAYS[SPECIMEN],
	"specimen.ballsUnit": (At(SPECIMEN, lambda config: config.specimen.balls is not None),),
	"specimen.gradation": _PACKED,
	"specimen.radiusRange": _PACKED,
	"specimen.radiusMean": _PACKED,
	"specimen.radiusDeviation": _PACKED,
	"specimen.radiusBins": _PACKED,
	"specimen.scale": _PACKED,
	"specimen.cutBelow": _PACKED,
	"specimen.cutAbove": _PACKED,
	"specimen.grains": _PACKED,
	"specimen.porosity": _PACKED,
	"specimen.seed": _PACKED,
	"specimen.stress": _PACKED,
	"specimen.friction": (At(SPECIMEN, _stressed), At(CONSOLIDATION, lambda config: config.consolidation.friction is None), At(SHEAR)),
	"specimen.packingRollingFriction": (At(SPECIMEN, _stressed),),
	"specimen.kn": _STIFFNESS,
	"specimen.ks": _STIFFNESS,
	"specimen.emod": _STIFFNESS,
	"specimen.kratio": _STIFFNESS,
	"specimen.*": _ALWAYS[CONSOLIDATION],
	"membrane.placement": _ALWAYS[SPECIMEN],
	"membrane.particleRadius": (At(SPECIMEN, _centred), At(CONSOLIDATION, _membrane)),
	"membrane.*": _SHEET,
	"wall.*": _RIGID,
	"platens.friction": (At(CONSOLIDATION, lambda config: config.platens.consolidationFriction is None), At(SHEAR)),
	"platens.*": _ALWAYS[CONSOLIDATION],
	"contacts.*": _ALWAYS[CONSOLIDATION],
	"cement.*": (At(CONSOLIDATION, lambda config: config.cement.given),),
	"consolidation.*": _ALWAYS[CONSOLIDATION],
	"shear.strain": (At(CONSOLIDATION, lambda config: config.platens.thickness is None), At(SHEAR)),  # platens are as thick as they travel
	"shear.pressureTolerance": (At(SHEAR, lambda config: config.shear.stopOutsideTolerance),),
	"shear.*": _ALWAYS[SHEAR],
	"measure.*": _ALWAYS[SHEAR],
	"lab.*": (),
	"numerics.threads": (At(CONSOLIDATION, lambda config: (config.numerics.threads or 1) > 1),),  # another order of sums
	"numerics.verlet": (At(CONSOLIDATION, _reference),),
	"numerics.skin": (At(CONSOLIDATION, _compact),),
	"numerics.substeps": (At(CONSOLIDATION, _compact),),
	"numerics.*": _ALWAYS[CONSOLIDATION],
	"output.records": _ALWAYS[SHEAR],
	"output.vtkEvery": (),
	"output.contacts": (),
	"output.report": (),
	"output.checkpointEvery": (At(CONSOLIDATION, _reference),),  # there a test goes on from what it has saved
	"output.*": _ALWAYS[CONSOLIDATION],
}


def flat(values, path=""):
	"""Nested dictionaries as {key path: value}."""
	found = {}
	for name, value in values.items():
		at = f"{path}.{name}" if path else str(name)
		found.update(flat(value, at) if isinstance(value, dict) else {at: value})
	return found


def stageOf(key, config):
	"""The first stage in which the key acts in this test, None: in none.

	:raises KeyError: the table has no row for the key.
	"""
	places = TABLE[key] if key in TABLE else TABLE[key.split(".")[0] + ".*"]
	return next((place.stage for place in places if place.when is None or place.when(config)), None)


def contentOf(path):
	"""SHA-256 of a file."""
	return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def givesOwnPorosity(config):
	"""Whether the packing has the porosity that grains without friction find under a stress (see :func:`hexmembrane.scene.specimen.make`)."""
	return _stressed(config) and config.specimen.friction == 0 and "specimen.porosity" not in config.given


def ownKeys(config, stage):
	"""{key: value} of the keys that act in the stage and in none before it; a file is known by its content.

	:param config: checked configuration without ``accuracy``.
	"""
	files = {f"specimen.{name}" for name in PATHS}
	found = {key: value for key, value in flat(toDict(config)).items() if stageOf(key, config) == stage}
	found.update({key: contentOf(found[key]) for key in files & set(found) if found[key] is not None})
	if "specimen.porosity" in found and givesOwnPorosity(config):
		found["specimen.porosity"] = "its own"
	return found


def foldersOf(config):
	"""{stage that has a folder of its own: stages that run there}. A list of stages runs in one: what its consolidations have is not shared."""
	return {stage: (stage,) for stage in STAGES} if config.stages is None else {SPECIMEN: (SPECIMEN,), SHEAR: (CONSOLIDATION, SHEAR)}


def names(config):
	"""{stage: name of its folder}, such as 'shear-0123456789abcdef'."""
	made, before = {}, ""
	for stage, parts in foldersOf(config).items():
		keys = {key: "inf" if value == math.inf else value for part in parts for key, value in ownKeys(config, part).items()}
		text = json.dumps([_FORMAT, before, keys], sort_keys=True, allow_nan=False)
		before = hashlib.sha256(text.encode()).hexdigest()[:16]
		made[stage] = f"{stage}-{before}"
	return made
