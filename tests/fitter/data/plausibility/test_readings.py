"""Raw accelerations that are not m/s² of specific force."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from fitter.data.motions import Measured
from fitter.data.plausibility.readings import look
from fitter.data.plausibility.refusal import Refusal

G = 9.80665


def raw(arm, seed=0, rate_hz=500.0):
    rng, t = np.random.default_rng(seed), np.arange(0.0, 4.0, 1.0 / rate_hz)
    s = np.clip((t - 1.0) / 1.5, 0.0, 1.0)
    shape = s**3 * (10 - 15 * s + 6 * s**2)
    moved = [shape, np.gradient(shape, t), np.gradient(np.gradient(shape, t), t)]
    way = rng.uniform(-1.0, 1.0, arm.n_joint)
    a = specific_force(arm, *(np.outer(part, way) for part in moved)).reshape(len(t), -1)
    return Measured("raw", "raw.csv", 0, t, {"a": a + 0.02 * rng.normal(size=a.shape)})


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ["dd-arm", "dd-arm-vertical"])
def test_each_fault_is_named_and_none_where_there_is_none(name, seed):
    arm = load_arm(name)
    motion = raw(arm, seed)
    assert look(motion, arm) is motion
    a = motion.columns["a"]
    with pytest.raises(Refusal, match="in g"):
        look(replace(motion, columns={"a": a / G}), arm)
    weightless = raw(replace(arm, gravity_m_s2=(0.0, 0.0, 0.0)), seed)
    with pytest.raises(Refusal, match="without gravity"):
        look(weightless, arm)


def test_gravity_turned_round_is_named_where_the_pose_does_not_matter():
    arm = load_arm("dd-arm")
    motion = raw(arm)
    a = motion.columns["a"].copy()
    a[:, 2::3] *= -1.0
    with pytest.raises(Refusal, match="sign turned round"):
        look(replace(motion, columns={"a": a}), arm)


@pytest.mark.parametrize("rate_hz", [200.0, 4000.0])
@pytest.mark.parametrize(("unit", "parts"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_parts_of_seconds_are_named(rate_hz, unit, parts):
    arm = load_arm("dd-arm")
    motion = raw(arm, 0, rate_hz)
    with pytest.raises(Refusal, match=f"is t in {unit}"):
        look(replace(motion, t=parts * motion.t), arm)
    stated = replace(motion, t=parts * motion.t, stated=frozenset({"t"}))
    assert look(stated, arm) is stated


def test_a_unit_that_is_stated_and_a_handful_of_readings_are_believed():
    arm = load_arm("dd-arm")
    in_g = raw(arm)
    in_g = replace(in_g, columns={"a": in_g.columns["a"] / G})
    stated = replace(in_g, stated=frozenset({"s1x"}))
    assert look(stated, arm) is stated
    few = in_g.rows(0, 127, "few")
    assert look(few, arm) is few
    with pytest.raises(Refusal, match="in g"):
        look(in_g.rows(0, 128, "enough"), arm)


def test_without_gravity_nothing_is_asked_of_it():
    arm = replace(load_arm("dd-arm"), gravity_m_s2=(0.0, 0.0, 0.0))
    motion = raw(arm)
    assert look(motion, arm) is motion


def test_a_sensor_that_is_ac_coupled_reads_no_gravity():
    arm = load_arm("dd-arm")
    coupled = replace(arm, sensors=tuple(replace(sensor, highpass_hz=0.1) for sensor in arm.sensors))
    motion = raw(replace(arm, gravity_m_s2=(0.0, 0.0, 0.0)))
    assert look(motion, coupled) is motion
