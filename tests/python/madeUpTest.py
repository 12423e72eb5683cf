# SPDX-License-Identifier: GPL-2.0-or-later
"""Folders of made-up tests, as runs leave them, for the tests of reports."""

import math

import numpy as np
import yaml
from hexmembrane.measure.local import FIELDS
from hexmembrane.output import fields, records, vtk

HARM = "</script><script>harmed=1</script><img src=x onerror=harmed=1> & \"'"
CONFIG = {
	"boundary": "membrane",
	"specimen": {"seed": 1, "grains": 30, "gradation": "/somewhere/sand.csv"},
	"consolidation": {"pressure": 1e5, "unbalanced": 1e-3, "tolerance": None},
	"shear": {"strain": 0.1, "pressureTolerance": 0.05},
	"made": {"commit": "0" * 40, "yade": "2025.2.0", "budget": {"budget of a run": {"peak q": 0.1}, "scatter of packings": {"peak q": 0.02}}},
}


def row(stage, strain, **more):
	values = {column.name: 1.0 for column in records.COLUMNS}
	values.update(stage=stage, step=int(1e5 * strain) + 1, time=strain, axial_strain=strain, q=2e5 * (1 - math.exp(-50 * strain)), p=1.5e5, sigma3_target=1e5)
	values.update(soil_axial_middle=1.001e5, soil_radial_middle=0.999e5, inertial_number=5e-4, sigma3_distance=-0.01, energy_error=-1e-4, bonds_broken=0, unbalanced=5e-4)
	return {**values, **more}


def makeTest(folder, rows=11, frames=3, grains=30, seed=1, title="a test", last=0.1, jitter=0.0, sheet=12, **columns):
	"""A test's folder with rows to 10 % strain and frames, as a run leaves them."""
	(folder / "vtk").mkdir(parents=True)
	config = {**CONFIG, "title": title, "specimen": {**CONFIG["specimen"], "seed": seed}}
	(folder / "config.yaml").write_text(yaml.safe_dump(config))
	with records.Records(folder / "records.csv") as table:
		table.append(row("consolidation", 0.0))
		for strain in np.linspace(0, last, rows):
			table.append(row("shear", float(strain), **columns))
	random = np.random.default_rng(seed)
	grainsAt, sheetAt = random.uniform(-0.02, 0.02, (grains, 3)), random.uniform(-0.02, 0.02, (sheet, 3))
	triangles = np.arange(sheet).reshape(-1, 3)
	for k in range(frames):
		moved = np.tile([0, 0, -1e-3 * k], (grains, 1)) + jitter * k * random.normal(size=(grains, 3))
		ofGrains = {"radius": np.full(grains, 1e-3), "displacement": moved, "coordination": np.arange(grains) % 7}
		vtk.write(folder / "vtk" / f"grains-{k:04d}.vtp", grainsAt + moved, pointData=ofGrains)
		ofSheet = {"group": np.full(sheet, 3), "pressure": np.full(sheet, 1e5), "normal_displacement": np.full(sheet, 1e-3 * k)}
		vtk.write(folder / "vtk" / f"membrane-{k:04d}.vtp", sheetAt + jitter * random.normal(size=(sheet, 3)), triangles, ofSheet, {"hoop_tension": np.arange(sheet / 3)})
		ends = grainsAt[random.integers(0, grains, (3 * grains, 2))].astype(np.float32)
		forces = random.exponential(size=3 * grains).astype(np.float32)
		vtk.write(folder / "vtk" / f"contacts-{k:04d}.vtp", ends, np.arange(6 * grains).reshape(-1, 2), {"normal_force": np.repeat(forces, 2)})
	for name in ("grains", "membrane", "contacts"):
		vtk.series(folder / "vtk" / f"{name}.pvd", [(0.05 * k, f"{name}-{k:04d}.vtp") for k in range(frames)])
	return folder


def addInside(folder, seed=1, grains=400):
	"""What a test that was measured inside has beside: fields.h5 at two strains, profile.csv, and bands.csv with a band."""
	random = np.random.default_rng(seed)
	about = {"d50": 0.003, "title": "", "boundary": "membrane", "pressure": 1e5}
	made = fields.FieldsFile(folder / "fields.h5", about, FIELDS)
	at = random.uniform((-0.02, -0.02, -0.02), (0.02, 0.02, 0.02), (grains, 3))
	arrays = {name: np.ones(grains) for name in FIELDS}
	arrays.update(position=at, displacement=0.1 * at, rotation=0.1 * at, rotation_sum=10 * at, stress=np.ones((grains, 3, 3)), volume=np.full(grains, 1e-8))
	for k, strain in enumerate((0.0, 0.1)):
		arrays["deviatoric_sum"] = strain * (1 + 20 * at[:, 2])
		attributes = {"row": 10 * k, "step": int(1e5 * strain) + 1, "axial_strain": strain, "increment": 0.0, "bottom": -0.02, "top": 0.02, "radius": 0.02}
		made.add(attributes, np.arange(grains), np.full(grains, 1e-3), arrays)
	slices = [f"{int(1e5 * strain) + 1},{strain},{k},{0.01 * k},{0.02 + strain * 0.01 * k},{2e5 + 1e4 * k},{1e5}" for strain in (0.0, 0.1) for k in range(5)]
	(folder / "profile.csv").write_text("\n".join(["step,axial_strain [-],slice,height [m],radius [m],axial [Pa],radial [Pa]", *slices, ""]))
	(folder / "bands.csv").write_text(
		"step,axial_strain [-],verdict,plane,dip [deg],azimuth [deg],thickness [m],height [m]\n5001,0.05,none,0,50,20,0.01,0.02\n10001,0.1,band,0,55,30,0.01,0.02\n"
	)
