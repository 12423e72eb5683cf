# SPDX-License-Identifier: GPL-2.0-or-later
"""What stands on the pages runs: each command line, each Python and each YAML snippet of each Markdown file.

A command line is run here, in a short form where the whole takes minutes, or another test runs it, or it can only be run by hand: COMMANDS says which. Options
of all command lines, those in running text too, are ones that the command knows.
"""

import contextlib
import functools
import importlib.util
import io
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys

import exchangeScene
import pytest
import test_scripts
import yaml
from hexmembrane.configuration import Config
from pagesTable import BY_HAND, COMMANDS, SNIPPETS, YAMLS, Elsewhere, Run
from tinyTest import TINY, configure
from yade import O, plot

ROOT = pathlib.Path(__file__).resolve().parents[2]
SETUP = ROOT / "scripts" / "setup.d"
sys.path.append(str(ROOT / "scripts" / "docs.d"))
from sources import PAGES, markdownFiles  # noqa: E402

FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`((?:scripts/[\w-]+|cmake|xvfb-run) [^`\n]+)`")
PATHS = [ROOT / file for file in markdownFiles()] + sorted(PAGES.glob("*.md"))
TEXTS = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in PATHS}
#: Languages of blocks that are shown only, or that Sphinx takes.
SHOWN = re.compile(r"text|\{\w+\}.*")


def blocks(*languages):
	"""(page, code) of all blocks in these languages."""
	return [(page, code) for page, text in TEXTS.items() for language, code in FENCE.findall(text) if language in languages]


def stripped(line):
	return re.sub(r"\s+#.*", "", line).strip()


#: Command lines in blocks, without comments, and those in running text that have arguments.
LINES = sorted({stripped(line) for _, code in blocks("") for line in code.splitlines() if stripped(line)})
INLINES = sorted({line for text in TEXTS.values() for line in INLINE.findall(FENCE.sub("", text))} - set(LINES))
#: A form of a command, with names to fill in or with options alone: nothing to run.
FORM = re.compile(r"\S+ .*([A-Z]{3,}|\[|\.\.\.).*|\S+( --?[\w-]+)+|\S+/bench \w+ (prove|figures) .*")
#: Scripts that test_scripts.py runs, all of them.
PLAIN = re.compile(r"scripts/yade (-x )?examples/scripts/(\w+)\.py( out/view\.jpg)?")
ROWS = {*LINES, *(line for line in INLINES if not FORM.fullmatch(line))}


def launcher():
	spec = importlib.util.spec_from_file_location("launch", SETUP / "launch.py")
	module = importlib.util.module_from_spec(spec)
	spec.loader.exec_module(module)
	return module


@functools.cache
def command(name):
	"""The text of a command, and the Python script that it starts."""
	text = (ROOT / "scripts" / name).read_text(encoding="utf-8")
	found = re.findall(r'"\$(checkout|setupDir)/([\w./]+\.py)" ', text)
	return text, {"checkout": ROOT, "setupDir": SETUP}[found[-1][0]] / found[-1][1] if found else None


def called(words):
	"""(script, arguments) that a command line of scripts/ starts."""
	name, arguments = pathlib.PurePath(words[0]).name, words[1:]
	if name == "yade":
		arguments = arguments[next(k for k, word in enumerate(arguments) if not word.startswith("-")) :]
		return ROOT / arguments[0], arguments[1:]
	if words[:2] == ["scripts/bench", "kernels"]:
		return pathlib.Path(os.environ["HEXMEMBRANE_BUILD"]) / "kernel_bench", arguments[1:]
	if name == "bench":
		return ROOT / "scripts" / "bench.d" / f"{arguments[0]}.py", arguments[1:]
	return command(name)[1], arguments


def execute(script, arguments):
	"""(exit code, what it says), run by the launcher in this YADE."""
	O.reset()
	plot.reset()
	kept = list(sys.argv), {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
	said = io.StringIO()
	try:
		with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
			code = launcher().run(str(script), list(arguments))
	finally:
		sys.argv = kept[0]
		for number, handler in kept[1].items():
			signal.signal(number, handler)
		O.reset()
	return code, said.getvalue()


@pytest.fixture(scope="module")
def place(tmp_path_factory):
	"""A folder like the checkout, whose quick.yaml is a test of 200 grains, with what that has left in out/."""
	folder = tmp_path_factory.mktemp("pages")
	for name in ("examples", "pkg", "tests", "scripts"):
		(folder / name).symlink_to(ROOT / name)
	with contextlib.chdir(folder):
		configure(folder, shear={"strain": 0.004}, output={"records": 6, "vtkEvery": 3, "checkpointEvery": 3, "report": True}, title="quick").rename("quick.yaml")
		shutil.copy("quick.yaml", "my.yaml")
		pathlib.Path("triaxial.csv").write_text("axial_strain [%],stress_ratio,volumetric_strain [%]\n" + "".join(f"{k},{1 + k},{-k}\n" for k in range(6)))
		code, said = execute(command("run")[1], ["quick.yaml"])
		assert code == 0, said
		for name in ("out/a", "out/b", "out/c", "out/study", "DIR"):
			shutil.copytree("out/quick", name)
		exchangeScene.states(O, folder / "state", folder / "state-one-cycle-later")
	return folder


def test_allAreInTheTable():
	"""Each command line of a page has its row, and each row its page."""
	plain = {line for line in ROWS if PLAIN.fullmatch(line)}
	assert {PLAIN.fullmatch(line)[2] for line in plain} - {"NAME"} <= set(test_scripts.SAYS)
	assert sorted(ROWS - plain - {*COMMANDS, *BY_HAND}) == [] and sorted({*COMMANDS, *BY_HAND} - ROWS) == []
	assert [(page, language) for page, text in TEXTS.items() for language, _ in FENCE.findall(text) if language not in ("", "python", "yaml") and not SHOWN.fullmatch(language)] == []


@pytest.mark.parametrize("line", [line for line, row in COMMANDS.items() if isinstance(row, Run)])
def test_command(line, place, monkeypatch):
	row = COMMANDS[line]
	monkeypatch.chdir(place)
	monkeypatch.setenv("SHORT", "1")
	words = shlex.split(row.instead or line)
	if words[0] == "scripts/run" and not [word for word in words[1:] if word.endswith(".yaml")]:
		assert "$checkout/examples/quick.yaml" in command("run")[0]
		words.insert(1, "examples/quick.yaml")
	words = [{"examples/quick.yaml": "quick.yaml"}.get(word, word) for word in words] + list(row.more)
	script, arguments = called(words)
	if row.outside or script.suffix != ".py":
		environment = {**os.environ, "PYTHONPATH": str(ROOT / "py")}
		program = [sys.executable, str(script)] if script.suffix == ".py" else [str(script)]
		result = subprocess.run([*program, *arguments], env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
		code, said = result.returncode, result.stdout + result.stderr
	else:
		code, said = execute(script, arguments)
	assert code == row.code and re.search(row.says, said), said
	assert [path for path in row.leaves if not pathlib.Path(path).exists()] == []


@pytest.mark.parametrize("line", [line for line, row in COMMANDS.items() if isinstance(row, Elsewhere)])
def test_commandOfAnotherTest(line):
	row = COMMANDS[line]
	assert row.text in (ROOT / row.file).read_text(encoding="utf-8")


@functools.cache
def known(script):
	"""What a script says of its options; nothing of a plain one."""
	if "argparse" not in script.read_text(encoding="utf-8") and script.parent.name != "hexmembrane":
		return ""
	if script.parent.name == "faults.d":  # Python's own program runs it
		return subprocess.run([sys.executable, str(script), "--help"], capture_output=True, text=True).stdout
	code, said = execute(script, ["--help"])
	assert code == 0, said
	return said


@pytest.mark.parametrize("line", [line for line in LINES + INLINES if line.startswith("scripts/")])
def test_optionsAndFilesAreThere(line):
	"""The command is there, knows its options, and files of the checkout that are named are there too."""
	words = re.sub(r"[][|]", " ", line.replace("...", "")).split()
	assert os.access(ROOT / words[0], os.X_OK)
	files = [word for word in words if re.match(r"(examples|pkg|py|tests)/[\w./-]+\.(py|yaml|txt|csv)$", word) and "NAME" not in word]
	assert [word for word in files if not (ROOT / word).is_file()] == []
	options = [word.partition("=")[0] for word in words if word.startswith("--")]
	if not options or words[0] in ("scripts/yade-batch", "scripts/test") or "kernels" in words:  # options of YADE's, pytest's and Google's own
		return
	if words[:3] == ["scripts/bench", "accuracy", "prove"]:
		words = words[:2]
	script, _ = called(words)
	assert [option for option in options if option not in known(script) and option not in command(pathlib.PurePath(words[0]).name)[0]] == []


@pytest.mark.parametrize("page, code", blocks("python"), ids=lambda value: value if "/" in value and "\n" not in value else "")
def test_python(page, code, place, monkeypatch):
	"""A snippet runs: a whole script as it is, a fragment after its preamble."""
	(key,) = [key for key in SNIPPETS if key[0] == page and key[1] in code]
	row = SNIPPETS[key]
	if isinstance(row, Elsewhere):
		assert row.text in (ROOT / row.file).read_text(encoding="utf-8")
		return
	monkeypatch.chdir(place)
	O.reset()
	for old, new in row.short:
		assert old in code
		code = code.replace(old, new)
	names = {}
	exec(compile(row.before, "preamble", "exec"), names)
	exec(compile(code, page, "exec"), names)
	exec(compile(row.after, "afterwards", "exec"), names)
	O.reset()


def test_everySnippetHasItsRow():
	assert [key for key in SNIPPETS if not any(page == key[0] and key[1] in code for page, code in blocks("python"))] == []


@pytest.mark.parametrize("page, code", [(page, code) for page, code in blocks("yaml") if page not in YAMLS], ids=lambda value: value if "\n" not in value else "")
def test_yaml(page, code, tmp_path):
	"""A part of a configuration is sound beside the other sections of a tiny test."""
	configure(tmp_path)
	tiny = {**TINY, "shear": {"strain": 0.2, "velocity": 0.08}}
	given = yaml.safe_load(code)
	if "grainWall" in given.get("contacts", {}):
		given["boundary"] = "wall"
		assert Config.of({**tiny, **given, "contacts": {name: part for name, part in given["contacts"].items() if name != "grainMembrane"}}, tmp_path)
		given["boundary"] = "membrane"
		given["contacts"] = {name: part for name, part in given["contacts"].items() if name != "grainWall"}
	Config.of({**tiny, **given}, tmp_path)


@pytest.mark.parametrize("page, row", YAMLS.items())
def test_yamlOfAnotherTest(page, row):
	assert any(page == found for found, _ in blocks("yaml")) and row.text in (ROOT / row.file).read_text(encoding="utf-8")
