# SPDX-License-Identifier: GPL-2.0-or-later
"""End platens as bodies.

A platen is one body with the shape `Platen`, a solid cylinder. This module places it by the face that touches the specimen,
which is what one knows, and not by its centre. Motion is given by the engine `PlatenDrive`; contacts need
`Bo1_Platen_Aabb` and `Ig2_Platen_Sphere_ScGeom` (or ``...6D``).
"""

import math

import yade


def platen(faceCentre, radius, height, facing, material=None, color=(0.55, 0.57, 0.6), mask=1):
	"""A platen with a horizontal face at `faceCentre`, ready for ``O.bodies.append``.

	:param faceCentre: centre of the face that touches the specimen, three coordinates (m)
	:param radius: radius of the cylinder (m), > 0
	:param height: thickness of the cylinder (m), > 0; it extends away from the specimen
	:param facing: +1 when the face looks up (+z: the platen below a specimen), -1 when it looks down
	:param material: a Material, its label or its index in ``O.materials``; None: the last of ``O.materials``
	:param color: red, green, blue, each 0 to 1
	:param mask: the body's group mask, an int >= 1
	:return: a Body, upright, with all degrees of freedom blocked, mass 0 (its motion is given, so it has no kinetic energy to account for)
	:raises ValueError: for sizes that are not positive and finite, another `facing`, or when there is no such material
	"""
	centre = [float(coordinate) for coordinate in faceCentre]
	if len(centre) != 3 or not all(map(math.isfinite, centre)):
		raise ValueError(f"platen.faceCentre = {faceCentre!r}: must be three finite coordinates; fix: give (x, y, z) in m")
	for name, value in (("radius", radius), ("height", height)):
		if not (math.isfinite(value) and value > 0):
			raise ValueError(f"platen.{name} = {value!r}: must be positive and finite; fix: give a number > 0 in m")
	if facing not in (1, -1):
		raise ValueError(f"platen.facing = {facing!r}: unknown; fix: give +1 (face looks up) or -1 (face looks down)")

	body = yade.Body()
	body.shape = yade.Platen(radius=radius, height=height, color=color)
	body.material = _material(material)
	body.mask = mask
	body.state.pos = body.state.refPos = (centre[0], centre[1], centre[2] - 0.5 * facing * height)
	body.dynamic = False
	return body


def _material(wanted):
	materials = yade.O.materials
	if isinstance(wanted, yade.Material):
		return wanted
	if len(materials) == 0:
		raise ValueError(f"platen.material = {wanted!r}: O.materials is empty; fix: append a material first, or give one")
	if wanted is None:
		return materials[len(materials) - 1]
	try:
		return materials[wanted]
	except (IndexError, KeyError, RuntimeError, ValueError) as error:
		raise ValueError(f"platen.material = {wanted!r}: {error}; fix: give a Material, its label or its index") from error
