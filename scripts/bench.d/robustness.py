# SPDX-License-Identifier: GPL-2.0-or-later
"""What becomes of 200 tests: examples/quick.yaml with ten seeds and twenty changes, to 20 % strain, each a process of its own.

	robustness.py FOLDER [--runs N] [--processes N] [--only TEXT]

FOLDER keeps one folder a run and robustness.csv, one row a run: how it ended, and how far its stresses were from what they should be. A run
whose folder has a result is not run again, so an interrupted survey goes on. Runs go seed by seed: the first twenty have one of each change.
"""

import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))

import survey  # noqa: E402
from hexmembrane.configuration import merged  # noqa: E402
from hexmembrane.output import records  # noqa: E402
from table import write  # noqa: E402

SEEDS = range(7, 17)
VELOCITIES, STRETCH = (0.015, 0.03, 0.12), (150, 300, 450, 2400)
HEADER = (
	"run", "outcome", "axial strain [%]", "start: axial [kPa]", "radial [kPa]", "middle axial [kPa]", "middle radial [kPa]", "largest q [kPa]",
	"boundary and inertia against contacts [% of axial]", "inertia [% of axial]", "lost bonds", "time [s]", "message",
)  # fmt: skip


def sheet(stretch):
	"""E t [N/m] as configuration keys, at latex' thickness."""
	return {"membrane": {"young": stretch / 3e-4, "thickness": 3e-4}}


def changes():
	"""Name -> changes of quick.yaml: one key each, and the hard ones together."""
	found = {"as it is": {}}
	found.update({f"{v} m/s": {"shear": {"velocity": v}} for v in VELOCITIES})
	found.update({f"E t {e}": sheet(e) for e in STRETCH})
	found.update({f"R over r {ratio}": {"membrane": {"sizeRatio": ratio}} for ratio in (0.4, 1.5)})
	found.update({f"{p} kPa": {"consolidation": {"pressure": 1e3 * p}} for p in (10, 50, 200, 400)})
	for first, second in (("E t 150", "R over r 0.4"), ("E t 150", "0.03 m/s"), ("E t 300", "R over r 1.5"), ("400 kPa", "E t 300"), ("400 kPa", "R over r 0.4"), ("10 kPa", "R over r 1.5")):  # fmt: skip
		found[f"{first}, {second}"] = merged(found[first], found[second])
	return found


def cases():
	for seed in SEEDS:
		for name, change in changes().items():
			yield f"{name}, seed {seed}", merged(change, {"specimen": {"seed": seed}})


def configuration(change):
	common = {"shear": {"strain": 0.2}, "output": {"records": 40, "vtkEvery": 0, "checkpointEvery": 10, "energy": False, "report": False}}
	return survey.configuration(common, change)


def run(name, change, folder):
	"""One test in a process of its own; its row."""
	return row(name, *survey.run(name, configuration(change), folder))


def row(name, code, message, out):
	outcome = survey.outcome(code)
	if not (out / "records.csv").is_file():
		return name, outcome, *[""] * 10, message
	table = records.read(out / "records.csv")
	shear = [i for i, stage in enumerate(table["stage"]) if stage == "shear"]
	if not shear:
		return name, outcome, *[""] * 10, message
	first = shear[0]
	start = [f"{1e-3 * table[key][first]:.2f}" for key in ("soil_axial", "soil_radial", "soil_axial_middle", "soil_radial_middle")]
	apart, inertia = (
		max(abs(sum(sign * table[f"{name}_{a}"][i] for name, sign in parts)) / table["soil_axial"][i] for a in ("axial", "radial") for i in shear)
		for parts in ((("boundary", 1), ("inertia", 1), ("soil", -1)), (("inertia", 1),))
	)
	most = max(table["q"][i] for i in shear)
	return (
		name, outcome, f"{100 * table['axial_strain'][-1]:.2f}", *start, f"{1e-3 * most:.1f}", f"{100 * apart:.4f}", f"{100 * inertia:.2f}",
		int(table["bonds_broken"][-1]), f"{table['elapsed'][-1]:.0f}", message,
	)  # fmt: skip


def main(argv):
	parser = argparse.ArgumentParser(prog="robustness.py", description="What becomes of 200 tests.")
	survey.addOptions(parser)
	parser.add_argument("--runs", type=int, default=200, help="how many, from the first on")
	arguments = parser.parse_args(argv)
	changed = {name: change for name, change in list(cases())[: arguments.runs] if arguments.only in name}
	csv = str(arguments.folder / "robustness.csv")
	rows = survey.runAll(
		list(changed), lambda name: run(name, changed[name], arguments.folder), arguments.folder, arguments.processes, lambda rows: write(csv, HEADER, rows)
	)
	outcomes = [found[1] for found in rows.values()]
	print(", ".join(f"{outcomes.count(kind)} {kind}" for kind in sorted(set(outcomes))))


if __name__ == "__main__":
	main(sys.argv[1:])
