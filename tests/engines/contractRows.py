# SPDX-License-Identifier: GPL-2.0-or-later
"""The rows of the compact tier's reading contract, by their names: one for each attribute that a script may change between two iterations."""

import yade
from contractScene import BEFORE, Put, Row, addGrain, body, clump, other, permanent, scaled, secondLaw, shifted, tilted
from tiers import loop
from yade import O, Vector3



def sparing(scene):
	"""Platens, and grains, of a mask of their own beside the common one: they do not meet the membrane."""
	grains = range(min(scene.ids["bottom"], scene.ids["top"]))
	before = {i: O.bodies[i].mask for i in (*grains, scene.ids["bottom"], scene.ids["top"])}
	for i in before:
		O.bodies[i].mask = 5 if i in grains else 4

	def undo():
		for i, mask in before.items():
			O.bodies[i].mask = mask

	return undo


BLOCKED = ("x", "xyz", "XYZ", "xyzXYZ", "yZ")
ROWS = {
	# a grain
	"a grain's radius": body("wall", "grain", "shape.radius", scaled(1.002), remake=True),
	"a grain's shape, a larger sphere": body("wall", "grain", "shape", lambda old: yade.Sphere(radius=1.002 * old.radius), remake=True),
	"a grain's shape, a box": body("wall", "grain", "shape", yade.Box(extents=(1e-3, 1e-3, 1e-3)), must="refused"),
	"a grain's position": body("wall", "grain", "state.pos", shifted(2e-6, -1e-6, 3e-6), must="acts"),
	"a grain's velocity": body("wall", "grain", "state.vel", (0.1, -0.2, 0.3), must="acts"),
	"a grain's spin": body("wall", "grain", "state.angVel", (50, -30, 20), must="acts"),
	"a grain's orientation": body("wall", "grain", "state.ori", tilted(0.7), must="acts"),
	"a grain's mass": body("wall", "grain", "state.mass", scaled(2)),
	"a grain's inertia": body("wall", "grain", "state.inertia", scaled(2)),
	"a grain's inertia, aspherical": body("wall", "grain", "state.inertia", lambda old: Vector3(old[0], 2 * old[1], 3 * old[2])),
	**{"a grain's blockedDOFs %s" % dofs: body("wall", "grain", "state.blockedDOFs", dofs) for dofs in BLOCKED},
	"a grain's blockedDOFs, none any more": body("wall", "grain", "state.blockedDOFs", "", first=Put("grain", "state.blockedDOFs", "xyzXYZ")),
	"a blocked grain's velocity": body("wall", "grain", "state.vel", (0.1, 0, 0.05), must="acts", first=Put("grain", "state.blockedDOFs", "xyzXYZ")),
	"a blocked grain's spin": body("wall", "grain", "state.angVel", (50, 0, 20), must="acts", first=Put("grain", "state.blockedDOFs", "xyzXYZ")),
	"a grain's dynamic": body("wall", "grain", "dynamic", False),
	"a grain's isDamped": body("wall", "grain", "state.isDamped", False),
	"a grain's densityScaling, of NewtonIntegrator.densityScaling alone": body("wall", "grain", "state.densityScaling", 0.25, effect=False),
	"a grain's aspherical": body("wall", "grain", "aspherical", True),
	"a grain's mat, another LinearMat": body("wall", "grain", "mat", other(), remake=True),
	"a grain's mat, one without friction": body("wall", "grain", "mat", other(friction=0, rollingFriction=0), remake=True),
	"a grain's mat that nobody else holds": body("wall", "grain", "mat", other(), remake=True, first=Put("grain", "mat", other(friction=0.2))),
	"a grain's mat, a FrictMat": body("wall", "grain", "mat", lambda old: yade.FrictMat(young=1e8, poisson=0.3), must="refused"),
	"a grain's mask": body("wall", "grain", "mask", 4, must="refused"),
	"a grain's groupMask": body("wall", "grain", "groupMask", 4, must="refused"),
	"a grain in a clump": Row("wall", clump, body="grain", must="refused", exact=False),
	"a grain is erased": Row("wall", lambda scene: O.bodies.erase(scene.ids["grain"]), must="acts"),
	"a grain is added": Row("wall", addGrain, must="acts"),
	# a particle of the membrane
	"a particle's radius": body("membrane", "particle", "shape.radius", scaled(1.002), remake=True),
	"a particle's shape, a larger sphere": body("membrane", "particle", "shape", lambda old: yade.Sphere(radius=1.002 * old.radius), remake=True),
	"a particle's position": body("membrane", "particle", "state.pos", shifted(2e-6, -1e-6, 3e-6), must="acts"),
	"a particle's velocity": body("membrane", "particle", "state.vel", (0.1, -0.2, 0.3), must="acts"),
	"a particle's spin": body("membrane", "particle", "state.angVel", (50, -30, 20), must="acts"),
	"a particle's mass": body("membrane", "particle", "state.mass", scaled(2)),
	"a particle's inertia": body("membrane", "particle", "state.inertia", scaled(2)),
	**{"a particle's blockedDOFs %s" % dofs: body("membrane", "particle", "state.blockedDOFs", dofs) for dofs in BLOCKED},
	**{"a central particle's blockedDOFs %s" % dofs: body("central", "particle", "state.blockedDOFs", dofs) for dofs in ("xXYZ", "xyzXYZ", "")},
	"a blocked particle's velocity": body("central", "particle", "state.vel", (0.1, 0, 0.05), first=Put("particle", "state.blockedDOFs", "xyzXYZ")),
	"a particle's dynamic": body("membrane", "particle", "dynamic", False),
	"a particle's isDamped": body("membrane", "particle", "state.isDamped", False),
	"a particle's mat, another LinearMat": body("membrane", "particle", "mat", other(), remake=True),
	"a particle's mask": body("membrane", "particle", "mask", 4, must="refused"),
	"a particle is erased": Row("membrane", lambda scene: O.bodies.erase(scene.ids["particle"]), body="particle", must="refused", exact=None),
	# platens
	"a platen's position": body("membrane", "bottom", "state.pos", shifted(0, 0, 3e-6), must="acts"),
	"a platen's velocity": body("membrane", "bottom", "state.vel", (0.02, 0, 0.05), must="acts"),
	"a platen's spin about its axis": body("membrane", "bottom", "state.angVel", (0, 0, 20), must="acts"),
	"a platen's spin about another axis": body("membrane", "bottom", "state.angVel", (5, 0, 0)),
	"a platen's orientation": body("membrane", "bottom", "state.ori", tilted(1e-3)),
	"a platen's radius": body("membrane", "bottom", "shape.radius", scaled(1.0005)),
	"a platen's height": body("membrane", "bottom", "shape.height", scaled(1.0005)),
	"a platen's shape, another Platen": body("membrane", "bottom", "shape", lambda old: yade.Platen(radius=old.radius, height=1.0005 * old.height)),
	"a platen's mat": body("membrane", "bottom", "mat", other(), remake=True),
	"a platen's mask": body("membrane", "bottom", "mask", 4, must="refused"),
	"a platen's blockedDOFs": body("membrane", "bottom", "state.blockedDOFs", "xyXYZ", must="refused"),
	"a driven platen's position": body("membrane", "top", "state.pos", shifted(0, 0, -3e-6), must="acts"),
	# the wall
	"the wall's radius": body("wall", "wall", "shape.radius", scaled(1 - 1e-4), must="acts"),
	"the wall's height": body("wall", "wall", "shape.height", scaled(0.25)),
	"the wall's shape, another CylinderWall": body(
		"wall", "wall", "shape", lambda old: yade.CylinderWall(radius=(1 - 1e-4) * old.radius, height=old.height)
	),
	"the wall's position": body("wall", "wall", "state.pos", shifted(2e-6, -1e-6, 0), must="acts"),
	"the wall's velocity": body("wall", "wall", "state.vel", (0.02, 0, 0.05), must="acts"),
	"the wall's spin about its axis": body("wall", "wall", "state.angVel", (0, 0, 20)),
	"the wall's spin about another axis": body("wall", "wall", "state.angVel", (5, 0, 0)),
	"the wall's mat": body("wall", "wall", "mat", other(), remake=True),
	"the platens' mask, without the membrane's bits": Row("central", sparing, must="acts", effect=None, at=(0,)),
	"the wall's mask": body("wall", "wall", "mask", 4, must="refused"),
	"the wall's blockedDOFs": body("wall", "wall", "state.blockedDOFs", "zXYZ", must="refused"),
	# O-rings: their motion is the engine's
	"an O-ring particle's position": body("membrane", "ring", "state.pos", shifted(2e-6, -1e-6, 3e-6), must="acts"),
	"an O-ring particle's blockedDOFs": body("membrane", "ring", "state.blockedDOFs", "", effect=None),
	# the engines inside, the same objects in either tier
	**{
		"%s.%s" % (name, path): Row(scene, Put("engine " + name, path, value), must="acts", effect=effect)
		for name, scene, path, value, effect in (
			("pressure", "membrane", "pressure", scaled(2), True),
			("pressure", "membrane", "surface", "centre", True),
			("pressure", "smooth", "timeConstant", 4e-4, True),
			("pressure", "membrane", "dead", True, True),
			("servo", "membrane", "pressure", scaled(2), True),
			("servo", "membrane", "areaRule", "cube", True),
			("servo", "membrane", "dead", True, True),
			("bonds", "membrane", "young", scaled(2), True),
			("bonds", "membrane", "tensileStrength", 1e-3, True),
			("oRings", "membrane", "mode", "fixed", True),
			("oRings", "membrane", "dead", True, True),
			("top", "membrane", "stress", scaled(20), True),
			("top", "membrane", "dead", True, True),
			("wall", "wall", "stress", scaled(0.01), True),
			("wall", "wall", "dead", True, True),
		)
	},
	"top.mode": Row("membrane", lambda scene: scene.made["top"].updateAttrs(dict(mode="velocity", velocity=0.05)), must="acts"),
	"the integrator's damping": Row("membrane", lambda scene: setattr(loop() or O.engines[-1], "damping", 0.5), must="acts"),
	# materials, changed in place
	**{
		"a material's %s" % name: Row(scene, Put("material " + material, attribute, value), must="acts", remake=True, at=(BEFORE,))
		for name, scene, material, attribute, value in (
			("emod", "wall", "grain", "emod", scaled(1.5)),
			("kratio", "wall", "grain", "kratio", 5.0),
			("kn", "springs", "grain", "kn", scaled(1.5)),
			("ks", "springs", "grain", "ks", scaled(0.5)),
			("ks, 0", "springs", "grain", "ks", 0.0),
			("friction", "wall", "grain", "friction", 0.1),
			("friction, 0", "wall", "grain", "friction", 0.0),
			("friction, from 0", "frictionless", "grain", "friction", 0.4),
			("rollingFriction", "wall", "grain", "rollingFriction", 0.1),
			("rollingFriction, 0", "wall", "grain", "rollingFriction", 0.0),
			("friction, of the platens", "wall", "platen", "friction", 0.05),
			("friction, 0, of the membrane", "membrane", "membrane", "friction", 0.0),
			("friction, from 0, of the membrane", "smooth", "membrane", "friction", 0.3),
		)
	},
	"a pair's own stiffness and friction": Row(
		"wall", lambda scene: O.materials["grain"].setPair("platen", kn=2e5, ks=1e5, friction=0.6), must="acts", remake=True, at=(BEFORE,)
	),
	"a material's density, which is nobody's mass": Row("wall", Put("material grain", "density", 5000.0), must="acts", effect=False),
	# the scene
	"O.dt": Row("membrane", Put("O", "dt", 1e-6), must="acts"),
	"O.periodic": Row("wall", Put("O", "periodic", True), must="refused"),
	"gravity, by an engine before the loop": Row("membrane", lambda scene: scene.insert(yade.GravityEngine(gravity=(5, 0, -50))), must="acts"),
	"O.forces.setPermF of a grain": Row("wall", permanent("grain", "setPermF", (3, -2, 5)), must="acts"),
	"O.forces.setPermT of a grain": Row("wall", permanent("grain", "setPermT", (3e-3, -2e-3, 5e-3)), must="acts"),
	"O.forces.setPermF of a particle": Row("membrane", permanent("particle", "setPermF", (3, -2, 5)), must="acts"),
	"O.forces.setPermT of a particle": Row("membrane", permanent("particle", "setPermT", (3e-3, -2e-3, 5e-3)), must="acts"),
	"O.forces.setPermF of a platen that holds a stress": Row("membrane", permanent("top", "setPermF", (0, 0, -1240)), body="top"),
	**{
		# engines that do what the loop does already
		"%s beside the loop" % name: Row("membrane", lambda scene, make=make: scene.insert(make(scene), last=True), must="refused")
		for name, make in (
			("NewtonIntegrator", lambda scene: yade.NewtonIntegrator()),
			("a second CompactLoop", lambda scene: yade.CompactLoop()),
			("InteractionLoop", lambda scene: secondLaw()),
			("a collider", lambda scene: yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb()], verletDist=0)),
			("MembranePressure in both lists", lambda scene: scene.made["pressure"]),
		)
	},
}
