# SPDX-License-Identifier: GPL-2.0-or-later
"""Clouds: fields of a test's grains on a vertical section, several tests and strains beside each other with one colour scale; as PNG and as VTK.

A cloud is a mean over the grains near each point of the section, weighted with exp(-d^2/2 h^2), d the distance, h = d50. It needs fields.h5 (``measure.strains``).
The section stands through the axis, or beside it, along the direction in which the band dips. Uses nothing of YADE.
"""

import argparse
import dataclasses
import math
import pathlib

import numpy as np
from scipy.spatial import cKDTree

from hexmembrane.output import fields, tables, vtk

#: Quantities: name -> (label with unit, colour map, whether both signs count). The coordination number counts all partners. Shear intensity (sum of the steps'
#: deviatoric strain), rotation and displacement count from the start of shear; the normal is the section's.
QUANTITIES = {
	"porosity": ("porosity [-]", "viridis", False),
	"coordination": ("coordination number [-]", "cividis", False),
	"shear": ("shear intensity [-]", "inferno", False),
	"increment": ("deviatoric strain of the step [-]", "inferno", False),
	"rotation": ("rotation about the normal [degrees]", "RdBu_r", True),
	"displacement": ("displacement [mm]", "magma", False),
}
#: Points of a section are this far apart, in d50; means reach over this many standard deviations of their weight.
_GRID, _REACH = 0.25, 2.5
#: A point farther from every grain's surface than this is outside the specimen, in d50: pores are narrower.
_EDGE = 0.4


@dataclasses.dataclass
class Section:
	"""A vertical section.

	:param azimuth: its direction, from x towards y [degrees].
	:param offset: distance from the axis, to the left of that direction [m].
	"""

	azimuth: float = 0.0
	offset: float = 0.0

	def axes(self):
		"""Unit vectors along it and normal to it, (3,) each."""
		angle = math.radians(self.azimuth)
		return np.array([math.cos(angle), math.sin(angle), 0.0]), np.array([-math.sin(angle), math.cos(angle), 0.0])


@dataclasses.dataclass
class Cloud:
	"""Fields on a section.

	:param along, height: coordinates of the points [m], (n,) and (m,); height above the bottom platen's face.
	:param values: by quantity, (m, n), nan outside the specimen.
	"""

	along: np.ndarray
	height: np.ndarray
	values: dict


def bandSection(folder, offset=0.0):
	"""The section along the direction in which the first plane of the last band in ``folder``/bands.csv dips; None without one."""
	path = pathlib.Path(folder) / "bands.csv"
	if not path.is_file():
		return None
	table = tables.read(path, ("verdict",))
	found = [k for k, verdict in enumerate(table["verdict"]) if verdict in ("band", "pair") and table["plane"][k] == 0]
	return Section(float(table["azimuth"][found[-1]]), offset) if found else None


def cloud(path, strain, section, quantities=tuple(QUANTITIES)):
	"""The :class:`Cloud` of a test's state.

	:param path: fields.h5. :param strain: axial strain of the state, None: the last. :param section: a :class:`Section`.
	:raises ValueError: no such state or quantity; a section that misses the specimen.
	"""
	if odd := [name for name in quantities if name not in QUANTITIES]:
		raise ValueError(f"quantities = {odd}: are not known; fix: choose of {', '.join(QUANTITIES)}")
	test, grains = fields.read(path, strain)
	if abs(section.offset) >= test["radius"]:
		raise ValueError(f"section.offset = {section.offset:g} m: misses the specimen of radius {test['radius']:.4g} m; fix: give a smaller offset")
	d50, kept = float(test["d50"]), np.isfinite(grains["deviatoric_sum"]) & (grains["volume"] > 0)
	x = grains["position"][kept] - [0, 0, test["bottom"]]
	along, normal = section.axes()
	wide = np.abs(x @ along).max() + d50 / 2
	a = np.arange(-wide, wide, _GRID * d50)
	z = np.arange(_GRID * d50 / 2, test["top"] - test["bottom"], _GRID * d50)
	points = (section.offset * normal + a[None, :, None] * along + z[:, None, None] * [0, 0, 1]).reshape(-1, 3)
	weight, inside = _weights(x, points, d50), _near(x, grains["radii"][kept], points, _EDGE * d50)
	volume, solid = grains["volume"][kept], 4 / 3 * np.pi * grains["radii"][kept] ** 3
	cells = weight @ volume
	one = np.ones(kept.sum())
	per = {
		"porosity": (volume - solid, volume, 1.0),
		"coordination": (grains["coordination"][kept], one, 1.0),
		"shear": (volume * grains["deviatoric_sum"][kept], volume, 1.0),
		"increment": (volume * np.nan_to_num(grains["deviatoric"][kept]), volume, 1.0),
		"rotation": (volume * (grains["rotation_sum"][kept] @ normal), volume, 180 / np.pi),
	}
	values = {}
	for name in quantities:
		if name == "displacement":
			u = np.column_stack([weight @ (volume * part) for part in grains["displacement"][kept].T])
			found = 1e3 * np.linalg.norm(u, axis=1) / np.maximum(cells, 1e-300)
		else:
			top, bottom, factor = per[name]
			found = factor * (weight @ top) / np.maximum(weight @ bottom, 1e-300)
		values[name] = np.where(inside, found, np.nan).reshape(len(z), len(a))
	return Cloud(a, z, values)


def _weights(x, points, width):
	"""Sparse matrix of each grain's weight at each point."""
	pairs = cKDTree(points).sparse_distance_matrix(cKDTree(x), _REACH * width, output_type="coo_matrix")
	pairs.data = np.exp(-0.5 * (pairs.data / width) ** 2)
	return pairs.tocsr()


def _near(x, radii, points, gap):
	"""Which points are within grains or nearer to one's surface than ``gap`` [m]."""
	distance, nearest = cKDTree(x).query(points, k=min(6, len(x)))
	return (distance - radii[nearest]).min(axis=1) < gap


def picture(path, clouds, name, titles=(), rows=()):
	"""Draw a quantity of several clouds with one colour scale.

	:param path: PNG to write. :param clouds: :class:`Cloud` s, a list of rows. :param name: of the quantity.
	:param titles: of the columns. :param rows: of the rows.
	"""
	from matplotlib.backends.backend_agg import FigureCanvasAgg
	from matplotlib.figure import Figure

	label, colours, signed = QUANTITIES[name]
	seen = np.concatenate([one.values[name][np.isfinite(one.values[name])] for row in clouds for one in row])
	low, high = np.percentile(seen, (0.5, 99.5))
	if signed:
		low, high = -max(abs(low), abs(high)), max(abs(low), abs(high))
	count = max(map(len, clouds))
	ratio = max(one.height[-1] / (one.along[-1] - one.along[0]) for row in clouds for one in row)
	figure = Figure(figsize=(1.2 + 1.9 * count, 0.6 + len(clouds) * (0.2 + 1.25 * ratio)), layout="constrained")
	FigureCanvasAgg(figure)
	axes = figure.subplots(len(clouds), count, squeeze=False, sharex=True, sharey=True)
	for i, row in enumerate(clouds):
		for j, one in enumerate(row):
			a, z = 1e3 * one.along, 1e3 * one.height
			shown = axes[i][j].pcolormesh(a, z, np.ma.masked_invalid(one.values[name]), cmap=colours, vmin=low, vmax=high, shading="nearest", rasterized=True)
			axes[i][j].set_aspect("equal")
			if i == 0 and j < len(titles):
				axes[i][j].set_title(titles[j], fontsize="medium")
		if i < len(rows):
			axes[i][0].set_ylabel(f"{rows[i]}\nheight [mm]")
	for one in axes[-1]:
		one.set_xlabel("along [mm]")
	figure.colorbar(shown, ax=axes, label=label, shrink=0.8, extend="both")
	path = pathlib.Path(path)
	part = path.with_name(path.name + ".part")
	figure.savefig(part, dpi=150, format="png", metadata={"Software": "hexmembrane"})
	part.replace(path)


def writeVtk(path, one, section):
	"""Write a cloud as a surface of triangles in space with all its quantities, for ParaView; points outside the specimen are left out."""
	along, normal = section.axes()
	grid = section.offset * normal + one.along[None, :, None] * along + one.height[:, None, None] * [0, 0, 1]
	inside = np.all([np.isfinite(values) for values in one.values.values()], axis=0).ravel()
	count = len(one.along)
	corner = (np.arange(len(one.height) - 1)[:, None] * count + np.arange(count - 1)).ravel()
	triangles = np.vstack([np.column_stack([corner, corner + 1, corner + count]), np.column_stack([corner + 1, corner + count + 1, corner + count])])
	number = np.cumsum(inside) - 1
	triangles = number[triangles[inside[triangles].all(axis=1)]]
	vtk.write(path, grid.reshape(-1, 3)[inside], triangles, {name: values.ravel()[inside] for name, values in one.values.items()})


def strainsOf(folder):
	"""The axial strains at which a test kept its fields, in fields.h5, to 1e-4."""
	with fields.opened(pathlib.Path(folder) / "fields.h5") as file:
		return [round(float(file[name].attrs["axial_strain"]), 4) + 0.0 for name in fields.states(file)]  # + 0.0: no "-0 %" in a title


def draw(folders, out, strains=(None,), section=None, quantities=tuple(QUANTITIES), names=None):
	"""Clouds of tests at strains: one PNG a quantity, ``out``/NAME.png, one row a test; and ``out``/TEST-STRAIN.vtp.

	:param folders: of tests, with fields.h5. :param out: folder, made if need be. :param strains: axial strains, None: the last state.
	:param section: the same for all; None: of each test its band's, x without one. :param quantities: names of :data:`QUANTITIES`.
	:param names: of the tests; None: their folders'.
	:returns: the files.
	:raises ValueError: as :func:`cloud`.
	"""
	out = pathlib.Path(out)
	sections = [section or bandSection(folder) or Section() for folder in folders]
	rows = [[cloud(pathlib.Path(folder) / "fields.h5", strain, at, quantities) for strain in strains] for folder, at in zip(folders, sections)]
	out.mkdir(parents=True, exist_ok=True)
	titles = ["last" if strain is None else f"{100 * strain:g} %" for strain in strains]
	names = names or [pathlib.Path(folder).name for folder in folders]
	files = []
	for quantity in quantities:
		files.append(out / f"{quantity}.png")
		picture(files[-1], rows, quantity, titles, [f"{name}, {at.azimuth:.0f}\N{DEGREE SIGN}" for name, at in zip(names, sections)])
	for name, row, at in zip(names, rows, sections):
		for one, title in zip(row, titles):
			files.append(out / f"{name}-{title.split()[0]}.vtp")
			writeVtk(files[-1], one, at)
	return files


def main(arguments):
	"""The command ``scripts/clouds``; returns its exit code."""
	parser = argparse.ArgumentParser(prog="clouds", description="Draw clouds of tests that kept fields.h5 (measure.strains), with one colour scale.")
	parser.add_argument("folders", nargs="+", metavar="DIR", help="output folder of a test")
	parser.add_argument("--out", default="clouds", help="folder of the pictures")
	parser.add_argument("--strains", type=float, nargs="+", default=[None], help="axial strains, such as 0 0.08 0.15; the last state without")
	parser.add_argument("--azimuth", type=float, help="direction of the section from x towards y, degrees; that of the band without")
	parser.add_argument("--offset", type=float, default=0.0, help="distance of the section from the axis [m]")
	parser.add_argument("--quantities", nargs="+", default=list(QUANTITIES), help=", ".join(QUANTITIES))
	given = parser.parse_args(arguments)
	try:
		if given.azimuth is None and given.offset:
			raise ValueError(f"--offset = {given.offset:g}: of which section is not said; fix: give --azimuth too")
		section = None if given.azimuth is None else Section(given.azimuth, given.offset)
		for path in draw(given.folders, given.out, given.strains, section, given.quantities):
			print(path)
	except ValueError as error:
		parser.exit(1, f"clouds: {error}\n")
	return 0


if __name__ == "__main__":
	import sys

	sys.exit(main(sys.argv[1:]))
