# SPDX-License-Identifier: GPL-2.0-or-later
"""Reports in a browser: opened from the disk as a reader does, by scripts/report.d/look; and that the look finds what is wrong.

``scripts/test`` gives the browser by HEXMEMBRANE_BROWSER. With HEXMEMBRANE_LOOK, a folder, pages and screenshots stay there, and speeds are measured.
"""

import contextlib
import json
import os
import pathlib
import stat
import struct
import sys
import time

import pytest
import yaml
from hexmembrane.report import page
from madeUpTest import HARM, addInside, makeTest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "scripts" / "report.d"))
import look  # noqa: E402
from browser import Browser, BrowserError, Page  # noqa: E402

PROGRAM = os.environ.get("HEXMEMBRANE_BROWSER")
LOOK = os.environ.get("HEXMEMBRANE_LOOK")
#: Of a page: its frames, the slider's place; what the reader has chosen: colour of the grains, range of the curves, place on the page, the camera's.
_VIEW = """[report.state.strains.length, document.getElementById("at").textContent, report.state.parts[0].options.grains, report.curves.view().domain, Math.round(scrollY),
	report.state.parts[0].camera.position.toArray()]"""


@pytest.fixture(scope="module")
def browser():
	if not PROGRAM:
		told = "HEXMEMBRANE_BROWSER names no browser: run the tests with scripts/test, which sets Chromium up."
		(pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(told)
	with Browser(PROGRAM) as one:
		yield one


@pytest.fixture(scope="module")
def out(tmp_path_factory):
	"""Where pages and screenshots go."""
	folder = pathlib.Path(LOOK) if LOOK else tmp_path_factory.mktemp("look")
	folder.mkdir(parents=True, exist_ok=True)
	return folder


@pytest.fixture(scope="module")
def several(tmp_path_factory, out):
	"""The page of a study with a laboratory's curve: two packings, one of them with all that is measured inside and a harmful title, and a damaged test."""
	study = tmp_path_factory.mktemp("study")
	places = {f"{name} {HARM}": study / "stages" / f"shear-{name}" / "test" for name in ("dense-1", "dense-2", "loose-1")}
	for seed, folder in enumerate(places.values(), 1):
		makeTest(folder, seed=seed, title=HARM, last=0.1 if seed < 3 else 0.06, p=1.5e5 + 1e4 * seed)
	first, _, damaged = places.values()
	addInside(first)
	(damaged / "vtk" / "grains-0001.vtp").unlink()
	(damaged / "fields.h5").write_bytes(b"no HDF5")
	config = yaml.safe_load((damaged / "config.yaml").read_text())
	config["specimen"]["friction"] = HARM
	(damaged / "config.yaml").write_text(yaml.safe_dump(config))
	plan = {"runs": [{"name": name, "stages": {"shear": folder.parent.name}} for name, folder in places.items()]}
	(study / "plan.json").write_text(json.dumps(plan))
	laboratory = study / "a <b>laboratory&.csv"
	laboratory.write_text("axial_strain [%],q [kPa],volumetric_strain [%]\n0,0,0\n1,60,-0.1\n2,100,0\n4,150,0.5\n10,180,2\n")
	path = out / "study.html"
	page.write(path, page.gather([study], [laboratory]))
	return path


def test_aPageAsAReaderSeesIt(browser, several, out):
	"""Without errors, light and dark, at three sizes; what is read, moved, picked, zoomed, turned and saved; see scripts/report.d/look.py."""
	assert look.look(browser, several, out, speeds=bool(LOOK)) == []
	for theme in look.THEMES:
		for label, (width, _) in look.SIZES.items():
			header = (out / f"study-{label}-{theme}.png").read_bytes()[:24]
			assert header[:8] == b"\x89PNG\r\n\x1a\n" and width / 2 < struct.unpack(">I", header[16:20])[0] <= width
	assert (out / "study.pdf").read_bytes().startswith(b"%PDF")


def test_whatThePageTells(browser, several):
	"""Texts of a user as they are, what is missing, means with their bands, the plane of a band, the slider's strain in all parts."""
	seen = Page(browser, several.as_uri(), look.SIZES["wide"])
	assert seen.run("document.querySelector('#origin h3').textContent") == f"dense-1 {HARM}: {HARM}"
	assert seen.run("document.querySelectorAll('img, b').length") == 0 and not seen.run("'harmed' in window")
	problems = seen.run("document.querySelector('#problems').textContent")
	assert f"loose-1 {HARM}: fields.h5 cannot be read" in problems and "1 of 3 frames in vtk/ are missing" in problems
	assert problems.count("not at its end") == 1
	names = seen.run("[...document.querySelectorAll('.legend label')].map((one) => one.textContent)")
	assert len(names) == 5 and names[0].endswith(f"mean of 2: {HARM}") and names[4].endswith("laboratory: a <b>laboratory& at 100 kPa")
	shown = seen.run("[...document.querySelectorAll('.panels figure')].filter((one) => !one.hidden).map((one) => one.querySelectorAll('.curve').length)")
	assert shown[0] == 5 and shown[3] == 4  # q, with the laboratory's, and porosity, without
	assert seen.run("document.querySelectorAll('.panels figure path[fill-opacity]').length") >= 10
	assert seen.run("report.state.parts[0].planes.children.length") == 1
	marks = [seen.run("[...document.querySelectorAll('.specimen figcaption span')].map((one) => one.textContent)")]
	seen.run("document.getElementById('strain').value = 0, document.getElementById('strain').dispatchEvent(new Event('input'))")
	assert seen.until("document.getElementById('at').textContent === '0 %'") and seen.until("report.state.parts[1].state === 0")
	marks.append(seen.run("[...document.querySelectorAll('.specimen figcaption span')].map((one) => one.textContent)"))
	assert [len(one) for one in marks] == [3, 3] and all(" 10 %" in one for one in marks[0]) and all(" 0 %" in one for one in marks[1])
	assert seen.errors() == []
	seen.close()


def test_theLookFindsWhatIsWrong(browser, several, out, monkeypatch):
	"""A page with faults of each kind."""
	text = several.read_text(encoding="utf-8")
	start = text.index('<meta http-equiv="Content-Security-Policy"')
	text = text[:start] + text[text.index(">", start) + 1 :]
	text = text.replace("<h1", f"{HARM}<h1", 1).replace("--ink: #1b1f24", "--ink: #dddddd", 1)
	faults = """<script>
		document.querySelector("main").append(report.element("button", {}), report.element("div", { style: "width: 5000px; height: 1px" }));
		document.querySelectorAll("#strain, .panels svg, .stage").forEach((one) => addEventListener("keydown", (event) => event.stopImmediatePropagation(), true));
		report.Scene.prototype.render = function () { this.renderer.clear(); };
		fetch("http://127.0.0.1:9/").catch(() => null);
		setTimeout(() => nothing.isThere);
	</script></body>"""
	path = out / "faulty.html"
	path.write_text(text.replace("</body>", faults), encoding="utf-8")
	monkeypatch.setattr(browser, "patience", 0.3)
	wrong = look.look(browser, path, out, themes=("light",), sizes={"narrow": look.SIZES["narrow"]}, speeds=False)
	for told in (
		"are wider than the window",
		"% are drawn, in 1 colours",
		"light: contrast of text",
		"force chains tell",
		"the scene does not turn by keys",
		"the cursor of curves does not move by keys",
		"without a name: <button></button>",
		"a text of a test was run",
		"asked for http://127.0.0.1:9/",
		"nothing is not defined",
	):
		assert sum(told in one for one in wrong) == 1, (told, wrong)


def test_anUnescapedTextIsRefusedByThePolicy(browser, several, out):
	"""Markup in a page is a fault that the look tells, and is not run."""
	path = out / "unescaped.html"
	path.write_text(several.read_text(encoding="utf-8").replace("<h1", f"{HARM}<h1", 1), encoding="utf-8")
	seen = Page(browser, path.as_uri(), look.SIZES["wide"])
	assert any("Content Security Policy" in one for one in seen.errors()) and not seen.run("'harmed' in window")
	seen.close()


def test_anAnswerThatNeverComesIsAnError(browser, monkeypatch):
	"""Of the browser, and of programs in its place: one that ends, one that reads nothing, one that tells without end."""
	seen = Page(browser, "about:blank", look.SIZES["narrow"], ready="0")
	assert seen.run("Promise.resolve(7)") == 7 and not seen.until("false", 0.1)
	with pytest.raises(BrowserError, match="report.ready: ReferenceError"):
		seen.run("report.ready")
	monkeypatch.setattr(browser, "limit", 0.5)
	with pytest.raises(BrowserError, match=r"new Promise\(\(\) => 0\): Runtime.evaluate: no answer within 0.5 s"):
		seen.run("new Promise(() => 0)")
	monkeypatch.undo()
	assert seen.run("1 + 1") == 2
	seen.close()


@pytest.mark.parametrize(
	"does, told",
	[
		("exit 0", "the browser has ended"),
		("sleep 60", "no answer within 0.5 s"),
		("while true; do printf '{\"method\": \"a\"}\\0' >&4; done", "no answer within 0.5 s"),
	],
)
def test_aBrowserThatDoesNotAnswerIsAnError(tmp_path, does, told):
	"""Also with a command that is longer than what its pipe holds; its end is waited for no longer."""
	program, start = tmp_path / "program", time.monotonic()
	program.write_text(f"#!/bin/bash\n{does}\n")
	program.chmod(program.stat().st_mode | stat.S_IXUSR)
	with Browser(program, limit=0.5) as one:
		for _ in range(2):
			with pytest.raises(BrowserError, match=told):
				one.ask("Page.enable", filler="a" * 2**18)
	assert time.monotonic() - start < 10


def test_aPageThatRenewsItselfIsAsTheReaderLeftIt(browser, tmp_path):
	"""Zoom, curves, view and colours of the specimen, place on the page; the slider goes on with the test; also when the page does not renew itself any more."""
	folder, path = makeTest(tmp_path / "a", last=0.05, frames=2), tmp_path / "page.html"
	page.write(path, page.gather([folder], watch=1))
	seen = Page(browser, path.as_uri(), look.SIZES["narrow"])
	assert seen.run("document.getElementById('about').textContent").endswith("renews itself every 1 s")
	makeTest(tmp_path / "later" / "a")
	page.write(path, page.gather([tmp_path / "later" / "a"]))
	seen.run("scrollTo(0, 700), document.querySelector('.panels svg').dispatchEvent(new KeyboardEvent('keydown', { key: '+' }))")
	seen.run("(async () => { const one = report.state.parts[0]; await one.ready; one.options.grains = 'settlement'; one.key(new KeyboardEvent('keydown', { key: '-' })); })()")
	before, end = seen.run(_VIEW), time.monotonic() + 20
	assert before[:3] == [2, "5 %", "settlement"]
	renewed = False
	while not renewed and time.monotonic() < end:
		time.sleep(0.1)
		with contextlib.suppress(BrowserError):  # the page is being loaded
			renewed = seen.run("report.content.watch === null && report.ready.then(() => report.state.parts[0].ready).then(() => true)")
	after = seen.run(_VIEW)
	assert after[:2] == [3, "10 %"] and after[2:5] == before[2:5] and after[5] == pytest.approx(before[5]) and seen.errors() == []
	seen.close()
