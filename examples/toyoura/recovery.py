# SPDX-License-Identifier: GPL-2.0-or-later
"""Do known grains come back from tests of theirs? scripts/yade -x examples/toyoura/recovery.py CALIBRATION_FOLDER [--tests N].

A trial takes one test (one packing) of one set as the laboratory's, or the mean of N, with noise of reading on it. The other sets' tests are what a calibration has. Between
them curves are a quadratic in the parameters, fitted without the trial's set; the posterior is over a quasi-random cloud in the prior's box. So curves are
of DEM and the way between them is a surrogate: it needs no tests beside those of the calibration. A trial counts where its set is within the box that
most sets are drawn in, since a quadratic is no extrapolation.
"""

import argparse
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
import likelihood
import sampling
from evaluate import GENERATIONS, TESTS, setName
from scipy.linalg import cho_solve
from scipy.stats import qmc

#: Points of the cloud; the interval that is to hold the truth.
CLOUD, CONFIDENCE = 4096, 0.95


def terms(points):
	"""The quadratic's terms at (N, dimensions) points of the unit cube."""
	count = points.shape[1]
	pairs = [points[:, i] * points[:, j] for i in range(count) for j in range(i, count)]
	return numpy.column_stack([numpy.ones(len(points)), points, *pairs])


def posterior(target, values, points, found, seeds, cloud, tests):
	"""Log likelihood on the cloud of laboratory ``values`` at a target, means of ``tests``; ``found``: (sets, strains) means over ``seeds`` packings at ``points``."""
	matrix = terms(points)
	fit, *_ = numpy.linalg.lstsq(matrix, found, rcond=None)
	freedom = max(len(points) - matrix.shape[1], 1)
	# of a packing: what the quadratic leaves of means over packings
	scatter = numpy.sqrt((seeds * ((found - matrix @ fit) ** 2).sum(axis=0) / freedom + likelihood.READING[target.quantity] ** 2) / tests)
	covariance = numpy.outer(scatter, scatter) * numpy.exp(-abs(target.strain[:, None] - target.strain) / likelihood.LENGTH)
	factor = numpy.linalg.cholesky(covariance + 1e-9 * numpy.diag(scatter**2)), True
	apart = (terms(cloud) @ fit - values).T
	return -0.5 * (apart * cho_solve(factor, apart)).sum(axis=0)


def trials(folder, tests, say):
	"""Say what came out; the list of (covered, relative errors) by parameter, a trial each. ``tests``: so many are the laboratory's."""
	calibration = calibrationfile.load(HERE / "calibration.yaml")
	drawn = json.loads((pathlib.Path(folder) / GENERATIONS).read_text(encoding="utf-8"))["generations"]
	sets = [(setName(g, k), numpy.array(point)) for g, points in enumerate(drawn) for k, point in enumerate(points)]
	series, failed = evaluate.Inside(calibration, folder, None, say).series(sets)
	name, test = next(iter(calibration.tests.items()))
	sets = [one for one in sets if not failed[one[0]] and len(series[one[0]].get(name, ())) == len(calibration.seeds)]
	targets = likelihood.targets({name: test.curve}, {name: test.config.shear.strain})
	points, count = numpy.array([point for _, point in sets]), len(calibration.seeds)
	curves = {t.key: numpy.array([[one[t.quantity].at(t.strain) for one in series[label][name]] for label, _ in sets]) for t in targets}
	cloud = qmc.Sobol(points.shape[1], seed=1).random(CLOUD)
	random, rows, tail = numpy.random.default_rng(1), [], (1 - CONFIDENCE) / 2
	for k in (k for k, point in enumerate(points) if (abs(point - 0.5) < 0.35).all()):
		logs, others = numpy.zeros(CLOUD), numpy.arange(len(sets)) != k
		for target in targets:
			own = curves[target.key]
			read = own[k, :tests].mean(axis=0) + random.normal(size=len(target.strain)) * likelihood.READING[target.quantity] / tests**0.5
			logs += posterior(target, read, points[others], own[others].mean(axis=1), count, cloud, tests)
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


if __name__ == "__main__":
	parser = argparse.ArgumentParser(prog="recovery.py")
	parser.add_argument("calibration", metavar="CALIBRATION_FOLDER", help="what scripts/calibrate has left")
	parser.add_argument("--tests", type=int, default=1, metavar="N", help="the laboratory's, as many as the calibration has packings at most (1)")
	given = parser.parse_args()
	trials(given.calibration, given.tests, lambda text: print(text, flush=True))
