# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains and lateral boundary in space, from the VTK frames of a test: positions and quantities of all frames as arrays for the page. Uses nothing of YADE."""

import dataclasses
import math
import re
from typing import Callable

import numpy as np

from hexmembrane.output import vtk
from hexmembrane.report import chains, encode, profiles
from hexmembrane.report.runs import table

_FRAME = re.compile(r'timestep="([^"]+)" part="0" file="([^"/]+)"')
#: Bytes of numbers before compression that all scenes of a page may have together; frames are left out beyond. A study's test with 16 has 7e6.
MOST_BYTES = 1.6e7
_BYTES = 2


@dataclasses.dataclass(frozen=True)
class Quantity:
	"""A colour of grains or boundary: ``of(points' arrays)`` gives its values in ``unit``; ``needs``: array; ``signed``: its scale has 0 in the middle."""

	name: str
	label: str
	unit: str
	needs: str
	of: Callable
	signed: bool = False


def _length(name, factor=1.0):
	return lambda arrays: factor * np.linalg.norm(arrays[name], axis=1)


def _times(name, factor=1.0):
	return lambda arrays: factor * arrays[name]


GRAINS = (
	Quantity("displacement", "displacement", "mm", "displacement", _length("displacement", 1e3)),
	Quantity("settlement", "vertical displacement, up positive", "mm", "displacement", lambda arrays: 1e3 * arrays["displacement"][:, 2], True),
	Quantity("coordination", "contacts of the grain", "", "coordination", _times("coordination")),
	Quantity("shear", "shear intensity", "", "deviatoric_sum", _times("deviatoric_sum")),
	Quantity("volumetric", "volumetric strain of the cell", "%", "volumetric_sum", _times("volumetric_sum", 100), True),
	Quantity("rotation", "rotation", "degrees", "rotation_sum", _length("rotation_sum", 180 / math.pi)),
	Quantity("porosity", "porosity of the cell", "", "void_ratio", lambda arrays: arrays["void_ratio"] / (1 + arrays["void_ratio"])),
	Quantity("mean_stress", "mean stress of the cell", "kPa", "mean_stress", _times("mean_stress", 1e-3)),
	Quantity("shear_stress", "shear stress of the cell", "kPa", "shear_stress", _times("shear_stress", 1e-3)),
)
BOUNDARY = (
	Quantity("pressure", "pressure on it", "kPa", "pressure", _times("pressure", 1e-3)),
	Quantity("normal", "normal displacement, outward positive", "mm", "normal_displacement", _times("normal_displacement", 1e3), True),
	Quantity("hoop_tension", "hoop tension", "N/m", "hoop_tension", _times("hoop_tension")),
	Quantity("axial_tension", "axial tension", "N/m", "axial_tension", _times("axial_tension")),
)


def _series(run, name):
	"""(time [s], path) of the frames of a series, [] without one."""
	path = run.folder / "vtk" / f"{name}.pvd"
	try:
		text = path.read_text(encoding="utf-8")
		return [(float(time), path.with_name(file)) for time, file in _FRAME.findall(text)]
	except FileNotFoundError:
		return []
	except (OSError, ValueError) as error:
		run.problems.append(f"vtk/{name}.pvd cannot be read: {error}")
		return []


def _strains(run, times):
	"""Where frames are on the slider, by their times: axial strains of shear, numbered from 0 where the records do not tell; of a list of stages the times."""
	shear = run.rows("shear")
	if run.staged:
		return np.array(times)
	return np.interp(times, shear["time"], shear["axial_strain"]) if shear else np.arange(len(times), dtype=float)


def _frames(run):
	"""Pairs of files of a test, grains and boundary: (time, path, path or None) each, only those that are there."""
	around = dict(_series(run, run.boundary))
	return [(time, path, around.get(time)) for time, path in _series(run, "grains")]


def _readFrame(run, path):
	"""As :func:`hexmembrane.output.vtk.read`, a surface's arrays of triangles as means at its points; None and a problem when it cannot be read."""
	try:
		points, cells, arrays, ofCells = vtk.read(path)
	except (OSError, ValueError, AttributeError) as error:
		run.problems.append(f"vtk/{path.name} cannot be read: {error}")
		return None
	if not len(points) or not np.isfinite(points).all():
		run.problems.append(f"vtk/{path.name} is damaged: it holds no points.")
		return None
	if cells.shape[1] == 3:
		count = np.maximum(np.bincount(cells.ravel(), minlength=len(points)), 1)
		for name in set(ofCells) - set(arrays):
			arrays[name] = np.bincount(cells.ravel(), np.repeat(ofCells[name].astype(float), 3), len(points)) / count
	return points, cells, arrays


def _bodies(read, quantities):
	"""Positions and quantities of all frames, encoded; a quantity that no frame has is left out."""
	found = {"position": encode.array([points for points, _, _ in read]), "quantities": []}
	for one in quantities:
		if not any(one.needs in arrays for _, _, arrays in read):
			continue
		values = [one.of(arrays) if one.needs in arrays else np.full(len(points), math.nan) for points, _, arrays in read]
		seen = np.concatenate(values)
		seen = seen[np.isfinite(seen)]
		low, high = np.percentile(seen, (0.5, 99.5)) if len(seen) else (0.0, 0.0)
		if one.signed:
			low, high = -max(abs(low), abs(high)), max(abs(low), abs(high))
		values = encode.array(np.array(values)[:, :, None])
		found["quantities"].append({"name": one.name, "label": one.label, "unit": one.unit, "signed": one.signed, "range": [float(low), float(high)], "values": values})
	return found


def _same(run, read, what):
	"""The frames that have as many points as the first."""
	kept = [(k, frame) for k, frame in enumerate(read) if frame is not None]
	if not kept:
		return [], []
	count = len(kept[0][1][0])
	if odd := [k for k, frame in kept if len(frame[0]) != count]:
		run.problems.append(f"{len(odd)} frames of the {what} have another number of points than the first and are left out.")
	kept = [(k, frame) for k, frame in kept if len(frame[0]) == count]
	return [k for k, _ in kept], [frame for _, frame in kept]


def bytesOf(run):
	"""Bytes of numbers of all frames of a test before compression; 0 without frames."""
	listed = [one for one in _frames(run) if one[1].is_file()]
	if not listed:
		return 0
	first = [(_points(path), names) for path, names in zip(listed[0][1:], (GRAINS, BOUNDARY)) if path is not None and path.is_file()]
	contacts = next(iter(dict(_series(run, "contacts")).values()), None)
	return _BYTES * len(listed) * (sum(count * (3 + len(names)) for count, names in first) + (chains.NUMBERS * chains.countOf(contacts) if contacts else 0))


def _points(path):
	try:
		return len(vtk.read(path)[0])
	except (OSError, ValueError, AttributeError):
		return 0


def scene(run, every=1):
	"""The frames of a test for the page, None without any that can be read.

	:param every: of so many frames one is taken, and the last.
	"""
	listed = _frames(run)
	whole = [one for one in listed if one[1].is_file()]
	if len(whole) < len(listed):
		run.problems.append(f"{len(listed) - len(whole)} of {len(listed)} frames in vtk/ are missing.")
	if not whole:
		return None
	chosen = sorted({*range(0, len(whole), every), len(whole) - 1})
	if len(chosen) < len(whole):
		run.problems.append(f"Of {len(whole)} frames {len(chosen)} are in this page, lest it grow too large.")
	whole = [whole[k] for k in chosen]
	at, grains = _same(run, [_readFrame(run, path) for _, path, _ in whole], "grains")
	if not grains:
		return None
	whole = [whole[k] for k in at]
	found = {"strains": encode.numbers(_strains(run, [time for time, _, _ in whole])), "grains": _bodies(grains, GRAINS)}
	found["grains"]["radius"] = encode.array(grains[0][2]["radius"].reshape(1, -1, 1))
	boundaries = [_readFrame(run, path) if path and path.is_file() else None for _, _, path in whole]
	at, boundaries = _same(run, boundaries, "boundary")
	if boundaries and len(at) == len(whole):
		found["boundary"] = {**_bodies(boundaries, BOUNDARY), "triangles": encode.whole(boundaries[0][1])}
		found["profile"] = profiles.ofFrames(boundaries, found["strains"])
	elif any(path for _, _, path in whole):
		run.problems.append("Not every frame has its lateral boundary: it is left out of the scene.")
	contacts = dict(_series(run, "contacts"))
	if contacts:
		if missing := sum(time not in contacts for time, _, _ in whole):
			run.problems.append(f"{missing} of {len(whole)} frames have no contacts: there are no force chains.")
		else:
			found["chains"] = chains.ofFrames(run, [contacts[time] for time, _, _ in whole])
	found["bottom"] = encode.numbers([(points[:, 2] - arrays["radius"]).min() for points, _, arrays in grains])
	found["planes"] = _planes(run)
	return found


def _planes(run):
	"""Planes of the bands by strain: {"strain", "dip", "azimuth" [degrees], "height" above the bottom, "thickness" [m]}."""
	bands = table(run, "bands.csv", ("verdict",))
	if bands is None:
		return []
	names = ("dip", "azimuth", "height", "thickness")
	at = run.at(bands["axial_strain"], bands["step"])
	found = [[float(at[k]), *(float(bands[name][k]) for name in names)] for k, verdict in enumerate(bands["verdict"]) if verdict in ("band", "pair")]
	return [dict(zip(("strain", *names), values)) for values in found if np.isfinite(values).all()]
