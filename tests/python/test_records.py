# SPDX-License-Identifier: GPL-2.0-or-later
"""records.csv: reads back exactly, survives a kill, is cut at a checkpoint; and the picture made from it."""

import math

import pytest
from hexmembrane.output import records
from hexmembrane.output.plots import plot
from hexmembrane.output.records import COLUMNS, Records
from PIL import Image


def rowOf(k, stage="shear"):
	row = {column.name: 0.1 * k + 1e-17 * j + j for j, column in enumerate(COLUMNS)}
	strain = 0.01 * k
	row.update(stage=stage, step=1000 * k, axial_strain=strain, q=2e5 * math.tanh(60 * strain), volumetric_strain_radius=0.3 * strain - 0.002)
	row.update(volumetric_strain_volume=0.28 * strain, sigma3_target=1e5, sigma3_applied=0.98e5, sigma3_transmitted_group3=1.01e5, sigma3_transmitted_all=0.99e5)
	return row


def write(path, count, keep=None, start=0):
	with Records(path, keep) as made:
		places = []
		for k in range(start, count):
			made.append(rowOf(k))
			places.append(made.position())
	return places


def test_readsBackExactly(tmp_path):
	write(tmp_path / "r.csv", 5)
	table = records.read(tmp_path / "r.csv")
	assert list(table) == [column.name for column in COLUMNS]
	for k in range(5):
		assert all(table[name][k] == value for name, value in rowOf(k).items())


def test_headerHasUnits(tmp_path):
	write(tmp_path / "r.csv", 1)
	header = (tmp_path / "r.csv").read_text().split("\n")[0].split(",")
	assert "axial_strain [-]" in header and "q [Pa]" in header and "elapsed [s]" in header and "platen_force_top [N]" in header


def test_everyRowIsOnDiskAtOnce(tmp_path):
	made = Records(tmp_path / "r.csv")
	for k in range(3):
		made.append(rowOf(k))
		assert len(records.read(tmp_path / "r.csv")["step"]) == k + 1
	made.close()


def test_cutLastRowIsLeftOut(tmp_path):
	write(tmp_path / "r.csv", 3)
	whole = (tmp_path / "r.csv").read_bytes()
	(tmp_path / "r.csv").write_bytes(whole[:-5])
	assert list(records.read(tmp_path / "r.csv")["step"]) == [0, 1000]


def test_resumeCutsAndGoesOn(tmp_path):
	"""Rows after the checkpoint go, also half a row; what is written then equals a file written in one go."""
	places = write(tmp_path / "whole.csv", 8)
	write(tmp_path / "r.csv", 6)
	with open(tmp_path / "r.csv", "ab") as file:
		file.write(b"shear,99")
	write(tmp_path / "r.csv", 8, keep=places[3], start=4)
	assert (tmp_path / "r.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_resumeRefusesAnotherFile(tmp_path):
	places = write(tmp_path / "r.csv", 4)
	with pytest.raises(ValueError, match="its checkpoint was taken at"):
		Records(tmp_path / "r.csv", places[-1] + 1)
	with pytest.raises(ValueError, match="its checkpoint was taken at"):
		Records(tmp_path / "nowhere.csv", 10)
	text = (tmp_path / "r.csv").read_text()
	(tmp_path / "r.csv").write_text(text.replace("q [Pa]", "q [Pb]", 1))
	with pytest.raises(ValueError, match="other columns"):
		Records(tmp_path / "r.csv", places[-1])
	assert (tmp_path / "r.csv").read_text() == text.replace("q [Pa]", "q [Pb]", 1)


@pytest.mark.parametrize("name, value", [("q", math.nan), ("porosity", math.inf), ("elapsed", -math.inf)])
def test_notFiniteIsRefused(tmp_path, name, value):
	made = Records(tmp_path / "r.csv")
	with pytest.raises(ValueError, match=f"records.{name} = .*not finite"):
		made.append({**rowOf(0), name: value})
	made.close()
	assert len(records.read(tmp_path / "r.csv")["step"]) == 0


def test_wrongColumnsAreRefused(tmp_path):
	made = Records(tmp_path / "r.csv")
	for row in ({**rowOf(0), "quark": 1}, {name: value for name, value in rowOf(0).items() if name != "q"}):
		with pytest.raises(ValueError, match="missing or unknown columns"):
			made.append(row)
	made.close()


@pytest.mark.parametrize("text, message", [("", "no header"), ("a,b\n1,2\n", "no header"), ("stage,step\nshear\n", "has 1 cells")])
def test_badFile(tmp_path, text, message):
	(tmp_path / "r.csv").write_text(text)
	with pytest.raises(ValueError, match=message):
		records.read(tmp_path / "r.csv")


def test_everyColumnIsDocumented():
	assert len({column.name for column in COLUMNS}) == len(COLUMNS)
	for column in COLUMNS:
		assert len(column.doc) > 10 and "," not in column.header, column.name
		if column.unit in ("Pa", "N", "-") and ("strain" in column.name or column.unit != "-"):
			assert any(word in column.doc for word in ("positive", "pushes", "the same", "inward", "pressure")), f"{column.name}: sign"


def test_picture(tmp_path):
	"""The picture opens, shows the three curves' axes with units, and is not blank."""
	write(tmp_path / "r.csv", 13)
	figure = plot(tmp_path / "r.csv", tmp_path / "p.png", "a test")
	assert [axes.get_ylabel() for axes in figure.axes] == [
		"deviatoric stress of the soil q [kPa]",
		"volumetric strain [%]\n(dilation positive)",
		"confining pressure [kPa]",
	]
	assert figure.axes[-1].get_xlabel() == "axial strain [%]"
	x, y = figure.axes[0].lines[0].get_data()
	assert x[-1] == pytest.approx(12, rel=1e-12) and max(y) == pytest.approx(200, rel=1e-5)
	assert len(figure.axes[1].get_legend().get_texts()) == 2
	picture = Image.open(tmp_path / "p.png").convert("L")
	assert min(picture.size) > 800 and picture.getextrema()[0] < 60
	dark = sum(picture.histogram()[:200]) / (picture.size[0] * picture.size[1])
	assert 0.005 < dark < 0.3


def test_pictureWithoutShear(tmp_path):
	with Records(tmp_path / "r.csv") as made:
		made.append(rowOf(0, "consolidation"))
	with pytest.raises(ValueError, match="no shear rows"):
		plot(tmp_path / "r.csv", tmp_path / "p.png")
	assert not (tmp_path / "p.png").exists()
