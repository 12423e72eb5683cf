# SPDX-License-Identifier: GPL-2.0-or-later
"""The site is built without a warning and leads nowhere that is not. Its snippets and commands: test_pages.py."""

import html.parser
import os
import pathlib
import re
import subprocess
import sys
import urllib.parse

import hexmembrane
import pytest
import yade
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "scripts" / "docs.d"
sys.path.append(str(DOCS))
from classes import ROOMS, declared  # noqa: E402
from sources import PAGES  # noqa: E402


@pytest.fixture(scope="module")
def site(tmp_path_factory):
	"""The site's folder, and what was said."""
	out = tmp_path_factory.mktemp("docs") / "site"
	environment = {**os.environ, "PYTHONPATH": str(ROOT / "py")}
	command = [sys.executable, str(ROOT / "scripts" / "setup.d" / "launch.py"), "1", str(DOCS / "build.py"), str(out)]
	result = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=600)
	assert result.returncode == 0, result.stdout[-4000:] + result.stderr[-4000:]
	return out


class Page(html.parser.HTMLParser):
	"""Targets and links of a page."""

	def __init__(self, path):
		super().__init__()
		self.ids, self.links = set(), []
		self.feed(path.read_text(encoding="utf-8"))

	def handle_starttag(self, tag, attributes):
		for name, value in attributes:
			if name == "id":
				self.ids.add(value)
			elif name in ("href", "src") and value and not re.match(r"[a-z]+:", value):
				self.links.append(urllib.parse.unquote(value))


def test_everyLinkLeadsSomewhere(site):
	pages = {path.resolve(): Page(path) for path in site.rglob("*.html")}
	wrong = []
	for path, page in pages.items():
		for link in page.links:
			file, _, anchor = link.partition("#")
			target = (path.parent / file.partition("?")[0]).resolve() if file else path
			if not target.is_file() or (anchor and target in pages and anchor not in pages[target].ids):
				wrong.append(f"{path.relative_to(site.resolve())}: {link}")
	assert len(pages) > 30 and wrong == []


def test_lettersOfEquationsAreInEveryFont(site):
	"""A single Greek letter is upright: as an italic one browsers look for it in fonts for mathematics."""
	text = (site / "theory.html").read_text(encoding="utf-8")
	assert text.count('<mi mathvariant="normal">') > 5 and not re.search(r"<mi(?! mathvariant)[^>]*>\s*[\u0391-\u03f5]\s*</mi>", text)


def test_everyClassAndModuleIsThere(site):
	text = "".join(path.read_text(encoding="utf-8") for path in [*site.glob("classes/*.html"), site / "python.html"])
	names = [f"yade.wrapper.{name}" for room in ROOMS for name in declared(room)]
	assert len(names) > 30 and [name for name in names if f'id="{name}"' not in text] == []
	modules = [path.relative_to(ROOT / "py").with_suffix("") for path in (ROOT / "py").rglob("*.py") if not path.name.startswith("_")]
	assert [name for name in map(lambda path: ".".join(path.parts), modules) if f'id="module-{name}"' not in text] == []


def test_everyAttributeHasPlainText():
	"""No attribute or method without a text; no role and no LaTeX, which a terminal shows as they are."""
	wrong = []
	for name in [name for room in ROOMS for name in declared(room)]:
		kind = getattr(yade.wrapper, name)
		for key in [None, *(key for key in vars(kind) if not key.startswith("_"))]:
			text = re.sub(r":y(default|attrtype|attrflags):`[^`]*`", "", (getattr(kind, key) if key else kind).__doc__ or "")
			statics = re.findall(r"ystaticattr:: \w+\.(\w+)", kind.__doc__ or "")
			if key not in statics and (not text.strip() or re.search(r":yref:|\$|\|yupdate", text)):
				wrong.append(f"{name}.{key}")
	assert wrong == []


def test_citation():
	"""CITATION.cff has the version of the package, and the study as the theory page cites it."""
	cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
	(study,) = cited["references"]
	theory = (PAGES / "theory.md").read_text(encoding="utf-8")
	assert cited["version"] == hexmembrane.__version__ and study["title"] in theory and study["doi"] in theory
	assert all(author["family-names"] in theory for author in study["authors"])
