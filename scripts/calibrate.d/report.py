# SPDX-License-Identifier: GPL-2.0-or-later
"""What a calibration leaves: tables, the best configuration, pictures, GrainLearning's tables."""

import csv
import io
import json
import math

import numpy
import sampling
from hexmembrane import configuration
from hexmembrane.configuration import derived
from hexmembrane.laboratory import misfit
from plan import writeText
from scipy.stats import norm
import studyfile

SETS, POSTERIOR, BEST, MISFIT, GRAINLEARNING = "sets.csv", "posterior.json", "best.yaml", "misfit.csv", "grainlearning"
#: Share of the intervals; a parameter whose posterior is wider than this share of its prior is not determined.
CONFIDENCE, DETERMINED = 0.95, 0.6
_STEPS = 25
_NAMES = {"stress_ratio": "sigma1/sigma3 [-]", "volumetric_strain": "volumetric strain [%]\n(dilation positive)"}
_FACTORS = {"stress_ratio": 1.0, "volumetric_strain": 100.0}


def values(calibration, point):
	"""'friction 0.512, emod 4.1e+07' of a point."""
	return ", ".join(f"{key.rpartition('.')[2]} {value:.4g}" for key, value in calibration.values(point).items())


def _moments(calibration, points, weight):
	"""Weighted mean and standard deviation of each parameter's own values."""
	own = numpy.array([list(calibration.values(point).values()) for point in points])
	mean = weight @ own
	return own, mean, numpy.sqrt(weight @ (own - mean) ** 2)


def line(calibration, points, weight, power):
	"""A generation in a line."""
	_, mean, deviation = _moments(calibration, points, weight)
	said = ", ".join(f"{p.key.rpartition('.')[2]} {m:.4g} +- {d:.2g}" for p, m, d in zip(calibration.parameters, mean, deviation))
	tempered = "" if power == 1 else f", likelihood to the power {power:.2g}"
	return f"{said}; {sampling.effective(weight):.1f} effective sets of {len(points)}{tempered}"


def summary(calibration, points, weight):
	"""The posterior as plain values."""
	own, mean, deviation = _moments(calibration, points, weight)
	tail = (1 - CONFIDENCE) / 2
	parameters = {}
	for k, parameter in enumerate(calibration.parameters):
		units = points[:, k]
		prior = math.sqrt(1 / 12)
		spread = math.sqrt(float(weight @ (units - weight @ units) ** 2)) / prior
		low, median, high = sampling.quantiles(own[:, k], weight, (tail, 0.5, 1 - tail))
		parameters[parameter.key] = {
			"mean": float(mean[k]), "standard_deviation": float(deviation[k]), "low": float(low), "median": float(median), "high": float(high),
			"prior": [parameter.low, parameter.high], "width_over_prior": spread, "determined": spread < DETERMINED,
		}  # fmt: skip
	with numpy.errstate(invalid="ignore", divide="ignore"):
		correlation = (weight * (own - mean).T) @ (own - mean) / numpy.outer(deviation, deviation)
	return {"confidence": CONFIDENCE, "effective_sets": sampling.effective(weight), "sets": len(points), "parameters": parameters, "correlation": numpy.where(numpy.isfinite(correlation), correlation, 0).tolist()}


def write(calibration, folder, sets, evaluations, weight, failed, say):
	"""Write all of it and say the main things."""
	points = numpy.array([point for _, point in sets])
	logs = evaluations.logLikelihood()
	best = int(logs.argmax())
	writeText(folder / SETS, _table(calibration, sets, logs, weight, failed))
	for name, test in calibration.tests.items():
		one = derived(test.config, studyfile.nested(calibration.values(points[best])))
		configuration.save(one, folder / (BEST if len(calibration.tests) == 1 else f"best-{name}.yaml"))
	if calibration.method == "bayes":
		found, model = summary(calibration, points, weight), evaluations.modelError(weight)
		writeText(folder / POSTERIOR, json.dumps({**found, "best": calibration.values(points[best]), "model_error": model, "targets": _targets(evaluations, model[0])}, indent=1) + "\n")
		for key, one in found["parameters"].items():
			say(f"{key}: {one['median']:.4g} ({one['low']:.4g} to {one['high']:.4g})" + ("" if one["determined"] else "; the curves do not determine it"))
		if calibration.model is None:
			say("model error: {:.3g} ({:.3g} to {:.3g}) of a curve's largest value".format(*model))
		if found["effective_sets"] < 10:
			say(f"WARNING: the posterior rests on {found['effective_sets']:.1f} effective sets; fix: more generations or samples (a larger 'generations' goes on from here)")
		_drawPosterior(calibration, points, weight, found, folder / "posterior.png")
	say(f"best set {sets[best][0]}: {values(calibration, points[best])}")
	for text in (text for texts in failed.values() for text in texts):
		say(f"failed: {text}")
	_drawPredictions(calibration, evaluations, weight, best, folder / "prediction.png")
	_grainLearning(calibration, sets, evaluations, folder / GRAINLEARNING)
	say(f"written into {folder}: {SETS}, {POSTERIOR if calibration.method == 'bayes' else BEST}, best configurations, {MISFIT}, pictures, {GRAINLEARNING}/")


def writeMisfit(calibration, folder, series):
	"""How far the best set is from each laboratory curve, mean over its packings; ``series``: {curve: [series of a seed]}."""
	text = io.StringIO()
	writer = csv.writer(text, lineterminator="\n")
	writer.writerow(["curve", "number", "unit", "laboratory", "best set", "difference"])
	for name, test in calibration.tests.items():
		pressure = test.config.consolidation.pressure
		for rows in zip(*(misfit.numbers(test.curve, one, pressure) for one in series[name])):
			mean = float(numpy.mean([row.test for row in rows]))
			writer.writerow([name, rows[0].name, rows[0].unit, f"{rows[0].laboratory:.6g}", f"{mean:.6g}", f"{mean - rows[0].laboratory:.6g}"])
		apart = [misfit.rootMeanSquare(test.curve, one) for one in series[name]]
		for quantity in apart[0]:
			writer.writerow([name, f"root mean square of {quantity}", "-", "", "", f"{float(numpy.mean([one[quantity] for one in apart])):.6g}"])
	writeText(folder / MISFIT, text.getvalue())


def _table(calibration, sets, logs, weight, failed):
	text = io.StringIO()
	writer = csv.writer(text, lineterminator="\n")
	writer.writerow(["set", *(parameter.key for parameter in calibration.parameters), "log_likelihood", "weight", "failed"])
	for (name, point), log, one in zip(sets, logs, weight):
		writer.writerow([name, *map(repr, calibration.values(point).values()), repr(float(log)), repr(float(one)), "; ".join(failed.get(name, ()))])
	return text.getvalue()


def _targets(evaluations, model):
	return [
		{"curve": target.curve, "quantity": target.quantity, "points": len(target.strain), "packing": float(evaluations.packing(target).mean()), "deviation": float(numpy.sqrt(numpy.diag(evaluations.covariance(target, 1, model))).mean())}
		for target in evaluations.targets
	]


def band(evaluations, target, weight):
	"""(low, middle, high) of what the weighted sets and the scatter of one packing predict at the target's strains."""
	kept = [k for k in range(len(evaluations)) if evaluations.mean(k, target) is not None and weight[k] > 0]
	means = numpy.array([evaluations.mean(k, target) for k in kept])
	share = weight[kept] / weight[kept].sum()
	tail = (1 - CONFIDENCE) / 2
	# each set's mean with the scatter of a packing about it: a Gaussian as _STEPS points of equal weight
	steps = norm.ppf((numpy.arange(_STEPS) + 0.5) / _STEPS)
	spread = (means[:, None] + steps[:, None] * evaluations.packing(target)).reshape(-1, len(target.strain))
	return numpy.array([sampling.quantiles(column, numpy.repeat(share / _STEPS, _STEPS), (tail, 0.5, 1 - tail)) for column in spread.T]).T


def _figure(width, height, rows, columns):
	from matplotlib.backends.backend_agg import FigureCanvasAgg
	from matplotlib.figure import Figure

	figure = Figure(figsize=(width, height), layout="constrained")
	FigureCanvasAgg(figure)
	return figure, figure.subplots(rows, columns, squeeze=False)


def _save(figure, path):
	part = path.with_name(path.name + ".part")
	figure.savefig(part, dpi=130, format="png", metadata={"Software": "hexmembrane"})
	part.replace(path)


def _drawPredictions(calibration, evaluations, weight, best, path):
	quantities = [name for name in _NAMES if any(target.quantity == name for target in evaluations.targets)]
	figure, panels = _figure(4.6 * len(calibration.tests), 3.4 * len(quantities), len(quantities), len(calibration.tests))
	for target in evaluations.targets:
		axes = panels[quantities.index(target.quantity)][list(calibration.tests).index(target.curve)]
		factor, series = _FACTORS[target.quantity], calibration.tests[target.curve].curve.series[target.quantity]
		if calibration.method == "bayes":
			low, middle, high = factor * band(evaluations, target, weight)
			axes.fill_between(100 * target.strain, low, high, color="#3b6ea5", alpha=0.25, lw=0, label=f"{100 * CONFIDENCE:g} % of a test")
			axes.plot(100 * target.strain, middle, color="#1f4e79", label="median")
		axes.plot(100 * target.strain, factor * evaluations.mean(best, target), color="#b5561c", ls="--", label="best set")
		axes.plot(100 * series.strain, factor * series.value, "k.", ms=4, label="laboratory")
		axes.set_ylabel(_NAMES[target.quantity])
		axes.set_xlabel("axial strain [%]")
		axes.grid(color="0.92")
		axes.set_axisbelow(True)
	for axes, name in zip(panels[0], calibration.tests):
		axes.set_title(name, fontsize="medium")
	panels[0][0].legend(frameon=False, fontsize="small")
	figure.suptitle(calibration.title)
	_save(figure, path)


def _drawPosterior(calibration, points, weight, found, path):
	count = len(calibration.parameters)
	figure, panels = _figure(2.6 * count + 1, 2.6 * count, count, count)
	own = numpy.array([list(calibration.values(point).values()) for point in points])
	for row, down in enumerate(calibration.parameters):
		for column, across in enumerate(calibration.parameters):
			axes = panels[row][column]
			if column > row:
				axes.set_visible(False)
				continue
			if across.log:
				axes.set_xscale("log")
			if row == column:
				edges = [across.value(unit) for unit in numpy.linspace(0, 1, 21)]
				axes.hist(own[:, column], edges, weights=weight, color="#3b6ea5")
				axes.axvline(found["parameters"][across.key]["median"], color="k", lw=1)
				axes.set_yticks([])
			else:
				if down.log:
					axes.set_yscale("log")
				axes.scatter(own[:, column], own[:, row], s=2, color="0.75")
				axes.scatter(own[:, column], own[:, row], s=300 * weight / weight.max(), color="#3b6ea5", alpha=0.5, lw=0)
				axes.set_ylim(down.low, down.high)
			axes.set_xlim(across.low, across.high)
			if row == count - 1:
				axes.set_xlabel(across.key.rpartition(".")[2])
			if column == 0 and row:
				axes.set_ylabel(down.key.rpartition(".")[2])
	figure.suptitle(f"{calibration.title}: posterior of {found['sets']} sets, {found['effective_sets']:.0f} effective")
	_save(figure, path)


def _grainLearning(calibration, sets, evaluations, folder):
	"""Samples a generation and curves a set, in the form that GrainLearning reads: NAME_Iter0_Samples.txt, NAME_Iter0_Sample00_sim.txt, ..._param.txt."""
	folder.mkdir(exist_ok=True)
	name = "".join(letter if letter.isalnum() else "-" for letter in calibration.title) or "calibration"
	keys = [parameter.key for parameter in calibration.parameters]
	counts = {}
	for k, (label, point) in enumerate(sets):
		generation, number = label.split(".")
		counts.setdefault(generation, []).append((k, number, point))
	for generation, rows in counts.items():
		digits = math.floor(math.log10(len(rows))) + 1
		lines = [" ".join(["!OMP_NUM_THREADS", "description", "key", *keys])]
		for k, number, point in rows:
			description = f"{name}_Iter{int(generation)}_Sample{str(int(number)).zfill(digits)}"
			own = [f"{value:.10e}" for value in calibration.values(point).values()]
			lines.append(" ".join(["1", description, str(int(number)), *own]))
			writeText(folder / f"{description}_param.txt", " ".join(["#", *keys]) + "\n" + " ".join(own) + "\n")
			columns = {f"{target.curve}_{target.quantity}": evaluations.mean(k, target) for target in evaluations.targets}
			if all(column is not None for column in columns.values()):
				strain = evaluations.targets[0].strain
				columns = {"axial_strain": strain, **{key: numpy.interp(strain, target.strain, column) for (key, column), target in zip(columns.items(), evaluations.targets)}}
				writeText(folder / f"{description}_sim.txt", " ".join(["#", *columns]) + "\n" + "\n".join(" ".join(f"{value:.8e}" for value in row) for row in zip(*columns.values())) + "\n")
		writeText(folder / f"{name}_Iter{int(generation)}_Samples.txt", "\n".join(lines) + "\n")
