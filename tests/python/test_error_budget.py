# SPDX-License-Identifier: GPL-2.0-or-later
"""The error budget of a configuration, and the settings that are chosen within an error, on curves that are made up."""

import itertools
import math
import pathlib

import numpy
import pytest
from hexmembrane import configuration
from hexmembrane.configuration import Config, ConfigError
from hexmembrane.scene import accuracy, specimen

QUICK = pathlib.Path(__file__).resolve().parents[2] / "examples" / "quick.yaml"
HEADER = "knob,value,x,quantity,fit,scatter,fit_half_width,packings,steps,time,mean,half_width\n"
# error of the peak of q, error of the volumetric strain, time at (x, ...) of each knob
LEVELS = {
	"velocity": {1e-4: (0, 0, 8), 1e-3: (0.01, 1e-3, 1), 1e-2: (-0.05, 4e-3, 0.1)},
	"stiffness": {100: (0.03, 2e-3, 0.6), 300: (0.01, 1e-3, 1), 3000: (0, 0, 3)},
	"step": {0.1: (0, 0, 5), 0.5: (0.001, 0, 1), 0.8: (0.004, 0, 0.6)},
	"damping": {0.1: (0, 0, 1), 0.9: (0.02, 1e-3, 1)},
	"size ratio": {0.4: (0, 0, 2), 0.8: (0.002, 1e-4, 1), 2.0: (0.02, 1e-3, 0.7)},
	"density scaling": {1: (0, 0, 1), 8: (0.001, 0, 1), 64: (0.003, 1e-4, 1)},
}
HALF = 5e-4
PEAK, VOLUME = accuracy.PEAK, accuracy.VOLUME


@pytest.fixture
def measured(tmp_path):
	rows = ["skin,1,1,{0},0,0,0,8,1,1,0,0\nskin,2,2,{0},0,{1},0,8,1,1,0,0\npackings,,nan,{0},0,{2},0,8,1,1,0,0\n".format(*part) for part in ((PEAK, 0.004, 0.03), (VOLUME, 0.0005, 0.003))]
	for value, mean, half in (("off", 0, 0), ("on", -0.01, 0.002), ("on with the membrane", 0.02, 0.003)):
		rows += [f"mass scaling,{value},1,{name},nan,0,nan,8,1,1,{mean},{half}\n" for name in (PEAK, VOLUME)]
	for knob, levels in LEVELS.items():
		for x, (q, volume, time) in reversed(levels.items()):
			half, scatter = (HALF, 0.005) if q else (0, 0)
			rows.append(f"{knob},{x},{x},{PEAK},{q},{scatter},{half},8,1,{time},9,9\n{knob},{x},{x},{VOLUME},{volume},{scatter / 10},0,8,1,{time},9,9\n{knob},{x},{x},q at 1 %,9,9,9,8,1,1\n")
	path = tmp_path / "curves.csv"
	path.write_text(HEADER + "".join(rows))
	return accuracy.Measured.of(path)


def quick(without=(), **changes):
	"""examples/quick.yaml with changes, without some of its keys."""
	import yaml

	values = configuration.merged(yaml.safe_load(QUICK.read_text()), changes)
	for key in without:
		section, name = key.split(".")
		del values[section][name]
	return Config.of(values, QUICK.parent)


OPEN = ("shear.velocity", "specimen.emod", "membrane.sizeRatio")


def test_budgetIsTheSumOfItsParts(measured):
	"""At measured levels the mean's size and its half width, between them linear in log x; intervals and scatter at right angles, what rounding does once; scatter goes with 1/sqrt(N)."""
	config = quick(numerics={"safety": 0.5, "damping": 0.3})
	radii = specimen.plannedRadii(config)
	found = accuracy.budget(config, radii, measured)
	parts = {key: (value, x, errors) for key, value, x, errors in found.parts}
	assert parts["numerics.safety"] == (0.5, 0.5, {PEAK: pytest.approx((0.001, HALF, 0.005)), VOLUME: (0, 0, 0.0005)})
	share = math.log(3) / math.log(9)
	assert parts["numerics.damping"][2][PEAK] == pytest.approx((share * 0.02, share * HALF, share * 0.005))
	inertial = 0.06 / 0.08 * 2 * numpy.mean(radii**3) ** (1 / 3) * math.sqrt(2640 / 1e5)
	assert parts["shear.velocity"][1] == pytest.approx(inertial)
	assert parts["specimen.emod"][1] == pytest.approx(math.pi * 4e7 / 4e5)
	assert found.scatter[PEAK] == pytest.approx(0.004) and found.packings[PEAK] == pytest.approx(0.03)
	excess = sum(max(0, errors[PEAK][2] ** 2 - 0.004**2) for *_, errors in parts.values())
	halves = sum(errors[PEAK][1] ** 2 for *_, errors in parts.values())
	assert found.total(PEAK) == pytest.approx(sum(errors[PEAK][0] for *_, errors in parts.values()) + math.sqrt(halves + 4 * (0.004**2 + excess)))
	few = accuracy.budget(config, radii[:300], measured)
	assert few.scatter[PEAK] == pytest.approx(0.008) and few.parts[2][3][PEAK][2] == pytest.approx(2 * found.parts[2][3][PEAK][2])
	assert len(found.lines()) == 1 + len(LEVELS) + 3 and found.unmeasured() == []
	assert set(found.asDict()) == {*parts, "rounding alone", "scatter of packings", "budget of a run"}


def test_massScalingIsInTheBudget(measured):
	"""On it has the error of its own row, of both where the membrane's masses follow the grains'; off none; ``accuracy`` counts it."""
	radii = specimen.plannedRadii(quick())
	plain = accuracy.budget(quick(), radii, measured)
	assert "specimen.massScaling" not in [key for key, *_ in plain.parts]
	for membrane, mean in ((1.0, 0.01), (None, 0.02)):
		config = quick(OPEN, accuracy=0.05, specimen={"massScaling": True}, membrane={"densityScaling": membrane})
		found = accuracy.budget(config, radii, measured)
		assert found.parts[-1][0] == "specimen.massScaling" and found.parts[-1][3][PEAK][0] == mean
		assert "on" in found.lines()[len(found.parts)] and found.asDict()["specimen.massScaling"][PEAK][0] == mean
		accuracy.choose(config, radii, measured)
		assert accuracy.budget(config, radii, measured).total(PEAK) <= 0.05 * (1 + 1e-4)
	parts = {key: errors for key, _, _, errors in found.parts}
	assert parts["membrane.densityScaling"][PEAK][0] == 0.003 and "as needed" in "\n".join(found.lines())


@pytest.mark.parametrize("stiffness, share", [(100, 0), (100 * math.pi, 0), (math.sqrt(100 * math.pi * 3000), 0.5), (3000, 1)])
def test_speedCostsMoreOnStiffGrains(measured, stiffness, share):
	"""The velocity's error goes from one curve to the other with the logarithm of the stiffness."""
	measured.curves[accuracy.VELOCITY_ON_STIFF] = accuracy.Curve(
		numpy.array([1e-4, 1e-2]), *({PEAK: numpy.full(2, part), VOLUME: numpy.zeros(2)} for part in (0.1, 0.02, 0.03)), numpy.ones(2)
	)
	config = quick(specimen={"emod": 4e5 * stiffness / math.pi})
	radii = specimen.plannedRadii(config)
	found = accuracy.budget(config, radii, measured).parts[0]
	alone = measured.curves["velocity"].error(PEAK, found[2])
	assert found[0] == "shear.velocity" and found[3][PEAK] == pytest.approx([(1 - share) * soft + share * stiff for soft, stiff in zip(alone, (0.1, 0.02, 0.03))])


def test_outsideOfWhatWasMeasured(measured):
	config = quick(shear={"velocity": 3})
	found = accuracy.budget(config, specimen.plannedRadii(config), measured)
	assert found.unmeasured() == ["shear.velocity"]
	assert "not measured there" in "\n".join(found.lines()) and found.asDict()["shear.velocity"] == "not measured there"


def test_wallHasNoMembrane(measured):
	config = quick(boundary="wall")
	found = accuracy.budget(config, specimen.plannedRadii(config), measured)
	assert "membrane.sizeRatio" not in [key for key, *_ in found.parts]


def test_cheapestWithinTheError(measured):
	"""No other pick of measured levels within the error is cheaper than what is chosen, and what is chosen is within it."""
	config = quick(OPEN, accuracy=0.03)
	radii = specimen.plannedRadii(config)
	chosen = accuracy.choose(config, radii, measured)
	assert set(chosen) == {*OPEN, "numerics.safety"} and config.shear.velocity == chosen["shear.velocity"]
	found = accuracy.budget(config, radii, measured)
	assert found.total(PEAK) <= 0.03 * (1 + 1e-4)  # values are rounded to four digits
	free = [name for name in LEVELS if name not in ("damping", "density scaling")]
	share = math.log(2) / math.log(9)

	def total(pick):
		"""The formula for measured levels of the free knobs, beside damping, which is between two."""
		means = [LEVELS[name][x][0] for name, x in zip(free, pick)]
		off = sum(mean != 0 for mean in means)
		halves, excess = (off + share**2) * HALF**2, off * (0.005**2 - 0.004**2) + max(0, (share * 0.005) ** 2 - 0.004**2)
		return sum(map(abs, means)) + share * 0.02 + math.sqrt(halves + 4 * (0.004**2 + excess))

	cheapest = min(math.prod(LEVELS[name][x][2] for name, x in zip(free, pick)) for pick in itertools.product(*(LEVELS[name] for name in free)) if total(pick) <= 0.03)
	curves = measured.curves
	levels = {knob.name: knob.level(config, radii) for knob in accuracy.KNOBS}
	assert math.prod(float(curves[name].cost(levels[name])) for name in free) <= cheapest * (1 + 1e-3)


def test_givenKeysStay(measured):
	config = quick(("shear.velocity",), accuracy=0.04)
	assert accuracy.openKeys(config) == ["shear.velocity", "numerics.safety"]
	chosen = accuracy.choose(config, specimen.plannedRadii(config), measured)
	assert set(chosen) == {"shear.velocity", "numerics.safety"} and config.specimen.emod == 4e7


@pytest.mark.parametrize("changes, told", [({}, False), ({"specimen": {"rollingFriction": 0.5}}, True), ({"specimen": {"rollingFriction": 0.5, "emod": 2e8}}, False)])
def test_softGrainsWithRollingResistance(measured, changes, told):
	"""The curve of the stiffness is of grains without rolling resistance: a test of soft ones with it says so."""
	config = quick(**changes)
	lines = accuracy.budget(config, specimen.plannedRadii(config), measured).lines()
	assert ("measured without rolling resistance" in lines[-1]) is told


def test_massesAreScaledWhereThatIsCheaper(measured):
	"""The switches are tried where their keys are left out: on if what they cost in accuracy is bought back, and a key that is given stays."""
	radii = specimen.plannedRadii(quick())
	measured.switchTime["on with the membrane"] = 0.3
	chosen = accuracy.choose(quick(OPEN, accuracy=0.2), radii, measured)
	assert chosen["specimen.massScaling"] is True and chosen["membrane.densityScaling"] is None
	assert "specimen.massScaling" not in accuracy.choose(quick(OPEN, accuracy=0.022), radii, measured)
	assert "membrane.densityScaling" not in accuracy.choose(quick(OPEN, accuracy=0.2, membrane={"densityScaling": 1.0}), radii, measured)
	measured.switchTime["on with the membrane"] = 4.0
	measured.switchTime["on"] = 0.3
	config = quick(OPEN, accuracy=0.2)
	assert accuracy.choose(config, radii, measured)["specimen.massScaling"] is True and config.membrane.densityScaling == 1
	assert accuracy.budget(config, radii, measured).total(PEAK) <= 0.2 * (1 + 1e-4)
	assert "specimen.massScaling" not in accuracy.choose(quick(OPEN, accuracy=0.2, specimen={"massScaling": False}), radii, measured)


def test_lessAccurateIsNoDearer(measured):
	"""The chosen velocity does not fall as the error grows."""
	speeds = []
	for error in (0.024, 0.026, 0.03, 0.05, 0.1):
		config = quick(("shear.velocity",), accuracy=error, numerics={"safety": 0.5}, specimen={"emod": 3e8})
		speeds.append(accuracy.choose(config, specimen.plannedRadii(config), measured)["shear.velocity"])
	assert speeds == sorted(speeds) and speeds[0] < speeds[-1]


@pytest.mark.parametrize("change, words", [({"accuracy": 0.005}, "out of reach"), ({"accuracy": 0.05, "specimen": {"emod": 1e6}}, "were measured from 100 to 3e+03")])
def test_outOfReach(measured, change, words):
	config = quick(("shear.velocity",), **change)
	with pytest.raises(ConfigError, match=words.replace("+", r"\+")):
		accuracy.choose(config, specimen.plannedRadii(config), measured)


def test_adviceHolds(measured):
	"""The error that the message names is within reach."""
	config = quick(OPEN, accuracy=0.005)
	radii = specimen.plannedRadii(config)
	with pytest.raises(ConfigError) as caught:
		accuracy.choose(config, radii, measured)
	config = quick(OPEN, accuracy=float(str(caught.value).split("fix: accuracy: ")[1].split()[0]))
	accuracy.choose(config, radii, measured)


def test_whatWasGiven():
	"""A derived configuration has the keys of its base and the changed ones; one that was written and read has all."""
	config = quick(("shear.velocity",))
	assert "shear.velocity" not in config.given and "specimen.emod" in config.given
	assert "shear.velocity" not in configuration.derived(config, {"boundary": "wall"}).given
	assert "shear.velocity" in configuration.derived(config, {"shear": {"velocity": 0.1}}).given
	assert accuracy.openKeys(Config.of(configuration.resolved(config))) == []


def test_plannedRadii(tmp_path):
	"""They are those of the packing that is made, and of a packing's file."""
	config = quick(specimen={"grains": 120, "porosity": 0.47})
	packing = specimen.provide(config, tmp_path, lambda text: None)
	assert sorted(specimen.plannedRadii(config)) == pytest.approx(sorted(packing.radii), rel=1e-12)
	config.specimen.packing, config.specimen.gradation = str(tmp_path / "packing.txt"), None
	assert list(specimen.plannedRadii(config)) == list(packing.radii)


@pytest.mark.parametrize("boundary, most", [("membrane", 0.2), ("wall", 0.3)])
def test_everyKnobWasMeasured(boundary, most):
	"""The measurements that come with the package have a curve for each knob, its default inside."""
	config = quick(OPEN, boundary=boundary)
	measured = accuracy.Measured.forTest(config)
	found = accuracy.budget(config, specimen.plannedRadii(config))
	knobs = [knob for knob in accuracy.KNOBS if knob.applies(config)]
	assert set(measured.curves) == {knob.name for knob in knobs} | {accuracy.VELOCITY_ON_STIFF} and len(found.parts) == len(knobs)
	assert found.unmeasured() == [] and set(measured.scatter) == set(measured.packings) == set(accuracy.QUANTITIES)
	assert found.total(PEAK) < most
