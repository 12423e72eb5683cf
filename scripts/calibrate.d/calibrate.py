# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line ``scripts/calibrate CALIBRATION.yaml``: sets of parameters, their tests, what the laboratory's curves say of them."""

import argparse
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "sweep.d")]

import bestfit  # noqa: E402
import calibrationfile
import evaluate
import likelihood
import numpy
import report
import sampling
import sweep
from evaluate import GENERATIONS, setName
from hexmembrane.configuration import ConfigError
from hexmembrane.run.progress import clock
from plan import writeText


def _arguments(argv):
	parser = argparse.ArgumentParser(prog="scripts/calibrate", description="Calibrates grains on laboratory curves.")
	parser.add_argument("calibration", metavar="CALIBRATION", help="YAML file, see examples/calibrate/README.md")
	parser.add_argument("--out", metavar="DIR", help="folder (default: out/calibrate/NAME OF CALIBRATION)")
	parser.add_argument("--inside", action="store_true", help="tests one after the other in this one process: of few grains a YADE's start takes longer than the test")
	sweep.addRunning(parser)
	given = parser.parse_args(argv)
	if given.cores < 1:
		parser.error("--cores: a whole number of at least 1 is needed")
	return given


class Search:
	"""The generations of a calibration: what was drawn, what came out; goes on where it was."""

	def __init__(self, calibration, folder, tests, say):
		self.calibration, self.tests, self._say = calibration, tests, say
		self.path = pathlib.Path(folder) / GENERATIONS
		self.drawn = self._read()
		self.targets = likelihood.targets({name: test.curve for name, test in calibration.tests.items()}, {name: test.end for name, test in calibration.tests.items()})

	def _stamp(self):
		"""What the drawn sets depend on."""
		c = self.calibration
		ranges = [[p.key, p.low, p.high, p.log] for p in c.parameters]
		return {"parameters": ranges, "samples": c.samples, "method": c.method, "randomSeed": c.randomSeed, "seeds": list(c.seeds), "model": c.model}

	def _read(self):
		try:
			kept = json.loads(self.path.read_text(encoding="utf-8"))
		except FileNotFoundError:
			return []
		except ValueError as error:
			raise ConfigError("--out", str(self.path), f"cannot be read ({error})", "choose another folder") from None
		if kept.get("stamp") != self._stamp():
			raise ConfigError("--out", str(self.path.parent), "holds a calibration with other parameters, samples, method, randomSeed, seeds or model", "choose another folder")
		return [numpy.array(points) for points in kept["generations"]]

	def keep(self, points):
		"""Write a generation down before its tests run."""
		self.drawn.append(points)
		writeText(self.path, json.dumps({"stamp": self._stamp(), "generations": [p.tolist() for p in self.drawn]}, indent=1) + "\n")

	def sets(self, generations):
		"""[(name, point)] of the first generations."""
		return [(setName(g, k), point) for g, points in enumerate(self.drawn[:generations]) for k, point in enumerate(points)]

	def evaluated(self, generations):
		"""(:class:`likelihood.Evaluations`, {set: what failed}) of the first generations, whose tests are run where they have not been."""
		sets = self.sets(generations)
		self.tests.run(sets)
		series, failed = self.tests.series(sets)
		found = likelihood.Evaluations(self.targets, self.calibration.model)
		for name, _ in sets:
			failed[name] += found.add(series[name])
		if not any(numpy.isfinite(found.logLikelihood())):
			first = next((text for texts in failed.values() for text in texts), "no test reaches the curves' strains")
			raise RuntimeError(f"calibration: no set of parameters has tests that are done; the first: {first}; fix: see {self.tests.folder}, narrow the ranges")
		return found, {name: texts for name, texts in failed.items() if texts}


def _bayes(search, say):
	"""Sequential Monte Carlo; (evaluations, failed, weights, power)."""
	c = search.calibration
	first = sampling.Prior(len(c.parameters))
	proposals, state = [], None
	for generation in range(c.generations):
		if generation == len(search.drawn):
			given = c.start if generation == 0 else None
			source = first if generation == 0 else proposals[generation]
			search.keep(source.draw(c.samples, c.randomSeed + generation) if given is None else given)
		if generation == 0:
			proposals.append(first)
		evaluations, failed = search.evaluated(generation + 1)
		points = numpy.vstack(search.drawn[: generation + 1])
		counted = [(proposal, len(drawn)) for proposal, drawn in zip(proposals, search.drawn)]
		logs = evaluations.logLikelihood()
		last = generation + 1 == c.generations
		weight, power = (sampling.weights(logs, points, counted), 1.0) if last else sampling.temper(logs, points, counted, sampling.KEPT * len(points) / (generation + 1))
		say(f"generation {generation + 1} of {c.generations}: {report.line(c, points, weight, power)}")
		state = evaluations, failed, weight
		proposals.append(sampling.Mixture(points, weight, c.randomSeed + generation))
	return state


def _best(search, say):
	"""The best fit by optuna; (evaluations, failed, weights), all weight on the best set."""
	c = search.calibration
	sampler = bestfit.Sampler(len(c.parameters), c.randomSeed)
	for generation in range(c.generations):
		if generation == len(search.drawn):
			search.keep(sampler.ask(c.samples) if generation or c.start is None else c.start)
		evaluations, failed = search.evaluated(generation + 1)
		logs = evaluations.logLikelihood()
		sampler.tell(search.drawn[generation], logs[-len(search.drawn[generation]) :])
		weight = numpy.zeros(len(logs))
		weight[int(logs.argmax())] = 1
		say(f"generation {generation + 1} of {c.generations}: best so far {report.values(c, numpy.vstack(search.drawn[: generation + 1])[int(logs.argmax())])}")
	return evaluations, failed, weight


def calibrate(calibration, folder, arguments, say):
	"""The exit code: 0, 1 when tests failed."""
	for name, test in calibration.tests.items():
		for text in test.curve.warnings:
			say(text)
	folder.mkdir(parents=True, exist_ok=True)
	with sweep.lock(folder):
		tests = (evaluate.Inside if arguments.inside else evaluate.Tests)(calibration, folder, arguments, say)
		search = Search(calibration, folder, tests, say)
		evaluations, failed, weight = (_bayes if calibration.method == "bayes" else _best)(search, say)
		sets = search.sets(calibration.generations)
		tests.gather(sets)
		best = sets[int(evaluations.logLikelihood().argmax())]
		report.writeMisfit(calibration, folder, tests.series([best])[0][best[0]])
		report.write(calibration, folder, sets, evaluations, weight, failed, say)
	return 1 if failed else 0


def announce(calibration, cores, say):
	"""Say what a whole calibration costs, from its first generation."""
	points = sampling.Prior(len(calibration.parameters)).draw(calibration.samples, calibration.randomSeed)
	plan, _ = evaluate.Tests(calibration, ".", None, say).plan([(setName(0, k), point) for k, point in enumerate(points)])
	count = calibration.generations * len(plan["runs"])
	say(f"{calibration.title}: {calibration.generations} generations of {calibration.samples} sets, {len(calibration.tests)} curves, {len(calibration.seeds)} packings: at most {count} tests")
	hours = calibration.generations * sweep.coreHours(plan["jobs"].values())
	say(f"about {hours:.2g} core hours, {clock(3600 * hours / cores)} on {cores} cores")


def main(argv):
	"""Exit code: 0; 1 when a test failed; 2 for bad input; 130 when interrupted."""
	arguments = _arguments(argv)

	def whole(say):
		calibration = calibrationfile.load(arguments.calibration)
		folder = pathlib.Path(arguments.out or pathlib.Path("out", "calibrate", pathlib.Path(arguments.calibration).name.removesuffix(".yaml"))).absolute()
		announce(calibration, arguments.cores, say)
		return 0 if arguments.dry_run else calibrate(calibration, folder, arguments, say)

	return sweep.guarded(whole)


if __name__ == "__main__":
	sys.exit(main(sys.argv[1:]))
