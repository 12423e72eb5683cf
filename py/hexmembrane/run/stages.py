# SPDX-License-Identifier: GPL-2.0-or-later
"""The stages of a test on the scene in ``O``, in the order of its plan, with records, VTK frames and checkpoints in one folder.

Python is not in the loop of a step: YADE runs in chunks of steps between rows. After each checkpoint the test goes on from the
saved state itself in the reference tier, where YADE's collider makes its lists anew after a load. A resumed run and one that was never
stopped take the same steps for that reason, bit by bit on one thread.
"""

import pathlib
import time

from yade import BodyArrays, O

from hexmembrane.configuration.stages import CONSOLIDATION, MEMBRANE, plan
from hexmembrane.measure import rows
from hexmembrane.output.frames import Frames
from hexmembrane.output.records import Records
from hexmembrane.run.checkpoints import RECORDS, Store
from hexmembrane.run.consolidation import Consolidation
from hexmembrane.run.from_wall import FromWall
from hexmembrane.run.inside import Inside
from hexmembrane.run.manifest import Checkpoint, Entry
from hexmembrane.run.stage import StageError
from hexmembrane.run.states import Image
from hexmembrane.run.straining import Resting, Straining
from hexmembrane.scene.handles import Scene


class TriaxialTest:
	"""A test whose specimen and lateral boundary are in ``O`` (see :func:`hexmembrane.scene.builder.build`).

	Attributes: ``config``, ``out``, ``quiet`` (see below); ``scene`` and ``grains`` (handles), ``plan`` (its stages), ``stage`` (label), ``rowCount`` (rows of the
	stage so far), ``lastRow`` (a dict by column of the records), ``stageStart`` (step, time, strain), ``reference`` (what strains count from), ``records``, ``frames``,
	``inside`` (what the configuration's ``measure`` asks for).

	:param config: checked configuration.
	:param out: existing folder for all files.
	:param quiet: print nothing.
	:param store: the folder's :class:`hexmembrane.run.checkpoints.Store`; None: one of its own, for a folder that nobody else writes into.
	:param resumed: what ``store.last()`` gave, its state loaded; None: begin.
	"""

	def __init__(self, config, out, quiet=False, store=None, resumed=None):
		self.config, self.out, self.quiet = config, pathlib.Path(out), quiet
		self.store = Store(out) if store is None else store
		self.scene, self.plan = Scene(), plan(config)
		self.grains = rows.Grains.of(self.scene.grainIds())
		self._earlierRows, self._told = 0, set()
		self.stage, self.rowCount, self.lastRow, self._earlier = "generated", 0, None, 0.0
		if resumed is None:
			self.stageStart, self.reference = {"step": O.iter, "time": O.time, "strain": 0.0}, rows.Reference.of(self.scene)
			self.frames, self.records = Frames(self.out, config.output.contacts), Records(self.out / RECORDS, cement=config.cement.given or self.scene.cement is not None)
			self.inside = Inside(config, self.out)
		else:
			self._goOnFrom(resumed)
		self._clock = time.monotonic()

	def _goOnFrom(self, resumed):
		checkpoint = resumed.checkpoint
		self.stage, self.rowCount, self.lastRow, self._earlier = checkpoint.stage, resumed.rows, resumed.last, checkpoint.elapsed
		self.stageStart, self.reference = checkpoint.begun, rows.Reference(**checkpoint.reference)
		self._earlierRows = self._countEarlier(resumed.count)
		self.frames, self.records = Frames(self.out, self.config.output.contacts, checkpoint.frames), Records(self.out / RECORDS, checkpoint.records.size)
		self.inside = Inside(self.config, self.out, checkpoint.inside)
		self.scene.tellCheckpoint(self.out / checkpoint.state)

	# What all stages share

	def elapsed(self):
		"""Wall clock of the test so far [s]."""
		return self._earlier + time.monotonic() - self._clock

	def enter(self, stage):
		"""Begin a stage: strains, displacements and energies count from here."""
		if O.trackEnergy and not O.energy.items():
			self.advance(1)  # energies are known after a step
		self.reference = rows.Reference.of(self.scene)
		BodyArrays.setReference()
		self._earlierRows = 0
		self._enter(stage)

	def enterNext(self, stage):
		"""Begin a stage whose strains count from where those of the stage before do."""
		self._earlierRows += self.rowCount
		self._enter(stage)

	def _enter(self, stage):
		self.stage, self.rowCount = stage, 0
		self.stageStart = {"step": O.iter, "time": O.time, "strain": self.strain()}

	def _countEarlier(self, count):
		"""Rows of the stages before the present one that strains count from; ``count(label)``: rows of a stage."""
		chain = next((planned.chain for planned in self.plan if planned.label == self.stage), ())
		return sum(count(label) for label in chain[:-1])

	def advance(self, steps):
		"""Run YADE for a number of steps.

		:raises StageError: YADE stopped before.
		"""
		wanted, why = O.iter + steps, ""
		O.stopAtIter = wanted  # the compact tier takes several steps in one iteration
		try:
			# O.run() waits for a thread of YADE's and looks every 40 ms whether it has ended: more than many a row's steps take
			while O.iter < wanted:
				O.step()
		except Exception as error:  # errors of C++ come as many types
			why = str(error) or type(error).__name__
		finally:
			O.stopAtIter = -1
		if why:
			raise StageError(
				f"{self.stage}.step = {O.iter}: YADE stopped before step {wanted}: {self._torn()}{why}; "
				f"fix: go on from the last checkpoint in '{self.out}', with a smaller numerics.safety, a slower test or what else is said here"
			)

	def _torn(self):
		"""What an error says first when the membrane is torn, else nothing."""
		broken = self.scene.lateralBoundary.brokenBonds()
		return f"the membrane is torn, {broken} of its bonds are broken (membrane.tensileStrength, shearStrength); " if broken else ""

	def row(self):
		"""Measure, write and return a row of the records."""
		self.lastRow = rows.row(self.scene, self.grains, self.reference, self.stage, self.elapsed(), self.records.cement)
		lost = rows.escaped(self.scene, self.grains)
		if lost is not None:
			raise StageError(
				f"{self.stage}.step = {O.iter}: grain {lost} at {tuple(O.bodies[lost].state.pos)} has left the {self.scene.lateralBoundary.name}; {self._torn()}"
				"fix: a smaller membrane.particleRadius, a smaller numerics.safety or a slower test"
			)
		self.records.append(self.lastRow)
		self.rowCount += 1
		if self.present >= 0 and self.plan[self.present].chain:
			self._measureInside()
		return self.lastRow

	def _measureInside(self):
		try:
			self.inside.row(self.scene, self.lastRow, self._earlierRows + self.rowCount - 1, self.stageAt(self.present).nominal())
		except (RuntimeError, ValueError) as error:
			raise StageError(f"measure, in step {O.iter}: {self._torn()}{error}") from None

	def checkpoint(self, name=None):
		"""Save the state: as ``name``.yade.gz, kept; else uncompressed, which takes a third of the time, until two later ones are there.

		:raises OSError: the folder cannot be written; the checkpoint before is whole.
		"""
		state = self.store.stateName(name)
		if self.store.isLast(state, O.iter, self.records.size):
			return  # a test that has ended and is resumed
		with Image.taken() as image:
			entry = image.write(self.out / state)
			records = Entry(self.records.position(), self.records.sha256)
			elapsed = round(self.elapsed(), 2)
			made = Checkpoint(state, self.stage, O.iter, self.stageStart, records, list(self.frames.written), vars(self.reference), elapsed, self.inside.position())
			self.store.add(made, entry)
			if self.scene.loop is None:
				image.load(self.out / state)
				self.scene = Scene()
		self.scene.tellCheckpoint(self.out / state)

	def show(self, progress, done):
		"""Show how far the stage is, with its last row."""
		row = self.lastRow
		progress.update(
			done,
			strain=f"{100 * row['axial_strain']:.2f} %",
			q=f"{1e-3 * row['q']:.1f} kPa",
			porosity=f"{row['porosity']:.4f}",
			unbalanced=f"{row['unbalanced']:.1e}",
		)

	def checkpointDue(self):
		"""Whether a checkpoint belongs after this row."""
		every = self.config.output.checkpointEvery
		return every > 0 and self.rowCount % every == 0

	def maybeCheckpoint(self):
		if self.checkpointDue():
			self.checkpoint()

	def frame(self):
		"""Write a VTK frame, where they are asked for."""
		if self.config.output.vtkEvery:
			self.frames.write(self.scene, self.grains, self.reference.radius, self.inside.grainArrays)

	def tellSaturated(self, say):
		"""Tell of each closed loop that has come to its limit, once. :param say: takes lines of the log."""
		for loop, (state, fix) in self.scene.saturated().items():
			if loop in self._told:
				continue
			self._told.add(loop)
			row = self.lastRow
			say(
				f"WARNING: {loop} {state}, in {self.stage} at {100 * row['axial_strain']:.2f} %: "
				f"{1e-3 * row['sigma3_transmitted_group3']:.4g} kPa of {1e-3 * row['sigma3_target']:.4g} kPa arrive; fix: {fix}"
			)

	def strain(self):
		"""Axial strain since the last consolidation ended, compression positive."""
		bottom, top = self.scene.faces()
		return 1 - (top - bottom) / self.reference.height

	def q(self):
		"""Deviatoric stress of the soil [Pa], as in the records."""
		return rows.deviator(self.scene.measure.stress())

	# The stages

	def begin(self, k):
		"""Begin stage ``k`` of the plan."""
		self.stageAt(k).begin()

	def stageAt(self, k):
		"""What runs stage ``k`` of the plan."""
		planned = self.plan[k]
		special = {CONSOLIDATION: Consolidation, MEMBRANE: FromWall}.get(planned.kind)
		return (special or (Straining if planned.straining else Resting))(self, planned)

	@property
	def present(self):
		"""Number of the present stage in the plan, -1: none is begun."""
		return next((k for k, planned in enumerate(self.plan) if planned.label == self.stage), -1)

	def proceed(self, until=None):
		"""Run the stages from where the test is to the end of the one with the label ``until``, None: all. Each leaves its state, ``consolidated.yade.gz`` for example.

		:raises StageError: a stage does not reach its end.
		"""
		if self.present < 0:
			self.begin(0)
		last = len(self.plan) - 1 if until is None else [planned.label for planned in self.plan].index(until)
		for k in range(self.present, last + 1):
			self.runStage(k)
			if k + 1 < len(self.plan):
				self.begin(k + 1)
			self.checkpoint(self.plan[k].state)

	def runStage(self, k):
		"""Run stage ``k`` of the plan, which is begun, to its end."""
		self.stageAt(k).run()
