# Two balls of 1 and 2 mm, moved as told: load, slip, roll, and a contact bond that is pulled. scripts/yade -x examples/pfc/two_balls.py
# Motion comes before the forces, as in PFC's cycle, so that cycle N here is cycle N there. The data files of PFC and the numbers: examples/pfc/guide.md
import hexmembrane  # noqa: F401
from yade import *
from yade.wrapper import Ig2_Sphere_Sphere_LinearScGeom, Ip2_LinearMat_LinearMat_LinearPhys, Law2_ScGeom_LinearPhys_Linear, LinearMat

R1, R2, OVERLAP = 1e-3, 2e-3, 1e-5  # m
#: case -> (overlap at the beginning [m], velocity of ball 2 [m/s], spins of both about y [rad/s], bond, cycles that are printed)
CASES = {
	"load": (0, (0, 0, -0.1), (0, 0), False, (1, 50, 100)),
	"slip": (OVERLAP, (0.1, 0, 0), (0, 0), False, (1, 50, 100, 150)),
	"roll": (OVERLAP, (0, 0, 0), (40 / 3, -20 / 3), False, (1, 100, 200)),
	"bond": (0, (0, 0, 0.1), (0, 0), True, (1, 30, 40, 41)),
}

print("case cycle Fn [N] Fs [N] M [N m]")
for name, (overlap, velocity, spins, bond, cycles) in CASES.items():
	O.reset()
	O.materials.append(LinearMat(kn=1e6, ks=5e5, friction=0.5, rollingFriction=0 if bond else 0.1, density=2650, cbTensile=2.01 if bond else 0, cbShear=2.01 if bond else 0))
	O.bodies.append([utils.sphere((0, 0, 0), R1, fixed=True), utils.sphere((0, 0, R1 + R2 - overlap), R2, fixed=True)])
	O.bodies[1].state.vel = velocity
	for body, spin in zip(O.bodies, spins):
		body.state.angVel = (0, spin, 0)
	O.engines = [
		NewtonIntegrator(warnNoForceReset=False),
		ForceResetter(),
		InteractionLoop(
			[Ig2_Sphere_Sphere_LinearScGeom(avoidGranularRatcheting=False)],
			[Ip2_LinearMat_LinearMat_LinearPhys(bondNewContacts=bond)],
			[Law2_ScGeom_LinearPhys_Linear()],
		),
	]
	O.dt = 1e-6
	contact = utils.createInteraction(0, 1)
	for cycle in range(1, max(cycles) + 1):
		O.step()
		if cycle in cycles:
			real = contact.isReal
			normal = contact.phys.normalForce.dot(contact.geom.normal) if real else 0.0
			shear, moment = (contact.phys.shearForce.norm(), contact.phys.moment.norm()) if real else (0.0, 0.0)
			print(f"{name} {cycle} {normal:.6f} {shear:.6f} {moment:.6e}")
