# SPDX-License-Identifier: GPL-2.0-or-later
"""Stress along the specimen's height: what the membrane hands over row by row, and what the soil carries slice by slice.

The mean stress of a slice is (1/V) sum F (x) l over the contacts of the grains, compression positive: F the contact force on the
second body, l the branch from the first body to the second. Between grains the branch joins the centres; to membrane and platens it
ends at the contact point. A branch that crosses a border between slices counts in each with the part that lies in it. The slices,
weighted with their volumes, then add up to the whole specimen's stress exactly.
"""

import dataclasses

import numpy
from yade import O


@dataclasses.dataclass
class Profile:
	"""Stresses along the height [Pa], compression and inward pressure positive; heights above the bottom platen's face [m].

	:param height: of the specimen, between the faces.
	:param rowHeight: of each membrane row, mean of its particles; O-ring rows included.
	:param rowPressure: transmitted radial pressure of each row, see ``HexMembrane.transmittedByRing``.
	:param edges: of the n slices, n + 1.
	:param volume: of each slice inside the membrane's inner surface [m3], n.
	:param radial: mean horizontal stress (s_xx + s_yy)/2 of each slice, the mean of radial and hoop stress, n.
	:param axial: s_zz of each slice, n.
	"""

	height: float
	rowHeight: numpy.ndarray
	rowPressure: numpy.ndarray
	edges: numpy.ndarray
	volume: numpy.ndarray
	radial: numpy.ndarray
	axial: numpy.ndarray

	@property
	def middle(self):
		"""Heights of the slices' middles [m]."""
		return 0.5 * (self.edges[1:] + self.edges[:-1])


def shares(edges, low, high):
	"""Share of each interval low..high in each slice, an (intervals, slices) array whose rows add up to 1.

	The lowest and the highest slice take what lies beyond the ends; an interval of no length lies in one slice whole.

	:param edges: rising borders of the slices, n + 1 >= 2.
	:param low: starts.
	:param high: ends, >= low.
	:raises ValueError: borders that do not rise.
	"""
	edges = numpy.asarray(edges, dtype=float)
	if len(edges) < 2 or not (numpy.diff(edges) > 0).all():
		raise ValueError(f"profile.edges = {edges.tolist()}: do not rise; fix: give the borders of the slices from below")
	inner = edges[1:-1]
	length = high - low
	# part of each interval below each inner border: 0 .. 1
	with numpy.errstate(invalid="ignore", divide="ignore"):
		below = (inner[None, :] - low[:, None]) / length[:, None]
	flat = length == 0
	below[flat] = low[flat, None] < inner[None, :]
	below = numpy.clip(below, 0.0, 1.0)
	ends = numpy.hstack([numpy.zeros((len(low), 1)), below, numpy.ones((len(low), 1))])
	return numpy.diff(ends, axis=1)


def sliceSums(edges, start, branch, force):
	"""Sum of F (x) l over the parts of the branches in each slice, an (n, 3, 3) array [N m]; over its volume it is the mean stress.

	:param edges: heights of the borders [m].
	:param start: (M, 3) where the branches begin [m].
	:param branch: (M, 3) [m].
	:param force: (M, 3) contact forces [N]; compression positive when they point along the branch.
	"""
	ends = start[:, 2], start[:, 2] + branch[:, 2]
	part = shares(edges, numpy.minimum(*ends), numpy.maximum(*ends))
	return numpy.einsum("ms,mi,mj->sij", part, force, branch)


def contacts(grains):
	"""Branches of all contacts of the grains in ``O``: (start [m], branch [m], force [N]) as (M, 3) arrays.

	:param grains: ids of the grains. Contacts without a grain are left out, as membrane against platen.
	"""
	grains = set(grains)
	start, end, force = [], [], []
	for contact in O.interactions:
		own = contact.id1 in grains, contact.id2 in grains
		if not any(own):
			continue
		start.append(O.bodies[contact.id1].state.pos if own[0] else contact.geom.contactPoint)
		end.append(O.bodies[contact.id2].state.pos if own[1] else contact.geom.contactPoint)
		force.append(contact.phys.normalForce + contact.phys.shearForce)  # on the second body
	start, end, force = (numpy.array([tuple(one) for one in v]).reshape(-1, 3) for v in (start, end, force))
	return start, end - start, force


def measure(scene, grains, count=16):
	"""The :class:`Profile` of the scene as it stands, from the contacts of the last step.

	:param scene: handles, :class:`hexmembrane.scene.handles.Scene`, of a test in a flexible membrane.
	:param grains: ids of the grains.
	:param count: slices, >= 1.
	:raises ValueError: no slice.
	"""
	if count < 1:
		raise ValueError(f"profile.count = {count}: no slice; fix: 1 or more")
	scene.exportContacts()
	membrane = scene.lateralBoundary.membrane
	bottom, top = scene.faces()
	edges = numpy.linspace(bottom, top, count + 1)
	volume = numpy.array([membrane.enclosedVolume(low, high) for low, high in zip(edges, edges[1:])])
	stress = sliceSums(edges, *contacts(grains)) / volume[:, None, None]
	rows = numpy.array(membrane.positions)[:, 2].reshape(membrane.rings, membrane.perRing).mean(axis=1)
	return Profile(
		height=top - bottom,
		rowHeight=rows - bottom,
		rowPressure=numpy.array(membrane.transmittedByRing()),
		edges=edges - bottom,
		volume=volume,
		radial=0.5 * (stress[:, 0, 0] + stress[:, 1, 1]),
		axial=stress[:, 2, 2],
	)
