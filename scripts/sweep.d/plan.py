# SPDX-License-Identifier: GPL-2.0-or-later
"""From a checked study to ``plan.json``: its tests, the stages that they share, what each stage will cost. The folder of the plan is moved and archived as a whole."""

import contextlib
import json
import pathlib
import shutil

from dependence import CONSOLIDATION, SHEAR, SPECIMEN, contentOf, foldersOf, givesOwnPorosity, names
import studyfile
from hexmembrane.configuration import ConfigError, toDict
from hexmembrane.configuration import stages as lists
from hexmembrane.configuration.lab import Lab
from hexmembrane.configuration.specimen import PATHS
from hexmembrane.run import estimate
from hexmembrane.scene import accuracy, specimen

FORMAT = 1
NAME, STAGES_FOLDER, INPUTS, RESULT = "plan.json", "stages", "inputs", "result.json"
#: Processor time [s] of a stage's start, and of the start of scripts/sweep itself, both on the machine that these and estimate.STEP are of.
_START, SWEEP_START = 1.0, 1.05
#: Time [s] of a sphere in a stage's scene: it is made or read, the critical step sought, the state written.
_SPHERE_TIME = 1.5e-4
#: Time [s] of a grain that is packed, of a picture, of a row, of a checkpoint, of a search for bands among 1,200 grains, and of a replicate of one there.
_PACKING_TIME, _PICTURE_TIME, _ROW_TIME, _CHECKPOINT_TIME, _BANDS_TIME, _REPLICATE_TIME = 2e-3, 0.5, 3e-3, 0.02, 0.25, 0.01
#: Bytes of a grain that is packed, of a picture.
_PACKING, _PICTURE = 90, 150000


def _settled(config):
	"""The configuration with what ``accuracy`` chooses, and the radii of its grains; no laboratory, and pictures in VTK and pages only when they are asked for."""
	radii = specimen.plannedRadii(config)
	if config.accuracy is not None:
		accuracy.choose(config, radii)
	config.accuracy = None
	config.lab = Lab()  # its file is no part of a study's folder
	if "output.vtkEvery" not in config.given:
		config.output.vtkEvery = 0
	if "output.report" not in config.given:
		config.output.report = False
	return radii


def _threads(config):
	"""Threads of a test's steps: one, unless its configuration says more."""
	return config.numerics.threads or 1


def _costs(config, radii):
	"""{stage: (processor time [s], bytes on the disk, processor time of the steps in it [s])}, as a test's own estimate has them.

	:raises ConfigError: the test is beyond this machine, or not sound.
	"""
	estimate.requireStiffness(config, radii)
	estimate.requireTravel(config)
	needs = estimate.Estimate.of(config, radii)
	needs.require(config, estimate.Machine.here())
	spheres = needs.grains + needs.membrane
	one = needs.seconds / (needs.consolidation + needs.shear) * (1 + estimate.UNDIVIDED * (_threads(config) - 1))
	start = _START + _SPHERE_TIME * spheres
	kept = spheres * (estimate.STATE + 2 * estimate.CHECKPOINT)
	rows = needs.consolidation / config.output.consolidationSteps, sum(stage.records for stage in lists.plan(config))
	row = _ROW_TIME + (_CHECKPOINT_TIME / config.output.checkpointEvery if config.output.checkpointEvery else 0)
	each = {
		SPECIMEN: (_START + _PACKING_TIME * len(radii), _PACKING * len(radii), 0.0),
		CONSOLIDATION: (start + one * needs.consolidation + row * rows[0], kept + estimate.ROW * rows[0], one * needs.consolidation),
		SHEAR: (start + one * needs.shear + row * rows[1] + _PICTURE_TIME + _bandsTime(config, needs.grains), kept + estimate.ROW * rows[1] + _PICTURE, one * needs.shear),
	}
	made = {}
	for stage, parts in foldersOf(config).items():
		time, size, steps = (sum(each[part][k] for part in parts) for k in range(3))
		made[stage] = time - start * (len(parts) - 1), size, steps  # a list of stages starts once
	return made


def _bandsTime(config, grains):
	"""Processor time [s] of the search for bands in a test."""
	keys = config.measure
	steps = config.shear.strain / keys.step if keys.bands else 0
	return steps * (_BANDS_TIME + _REPLICATE_TIME * keys.replicates) * (0.5 + grains / 2400)


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
		try:
			radii = _settled(run.config)
			stages, costs, before = names(run.config), _costs(run.config, radii), None
		except ConfigError as error:
			raise studyfile.wrongRun(run.name, {**run.values, studyfile.SEED: run.seed}, error) from None
		for stage, name in stages.items():
			if name not in jobs:
				keys = _keys(run.config, inputs)
				if before:
					keys["specimen"].update(packing=f"{STAGES_FOLDER}/{stages[SPECIMEN]}/test/packing.txt", gradation=None)
				jobs[name] = {"stage": stage, "before": before, "seconds": round(costs[stage][0], 2), "bytes": round(costs[stage][1]), "config": keys}
				jobs[name]["stepping"] = round(costs[stage][2], 2)
				jobs[name]["threads"] = 1 if stage == SPECIMEN else _threads(run.config)
				keys["numerics"]["threads"] = None  # the job starts YADE with them
				if stage == SHEAR:
					jobs[name]["rows"] = list(lists.plan(run.config)[-1].chain)
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
	for job in plan["jobs"].values():
		job.setdefault("threads", 1)  # plans of older versions say none
	return plan


def result(folder, name):
	"""What became of a stage, a dict with ``status`` 'done' or 'failed'; None: it has not ended."""
	try:
		found = json.loads((pathlib.Path(folder) / STAGES_FOLDER / name / RESULT).read_text(encoding="utf-8"))
	except (OSError, ValueError):
		return None
	return found if isinstance(found, dict) and found.get("status") in ("done", "failed") else None
