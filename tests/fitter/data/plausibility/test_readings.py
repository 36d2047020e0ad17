"""Raw accelerations that are not m/s² of specific force."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from fitter.data.motions import Measured
from fitter.data.plausibility.readings import look, resting
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


ARM = replace(load_arm("dd-arm"), gravity_m_s2=(0.0, 0.0, -G))
N_SENSOR = len(ARM.sensors)


def held(up, n=128, step_s=2e-3, **more):
    """Return readings of an arm that is held still: so much along z at every sensor."""
    return Measured(
        "held", "held.csv", 0, step_s * np.arange(n), {"a": np.tile([0.0, 0.0, up], (n, N_SENSOR))}, **more
    )


def said_of(motion, arm=ARM):
    try:
        assert look(motion, arm) is motion
    except Refusal as refusal:
        return str(refusal)
    return ""


@pytest.mark.parametrize(
    ("up", "words"),
    [
        (0.89, ""),
        (0.91, "held.csv: at rest the sensors read 0.91: are they in g? Expected m/s², 9.807 at rest"),
        (1.09, "are they in g?"),
        (1.11, ""),
        (890.0, ""),
        (910.0, "are they in mg?"),
        (1090.0, "are they in mg?"),
        (1110.0, ""),
        (0.0, "at rest the sensors read 0 m/s²: readings without gravity?"),
        (0.48, "readings without gravity?"),  # less than a twentieth
        (0.50, ""),
        (-8.7, ""),
        (-8.9, "gravity downwards: is its sign turned round"),  # within a tenth
        (-10.7, "9.807 m/s² upwards"),
        (-10.9, ""),
        (G, ""),
    ],
)
def test_what_is_read_at_rest_tells_unit_and_sign(up, words):
    said = said_of(held(up))
    assert words in said and bool(said) == bool(words)


@pytest.mark.parametrize(
    ("off", "words"), [(G, ""), (0.0, "readings without gravity?"), (2.0 * G, "gravity downwards")]
)
def test_what_the_arm_file_says_was_taken_off_is_put_back(off, words):
    """A sensor that was set to zero at rest reads nothing there, and its file says what was taken off."""
    zeroed = replace(ARM, sensors=tuple(replace(s, bias_m_s2=(0.0, 0.0, -off)) for s in ARM.sensors))
    said = said_of(held(0.0 if off < 1.5 * G else -3.0 * G), zeroed)
    assert words in said and bool(said) == bool(words)


def test_half_of_the_sensors_turned_round_is_a_mounting():
    motion = held(G)
    motion.columns["a"][:, 2] *= -1.0
    assert said_of(motion) == ""


def test_the_sign_is_not_asked_of_sensors_that_may_be_turned_in_any_way():
    """All of those that feel the same in any pose were mounted upside down: `fitter sensors` refused them."""
    motion = held(-G)
    assert look(motion, ARM, as_filed=False) is motion
    assert "in g?" in said_of(held(1.0))


def test_the_sign_is_asked_of_readings_whose_unit_is_stated():
    assert "sign turned round" in said_of(held(-G, stated=frozenset({"s1x"})))
    assert said_of(held(1.0, stated=frozenset({"s1z"}))) == ""
    assert "in g?" in said_of(held(1.0, stated=frozenset({"t"})))


@pytest.mark.parametrize("pose", [0.0, np.pi])
def test_gravity_downwards_is_no_question_where_poses_differ(pose):
    upright = load_arm("dd-arm-vertical")
    a = specific_force(upright, np.full((1, 2), pose), *np.zeros((2, 1, 2))).reshape(1, -1)
    motion = replace(held(0.0), columns={"a": -np.repeat(a, 128, axis=0)})
    assert said_of(motion, upright) == ""


def test_one_sensor_that_is_ac_coupled_is_enough():
    coupled = replace(ARM, sensors=(*ARM.sensors[:-1], replace(ARM.sensors[-1], highpass_hz=0.5)))
    assert said_of(held(1.0), coupled) == "" and "in g?" in said_of(held(1.0))


def test_time_that_stands_still_is_not_questioned_here():
    assert said_of(held(G, step_s=0.0)) == ""


def test_no_readings_are_asked_nothing():
    assert said_of(replace(held(1.0), columns={"q": np.zeros((128, 2))})) == ""


def test_a_rest_is_sought_in_windows_of_32_samples():
    rng, noise = np.random.default_rng(0), np.ones((131, 6))
    noise[40:56] = 0.1  # in the second window, and none whole
    noise[64:96] = 0.5
    a = noise * rng.normal(size=(131, 6)) + np.arange(6.0)
    a[96:] = np.tile([9.0, -9.0], 18)[:35, None]
    np.testing.assert_allclose(resting(a), a[64:96].mean(axis=0).reshape(2, 3), rtol=1e-12)
    still = np.repeat(np.arange(4.0), 32)[:, None] * np.ones(6)
    assert (resting(still) == 0.0).all()


@pytest.mark.parametrize(("step", "asked"), [(0.80, False), (0.83, True)])
def test_of_sensors_at_rest_the_rate_alone_tells(step, asked):
    said = said_of(held(G, step_s=step))
    assert bool(said) == asked
    if asked:
        assert "held.csv: a sample comes every 0.83 s: is t in ms?" in said and '"t=t:ms"' in said


def pushed(size, bias=0.0, step_s=0.05):
    """Return readings of a rest, a push by so much and one back; a bias along y at the first sensor."""
    motion = held(G, 160, step_s)
    motion.columns["a"][:, 0] = np.repeat([0.0, size, -size], [32, 64, 64])
    motion.columns["a"][:, 1] = bias
    return motion


@pytest.mark.parametrize(("size", "asked"), [(72.0, False), (82.0, True), (-72.0, False), (-82.0, True)])
@pytest.mark.parametrize("bias", [0.0, 40.0])
def test_a_speed_that_no_arm_reaches_tells_the_time_s_unit(size, asked, bias):
    """At 20 Hz a push of 77 m/s² over 64 samples makes 246 m/s, and a quarter of that per millisecond is usual."""
    assert ("is t in ms?" in said_of(pushed(size, bias))) == asked
