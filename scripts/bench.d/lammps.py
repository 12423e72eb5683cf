# SPDX-License-Identifier: GPL-2.0-or-later
"""Cost of a step of soil alone with the linear frictional law: the compact tier and stock YADE against LAMMPS granular (gran/hooke/history).

The study's 7,045 grains in a rigid cylinder with two flat ends. All three start from the same places, radii and velocities and have the same stiffness of every
contact, friction, time step, skin of the neighbour lists and no damping. The packing's grains are swollen a little, so that they press on each other, and
start at slow random velocities, so that contacts slide. One thread (one MPI process). In turns; medians over the turns. LAMMPS: its own 'Loop time'; YADE: wall
clock of O.run. Stock is YADE's collider, loop, integrator and Law2_ScGeom_FrictPhys_CundallStrack; platens and cylinder, which YADE lacks, are ours.
That all have run the same thing is checked after the timed steps, from places and velocities: contacts to 0.5 %, kinetic energy to 2 % (measured: 0.1 and
0.3 %; YADE's velocities are half a step older, and a dense packing forgets its start). Otherwise it ends with an error.
Arguments: folder of the results, LAMMPS' program.
"""

import math
import os
import re
import statistics
import subprocess
import sys
import time

import hexmembrane  # noqa: F401
import numpy
import yade
from scipy.spatial import cKDTree
from yade import O, utils

sys.path.insert(0, os.path.dirname(os.path.abspath(sys.argv[0])))  # YADE runs scripts without their __file__
from study import HEIGHT, RADIUS, packing  # noqa: E402
from table import write  # noqa: E402

from hexmembrane.scene.platens import platen  # noqa: E402

WARM, STEPS, TURNS = 200, 2000, 5
SWELL = 1.002  # of the packing's radii
KN, KT, FRICTION, DENSITY = 1.2e5, 4e4, 0.4, 2650  # of a contact: N/m, N/m, -; kg/m3. The study's sand with emod 6e7 Pa has kn near this
SPEED = 0.01  # m/s, largest component at the start
COMPACT, STOCK, LAMMPS = "compact tier", "stock YADE", "LAMMPS"


class Scene:
	"""What all codes are given."""

	def __init__(self, packed):
		self.centres, self.radii = packed.centres, packed.radii * SWELL
		self.masses = DENSITY * 4 / 3 * math.pi * self.radii**3
		self.velocities = SPEED * numpy.random.default_rng(1).uniform(-1, 1, self.centres.shape)
		self.skin = 0.3 * float(self.radii.min())
		self.dt = 0.1 * math.sqrt(float(self.masses.min()) / KN)


def runYade(tier, scene):
	"""ms a step, how often lists were made in the timed steps, and the state at the end: places, velocities, spins."""
	O.reset()
	O.materials.append(yade.LinearMat(kn=2 * KN, ks=2 * KT, friction=FRICTION, density=DENSITY))  # two springs in series
	for centre, radius, velocity in zip(scene.centres.tolist(), scene.radii.tolist(), scene.velocities.tolist()):
		body = utils.sphere(centre, radius)
		body.state.vel = velocity
		O.bodies.append(body)
	for z, facing in ((0, 1), (HEIGHT, -1)):
		O.bodies.append(platen((0, 0, z), 1.2 * RADIUS, 0.01, facing=facing))
	wall = yade.Body()
	wall.shape = yade.CylinderWall(radius=RADIUS, height=2 * HEIGHT)
	wall.state.pos = (0, 0, HEIGHT / 2)
	wall.material = O.materials[0]
	wall.dynamic = False
	O.bodies.append(wall)
	if tier == COMPACT:
		lists = yade.CompactLoop(damping=0, substeps=100, skin=scene.skin)
		O.engines = [yade.ForceResetter(), lists]
	else:
		# a body's box grows by verletDist on every side
		lists = yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), yade.Bo1_Platen_Aabb(), yade.Bo1_CylinderWall_Aabb()], verletDist=scene.skin / 2)
		loop = yade.InteractionLoop(
			[yade.Ig2_Sphere_Sphere_ScGeom(), yade.Ig2_Platen_Sphere_ScGeom(), yade.Ig2_CylinderWall_Sphere_ScGeom()],
			[yade.Ip2_LinearMat_LinearMat_LinearPhys()],
			[yade.Law2_ScGeom_FrictPhys_CundallStrack()],
		)
		O.engines = [yade.ForceResetter(), lists, loop, yade.NewtonIntegrator(damping=0)]
	O.dt = scene.dt
	made = (lambda: lists.listsMade) if tier == COMPACT else (lambda: lists.numAction)
	O.run(WARM, True)
	before, begun = made(), time.perf_counter()
	O.run(STEPS, True)
	spent = time.perf_counter() - begun
	assert O.iter == WARM + STEPS, "stopped at step %d" % O.iter
	grains = [O.bodies[i].state for i in range(len(scene.radii))]
	state = numpy.array([tuple(s.pos) + tuple(s.vel) + tuple(s.angVel) for s in grains])
	return spent / STEPS * 1e3, made() - before, state


def writeInput(folder, scene):
	"""LAMMPS' script and data file; SI units."""
	# The walls of style hooke/history multiply the shear stiffness by the contact's radius and divide by the damping (version 20250204): the same law
	# by its modern name is right, checked against the closed form of a sphere that sticks to a plane and swings.
	wall = "granular hooke %r 0 damping velocity tangential linear_history %r 0 %r" % (KN, KT, FRICTION)
	with open(os.path.join(folder, "grains.data"), "w") as file:
		file.write("grains\n\n%d atoms\n1 atom types\n" % len(scene.radii))
		file.write("%r %r xlo xhi\n%r %r ylo yhi\n%r %r zlo zhi\n" % ((-1.1 * RADIUS, 1.1 * RADIUS) * 2 + (-0.1 * HEIGHT, 1.1 * HEIGHT)))
		file.write("\nAtoms # sphere\n\n")
		for i, (centre, radius) in enumerate(zip(scene.centres.tolist(), scene.radii.tolist())):
			file.write("%d 1 %r %r %r %r %r\n" % (i + 1, 2 * radius, DENSITY, *centre))
		file.write("\nVelocities\n\n")
		for i, velocity in enumerate(scene.velocities.tolist()):
			file.write("%d %r %r %r 0 0 0\n" % (i + 1, *velocity))
	lines = [
		"units si",
		"atom_style sphere",
		"boundary f f f",
		"newton off",
		"comm_modify vel yes",
		"read_data grains.data",
		"neighbor %r bin" % scene.skin,
		"neigh_modify delay 0 every 1 check yes",
		"pair_style gran/hooke/history %r %r 0 0 %r 0" % (KN, KT, FRICTION),
		"pair_coeff * *",
		"fix move all nve/sphere",
		"fix side all wall/gran %s zcylinder %r" % (wall, RADIUS),
		"fix ends all wall/gran %s zplane 0 %r" % (wall, HEIGHT),
		"timestep %r" % scene.dt,
		"thermo %d" % (WARM + STEPS),
		"run %d" % WARM,
		"run %d" % STEPS,
		"write_dump all custom end.dump id x y z vx vy vz omegax omegay omegaz modify sort id format float %.17g",
	]
	with open(os.path.join(folder, "grains.in"), "w") as file:
		file.write("\n".join(lines) + "\n")


def runLammps(program, folder, scene):
	"""As runYade(), and LAMMPS' own account of the last run, a dict of shares in percent."""
	done = subprocess.run([program, "-in", "grains.in", "-log", "grains.log"], cwd=folder, capture_output=True, text=True)
	if done.returncode:
		raise RuntimeError("LAMMPS failed: %s" % (done.stdout + done.stderr)[-2000:])
	log = done.stdout
	spent = float(re.findall(r"Loop time of (\S+) on 1 procs for %d steps" % STEPS, log)[-1])
	made = int(re.findall(r"Neighbor list builds = (\d+)", log)[-1])
	shares = {name: float(share) for name, share in re.findall(r"^(\w+) +\|.*\| +([\d.]+)$", log, re.M)}
	state = numpy.loadtxt(os.path.join(folder, "end.dump"), skiprows=9)
	assert len(state) == len(scene.radii), "LAMMPS has lost grains: %d of %d are left" % (len(state), len(scene.radii))
	return spent / STEPS * 1e3, made, state[:, 1:], shares


def contacts(state, scene):
	"""Touching pairs, those with cylinder and ends included."""
	centres, radii = state[:, :3], scene.radii
	pairs = cKDTree(centres).query_pairs(2 * radii.max(), output_type="ndarray")
	distance = numpy.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1)
	touching = (distance < radii[pairs].sum(axis=1)).sum()
	for gap in (RADIUS - numpy.hypot(centres[:, 0], centres[:, 1]), centres[:, 2], HEIGHT - centres[:, 2]):
		touching += (gap < radii).sum()
	return int(touching)


def kinetic(state, scene):
	"""Kinetic energy, of translation and rotation (J)."""
	square = (state[:, 3:6] ** 2).sum(axis=1) + 0.4 * scene.radii**2 * (state[:, 6:9] ** 2).sum(axis=1)
	return float(0.5 * (scene.masses * square).sum())


def main(folder, program):
	scene = Scene(packing(folder))
	work = os.path.join(folder, "lammps")
	os.makedirs(work, exist_ok=True)
	writeInput(work, scene)
	times, last = {name: [] for name in (COMPACT, LAMMPS, STOCK)}, {}
	for turn in range(TURNS):
		for name in times:
			result = runLammps(program, work, scene) if name == LAMMPS else runYade(name, scene)
			times[name].append(result[0])
			last[name] = result
		print("turn %d: %s" % (turn + 1, ", ".join("%s %.3f ms" % (name, values[-1]) for name, values in times.items())), flush=True)
	touching = {name: contacts(result[2], scene) for name, result in last.items()}
	energy = {name: kinetic(result[2], scene) for name, result in last.items()}
	rows = []
	for name, values in times.items():
		value = statistics.median(values)
		ratio = statistics.median(mine / theirs for mine, theirs in zip(values, times[LAMMPS]))
		rows.append((name, len(scene.radii), touching[name], value * 1e3, value * 1e6 / touching[name], ratio, last[name][1], energy[name]))
		print("%-12s %8.1f us a step, %6.1f ns a contact, %5.2f times LAMMPS; %d contacts, lists made %d times in %d steps, kinetic energy %.5g J"
			% (name, rows[-1][3], rows[-1][4], ratio, touching[name], last[name][1], STEPS, energy[name]))  # fmt: skip
	print("LAMMPS' own account: " + ", ".join("%s %.1f %%" % item for item in last[LAMMPS][3].items()))
	header = ["code", "spheres", "contacts", "cost (us a step)", "cost (ns a contact and step)", "times LAMMPS", "lists made", "kinetic energy at the end (J)"]
	write(os.path.join(folder, "lammps.csv"), header, rows)
	for name in (COMPACT, STOCK):
		if abs(touching[name] / touching[LAMMPS] - 1) > 0.005 or abs(energy[name] / energy[LAMMPS] - 1) > 0.02:
			raise RuntimeError("%s has not run what LAMMPS has run: contacts or kinetic energy differ (see above); the times do not compare" % name)


main(*sys.argv[1:])
