# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs inside PFC3D 5.00.20 and later: writes balls.csv, contacts.csv, bonds.csv, walls.csv and measures.csv of the model, for hexmembrane's scripts/pfc-check.

In PFC:  import sys; sys.path.append("where this file is"); import export_pfc; export_pfc.export("folder")

The folder must be there. The model must be in SI units. PFC 5 has Python 2.7, later ones Python 3: this file runs in both and needs nothing but itasca.
Clumps, contacts of other kinds than ball-ball and ball-facet, and walls' contacts with a parallel bond are left out and told.
"""

from __future__ import print_function

import os

import itasca

VERSION = 1
BALLS = "id,x,y,z,r,vx,vy,vz,wx,wy,wz,density,group"
CONTACTS = (
	"id,kind,end1,end2,model,gap,px,py,pz,nx,ny,nz,fx,fy,fz,mx,my,mz,kn,ks,fric,rr_fric,rr_kr,emod,cb_state,cb_tenf,cb_shearf,dp_nratio,dp_sratio,rgap,lin_mode"
)
BONDS = "id,end1,end2,pb_rmul,pb_kn,pb_ks,pb_ten,pb_coh,pb_fa,pb_mcf,pb_fx,pb_fy,pb_fz,pb_mx,pb_my,pb_mz,pb_sigma,pb_tau"
WALLS = "id,name,x,y,z,vx,vy,vz,fx,fy,fz"
MEASURES = "id,x,y,z,r,porosity,coordination,sxx,syy,szz,sxy,sxz,syz"
#: Properties of contacts that are columns of their own; a contact model that has no such property leaves the field empty.
PROPERTIES = CONTACTS.split(",")[18:]
#: pb_state of a parallel bond that holds.
BONDED = 3
KINDS = {"BallBallContact": "ball-ball", "BallFacetContact": "ball-facet"}


def export(folder="."):
	"""Write the five tables into a folder; the numbers of lines by table."""
	contacts, bonds, left = contactRows()
	head = "cycle=%d timestep=%r time=%r code=PFC" % (asked("cycle", "global.cycle"), float(asked("timestep", "global.timestep")), float(asked("mech_age", "mech.age")))
	written = {}
	for name, columns, rows in (
		("balls", BALLS, [ballRow(ball) for ball in itasca.ball.list()]),
		("contacts", CONTACTS, contacts),
		("bonds", BONDS, bonds),
		("walls", WALLS, [wallRow(wall) for wall in itasca.wall.list()]),
		("measures", MEASURES, [measureRow(sphere) for sphere in itasca.measure.list()]),
	):
		with open(os.path.join(folder, name + ".csv"), "w") as file:
			file.write("# hexmembrane-tables=%d table=%s %s\n%s\n" % (VERSION, name, head, columns))
			for row in rows:
				file.write(",".join(text(value) for value in row) + "\n")
		written[name] = len(rows)
	print("hexmembrane: written " + ", ".join("%d %s" % (written[name], name) for name in sorted(written)) + (", left out %s" % left if left else ""))
	return written


def asked(name, fish):
	"""A number of the model, by the module's function or by FISH where this version's module has none."""
	if hasattr(itasca, name):
		return getattr(itasca, name)()
	itasca.command("[hexmembrane_number = %s]" % fish)
	return itasca.fish.get("hexmembrane_number")


def text(value):
	"""A field; numbers with all their digits."""
	if value is None:
		return ""
	if isinstance(value, bool):
		return str(int(value))
	if isinstance(value, float):
		return repr(value)
	return str(value).replace(",", ";").replace("\n", " ")


def vector(value):
	"""Three floats of a vector, whatever this version's module makes of one."""
	if hasattr(value, "x") and callable(value.x):
		return [float(value.x()), float(value.y()), float(value.z())]
	return [float(value[k]) for k in range(3)]


def ballRow(ball):
	return [ball.id()] + vector(ball.pos()) + [float(ball.radius())] + vector(ball.vel()) + vector(ball.spin()) + [float(ball.density()), ball.group()]


def contactRows():
	"""(rows of contacts, rows of parallel bonds, how many contacts of other kinds by the name of their class)."""
	rows, bonds, left = [], [], {}
	for contact in itasca.contact.list():
		name = type(contact).__name__
		if name == "BallFacetContact" and bonded(contact):
			name += " with a parallel bond"
		if name in KINDS:
			row, bond = contactRow(contact, KINDS[name])
			rows.append(row)
			bonds += bond
		else:
			left[name] = left.get(name, 0) + 1
	return rows, bonds, left


def bonded(contact):
	return contact.props().get("pb_state") == BONDED


def contactRow(contact, kind):
	"""(the contact's row, [the row of its parallel bond])."""
	one, two, sign = contact.end1(), contact.end2(), 1.0
	if kind == "ball-facet" and not hasattr(one, "radius"):
		one, two, sign = two, one, -1.0
	properties = contact.props()
	other = two.id() if kind == "ball-ball" else two.wall().id()
	normal, force = ([sign * number for number in vector(value)] for value in (contact.normal(), contact.force_global()))
	bond = []
	if bonded(contact):
		loads = [[sign * number for number in vector(contact.to_global(properties[name]))] for name in ("pb_force", "pb_moment")]
		force = [all - part for all, part in zip(force, loads[0])]  # PFC's force of the contact is the sum
		names = BONDS.split(",")
		bond = [[contact.id(), one.id(), other] + [number(properties.get(name)) for name in names[3:10]] + loads[0] + loads[1] + [number(properties.get(name)) for name in names[16:]]]
	moment = [None, None, None]
	if properties.get("rr_moment") is not None:
		moment = [sign * number for number in vector(contact.to_global(properties["rr_moment"]))]
	row = [contact.id(), kind, one.id(), other, contact.model(), float(contact.gap())] + vector(contact.pos()) + normal + force + moment
	return row + [number(properties.get(name)) for name in PROPERTIES], bond


def number(value):
	return value if value is None or isinstance(value, (bool, int)) else float(value)


def wallRow(wall):
	return [wall.id(), wall.name()] + vector(wall.pos()) + vector(wall.vel()) + vector(wall.force_contact())


def measureRow(sphere):
	row = [sphere.id()] + vector(sphere.pos()) + [float(sphere.radius()), float(sphere.porosity()), float(sphere.coordination())]
	parts = [getattr(sphere, "stress_" + name, None) for name in ("xx", "yy", "zz", "xy", "xz", "yz")]
	return row + [None if part is None else float(part()) for part in parts]
