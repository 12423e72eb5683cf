# SPDX-License-Identifier: GPL-2.0-or-later
"""Laboratory curves: what is read, what is refused and with which words, how far a test is from one."""

import copy

import numpy
import pytest
from hexmembrane import configuration
from hexmembrane.configuration import Config, ConfigError
from hexmembrane.laboratory import curve, misfit
from hexmembrane.laboratory.curve import Series
from tinyTest import TINY, configure

DECLARED = {"file": "c.csv", "strain": "e [%]", "stress_ratio": "sr", "volumetric_strain": "v [%]", "volumetric": "compression"}
STRAIN = numpy.linspace(0, 10, 21)
PRESSURE = 98e3


def write(folder, rows=None, header="e [%],sr,v [%]"):
	rows = [(e, 1 + 3 * e / (1 + e), -0.3 * e) for e in STRAIN] if rows is None else rows
	lines = [header] + [",".join("" if cell is None else f"{cell}" for cell in row) for row in rows]
	(folder / "c.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
	return folder


def read(folder, **changes):
	declared = {key: value for key, value in {**DECLARED, **changes}.items() if value is not None}
	return curve.read(declared, folder, PRESSURE)


def test_read(tmp_path):
	"""Percent become ratios, compression becomes negative dilation, empty cells are no values."""
	rows = [(0, 1, 0), (1, 2.5, None), (2, None, 0.3), (3, 3, None), (4, 3.2, -0.5), (5, 3.3, -0.8), (6, 3.35, -1.2), (7, None, -1.5)]
	found = read(write(tmp_path, rows))
	assert found.warnings == []
	assert found.series["stress_ratio"].strain == pytest.approx([0, 0.01, 0.03, 0.04, 0.05, 0.06])
	assert found.series["volumetric_strain"].value == pytest.approx([0, -0.003, 0.005, 0.008, 0.012, 0.015])
	dilation = read(write(tmp_path, rows), volumetric="dilation")
	assert dilation.series["volumetric_strain"].value[-1] == pytest.approx(-0.015)


def test_q(tmp_path):
	"""q in kPa and the test's pressure give the same curve as the stress ratio."""
	direct = read(write(tmp_path)).series["stress_ratio"]
	rows = [(e, 1e-3 * PRESSURE * (sr - 1), 0) for e, sr in zip(STRAIN, direct.value)]
	found = read(write(tmp_path, rows, "e [%],q [kPa],v [%]"), stress_ratio=None, q="q [kPa]").series["stress_ratio"]
	assert found.value == pytest.approx(direct.value)


def changed(**columns):
	strain, sr, v = (columns.get(name, known) for name, known in (("e", STRAIN), ("sr", 1 + 3 * STRAIN / (1 + STRAIN)), ("v", -0.3 * STRAIN)))
	return list(zip(strain, sr, v))


@pytest.mark.parametrize(
	("rows", "changes", "message"),
	[
		(changed(e=-STRAIN), {}, "its sign is wrong"),
		(changed(e=STRAIN / 100), {}, "a ratio given for percent"),
		(changed(), {"strain": "e", "units": {"e": "-"}}, "is no column"),
		(changed(e=STRAIN[[*range(10), 15, *range(10, 15), *range(16, 21)]]), {}, "unsorted"),
		(changed()[:3], {}, "is too short: it has 3 values"),
		(changed(sr=3 * STRAIN / (1 + STRAIN)), {}, "q/sigma3 given for sigma1/sigma3"),
		(changed(sr=100 * (1 + STRAIN)), {}, "which no sand has"),
		(changed(v=-30 * STRAIN), {}, "more than sand has"),
		(changed(v=-3e-5 * STRAIN), {}, "less than sand has"),
		(changed(), {"volumetric": None}, "does not say what is positive"),
		(changed(), {"strain": None}, "lab.strain"),
		(changed(), {"colour": "red"}, "lab.colour"),
		(changed(), {"q": "sr"}, "together with stress_ratio"),
		([(0, "a", 1)] * 5, {}, "row 2 has 'a', which is no number"),
		([(0, 1, 1, 1)] * 5, {}, "row 2 has 4 cells for 3 columns"),
	],
)
def test_refused(tmp_path, rows, changes, message):
	with pytest.raises(ConfigError, match=message):
		read(write(tmp_path, rows), **changes)


def test_unitsAreDeclared(tmp_path):
	write(tmp_path, header="e,sr,v [%]")
	with pytest.raises(ConfigError, match="has no unit; fix: end the header with a unit"):
		read(tmp_path, strain="e")
	assert read(tmp_path, strain="e", units={"e": "%"}).series["stress_ratio"].strain[-1] == pytest.approx(0.1)
	with pytest.raises(ConfigError, match="percent given for a ratio"):
		read(tmp_path, strain="e", units={"e": "-"})


def test_gapIsTold(tmp_path):
	found = read(write(tmp_path, [row for row in changed() if not 2 < row[0] < 7]))
	assert len(found.warnings) == 2 and "from 2 to 7 % of strain" in found.warnings[0]


def difference(number):
	return number.test - number.laboratory


def test_numbers():
	"""Of a curve with a known peak, modulus, residual and slope of dilation, against itself made weaker."""
	strain = numpy.linspace(0, 0.12, 121)
	lab = curve.Curve("c", {"stress_ratio": Series(strain, numpy.interp(strain, [0, 0.04, 0.12], [1, 5, 3])), "volumetric_strain": Series(strain, 0.5 * strain)}, [])
	test = {"stress_ratio": Series(strain, numpy.interp(strain, [0, 0.05, 0.12], [1, 4.5, 3])), "volumetric_strain": Series(strain, 0.25 * strain)}
	found = {number.name: number for number in misfit.numbers(lab, test, PRESSURE)}
	assert found["peak of sigma1/sigma3"].laboratory == pytest.approx(5) and difference(found["peak of sigma1/sigma3"]) == pytest.approx(-0.5)
	assert difference(found["strain at the peak"]) == pytest.approx(1.0)
	assert found["secant modulus at 0.5 %"].laboratory == pytest.approx(1e-6 * PRESSURE * 100)
	assert difference(found["sigma1/sigma3 at the end"]) == pytest.approx(0, abs=1e-12)
	assert found["dilation angle"].laboratory == pytest.approx(numpy.degrees(numpy.arcsin(0.2)))
	assert found["dilation angle"].test == pytest.approx(numpy.degrees(numpy.arcsin(1 / 9)))
	apart = misfit.rootMeanSquare(lab, test)
	assert apart["volumetric_strain"] == pytest.approx(0.25 * numpy.sqrt((strain**2).mean()))


def test_shorterTest():
	"""Numbers end where the shorter curve ends."""
	strain = numpy.linspace(0, 0.1, 11)
	lab = curve.Curve("c", {"stress_ratio": Series(strain, 1 + 20 * strain)}, [])
	test = {"stress_ratio": Series(strain[:6], 1 + 20 * strain[:6])}
	assert all(difference(number) == pytest.approx(0, abs=1e-12) for number in misfit.numbers(lab, test, PRESSURE))


def test_ofTest():
	"""The load cell's stress over the pressure; rows that stand still or go back are left out."""
	table = {name: numpy.array(values) for name, values in {"axial_strain": [0, 0, 0.01, 0.009, 0.02], "q_cell": [0, 0, 1e5, 1e5, 2e5], "sigma3_target": [1e5] * 5, "volumetric_strain_volume": [0, 0, -0.001, 0, 0.001]}.items()}
	found = misfit.ofTest(table)
	assert found["stress_ratio"].value.tolist() == [1, 2, 3] and found["volumetric_strain"].strain.tolist() == [0, 0.01, 0.02]


def test_theSectionLab(tmp_path):
	"""Its file counts from the configuration's folder; what cannot be meant is refused."""
	path = configure(tmp_path, lab={"file": "c.csv", "q": "q", "units": {"q": "kPa"}})
	config = configuration.load(path)
	assert config.lab.file == str((tmp_path / "c.csv").resolve()) and config.lab.units == {"q": "kPa"}
	(tmp_path / "below").mkdir()
	(tmp_path / "below" / "c.yaml").write_text("base: ../tiny.yaml\n")
	assert configuration.load(tmp_path / "below" / "c.yaml").lab.file == config.lab.file
	for changes, message in (
		({"lab": {"q": "q"}}, "lab.q = 'q': is of no curve; fix: give lab.file"),
		({"lab": {"file": "c.csv", "units": ["kPa"]}}, "lab.units = .*: is not a mapping; fix: "),
		({"lab": {"file": "c.csv"}, "stages": [{"kind": "consolidation"}]}, "lab.file = 'c.csv': a list of stages has no single curve; fix: "),
	):
		with pytest.raises(ConfigError, match=message):
			Config.of({**copy.deepcopy(TINY), **changes}, tmp_path)


def test_aConfigurationsCurve(tmp_path):
	"""Columns that are not named are those with the names of records.csv; nothing without a file."""
	assert curve.ofKeys({"file": None, "strain": None}, PRESSURE) is None
	write(tmp_path, header="axial_strain [%],stress_ratio,volumetric_strain [%]")
	found = curve.ofKeys({"file": str(tmp_path / "c.csv"), "q": None}, PRESSURE)
	assert set(found.series) == {"stress_ratio", "volumetric_strain"} and found.series["volumetric_strain"].value[-1] == pytest.approx(-0.03)
	found = curve.ofKeys({"file": str(tmp_path / "c.csv"), "volumetric_strain": "volumetric_strain [%]", "volumetric": "compression"}, PRESSURE)
	assert set(found.series) == {"volumetric_strain"} and found.series["volumetric_strain"].value[-1] == pytest.approx(0.03)
	write(tmp_path)
	with pytest.raises(ConfigError, match="lab.strain = None: is not given"):
		curve.ofKeys({"file": str(tmp_path / "c.csv")}, PRESSURE)


def test_ofRecords(tmp_path):
	"""A test that is the curve itself is no distance from it; one without shear has no numbers."""
	known = read(write(tmp_path))
	strain = numpy.linspace(0, 0.1, 21)
	table = {"stage": ["shear"] * 21, "axial_strain": strain, "q_cell": PRESSURE * (known.series["stress_ratio"].value - 1), "sigma3_target": numpy.full(21, PRESSURE)}
	table["volumetric_strain_volume"] = known.series["volumetric_strain"].value
	found = misfit.ofRecords(known, table, PRESSURE)
	assert [str(one) for one in found][0] == "peak of sigma1/sigma3 3.727, laboratory's 3.727"
	assert [one.test for one in found[-2:]] == pytest.approx([0, 0], abs=1e-12) and all(one.test == pytest.approx(one.laboratory) for one in found[:-2])
	assert misfit.ofRecords(known, {**table, "stage": ["consolidation"] * 21}, PRESSURE) == []
