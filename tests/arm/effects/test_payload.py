"""A mass at the tip: a point at the far end of the last link, in some trials or from some time on."""

from dataclasses import replace

import numpy as np

from arm.bench import Bench, motions
from arm.effects.effect import LATEST_S
from arm.effects.payload import with_load
from arm.kinematics import tip_position
from arm.model import Link
from arm.newton_euler import bias_torque
from arm.simulation import simulate

DT = 1e-3


def with_point(arm, mass):
    """Return the arm with a point at its tip, put together of centre of mass and Steiner's theorem."""
    last, old = arm.joints[-1], arm.joints[-1].link
    com = (old.mass_kg * np.array(old.com_m) + mass * np.array([last.a_m, 0.0, 0.0])) / (old.mass_kg + mass)
    inertia = np.array(old.inertia_kg_m2) + mass * last.a_m**2 * np.array([0.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    link = Link(old.mass_kg + mass, tuple(com.tolist()), tuple(inertia.tolist()))
    return replace(arm, joints=(*arm.joints[:-1], replace(last, link=link)))


def test_its_weight_pulls_at_the_tip(arm):
    """The moment of gravity at the joints is that of m g along the slope of the tip's place."""
    q, still, step = np.array([[0.3, -0.4, 0.9]]), np.zeros((1, 3)), 1e-6
    added = bias_torque(with_load(arm, 0.7), q, still)[0] - bias_torque(arm, q, still)[0]
    slopes = [tip_position(arm, q + step * e) - tip_position(arm, q - step * e) for e in np.eye(3)]
    expected = -0.7 * np.array(slopes)[:, 0] / (2.0 * step) @ np.array(arm.gravity_m_s2)
    np.testing.assert_allclose(added, expected, rtol=0, atol=1e-8)


def test_a_link_without_mass_keeps_its_centre(wheel):
    link = Link(0.0, (0.1, 0.2, 0.3))
    empty = replace(wheel, joints=(replace(wheel.joints[0], link=link),))
    assert with_load(empty, 0.0).joints[0].link == link
    loaded = with_load(empty, 2.0).joints[0].link
    assert (loaded.mass_kg, loaded.com_m) == (2.0, (0.4, 0.0, 0.0))
    np.testing.assert_allclose(loaded.inertia_kg_m2, [0.0, 0.32, 0.32, 0.0, 0.0, 0.0])


def test_it_draws_the_centre_of_mass_to_the_tip(wheel):
    """Three kilograms at 0.4 m and one at (0.1, 0.2, 0.3) m."""
    light = replace(wheel, joints=(replace(wheel.joints[0], link=Link(1.0, (0.1, 0.2, 0.3), (1.0,) * 6)),))
    loaded = with_load(light, 3.0).joints[0].link
    assert loaded.mass_kg == 4.0
    np.testing.assert_allclose(loaded.com_m, [1.3 / 4.0, 0.2 / 4.0, 0.3 / 4.0])
    np.testing.assert_allclose(loaded.inertia_kg_m2, [1.0, 1.48, 1.48, 1.0, 1.0, 1.0])


def test_it_is_a_point_at_the_tip_in_its_trials(arm, having, swung):
    loaded, point = having(arm, "payload", mass_kg=0.7, trials=[2, 4]), with_point(arm, 0.7)
    for trial in (1, 2, 3, 4):
        expected = swung(point if trial in (2, 4) else arm)
        np.testing.assert_allclose(swung(loaded, trial=trial).q, expected.q, rtol=0, atol=1e-11)
    always = swung(having(arm, "payload", mass_kg=0.7))
    np.testing.assert_allclose(always.q, swung(point).q, rtol=0, atol=1e-11)


def test_since_some_time_it_is_taken_up_on_the_way(arm, having, swung):
    loaded = having(arm, "payload", mass_kg=0.7, since_s=10.3)
    motion, plain = swung(loaded, t0_s=10.0), swung(arm)
    np.testing.assert_array_equal(motion.q[:300], plain.q[:300])
    rest = simulate(with_point(arm, 0.7), motion.ref[300:], DT, motion.q[300], motion.dq[300])
    np.testing.assert_allclose(motion.q[300:], rest.q, rtol=0, atol=1e-11)
    for t0, same in ((11.0, with_point(arm, 0.7)), (0.0, arm)):
        np.testing.assert_allclose(swung(loaded, t0_s=t0).q, swung(same).q, rtol=0, atol=1e-11)


def test_the_bench_counts_trials(arm, having):
    bench = Bench(rate_hz=1000.0, trial_s=0.4, rest_s=0.1, learning=2, evaluating=1)
    plain = [motion.q for motion in motions(arm, bench, 3)]
    loaded = [motion.q for motion in motions(having(arm, "payload", mass_kg=1.0, trials=[3]), bench, 3)]
    for trial in (0, 1):
        np.testing.assert_array_equal(loaded[trial], plain[trial])
    assert np.abs(loaded[2] - plain[2]).max() > 1e-3


def test_what_it_may_be(ranges, accepts):
    ranges("payload", "mass_kg", 0.0, 1e3)
    ranges("payload", "since_s", -LATEST_S, LATEST_S, mass_kg=1.0)
    assert accepts("payload", mass_kg=1.0, trials=[1, 1_000_000])
    assert not accepts("payload", mass_kg=1.0, trials=[0]) and not accepts(
        "payload", mass_kg=1.0, trials=[1_000_001]
    )
