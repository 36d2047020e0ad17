"""A motor that gives no more than so much."""

import numpy as np
from scipy.integrate import solve_ivp

from arm.simulation import simulate

INERTIA, KP, KV = 0.5, 8.0, -2.0
DT = 1e-3


def test_a_motor_gives_no_more_than_its_limit(wheel, having, held):
    weak = having(wheel, "torque_saturation", limit_N_m=1.5)

    def rate(_, x):
        return [x[1], np.clip(KP * (0.9 - x[0]) + KV * x[1], -1.5, 1.5) / INERTIA]

    run = solve_ivp(rate, (0.0, 2.0), [0.0, 0.0], rtol=1e-10, atol=1e-12, max_step=DT, t_eval=np.arange(2001) * DT)
    motion = simulate(weak, held(0.9, 2001), DT, np.zeros(1))
    np.testing.assert_allclose(motion.q[:, 0], run.y[0], rtol=0, atol=1e-6)
    assert np.abs(motion.tau).max() > 4.0  # `tau` is the commanded torque, not the delivered one
    assert np.abs(INERTIA * motion.ddq).max() <= 1.5 + 1e-12


def test_a_motor_that_gives_nothing_moves_nothing(wheel, having, held):
    motion = simulate(having(wheel, "torque_saturation", limit_N_m=0.0), held(0.9, 20), DT, np.zeros(1))
    np.testing.assert_array_equal(motion.q, 0.0)


def test_what_it_may_be(ranges, accepts):
    ranges("torque_saturation", "limit_N_m", 0.0, 1e6)
    assert accepts("torque_saturation", limit_N_m=np.inf)
