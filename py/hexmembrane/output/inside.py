# SPDX-License-Identifier: GPL-2.0-or-later
"""The columns of regions.csv, bands.csv and profile.csv, stated once. Long form: one row an observation. Needs no YADE."""

from hexmembrane.output.tables import Column

_WHEN = (
	Column("step", "", "YADE's step, O.iter"),
	Column("axial_strain", "-", "of the specimen, as in records.csv; compression positive"),
)


def _tensor(name, unit, doc):
	return tuple(Column(f"{name}_{ij}", unit, doc, True) for ij in ("xx", "yy", "zz", "xy", "xz", "yz"))


REGIONS = (
	*_WHEN,
	Column("region", "", "number of the region, from 0"),
	Column("x", "m", "centre"),
	Column("y", "m", "centre"),
	Column("z", "m", "centre; height above the bottom platen's face"),
	Column("radius", "m", "of the region"),
	Column("grains", "", "grains with centres inside"),
	Column("porosity", "-", "1 - (volume of grains inside - overlaps)/V, see MeasureRegions"),
	Column("coordination", "-", "mean number of active contacts, all partners, of the grains with centres inside; nan: none", True),
	Column("sliding", "-", "share of the contacts of two grains that slide; nan: no such contact", True),
	*_tensor("stress", "Pa", "stress tensor, compression positive; nan: no branch inside"),
	Column("q", "Pa", "sigma_zz - (sigma_xx + sigma_yy)/2", True),
	Column("p", "Pa", "mean stress", True),
	Column("axial_strain_region", "-", "of the grains that the region held, least squares, sum since shear began; compression positive; nan: less than four grains", True),
	Column("volumetric_strain", "-", "the same, dilation positive", True),
	Column("deviatoric_strain", "-", "the same, sum of sqrt(2/3 e:e)", True),
)

BANDS = (
	*_WHEN,
	Column("increment", "-", "axial strain over which the band was sought"),
	Column("verdict", "", "band, pair, barrel or none", text=True),
	Column("plane", "", "number of the plane, 0, or 1 for the second of a pair; without a band the best plane that there is"),
	Column("index", "-", "localisation index of all planes, see hexmembrane.measure.bands"),
	Column("index_low", "-", "lower end of its 95 % interval, nan: no band or no bootstrap; so all columns with _low and _high", True),
	Column("index_high", "-", "upper end", True),
	Column("explained", "-", "share of the displacement's unsymmetric, not affine part that the planes' jumps explain"),
	Column("barrel", "-", "coefficient of variation of the symmetric part of the deviatoric strain"),
	Column("certainty", "-", "share of the bootstrap's replicates in which the planes are bands", True),
	Column("dip", "deg", "angle of the plane with the horizontal"),
	Column("dip_low", "deg", "", True),
	Column("dip_high", "deg", "", True),
	Column("azimuth", "deg", "direction in which the plane dips, from x towards y"),
	Column("azimuth_low", "deg", "may be below 0", True),
	Column("azimuth_high", "deg", "may be above 360", True),
	Column("thickness", "m", "of the slab of uniform shear whose displacement fits best"),
	Column("thickness_low", "m", "", True),
	Column("thickness_high", "m", "", True),
	Column("thickness_d50", "-", "thickness over the grains' median diameter by volume"),
	Column("height", "m", "where the plane meets the axis, above the bottom platen's face"),
	Column("jump", "m", "size of the displacement's jump across the plane in the increment"),
	Column("friction_angle", "deg", "mobilised, asin((s1 - s3)/(s1 + s3)) of the soil's middle half"),
	Column("dilatancy_angle", "deg", "asin(-r/(2 - r)), r = d(volumetric)/d(axial strain) over the increment, compression positive"),
	Column("dip_coulomb", "deg", "45 + friction_angle/2"),
	Column("dip_roscoe", "deg", "45 + dilatancy_angle/2"),
	Column("dip_arthur", "deg", "mean of the two"),
	Column("porosity_inside", "-", "of the cells of the grains in the slabs", True),
	Column("porosity_outside", "-", "of the others", True),
	Column("start_porosity_inside", "-", "the same grains' at the start of shear", True),
	Column("start_porosity_outside", "-", "of the others", True),
)

PROFILE = (
	*_WHEN,
	Column("slice", "", "number of the slice, from 0 at the bottom platen"),
	Column("height", "m", "of its middle above the bottom platen's face"),
	Column("radius", "m", "mean radius of the lateral boundary: of the cylinder of the slice's volume"),
	Column("axial", "Pa", "the soil's axial stress, compression positive"),
	Column("radial", "Pa", "mean of its horizontal normal stresses"),
)
