"""A push that lasts a while, at the run's time."""

import numpy as np

from arm.bench import Bench, motions, rest_angles
from arm.effects.effect import LATEST_S
from arm.simulation import simulate

PUSH = {"start_s": 2.5, "duration_s": 0.1, "torque_N_m": -1.0}
DT = 1e-3


def test_it_pushes_from_its_start_as_long_as_it_lasts(resists):
    found = resists("external_push", PUSH, t=[0.0, 2.499, 2.5, 2.55, 2.6, 2.601, 9.0])
    np.testing.assert_allclose(found, [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0])


def test_a_free_joint_takes_up_its_impulse(wheel, having):
    none = np.zeros((1001, 1))
    push = {**PUSH, "start_s": 0.5}
    motion = simulate(having(wheel, "external_push", **push), none, DT, np.zeros(1), torque=none)
    np.testing.assert_array_equal(motion.dq[:500], 0.0)
    np.testing.assert_allclose(motion.dq[650:], -1.0 * 0.1 / 0.5, rtol=1e-2)


def test_it_comes_at_the_runs_time_in_later_trials(wheel, having):
    arm, ref = having(wheel, "external_push", **PUSH), np.full((2001, 1), 0.3)
    whole = simulate(arm, np.tile(ref, (2, 1))[:4001], DT, np.zeros(1))
    second = simulate(arm, ref, DT, whole.q[2000], whole.dq[2000], t0_s=2.0)
    np.testing.assert_allclose(second.q, whole.q[2000:], rtol=0, atol=1e-9)
    assert not np.allclose(second.q, simulate(arm, ref, DT, whole.q[2000], whole.dq[2000]).q, atol=1e-3)


def test_the_bench_counts_the_runs_time(arm, having):
    bench = Bench(rate_hz=1000.0, trial_s=0.6, rest_s=0.1, learning=2, evaluating=1)
    plain = [motion.q for motion in motions(arm, bench, 3)]
    pushed = having(arm, "external_push", start_s=1.3, duration_s=0.1, torque_N_m=3.0)
    pushes = [motion.q for motion in motions(pushed, bench, 3)]
    for trial in (0, 1):
        np.testing.assert_array_equal(pushes[trial], plain[trial])
    apart = np.abs(pushes[2] - plain[2])
    assert apart[:100].max() == 0.0 and apart.max() > 1e-3
    np.testing.assert_array_equal(rest_angles(pushed, np.zeros(3)), rest_angles(arm, np.zeros(3)))


def test_what_it_may_be(ranges):
    ranges("external_push", "start_s", -LATEST_S, LATEST_S, duration_s=1.0, torque_N_m=1.0)
    ranges("external_push", "duration_s", 1e-3, 1e4, start_s=0.0, torque_N_m=1.0)
    ranges("external_push", "torque_N_m", -1e3, 1e3, start_s=0.0, duration_s=1.0)
