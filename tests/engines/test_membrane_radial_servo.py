# SPDX-License-Identifier: GPL-2.0-or-later
import math

import numpy as np
import pytest

from membraneScene import forcesOn, makeMembrane, positions, pressOnCore, stateOf

P = 1e5


def run(m, **arguments):
	from yade import O, ForceResetter, NewtonIntegrator
	from yade.wrapper import MembraneRadialServo

	servo = MembraneRadialServo(membrane=m, pressure=P, **arguments)
	O.engines = [ForceResetter(), servo, NewtonIntegrator()]
	O.dt = 1e-9
	O.step()
	return servo, forcesOn(m.ids)


def test_equationTwoOfTheStudy(O):
	m = makeMembrane(placement="centred")
	servo, f = run(m, areaRule="cube")
	x, two = positions(m), np.array(m.groups) == 2
	expected = -P * (2 * m.sphereRadius) ** 2 * x[:, :2] / np.linalg.norm(x[:, :2], axis=1)[:, None]
	assert np.abs(f[two][:, :2] - expected[two]).max() < 1e-12 * np.abs(expected).max()
	assert (f[~two] == 0).all() and (f[:, 2] == 0).all()
	assert servo.area == pytest.approx(two.sum() * 4 * m.sphereRadius**2, rel=1e-12)


def test_tributaryAreaIsTheInnerSurface(O):
	m = makeMembrane()
	servo, f = run(m)
	rows = 2 * m.platenRows
	area = rows * m.ringSpacing * 2 * math.pi * m.innerRadius
	assert servo.area == pytest.approx(area, rel=1e-12)
	assert np.linalg.norm(f, axis=1).sum() == pytest.approx(P * area, rel=1e-12)


def test_towardTheAxisOfTheRingWhereItIsNow(O):
	m = makeMembrane()
	for i in m.ids:
		O.bodies[i].state.pos += (0.005, 0.003, 0)
	_, f = run(m)
	assert np.abs(f.sum(axis=0)).max() < 1e-12 * np.abs(f).sum()


def test_closedLoopReachesItsTarget(O):
	"""A stiff frictionless core carries the rows: the loop must find the factor that a wrong area rule makes necessary."""
	from yade.wrapper import MembraneRadialServo

	m = makeMembrane(mask=3)
	servo = MembraneRadialServo(membrane=m, pressure=P, areaRule="cube", gain=0.1, iterPeriod=20)
	pressOnCore(m, 2, servo)
	assert m.transmittedPressure(2) == pytest.approx(P, rel=5e-3)
	# the study's cube is 15.47 % more than a flat lattice's area; on the inner surface Rc/(Rc - R) more
	assert servo.factor == pytest.approx(math.sqrt(3) / 2 * m.innerRadius / m.centreRadius, rel=0.02)
	assert not servo.saturated


def test_saveAndLoadContinueExactly(O, tmp_path):
	from yade.wrapper import MembraneBonds

	m = makeMembrane()
	run(m)
	O.engines = O.engines[:1] + [MembraneBonds(membrane=m, kn=5e4)] + O.engines[1:]
	O.dt = 1e-6
	O.run(30, True)
	file = str(tmp_path / "half.yade.bz2")
	O.save(file)
	O.run(30, True)
	whole, work = stateOf(m.ids), O.engines[2].work
	O.reset()
	O.load(file)
	O.run(30, True)
	assert (stateOf(O.engines[2].membrane.ids) == whole).all() and O.engines[2].work == work and work > 0


BAD = [
	(dict(pressure=float("nan")), ValueError, "MembraneRadialServo.pressure"),
	(dict(areaRule="square"), ValueError, "'tributary' or 'cube'"),
	(dict(gain=-1.0), ValueError, "MembraneRadialServo.gain"),
	(dict(gain=0.1, iterPeriod=0), ValueError, "MembraneRadialServo.iterPeriod"),
	(dict(membrane=None), RuntimeError, "MembraneRadialServo.membrane = None"),
]


@pytest.mark.parametrize("changes, kind, message", BAD, ids=[b[2] for b in BAD])
def test_badInput(O, changes, kind, message):
	from yade.wrapper import MembraneRadialServo

	arguments = dict(membrane=makeMembrane(), pressure=P)
	arguments.update(changes)
	if arguments["membrane"] is None:
		del arguments["membrane"]
	with pytest.raises(kind) as error:
		MembraneRadialServo(**arguments)()
	assert message in str(error.value) and "fix:" in str(error.value)


def test_membraneWithoutGroupTwo(O):
	from yade.wrapper import MembraneRadialServo

	with pytest.raises(RuntimeError, match="platenRows=2"):
		MembraneRadialServo(membrane=makeMembrane(platenRows=0), pressure=P)()
