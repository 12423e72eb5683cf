# SPDX-License-Identifier: GPL-2.0-or-later
"""PFC's names of properties and what they are here: who writes one gets an error with the key. Uses nothing of YADE."""

_BONDS = "grains of a configuration have no contact bonds; a script has LinearMat.cbTensile and cbShear, membrane.tensileStrength and shearStrength are the sheet's"
_CEMENT = {"pb_ten": "tensileStrength", "pb_coh": "cohesion", "pb_fa": "frictionAngle", "pb_rmul": "radiusMultiplier", "pb_mcf": "momentFactor"}
_CEMENT.update({f"pb_{name}": name for name in ("kn", "ks", "emod", "kratio")})
_DASHPOT = "contacts have no dashpots here; numerics.damping is PFC's local damping"

#: PFC's name -> the key here by section, '' for every other section.
NAMES = {
	"fric": {"specimen": "specimen.friction", "platens": "platens.friction", "wall": "wall.friction", "membrane": "contacts.grainMembrane.friction; without it the membrane has no friction with the soil", "": "friction"},
	"rr_fric": {"contacts": "rollingFriction", "specimen": "specimen.rollingFriction", "": "specimen.rollingFriction; platens, wall and membrane have none, contacts.grainPlaten.rollingFriction gives their contacts one"},
	"damp": {"": "numerics.damping"},
	"density": {"": "density, in specimen or membrane"},
	"radius": {"membrane": "membrane.particleRadius", "": "specimen.radius for the specimen; sizes of grains are specimen.radiusRange, radiusMean, radiusBins or gradation"},
	"kn": {"membrane": "membrane.contactKn towards the soil; a bond of the sheet has kn = young thickness/(sqrt(3) (1 - poisson))", "": "specimen.kn, platens.kn or wall.kn; contacts.grainPlaten.kn and such for a pair of groups"},
	"ks": {
		"membrane": "membrane.contactKs towards the soil; a bond of the sheet has ks = kn (1 - 3 poisson)/(1 + poisson)",
		"": "specimen.ks, platens.ks or wall.ks; contacts.grainPlaten.ks and such for a pair of groups",
	},
	"emod": {"membrane": "membrane.contactKn and contactKs; without them the membrane has the grains' stiffness", "": "specimen.emod, platens.emod or wall.emod"},
	"kratio": {"membrane": "membrane.contactKn and contactKs; without them the membrane has the grains' stiffness", "": "specimen.kratio, platens.kratio or wall.kratio"},
	"cb_tenf": {"membrane": "membrane.tensileStrength", "": _BONDS},
	"cb_shearf": {"membrane": "membrane.shearStrength", "": _BONDS},
	**{name: {"cement": here, "membrane": "nothing: bonds of the sheet have no moments, membrane.bendingStiffness is its bending", "": f"cement.{here}"} for name, here in _CEMENT.items()},
	**{name: {"": _DASHPOT} for name in ("dp_nratio", "dp_sratio", "dp_mode")},
	"rgap": {"": "nothing: contacts begin where bodies touch"},
	"porosity": {"": "specimen.porosity"},
	"xvel": {"": "nothing: platens move along z"},
	"zvel": {"": "shear.velocity, at which the platens approach each other"},
	"gravity": {"": "nothing: tests have no gravity"},
}  # fmt: skip


def named(name, section):
	"""What PFC's property ``name``, written in a section, is called here; '' when PFC has none of that name."""
	places, section = NAMES.get(str(name).replace("-", "_"), {}), section.partition(".")[0]
	return places.get(section, places.get("", ""))
