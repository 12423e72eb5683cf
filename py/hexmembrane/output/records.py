# SPDX-License-Identifier: GPL-2.0-or-later
"""The rows of records.csv: what each column is, its unit, sign and source, stated once, here.

Every row is written whole and flushed, so that a killed run leaves a readable file; a resumed run cuts the rows after its
checkpoint and goes on. A test with cement has some columns more. Strains count from the start of the row's stage (``stage`` column). Needs no YADE.
"""

from hexmembrane.configuration.stages import ISOTROPIC
from hexmembrane.output import tables
from hexmembrane.output.tables import Column

COLUMNS = (
	Column("stage", "", "consolidation or shear; of a list of stages also membrane, unloading, hold, pressure, with a number from the second of a kind on: shear-2", text=True),
	Column("step", "", "YADE's step, O.iter"),
	Column("time", "s", "YADE's time, O.time"),
	Column("axial_strain", "-", "eps1 = (h0 - h)/h0 with h the distance of the platens' faces; compression positive"),
	Column("q", "Pa", "deviatoric stress of the soil, soil_axial - soil_radial; compression positive"),
	Column("p", "Pa", "mean stress of the soil, (soil_axial + 2 soil_radial)/3; compression positive"),
	Column(
		"soil_axial",
		"Pa",
		"mean axial stress of the soil over V from its own contacts, sum F (x) l/V, see SoilMeasure; compression positive",
	),
	Column("soil_radial", "Pa", "the same, mean of the two horizontal normal stresses"),
	Column("soil_axial_middle", "Pa", "soil_axial of the middle half of the height, branches cut at its planes; compression positive"),
	Column("soil_radial_middle", "Pa", "the same of soil_radial"),
	Column(
		"boundary_axial",
		"Pa",
		"the soil's axial stress from its boundary alone, -sum f (x) x/V over all contacts with platens and membrane or wall, friction included; "
		"without inertia it is soil_axial; compression positive",
	),
	Column("boundary_radial", "Pa", "the same, mean of the two horizontal normal stresses"),
	Column(
		"inertia_axial",
		"Pa",
		"what the grains' resultants f add, sum f (x) x/V over all grains, from the forces that move them: soil_axial = boundary_axial + inertia_axial, a "
		"check of contacts, boundary and motion; its size against soil_axial says how quasi-static the instant is; compression positive",
	),
	Column("inertia_radial", "Pa", "the same, mean of the two horizontal normal stresses"),
	Column(
		"q_cell",
		"Pa",
		"what a load cell at the platens and a laboratory's area correction show: (F - sigma3_target Ae)/Am, F mean platen force, Ae the specimen's end "
		"(pi R^2 of the inner surface at first, pi r^2 in a rigid wall), Am mean area V/h; the membrane's pull and sag are in it; compression positive",
	),
	Column("sigma3_target", "Pa", "sigma3: pressure asked for, that the soil is to have; pushes inwards"),
	Column(
		"sigma3_applied",
		"Pa",
		"pressure on the membrane's main body: sigma3 with an open loop (membrane.pressureTime .inf), else what brings the transmitted pressure to it; of a rigid wall sigma3",
	),
	Column(
		"sigma3_transmitted_group3",
		"Pa",
		"radial contact forces of the membrane's main body on grains and platens over its smooth inner area; inwards positive; "
		"of a rigid wall (all three columns): normal forces on it over 2 pi r h",
	),
	Column(
		"sigma3_transmitted_group2",
		"Pa",
		"the same of the rows beside the platens (their forces on the platens' sides included)",
	),
	Column("sigma3_transmitted_all", "Pa", "the same of the whole membrane between the O-rings"),
	Column(
		"volumetric_strain_radius",
		"-",
		"theta = (h - h0)/h0 + 2 (r - r0)/r0, r as mean_radius (Eq. 6, first order in the strains); dilation positive",
	),
	Column(
		"volumetric_strain_volume",
		"-",
		"(V - V0)/V0, V enclosed by the inner surface between the platens' faces; dilation positive",
	),
	Column("porosity", "-", "1 - (volume of the grains)/V; overlaps at contacts are not taken off"),
	Column("coordination", "-", "2 (contacts among grains with a normal force)/(number of grains)"),
	Column("unbalanced", "-", "YADE's unbalancedForce: mean force on moving bodies (membrane too) over mean contact force"),
	Column(
		"membrane_unbalanced",
		"-",
		"mean resultant force on the membrane's particles of groups 2 and 3, mass times acceleration, over sigma3 2 sqrt(3) R^2: "
		"what its inertia adds, and density scaling with it; 0 with a rigid wall",
	),
	Column("inertial_number", "-", "I = (approach speed of the platens/h) d sqrt(rho/sigma3), d mean diameter of the grains"),
	Column("platen_force_bottom", "N", "on the bottom platen along its outward normal; positive when the specimen pushes back"),
	Column("platen_force_top", "N", "the same on the top platen"),
	Column("height", "m", "h, distance of the platens' faces"),
	Column("mean_radius", "m", "r, mean radius of the membrane's inner surface, or radius of the rigid wall"),
	Column("volume", "m3", "V, enclosed by the inner surface between the platens' faces"),
	Column("membrane_area", "m2", "area on which the pressure acts (group 3), 2 pi r h of a rigid wall"),
	Column("bonds_broken", "", "broken membrane bonds, 0 with a rigid wall"),
	Column("loops_saturated", "", "closed loops of pressure and stress that stand at a limit (maxFactor of membrane and consolidation), so that what is asked for does not arrive"),
	Column("elapsed", "s", "wall clock spent on the test so far, set-up of a resumed run not counted"),
	Column("energy_elastic", "J", "elastic energy of the contacts; this and all energies: nan with output.energy: false", True),
	Column("energy_membrane", "J", "elastic energy of the membrane: bonds, bending, self-contact; 0 with a rigid wall", True),
	Column("energy_kinetic", "J", "kinetic energy, half a step before", True),
	Column("energy_friction", "J", "dissipated by contacts since the stage began: sliding, rolling, broken contact bonds", True),
	Column("energy_damping", "J", "dissipated by the local damping since the stage began", True),
	Column(
		"work_boundary",
		"J",
		"work of platens, confining pressure, O-rings or rigid wall since the stage began; positive when done on the specimen",
		True,
	),
	Column(
		"energy_error",
		"-",
		"(work - change of the stored energy - dissipated energy, since the stage began) over the larger of that work and the energy stored now",
		True,
	),
	Column(
		"pressure_axial",
		"N",
		"P, axial parts of the applied confining pressure's forces on each half of the membrane, towards mid-height; 0 with a rigid wall",
	),
	Column(
		"membrane_axial_mid",
		"N",
		"axial pull of the membrane through the plane at mid-height, from the forces of its bonds, bending and self-contact; tension positive; 0 with a rigid wall",
	),
	Column("membrane_axial_end", "N", "the same just inside the O-rings, mean of both ends"),
	Column(
		"sigma3_membrane",
		"Pa",
		"part of the membrane's own tension in what its main body transmits: forces of bonds, bending and self-contact towards the axis over the same "
		"area; inwards positive; 0 with a rigid wall",
	),
	Column(
		"sigma3_distance",
		"-",
		"distance of sigma3_transmitted_group3 from what the lateral boundary is to hold, over sigma3_target: of a rigid wall from sigma3, of the membrane from "
		"sigma3 in consolidation and from what consolidation ended with in shear; positive when too high",
	),
)

#: Columns of a test with cement, behind the others.
CEMENT = (
	Column("cement_bonds", "", "with cement: bonds between grains that hold"),
	Column("cement_broken_tension", "", "with cement: bonds that broke in tension so far"),
	Column("cement_broken_shear", "", "with cement: bonds that broke in shear so far"),
)

_TEXT = ("stage",)


def columns(cement):
	"""The columns of a test with or without cement."""
	return COLUMNS + CEMENT if cement else COLUMNS


def _columnsOf(path):
	"""The columns that a records.csv has, those without cement where it cannot be read: whoever reads it says so."""
	try:
		with open(path, encoding="utf-8", errors="replace") as file:
			return columns(CEMENT[0].header in file.readline().rstrip("\n").split(","))
	except OSError:
		return COLUMNS


class Kept(tables.Kept):
	"""The first bytes of a records.csv, see :class:`hexmembrane.output.tables.Kept`."""

	def __init__(self, path, size):
		super().__init__(path, _columnsOf(path), size, "records")

	def count(self, stage):
		"""Rows of a stage."""
		return sum(line.startswith(stage + ",") for line in self.lines())


class Records(tables.Table):
	"""records.csv being written, see :class:`hexmembrane.output.tables.Table`.

	:param cement: whether it has the columns of cement; of an existing file its header says so. Attribute: ``cement``.
	"""

	def __init__(self, path, keep=None, cement=False):
		found = columns(cement) if keep is None else _columnsOf(path)
		self.cement = len(found) > len(COLUMNS)
		super().__init__(path, found, keep, "records")


def read(path, damage=None):
	"""The records as a dict of column name -> numpy array (``stage``: list of text). A last row cut by a kill is left out.

	:param damage: as in :func:`hexmembrane.output.tables.read`.
	:raises ValueError: no records file, or a row with a wrong number of cells.
	"""
	return tables.read(path, _TEXT, "records", damage)


def sheared(table):
	"""Numbers of the rows that belong to no consolidation."""
	return [i for i, stage in enumerate(table["stage"]) if not stage.startswith(ISOTROPIC)]


def markdown():
	"""The table of columns for the documentation."""
	return tables.markdown(COLUMNS + CEMENT)
