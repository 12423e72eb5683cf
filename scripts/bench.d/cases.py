# SPDX-License-Identifier: GPL-2.0-or-later
"""What becomes of the hard cases of hardcases.py, each a process of its own, against what is expected of each.

	cases.py FOLDER [--only TEXT] [--processes N] [--once]

--only takes several texts with | between.
FOLDER keeps one folder a case, cases.csv and cases.md. A case whose folder has a result is not run again. A test that was done is run again,
killed in the middle of its shear and resumed: its rows must be the same; not with --once. The exit code is 1 when a case is not as expected.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))

import caseruns  # noqa: E402
import survey  # noqa: E402
from hardcases import CASES, named  # noqa: E402
from table import write  # noqa: E402

HEADER = "case", "verdict", "outcome", "expected", "not as expected", "measured", "message or warning"
#: What of the measurements is shown of a test; all of them are in case.json.
SHOWN = ("start axial", "boundary", "held", "energy", "membrane speed", "largest q/sigma3", "smallest q/sigma3", "rows that differ after a kill")


def child(arguments, log):
	"""This program in a process of its own, on one thread; its exit code."""
	program = [sys.executable, str(survey.ROOT / "scripts" / "setup.d" / "launch.py"), "1", str(pathlib.Path(__file__).resolve())]
	with open(log, "a") as file:
		return subprocess.run([*program, *map(str, arguments)], stdout=file, stderr=file, env={**os.environ, "OMP_NUM_THREADS": "1"}).returncode


def one(name, folder, once=False):
	"""A case's row of the table."""
	case, out = named(name), survey.place(name, folder)
	result = folder / f"{out.name}.json"
	if not result.is_file():
		out.mkdir(exist_ok=True)
		code = child([folder, "--one", name], folder / f"{out.name}.log")
		if code:
			return name, "FAILS", f"exit code {code}", case.expect, f"see {out.name}.log", "", ""
		found = json.loads((out / "case.json").read_text())
		if found["outcome"] == "done" and not case.scene and case.again and not once:
			again = out / "killed"
			child([folder, "--one", name, "--killed"], folder / f"{out.name}.log")
			child([folder, "--one", name, "--resumed"], folder / f"{out.name}.log")
			differing = caseruns.differingRows(out, again)
			found["seen"]["rows that differ after a kill"] = differing
			found["odd"] += [f"{differing:.0f} rows differ after a kill"] if differing else []
		result.write_text(json.dumps(found, indent=1))
	found = json.loads(result.read_text())
	names = found["seen"] if case.scene else dict.fromkeys((*SHOWN, *case.bounds))
	figures = ", ".join(f"{key} {found['seen'][key]:.3g}" for key in names if key in found["seen"])
	verdict = "FAILS" if found["odd"] else "as expected"
	return name, verdict, found["outcome"], case.expect, "; ".join(found["odd"]), figures, found["message"] or " ".join(found["warnings"])


def asChild(case, folder, arguments):
	out = survey.place(case.name, folder)
	if arguments.killed or arguments.resumed:
		again = out / "killed"
		again.mkdir(exist_ok=True)
		config = case.configuration(out)
		caseruns.whole(case, config, again, resume=arguments.resumed, killAfter=config["output"]["records"] // 2 + 5 if arguments.killed else None)
	else:
		print(json.dumps(caseruns.runCase(case, out), indent=1))


def keep(folder, rows):
	write(str(folder / "cases.csv"), HEADER, rows)
	lines = ["| " + " | ".join(HEADER) + " |", "| " + " | ".join("---" for _ in HEADER) + " |"]
	lines += ["| " + " | ".join(str(cell).replace("|", "/") for cell in row) + " |" for row in rows]
	(folder / "cases.md").write_text("\n".join(lines) + "\n")


def main(argv):
	parser = argparse.ArgumentParser(prog="cases.py", description="What becomes of the hard cases.")
	survey.addOptions(parser)
	parser.add_argument("--once", action="store_true", help="no test is killed and resumed")
	parser.add_argument("--one", help=argparse.SUPPRESS)
	parser.add_argument("--killed", action="store_true", help=argparse.SUPPRESS)
	parser.add_argument("--resumed", action="store_true", help=argparse.SUPPRESS)
	arguments = parser.parse_args(argv)
	if arguments.one:
		asChild(named(arguments.one), arguments.folder, arguments)
		return 0
	names = [case.name for case in CASES if any(text in case.name for text in arguments.only.split("|"))]
	rows = survey.runAll(names, lambda name: one(name, arguments.folder, arguments.once), arguments.folder, arguments.processes, lambda rows: keep(arguments.folder, rows))
	failing = [name for name, row in rows.items() if row[1] == "FAILS"]
	print(f"{len(rows) - len(failing)} as expected, {len(failing)} not" + (f": {', '.join(failing)}" if failing else ""))
	return 1 if failing else 0


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
