# SPDX-License-Identifier: GPL-2.0-or-later
"""Do known grains come back from tests of theirs? scripts/yade -x examples/toyoura/recovery.py CALIBRATION_FOLDER [--calibration FILE] [--curves NAMES] [--tests N].

A trial takes one test (one packing) of one set as the laboratory's, or the mean of N, with noise of reading on it. The other sets' tests on the other packings are
what a calibration has. Between them curves are a quadratic in the parameters; the posterior is over a quasi-random cloud in the prior's box. So curves are
of DEM and the way between them is a surrogate: it needs no tests beside those of the calibration. A trial counts where its set is within the box that
most sets are drawn in, since a quadratic is no extrapolation.

recovery.py FOLDER --make runs the tests of known grains (TRUTH) that recovery.yaml has as a laboratory's, one packing each, and writes their curves with noise of reading.
"""

import argparse
import functools
import json
import pathlib
import sys

import hexmembrane
import numpy

ROOT = pathlib.Path(hexmembrane.__file__).resolve().parents[2]  # YADE runs a script without its __file__
HERE = ROOT / "examples" / "toyoura"
sys.path[:0] = [str(ROOT / "scripts" / name) for name in ("calibrate.d", "sweep.d")]

import calibrationfile  # noqa: E402
import evaluate
import inside
import likelihood
import sampling
import studyfile
from evaluate import GENERATIONS, setName
from hexmembrane.configuration import ConfigError, derived
from hexmembrane.laboratory.misfit import ofTest
from scipy.linalg import cho_solve
from scipy.stats import qmc

#: Calibrations on the laboratory's test, and on two of known grains; those grains, and their packing, which no calibration has.
TOYOURA, KNOWN = HERE / "calibration.yaml", HERE / "recovery.yaml"
TRUTH, PACKING = {"specimen.friction": 0.7, "specimen.rollingFriction": 0.5}, 101
#: Points of the cloud; the interval that is to hold the truth.
CLOUD, CONFIDENCE = 4096, 0.95


def terms(points):
	"""The quadratic's terms at (N, dimensions) points of the unit cube."""
	count = points.shape[1]
	pairs = [points[:, i] * points[:, j] for i in range(count) for j in range(i, count)]
	return numpy.column_stack([numpy.ones(len(points)), points, *pairs])


def posterior(target, values, points, found, cloud, tests):
	"""Log likelihood on the cloud of laboratory ``values`` at a target, means of ``tests``; ``found``: (sets, packings, strains) at ``points``, of other packings."""
	matrix, means, seeds = terms(points), found.mean(axis=1), found.shape[1]
	fit, *_ = numpy.linalg.lstsq(matrix, means, rcond=None)
	freedom = max(len(points) - matrix.shape[1], 1)
	# of a packing, over packings of a set; what the quadratic leaves may be more than that
	packing = found.var(axis=1, ddof=1).mean(axis=0)
	left = numpy.maximum(((means - matrix @ fit) ** 2).sum(axis=0) / freedom - packing / seeds, 0)
	scatter = numpy.sqrt(packing * (1 / tests + 1 / seeds) + left + likelihood.READING[target.quantity] ** 2 / tests)
	covariance = numpy.outer(scatter, scatter) * numpy.exp(-abs(target.strain[:, None] - target.strain) / likelihood.LENGTH)
	factor = numpy.linalg.cholesky(covariance + 1e-9 * numpy.diag(scatter**2)), True
	apart = (terms(cloud) @ fit - values).T
	return -0.5 * (apart * cho_solve(factor, apart)).sum(axis=0)


def trials(calibration, folder, tests, say, names=None):
	"""Say what came out; the list of {parameter: (covered, relative error)}, a trial each.

	:param calibration: whose tests are in ``folder``.
	:param tests: so many are the laboratory's.
	:param names: of the curves that a trial has; None: all.
	:raises ConfigError: fewer than two packings are left for a calibration, or a curve is none of its.
	"""
	count, wrong = len(calibration.seeds), [name for name in names or () if name not in calibration.tests]
	if not 1 <= tests <= count - 2:
		raise ConfigError("--tests", tests, f"leaves fewer than 2 of the {count} packings of a set", f"give 1 to {count - 2}")
	if wrong:
		raise ConfigError("--curves", wrong[0], "is no curve of the calibration", f"its curves are {', '.join(calibration.tests)}")
	drawn = json.loads((pathlib.Path(folder) / GENERATIONS).read_text(encoding="utf-8"))["generations"]
	sets = [(setName(g, k), numpy.array(point)) for g, points in enumerate(drawn) for k, point in enumerate(points)]
	series, failed = evaluate.Inside(calibration, folder, None, say).series(sets)
	used = {name: test for name, test in calibration.tests.items() if names is None or name in names}
	sets = [one for one in sets if not failed[one[0]] and all(len(series[one[0]].get(name, ())) == count for name in used)]
	targets = likelihood.targets({name: test.curve for name, test in used.items()}, {name: test.end for name, test in used.items()})
	points = numpy.array([point for _, point in sets])
	curves = {t.key: numpy.array([[one[t.quantity].at(t.strain) for one in series[label][t.curve]] for label, _ in sets]) for t in targets}
	cloud = qmc.Sobol(points.shape[1], seed=1).random(CLOUD)
	random, rows, tail = numpy.random.default_rng(1), [], (1 - CONFIDENCE) / 2
	for k in (k for k, point in enumerate(points) if (abs(point - 0.5) < 0.35).all()):
		logs, others = numpy.zeros(CLOUD), numpy.arange(len(sets)) != k
		for target in targets:
			own = curves[target.key]
			packings = (k + numpy.arange(count)) % count
			read = own[k, packings[:tests]].mean(axis=0) + random.normal(size=len(target.strain)) * likelihood.READING[target.quantity] / tests**0.5
			logs += posterior(target, read, points[others], own[others][:, packings[tests:]], cloud, tests)
		weight = numpy.exp(logs - logs.max())
		weight /= weight.sum()
		row = {}
		for column, parameter in enumerate(calibration.parameters):
			low, median, high = (parameter.value(unit) for unit in sampling.quantiles(cloud[:, column], weight, (tail, 0.5, 1 - tail)))
			truth = parameter.value(points[k, column])
			row[parameter.key] = (low <= truth <= high, median / truth - 1)
		rows.append(row)
	for parameter in calibration.parameters:
		errors = numpy.array([abs(row[parameter.key][1]) for row in rows])
		covered = sum(row[parameter.key][0] for row in rows)
		say(f"{parameter.key}: {len(rows)} trials, {covered} covered; error median {100 * numpy.median(errors):.1f} %, within 5 % in {(errors <= 0.05).sum()}")
	return rows


def make(calibration, folder, say):
	"""Run the test of TRUTH and PACKING of each curve of a calibration, in a folder, and write its curve with noise of reading there, as CURVE.csv."""
	random = numpy.random.default_rng(PACKING)
	runs = [
		studyfile.Run(name, {}, PACKING, derived(test.config, studyfile.nested({**TRUTH, studyfile.SEED: PACKING}))) for name, test in calibration.tests.items()
	]
	inside.perform(studyfile.Study("known grains", [], runs, 1, {}), folder, say)
	for run in runs:
		test = ofTest(inside.table(folder, run))
		strain = numpy.linspace(0.0025, test["stress_ratio"].strain[-1], 54)
		columns = [test[quantity].at(strain) + likelihood.READING[quantity] * random.normal(size=len(strain)) for quantity in ("stress_ratio", "volumetric_strain")]
		table = numpy.column_stack([100 * strain, columns[0], 100 * columns[1]])
		said = f"a test of ours as if of a laboratory: {run.config.specimen.grains} grains, {', '.join(f'{key} {value}' for key, value in TRUTH.items())}, seed {PACKING}"
		header = f"# {said}\naxial strain [%],stress ratio [-],volumetric strain [%]"
		numpy.savetxt(pathlib.Path(folder) / f"{run.name}.csv", table, fmt=["%.3f", "%.4f", "%.4f"], delimiter=",", header=header, comments="")


if __name__ == "__main__":
	say = functools.partial(print, flush=True)
	parser = argparse.ArgumentParser(prog="recovery.py")
	parser.add_argument("folder", metavar="CALIBRATION_FOLDER", help="what scripts/calibrate has left; with --make: a folder for the tests and curves")
	parser.add_argument("--calibration", metavar="FILE", type=pathlib.Path, default=TOYOURA, help="the calibration of that folder (default: calibration.yaml)")
	parser.add_argument("--curves", metavar="NAMES", type=lambda text: text.split(","), help="those of the calibration that a trial has, parted by commas (default: all)")
	parser.add_argument("--tests", type=int, default=1, metavar="N", help="the laboratory's (1); a calibration needs two packings beside them")
	parser.add_argument("--make", action="store_true", help="run the tests of known grains that recovery.yaml has as a laboratory's")
	given = parser.parse_args()
	if given.make:
		make(calibrationfile.load(KNOWN), given.folder, say)
	else:
		trials(calibrationfile.load(given.calibration), given.folder, given.tests, say, given.curves)
