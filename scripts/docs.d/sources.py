# SPDX-License-Identifier: GPL-2.0-or-later
"""The sources of the site: the Markdown files of the checkout at their own places, and the pages of scripts/docs.d/pages beside them.

Links in the checkout's files are those of the checkout. A link to a folder becomes one to its README, a link to a file that is no page becomes a download,
a link to a folder without a README becomes its name. A link to nothing is an error.
"""

import os
import pathlib
import re
import shutil

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = pathlib.Path(__file__).resolve().parent / "pages"
#: Folders of the checkout whose Markdown files are pages, and single files.
PLACES = ("pkg", "py", "examples", "scripts", "tests", "README.md", "CONTRIBUTING.md", "CHANGELOG.md")
LINK = re.compile(r"(!?)\[([^\]\n]*)\]\(([^)\s]+)\)")
CODE = re.compile(r"(^```.*?^```|`[^`\n]*`)", re.MULTILINE | re.DOTALL)


def markdownFiles():
	"""Paths relative to the checkout."""
	found = []
	for place in PLACES:
		path = ROOT / place
		found += [path] if path.is_file() else sorted(path.rglob("*.md"))
	return [path.relative_to(ROOT) for path in found if PAGES not in path.parents]


class Sources:
	"""Writes pages into a folder, and copies the files that they link to."""

	def __init__(self, folder):
		self.folder = pathlib.Path(folder)
		self.pages = {*markdownFiles()}

	def write(self, name, text):
		path = self.folder / name
		path.parent.mkdir(parents=True, exist_ok=True)
		if not path.exists() or path.read_text(encoding="utf-8") != text:  # unchanged pages are not read anew
			path.write_text(text, encoding="utf-8")

	def checkout(self):
		"""All Markdown files of the checkout."""
		for page in sorted(self.pages):
			self.write(page, self.relinked(page, (ROOT / page).read_text(encoding="utf-8")))

	def own(self):
		"""The site's own pages; files of the checkout that they include are copied."""
		for path in sorted(PAGES.glob("*.md")):
			text = path.read_text(encoding="utf-8")
			for included in re.findall(r"^```\{literalinclude\} (\S+)", text, re.MULTILINE):
				self.copy(pathlib.Path(included))
			self.write(path.name, text)

	def copy(self, path):
		target = self.folder / path
		target.parent.mkdir(parents=True, exist_ok=True)
		shutil.copy2(ROOT / path, target)

	def relinked(self, page, text):
		"""The page's text with its links as the site has them; code is left as it is."""
		parts = CODE.split(text)
		for k in range(0, len(parts), 2):
			parts[k] = LINK.sub(lambda match: self._link(page, *match.groups()), parts[k])
		# a name in code inside a link's brackets is cut off by the split above: links are joined again and looked at as a whole
		return "".join(parts)

	def _link(self, page, picture, name, target):
		file, mark, anchor = target.partition("#")
		if not file or re.match(r"[a-z]+:", target):
			return f"{picture}[{name}]({target})"
		path = pathlib.Path(os.path.normpath(page.parent / file))
		if (ROOT / path).is_dir():
			path /= "README.md"
			if path not in self.pages:
				return name
		if not (ROOT / path).is_file():
			raise FileNotFoundError(f"{page}: link to {target}: there is no such file; fix: mend the link")
		shown = os.path.relpath(path, page.parent or ".")
		if path in self.pages:
			return f"[{name}]({shown}{mark}{anchor})"
		self.copy(path)
		return f"{picture}[{name}]({shown})" if picture else f"{{download}}`{name} <{shown}>`"
