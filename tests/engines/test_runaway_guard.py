# SPDX-License-Identifier: GPL-2.0-or-later
"""RunawayGuard: names the body, the iteration and the last good state; writes nothing."""

import math

import pytest
from contactScene import floor, sphere, springs
from tiers import engines, run
from yade import RunawayGuard, Vector3


def guarded(O, tier="reference", **options):
	"""Ten spheres at rest, far apart, and a platen; the guard is last."""
	springs()
	for i in range(10):
		sphere((0.1 * i, 0, 0.5), 0.01)
	floor()
	guard = RunawayGuard(**{"iterPeriod": 1, **options})
	O.engines = engines(tier, after=[guard])
	O.dt = 1e-3
	return guard


@pytest.mark.parametrize("attribute", ("pos", "vel", "angVel"))
@pytest.mark.parametrize("value", (math.nan, math.inf, -math.inf))
@pytest.mark.parametrize("component", (0, 1, 2))
def test_notFinite(O, attribute, value, component):
	guard = guarded(O, checkpoint="run/checkpoint-17.yade.gz", maxStep=math.nan)
	guard()
	bad = Vector3(0, 0, 0)
	bad[component] = value
	setattr(O.bodies[6].state, attribute, bad)
	with pytest.raises(RuntimeError) as caught:
		guard()
	message = str(caught.value)
	assert "body 6 at iteration 0 is not finite" in message
	assert "last good state: run/checkpoint-17.yade.gz" in message


def test_oppositeInfinitiesDoNotCancel(O):
	guard = guarded(O, maxStep=math.nan)
	O.bodies[3].state.vel = (math.inf, -math.inf, 0)
	with pytest.raises(RuntimeError, match="body 3 .* is not finite"):
		guard()


def test_nanOfAPlatenIsSeenToo(O):
	guard = guarded(O)
	O.bodies[10].state.pos = (0, 0, math.nan)
	with pytest.raises(RuntimeError, match="body 10 .* is not finite"):
		guard()


def test_wayPerStepIsMeasuredByTheRadius(O):
	"""0.1 of a radius of 0.01 m in 1e-3 s: the limit is 1 m/s."""
	guard = guarded(O)
	O.bodies[4].state.vel = (0, 0.6 * 0.9999, 0.8 * 0.9999)
	O.bodies[10].state.vel = (50, 0, 0)  # no sphere: has no radius to measure by
	guard()
	O.bodies[4].state.vel = (0, 0.6 * 1.0001, 0.8 * 1.0001)
	with pytest.raises(RuntimeError, match=r"body 4 at iteration 0 moves 0.10001 of its radius in one step \(RunawayGuard.maxStep = 0.1\).*no checkpoint is known"):
		guard()
	O.bodies[4].shape.radius = 0.011
	guard()
	guard.maxStep = 0.05
	with pytest.raises(RuntimeError, match="body 4"):
		guard()
	guard.maxStep = math.nan
	guard()


def test_velocityLimitHoldsForEveryBody(O):
	guard = guarded(O, maxVelocity=2.0, maxStep=math.nan)
	O.bodies[10].state.vel = (0, 0, -1.999)
	guard()
	O.bodies[10].state.vel = (0, 0, -2.001)
	with pytest.raises(RuntimeError, match=r"body 10 at iteration 0 moves at 2.001 m/s \(RunawayGuard.maxVelocity = 2\)"):
		guard()


def test_lowestIdIsNamed(O):
	guard = guarded(O)
	for body in (9, 2, 7):
		O.bodies[body].state.vel = (math.nan, 0, 0)
	with pytest.raises(RuntimeError, match="body 2 "):
		guard()
	O.bodies.erase(2)
	with pytest.raises(RuntimeError, match="body 7 "):
		guard()


def test_stopsTheRunAtTheIterationItHappens(O, tier, tmp_path):
	"""In a run: looks every `iterPeriod` iterations, stops there, and leaves the file it names alone."""
	kept = tmp_path / "good.yade.gz"
	guarded(O, tier, iterPeriod=10, checkpoint=str(kept))
	run(25)
	O.save(str(kept))
	content = kept.read_bytes()
	O.bodies[5].state.vel = (1.2, 0, 0)  # 0.12 of a radius in a step: the compact tier's own limit is 0.15
	run(5)  # 25 to 29 are not looked at
	with pytest.raises(RuntimeError, match="body 5 at iteration 30 "):
		O.step()
	assert kept.read_bytes() == content
	assert sorted(p.name for p in tmp_path.iterdir()) == ["good.yade.gz"]


@pytest.mark.parametrize(
	"change, part",
	(
		({"maxStep": 0}, "RunawayGuard.maxStep"),
		({"maxStep": -1}, "RunawayGuard.maxStep"),
		({"maxVelocity": 0}, "RunawayGuard.maxVelocity"),
		({"maxVelocity": math.inf}, "RunawayGuard.maxVelocity"),
	),
)
def test_refuses(O, change, part):
	guard = guarded(O, **change)
	with pytest.raises(ValueError, match=part):
		guard()


def test_refusesAPeriodOfZero(O):
	guarded(O, iterPeriod=0)
	with pytest.raises(ValueError, match="RunawayGuard.iterPeriod = 0"):
		O.step()


def test_savedAndLoaded(O, tmp_path):
	guarded(O, maxStep=0.25, maxVelocity=3.0, checkpoint="somewhere", iterPeriod=7)
	O.save(str(tmp_path / "scene.yade.gz"))
	O.reset()
	O.load(str(tmp_path / "scene.yade.gz"))
	guard = O.engines[-1]
	assert (guard.maxStep, guard.maxVelocity, guard.checkpoint, guard.iterPeriod) == (0.25, 3.0, "somewhere", 7)
