"""What every effect of the catalogue must be, whichever files there are."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from arm import effects
from arm.arm_file import format_arm, parse_arm
from arm.bench import SensorErrors, Sensors
from arm.effects.catalogue import catalogue
from arm.effects.effect_table import changed
from arm.effects.joint_torque import DQ, MOST_PARAMETERS, torque_along
from arm.effects.resisting_torque import resisting_torque
from arm.model import Effect
from arm.newton_euler import inverse_dynamics
from arm.simulation import simulate

KINDS = pytest.mark.parametrize("kind", catalogue().values(), ids=lambda kind: kind.name)
#: Those that a simulation knows; where a marker is changes neither motion nor readings.
SIMULATED = [kind for kind in catalogue().values() if kind.place != "marker"]
IN_SIMULATION = pytest.mark.parametrize("kind", SIMULATED, ids=lambda kind: kind.name)
STEP_S, N_SAMPLE = 1e-3, 1200


def effect_of(kind, arm, **numbers):
    """Return an effect on all joints or sensors: 0.3 for each number, or the next to it that may be."""
    usual = {p.name: float(np.clip(0.3, p.low, p.high)) for p in kind.parameters if not p.optional}
    joints = tuple(range(1, arm.n_joint + 1)) if not kind.whole and kind.place != "sensor" else ()
    sensors = tuple(s.name for s in arm.sensors) if not kind.whole and kind.place == "sensor" else ()
    return Effect(kind.name, usual | numbers, joints, sensors)


def neutral(kind):
    return {p.name: p.neutral for p in kind.parameters if p.neutral is not None and not p.optional}


def moved(arm):
    t = np.arange(N_SAMPLE)[:, None] * STEP_S
    return simulate(arm, 0.2 + 1.5 * np.sin(t * np.array([4.0, 5.0, 6.0])), STEP_S, np.full(3, 0.2))


def readings(arm, motion):
    shape = (len(arm.sensors), 3)
    perfect = SensorErrors(0.0, np.zeros(shape), np.ones(shape), np.zeros(shape), np.zeros(shape))
    return Sensors(arm, perfect, 1.0 / STEP_S, np.random.default_rng(0)).counts(motion).astype(float)


@KINDS
def test_it_says_what_it_is(kind):
    module = sys.modules[f"arm.effects.{kind.name}"]  # its file has its name
    assert module.EFFECT is kind and module.__doc__
    assert len(kind.sentence.split()) >= 3 and kind.sentence[0].islower() and not kind.sentence.endswith(".")
    assert kind.parameters and len({p.name for p in kind.parameters}) == len(kind.parameters)
    assert kind.torque is None or len(kind.parameters) <= MOST_PARAMETERS
    for p in kind.parameters:
        assert p.unit and np.isfinite([p.low, p.high]).all() and p.low < p.high
    assert neutral(kind) or all(p.optional for p in kind.parameters), "some number makes it go away"


@KINDS
def test_whom_it_can_be_taken_for_can_be_taken_for_it(kind):
    assert kind.taken_for and kind.name not in kind.taken_for
    for name in kind.taken_for:
        assert kind.name in catalogue()[name].taken_for


@IN_SIMULATION
def test_an_arm_file_keeps_it(kind, arm):
    having = replace(arm, effects=(effect_of(kind, arm),))
    assert parse_arm(format_arm(having), "it") == having


@IN_SIMULATION
def test_it_changes_the_motion_or_the_readings(kind, arm):
    having = replace(arm, effects=(effect_of(kind, arm),))
    before, after = moved(arm), moved(having)
    assert np.isfinite(after.q).all()
    if kind.place == "sensor":
        np.testing.assert_array_equal(after.q, before.q)
        assert np.abs(readings(having, before) - readings(arm, before)).max() > 10.0
    else:
        assert np.abs(after.q - before.q).max() > 1e-5


@IN_SIMULATION
def test_with_its_neutral_number_it_changes_nothing(kind, arm):
    having = replace(arm, effects=(effect_of(kind, arm, **neutral(kind)),))
    before, after = moved(arm), moved(having)
    for column in ("q", "dq", "tau"):
        np.testing.assert_allclose(getattr(after, column), getattr(before, column), rtol=0, atol=1e-8)
    np.testing.assert_allclose(readings(having, before), readings(arm, before), rtol=0, atol=1)
    assert parse_arm(format_arm(having), "it") == having


@pytest.mark.parametrize(
    ("kind", "name"),
    [(kind, p.name) for kind in SIMULATED if kind.place != "drive" for p in kind.parameters if p.linear],
    ids=lambda x: x if isinstance(x, str) else x.name,
)
def test_what_is_said_to_be_linear_is(kind, name, arm):
    """The second difference by the parameter is zero, in the torque and in the readings."""
    motion = moved(arm)
    seen = []
    for value in (0.05, 0.07, 0.09):
        having = replace(arm, effects=(effect_of(kind, arm, **{name: value}),))
        torque = inverse_dynamics(changed(having), motion.q, motion.dq, motion.ddq)
        torque += resisting_torque(having, motion.q, motion.dq, motion.ddq, motion.tau, motion.t)
        seen.append((torque, readings(having, motion) if kind.place == "sensor" else np.zeros(1)))
    for (a, b, c), rounding in zip(zip(*seen, strict=True), (1e-10, 2.1), strict=True):
        np.testing.assert_allclose(a - 2 * b + c, 0.0, rtol=0, atol=rounding)
    assert any(np.abs(c - a).max() > 1e-4 for a, _, c in zip(*seen, strict=True))


@pytest.mark.parametrize("kind", [k for k in catalogue().values() if k.torque], ids=lambda kind: kind.name)
def test_its_torque_is_that_of_the_simulation(kind, arm):
    """Moving joints obey the equations of motion with the effect's torque in them."""
    having = replace(arm, effects=(effect_of(kind, arm),))
    motion = moved(having)
    wanted = inverse_dynamics(arm, motion.q, motion.dq, motion.ddq)
    wanted += resisting_torque(having, motion.q, motion.dq, motion.ddq, motion.tau, motion.t)
    moving = np.all(motion.dq != 0.0, axis=1)
    assert np.mean(moving) > 0.5
    np.testing.assert_allclose(wanted[moving], motion.tau[moving], rtol=0, atol=1e-9)


NEW = '''
"""Resistance that grows with the cube of the speed."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DQ, Numbers, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * x[DQ] ** 3


EFFECT = EffectKind(
    name="cubic_drag",
    sentence="resistance grows with the speed cubed",
    place="joint",
    parameters=(Parameter("drag", "N m s^3/rad^3", 0.0, 1e3, linear=True, neutral=0.0),),
    torque=_torque,
)
'''


def test_a_file_put_beside_the_others_is_found_and_simulated(tmp_path, monkeypatch, arm):
    (tmp_path / "cubic_drag.py").write_text(NEW)
    with monkeypatch.context() as patched:
        patched.setattr(effects, "__path__", [*effects.__path__, str(tmp_path)])
        catalogue.cache_clear()
        kind = catalogue()["cubic_drag"]
        states = np.zeros((3, 7))
        states[:, DQ] = [0.0, 1.0, -2.0]
        np.testing.assert_allclose(torque_along(kind, np.array([0.5]), states), [0.0, 0.5, -4.0])
        dragged = moved(parse_arm(format_arm(replace(arm, effects=(effect_of(kind, arm),))), "it"))
        assert np.abs(dragged.q - moved(arm).q).max() > 1e-3
    sys.modules.pop("arm.effects.cubic_drag")
    catalogue.cache_clear()
    assert "cubic_drag" not in catalogue()
