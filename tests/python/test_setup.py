# SPDX-License-Identifier: GPL-2.0-or-later
"""The set-up's decisions: where Debian's archive is, which build folder is its own.

The functions of scripts/setup.d are called as the scripts call them, on made-up folders.
"""

import os
import pathlib
import shutil
import subprocess

import pytest

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
SETUP = CHECKOUT / "scripts" / "setup.d" / "setup.sh"


@pytest.fixture
def call(tmp_path):
	"""Runs bash after setup.sh was read: (exit code, stdout, stderr)."""

	# The private root has no alternatives: its awk is there under its own name only.
	(tmp_path / "bin").mkdir()
	(tmp_path / "bin" / "awk").symlink_to(shutil.which("awk") or shutil.which("mawk"))

	def run(code, *arguments, **variables):
		environment = {"PATH": "%s/bin:/usr/bin:/bin" % tmp_path, "XDG_CACHE_HOME": str(tmp_path / "cache"), **variables}
		command = ["bash", "-c", ". %s\n%s" % (SETUP, code), "bash", *map(str, arguments)]
		result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
		return result.returncode, result.stdout, result.stderr

	return run


@pytest.fixture
def archive(call, tmp_path):
	"""The archive chosen on a system with the given release and source files."""

	def choose(files, system="debian", codename="bookworm", **variables):
		apt = tmp_path / "apt"
		(apt / "sources.list.d").mkdir(parents=True)
		for name, text in files.items():
			(apt / name).write_text(text)
		release = tmp_path / "os-release"
		release.write_text('NAME="Some"\nVERSION_CODENAME=%s\nID=%s\n' % (codename, system))
		return call('chooseArchive "$@"; echo "$debianArchive"', apt, release, **variables)

	return choose


ONE_LINE = "deb http://near/debian bookworm main\n"
DEB822 = "Types: deb deb-src\nURIs: http://near/debian\nSuites: bookworm bookworm-updates\nComponents: main\nSigned-By: /usr/share/keyrings/debian-archive-keyring.gpg\n"
# for Debian's release, but not Debian
OTHERS = "deb [arch=amd64 signed-by=/etc/apt/keyrings/wine.gpg] http://wine/debian bookworm main\ndeb http://tools/apt tools-bookworm main\n"


@pytest.mark.parametrize(
	"files, codename, wanted",
	[
		({"sources.list": ONE_LINE}, "bookworm", "http://near/debian"),
		({"sources.list": "# deb http://old/debian bookworm main\n" + ONE_LINE.replace("\n", " contrib # near\n")}, "bookworm", "http://near/debian"),
		({"sources.list": "deb cdrom:[Debian 12]/ bookworm main\n" + ONE_LINE}, "bookworm", "http://near/debian"),
		({"sources.list": ONE_LINE.replace("bookworm", "stable")}, "bookworm", "http://near/debian"),
		({"sources.list": ONE_LINE.replace("bookworm", "forky")}, "forky", "http://near/debian"),
		({"sources.list": "deb-src [ signed-by=/usr/share/keyrings/debian-archive-keyring.gpg trusted=no ] https://near:8080/d trixie main\n"}, "trixie", "https://near:8080/d"),
		({"sources.list": "deb mirror+file:/etc/apt/mirrors.list bookworm main\n"}, "bookworm", "mirror+file:/etc/apt/mirrors.list"),
		({"sources.list": OTHERS, "sources.list.d/debian.list": ONE_LINE}, "bookworm", "http://near/debian"),
		({"sources.list": "", "sources.list.d/debian.sources": DEB822}, "bookworm", "http://near/debian"),
		({"sources.list.d/debian.sources": DEB822.replace("http://near/debian", "\n mirror+file:///etc/apt/m.list\n http://far/debian")}, "bookworm", "mirror+file:///etc/apt/m.list"),
		({"sources.list.d/debian.sources": DEB822.replace("near", "off") + "Enabled: no\n\n# ours\n" + DEB822.lower()}, "bookworm", "http://near/debian"),
		({"sources.list.d/debian.sources": DEB822.replace("bookworm bookworm-updates", "bookworm-security").replace("near", "safe") + "\n" + DEB822}, "bookworm", "http://near/debian"),
		({"sources.list.d/a.sources": DEB822.replace("debian-archive-", "wine-").replace("near", "wine"), "sources.list.d/b.sources": DEB822}, "bookworm", "http://near/debian"),
	],
)
def test_archiveOfThisDebian(archive, files, codename, wanted):
	assert archive(files, codename=codename) == (0, wanted + "\n", "")


@pytest.mark.parametrize("system", ["debian", "ubuntu"])
def test_archiveOfTheVariable(archive, system):
	"""What the user says wins on every system."""
	assert archive({"sources.list": ONE_LINE}, system, HEXMEMBRANE_DEBIAN_ARCHIVE="http://mine/debian") == (0, "http://mine/debian\n", "")


@pytest.mark.parametrize(
	"files, system, variable, wanted",
	[
		({"sources.list": ONE_LINE}, "ubuntu", "", "HEXMEMBRANE_DEBIAN_ARCHIVE = : not set, and this system is no Debian"),
		({}, "debian", "", "name no archive of Debian"),
		({"sources.list": OTHERS, "sources.list.d/debian.sources": DEB822 + "Enabled: no\n"}, "debian", "", "name no archive of Debian"),
		({"sources.list": ONE_LINE}, "debian", "near", "HEXMEMBRANE_DEBIAN_ARCHIVE = near: not the address of an archive"),
	],
)
def test_noArchive(archive, files, system, variable, wanted):
	"""The message names the variable and says how to set it."""
	code, said, error = archive(files, system, HEXMEMBRANE_DEBIAN_ARCHIVE=variable)
	assert code == 1 and said == "" and wanted in error and "fix: export HEXMEMBRANE_DEBIAN_ARCHIVE=ADDRESS" in error


CONFIGURE = """hostId=host; checkout=$1
fakeCmake() { printf '%s\\n' "$*"; touch "$1/build/build.ninja" "$1/build/object"; }
entry=(fakeCmake "$1")
configure "$1/build" -DA=1 && cat "$1/build/configure.log" && ls "$1/build"
"""


def test_ownBuildFolderIsMadeAndKept(call, tmp_path):
	"""A second call finds all as it was and configures nothing; other options do."""
	code, said, _ = call(CONFIGURE, tmp_path)
	assert code == 0 and said.startswith("%s cmake -S %s -B %s/build -G Ninja -DA=1\n" % (tmp_path, tmp_path, tmp_path))
	(tmp_path / "build" / "configure.log").write_text("kept\n")
	assert call(CONFIGURE, tmp_path)[1].startswith("kept\n")
	assert "-DA=2" in call(CONFIGURE.replace("-DA=1", "-DA=2"), tmp_path)[1]


def test_aCopiedCheckoutKeepsWhatWasCompiled(call, tmp_path):
	"""The same build at another place is configured anew and not emptied; ninja's commands do not say where the checkout is, but for those that make them."""
	(tmp_path / "build").mkdir()
	first = call(CONFIGURE, tmp_path)[1]
	(tmp_path / "build" / "mine.o").write_text("compiled")
	stamp = tmp_path / "build" / ".host"
	stamp.write_text(stamp.read_text().replace(str(tmp_path), "/another place"))
	assert "cmake -S" in first and "mine.o" in call(CONFIGURE, tmp_path)[1]
	stamp.write_text("another host" + stamp.read_text())
	assert "mine.o" not in call(CONFIGURE, tmp_path)[1]
	place = tmp_path / "a.b [c]"
	place.mkdir()
	lines = ["build x.o: CXX {0}/pkg/x.cpp || order", "  INCLUDES = -I{0} -I{0}/pkg -I{0}/build/made -isystem {0}s/headers", "build build.ninja: RERUN_CMAKE {0}/CMakeLists.txt", "  COMMAND = cmake -S{0}"]
	(place / "build.ninja").write_text("\n".join(lines).format(place))
	code, _, error = call('checkout=$1; nameNoPlace "$1"', place)
	wanted = ["build x.o: CXX ../pkg/x.cpp || order", "  INCLUDES = -I.. -I../pkg -I../build/made -isystem {0}s/headers", *lines[2:]]
	assert code == 0 and (place / "build.ninja").read_text() == "\n".join(wanted).format(place), error


def test_somebodysBuildFolderIsRefused(call, tmp_path):
	"""Files that the set-up has not made are not removed."""
	(tmp_path / "build").mkdir()
	(tmp_path / "build" / "thesis.tex").write_text("years of work")
	code, _, error = call(CONFIGURE, tmp_path)
	assert code == 1 and "build: not made by scripts/" in error and "fix: " in error
	assert (tmp_path / "build" / "thesis.tex").read_text() == "years of work"


def test_interruptedConfigurationGoesOn(call, tmp_path):
	"""A folder that a killed run has left is known by its stamp and made anew."""
	(tmp_path / "build" / "CMakeFiles").mkdir(parents=True)
	(tmp_path / "build" / ".host").write_text("unfinished\n")
	code, said, _ = call(CONFIGURE, tmp_path)
	assert code == 0 and "CMakeFiles" not in said


@pytest.mark.parametrize("variables, asked", [({}, False), ({"CI": "true"}, True)])
def test_warningsAreErrorsInContinuousIntegrationOnly(call, tmp_path, variables, asked):
	assert ("-DHEXMEMBRANE_WERROR=ON" in call(CONFIGURE, tmp_path, **variables)[1]) is asked


COMPLETE = """mkdir -p "$cache/root-$(rootHash)"; chmod a-w "$cache"; HEXMEMBRANE_HOST=root
isDebian13() { false; }
enterRoot() { entry=(%s); }
chooseHost; printf '%%s\\n' "${entry[0]}"; chmod u+w "$cache"
"""


def test_readOnlyCacheWithACompleteRoot(call):
	"""The root is entered and nothing is written; a file in its place makes it read-only for the superuser too."""
	code, said, error = call(COMPLETE.replace("chmod a-w", "mkdir -p \"$cache/enter.log\"; chmod a-w") % "env")
	assert (code, said, error) == (0, "env\n", "")


def test_refusedNamespacesAreToldAsTheyAre(call):
	code, _, error = call(COMPLETE % "sh -c 'echo no namespaces here >\\&2; exit 1'".replace("\\&", "&"))
	assert code == 1 and "refuses mount namespaces (no namespaces here)" in error


@pytest.mark.parametrize("odd", ["a:b", 'a"b', "a\\b", "a\nb"])
def test_cacheThatAptCannotName(call, tmp_path, odd):
	"""The character is named, before the network is asked."""
	code, _, error = call('setUpRoot "$cache/root-x"', XDG_CACHE_HOME=str(tmp_path / odd))
	assert code == 1 and "has the character " + odd[1] + " in its name" in error and "fix: set XDG_CACHE_HOME" in error


@pytest.mark.parametrize("signal, code", [("TERM", 143), ("INT", 130)])
def test_endedCommandSaysNothing(call, signal, code):
	"""No line of a shell's about a command that a signal has ended."""
	assert call("host=native; entry=(env); runBeside sh -c 'kill -%s $$'" % signal) == (code, "", "")


@pytest.mark.parametrize("threads", ["8193", "100000", "99999999999999999999"])
def test_threadsBeyondTheProcessors(tmp_path, threads):
	"""Refused before anything is set up."""
	command = ["bash", str(CHECKOUT / "scripts" / "run"), "--threads", threads]
	environment = {"PATH": "/usr/bin:/bin", "XDG_CACHE_HOME": str(tmp_path / "cache")}
	result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
	assert result.returncode == 1 and "threads = %s: is more than four a processor." % threads in result.stderr and "fix: " in result.stderr
	assert not (tmp_path / "cache").exists()


def test_browserOfDebian13(call, tmp_path):
	"""Installed for root where there is none, else told of; one in PATH is taken."""
	code, said, errors = call('host=native; installByApt() { echo "installs $*"; }; nativeBrowser() { :; }; chooseBrowser')
	assert code == 1 and "there is no chromium in PATH" in errors and "fix: apt-get install" in errors
	assert said == ("installs chromium-headless-shell\n" if os.geteuid() == 0 else "")
	(tmp_path / "bin" / "chromium").symlink_to("/bin/true")
	assert call('host=native; chooseBrowser; echo "$browser"')[:2] == (0, f"{tmp_path}/bin/chromium\n")
