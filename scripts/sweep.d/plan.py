# SPDX-License-Identifier: GPL-2.0-or-later
"""From a checked study to ``plan.json``: its tests, the stages that they share, what each stage will cost. The folder of the plan is moved and archived as a whole."""

import contextlib
import json
import math
import pathlib
import shutil

from dependence import CONSOLIDATION, SHEAR, SPECIMEN, contentOf, givesOwnPorosity, names
from hexmembrane.configuration import toDict
from hexmembrane.configuration.config import PATHS
from hexmembrane.scene import accuracy, specimen, timestep

FORMAT = 1
NAME, STAGES_FOLDER, INPUTS, RESULT = "plan.json", "stages", "inputs", "result.json"
#: Time of one particle in one step [s] on one thread: the compact tier with its membrane, and YADE's own loop. Rough, pkg/compact/README.md has the measurements.
PARTICLE_STEP = {"compact": 2e-7, "reference": 1.5e-6}
#: Start of YADE, plots and files of a stage [s].
_START = 4.0
#: Ramps of the pressure that a consolidation takes in all, until it is at rest.
_RAMPS = 2.0
#: Share of the grains' critical step that a membrane's spheres leave.
_MEMBRANE_SHARE = 0.6
#: Bytes of a particle in a kept state, in the two checkpoints that are kept, in a packing; bytes of a row and of a picture.
_STATE, _CHECKPOINTS, _PACKING, _ROW, _PICTURE = 250, 1500, 90, 800, 150000


def _settled(config):
	"""The configuration with what ``accuracy`` chooses, and the radii of its grains; one thread, and pictures in VTK only when they are asked for."""
	radii = specimen.plannedRadii(config)
	if config.accuracy is not None:
		accuracy.choose(config, radii)
	config.accuracy, config.numerics.threads = None, None
	if "output.vtkEvery" not in config.given:
		config.output.vtkEvery = 0
	return radii


def _particles(config, radii):
	if config.boundary != "membrane":
		return len(radii)
	radius = config.membrane.particleRadius or config.membrane.sizeRatio * float(radii.min())
	rows = config.specimen.height / (math.sqrt(3) * radius) + 2 * config.membrane.oRingRows
	return round(len(radii) + math.pi * config.specimen.radius / radius * rows)


def _costs(config, radii):
	"""{stage: (processor time [s], bytes on the disk)}: estimates."""
	particles, shear = _particles(config, radii), config.shear
	step = config.numerics.dt or config.numerics.safety * timestep.grainStep(config.specimen, radii) * (_MEMBRANE_SHARE if config.boundary == "membrane" else 1)
	ramp = config.consolidation.rampTime or 30 * timestep.inertialTime(radii, config.specimen.density, config.consolidation.pressure)
	sheared = (shear.strain + shear.rampStrain) * config.specimen.height / shear.velocity
	one = particles * PARTICLE_STEP[config.tier]
	steps = _RAMPS * ramp / step
	return {
		SPECIMEN: (_START + 2e-3 * len(radii), _PACKING * len(radii)),
		CONSOLIDATION: (_START + one * steps, particles * (_STATE + _CHECKPOINTS) + _ROW * steps / config.output.consolidationSteps),
		SHEAR: (_START + one * sheared / step, particles * (_STATE + _CHECKPOINTS) + _ROW * config.output.records + _PICTURE),
	}


def _keys(config, inputs):
	"""The configuration as keys for a job; files by their place under the plan's folder, which ``inputs`` collects: place -> file."""
	keys = toDict(config)
	for name in PATHS:
		if (path := keys["specimen"][name]) is not None:
			place = f"{INPUTS}/{contentOf(path)[:12]}/{pathlib.Path(path).name}"
			inputs[place] = path
			keys["specimen"][name] = place
	if givesOwnPorosity(config):
		del keys["specimen"]["porosity"]
	return keys


def make(study):
	"""The plan of a :class:`studyfile.Study` as plain values, and its input files: place under the plan's folder -> file."""
	runs, jobs, inputs = [], {}, {}
	for run in study.runs:
		radii = _settled(run.config)
		stages, costs, before = names(run.config), _costs(run.config, radii), None
		for stage, name in stages.items():
			if name not in jobs:
				keys = _keys(run.config, inputs)
				if before:
					keys["specimen"].update(packing=f"{STAGES_FOLDER}/{stages[SPECIMEN]}/test/packing.txt", gradation=None)
				jobs[name] = {"stage": stage, "before": before, "seconds": round(costs[stage][0], 2), "bytes": round(costs[stage][1]), "config": keys}
			before = name
		runs.append({"name": run.name, "values": run.values, "seed": run.seed, "stages": stages})
	return {"format": FORMAT, "title": study.title, "study": study.source, "axes": study.axes, "attempts": study.attempts, "runs": runs, "jobs": jobs}, inputs


def part(plan, runs):
	"""The plan of some of its runs (their names) alone."""
	kept = [run for run in plan["runs"] if run["name"] in runs]
	wanted = {name for run in kept for name in run["stages"].values()}
	return {**plan, "runs": kept, "jobs": {name: job for name, job in plan["jobs"].items() if name in wanted}}


def write(plan, inputs, folder):
	"""Write plan and inputs into a folder, each by temporary name and rename; nothing is touched that is as it should be."""
	folder = pathlib.Path(folder)
	for place, path in inputs.items():
		target = folder / place
		if not target.is_file():
			target.parent.mkdir(parents=True, exist_ok=True)
			shutil.copyfile(path, target.with_name(target.name + ".part"))
			target.with_name(target.name + ".part").replace(target)
	writeText(folder / NAME, json.dumps(plan, indent=1) + "\n")


def writeText(path, text):
	"""Write a file by temporary name and rename, unless it says that already."""
	with contextlib.suppress(OSError):
		if path.read_text(encoding="utf-8") == text:
			return
	part = path.with_name(path.name + ".part")
	part.write_text(text, encoding="utf-8")
	part.replace(path)


def read(folder):
	"""The plan in a folder. :raises OSError, ValueError: there is none."""
	plan = json.loads((pathlib.Path(folder) / NAME).read_text(encoding="utf-8"))
	if plan.get("format") != FORMAT:
		raise ValueError(f"plan = '{folder}': is of format {plan.get('format')}, this version reads {FORMAT}; fix: use the version that wrote it")
	return plan


def result(folder, name):
	"""What became of a stage, a dict with ``status`` 'done' or 'failed'; None: it has not ended."""
	try:
		found = json.loads((pathlib.Path(folder) / STAGES_FOLDER / name / RESULT).read_text(encoding="utf-8"))
	except (OSError, ValueError):
		return None
	return found if isinstance(found, dict) and found.get("status") in ("done", "failed") else None
