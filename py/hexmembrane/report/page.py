# SPDX-License-Identifier: GPL-2.0-or-later
"""A report's page: gathers what tests have left, and writes one file of HTML with libraries, scripts, style and data in it. Uses nothing of YADE.

The page loads nothing: its policy allows the scripts that are in it, by their digests, and no connection.
"""

import base64
import datetime
import hashlib
import html
import math
import pathlib

import hexmembrane
from hexmembrane.report import curves, laboratories, libraries, profiles, runs, sections, spatial, verdict
from hexmembrane.report.encode import numbers, script
from hexmembrane.report.summary import halfWidth, quantities

_SOURCES = pathlib.Path(__file__).with_name("page")
#: The page's own scripts, in the order in which they are run.
_SCRIPTS = ("data", "colours", "figure", "curves", "points", "sheet", "chains", "tools", "scene", "sections", "text", "renew", "main")


def _scatter(group):
	"""Relative half width of the mean peak of q over a group's tests, and their number."""
	peaks = [quantities(run.rows("shear"))["peak_q"] for run in group]
	return float(halfWidth(peaks)) * len(peaks) / sum(peaks), len(peaks)


def _rowsOfStages(run):
	"""Of a test with a list of stages the time [s], strain and stage of each row, which tell where the slider is; None of another test."""
	if not run.staged or not run.table:
		return None
	return {"time": numbers(run.table["time"]), "strain": numbers(run.table["axial_strain"]), "stage": [str(name) for name in run.table["stage"]]}


def _content(run, group, every, labs):
	"""All that the page tells of a test. What reads files comes first: it adds to the run's problems."""
	scene = spatial.scene(run, every)
	profile = profiles.measured(run) or (scene or {}).pop("profile", None)
	(scene or {}).pop("profile", None)
	return {
		"name": run.name,
		"title": run.title,
		"label": run.label(),
		"folder": str(run.folder),
		"state": run.state(),
		"curves": curves.ofRun(run),
		"stages": _rowsOfStages(run),
		"scene": scene,
		"clouds": sections.ofRun(run),
		"profile": profile,
		"summary": verdict.summary(run),
		"verdict": [vars(check) for check in verdict.checks(run, _scatter(group) if group else None)],
		"apart": laboratories.apart(run, labs),
		"configuration": run.text,
		"made": {str(name): str(value) for name, value in run.made.items() if name != "budget"},
		"digests": runs.digests(run),
		"problems": list(dict.fromkeys(run.problems)),
	}


def gather(folders, curvesOfLaboratories=(), watch=None):
	"""The content of a page.

	:param folders: of tests and studies. :param curvesOfLaboratories: CSV files, see :mod:`hexmembrane.report.laboratories`.
	:param watch: seconds after which the page loads itself anew, None: never.
	:raises ReportError: a folder or file is none of these.
	"""
	found = runs.gather(folders)
	labs = laboratories.gather(found, curvesOfLaboratories)
	groups = curves.groups(found)
	groupOf = {run.name: group for group in groups for run in group}
	every = max(1, math.ceil(sum(map(spatial.bytesOf, found)) / spatial.MOST_BYTES))
	return {
		"title": found[0].title if len(found) == 1 else f"{len(found)} tests",
		"date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
		"version": hexmembrane.__version__,
		"watch": watch,
		"panels": [{"name": panel.name, "title": panel.title, "unit": panel.unit, "log": panel.log} for panel in curves.PANELS],
		"axes": curves.axes(),
		"runs": [_content(run, groupOf.get(run.name), every, labs) for run in found],
		"groups": [curves.ofGroup(group) for group in groups],
		"differences": runs.differences(found),
		"laboratories": laboratories.drawn(labs),
	}


def _digest(text):
	return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"


def text(content):
	"""The page's HTML.

	:raises LibraryError: a library is not installed.
	"""
	used = libraries.scripts(libraries.CURVES)
	if any(run["scene"] for run in content["runs"]):
		used += libraries.scripts(libraries.SCENES)
	own = "\n".join((_SOURCES / f"{name}.js").read_text(encoding="utf-8") for name in _SCRIPTS)
	code = [one.replace("</script", "<\\/script") for one in (*used, own)]
	policy = f"default-src 'none'; script-src {' '.join(map(_digest, code))}; style-src 'unsafe-inline'; img-src data: blob:"
	parts = {
		"POLICY": policy,
		"TITLE": html.escape(content["title"]),
		"STYLE": (_SOURCES / "style.css").read_text(encoding="utf-8"),
		"DATA": script(content),
		"SCRIPTS": "\n".join(f"<script>{one}</script>" for one in code),
	}
	page = (_SOURCES / "page.html").read_text(encoding="utf-8")
	pieces = page.split("@@")
	return "".join(parts[piece] if k % 2 else piece for k, piece in enumerate(pieces))


def write(path, content):
	"""Write the page by temporary name and rename.

	:raises LibraryError: a library is not installed. :raises OSError: the file cannot be written.
	"""
	path = pathlib.Path(path)
	part = path.with_name(path.name + ".part")
	part.write_text(text(content), encoding="utf-8")
	part.replace(path)
