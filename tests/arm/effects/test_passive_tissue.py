"""Tissue at an end of a joint's range: its moment by closed form, and that it takes energy."""

import numpy as np
import pytest

from arm.effects.joint_torque import torque_along
from arm.effects.passive_tissue import EFFECT
from arm.effects.resisting_torque import resisting_torque
from arm.simulation import simulate

ANGLE, MOMENT, RATE, DAMPING = 0.4, 2.0, 12.0, 0.3


def moment(q, dq, side):
    state = np.array([[0.0, q, dq, np.sign(dq), 0.0, 0.0, 0.0]])
    return float(torque_along(EFFECT, np.array([ANGLE, MOMENT, RATE, DAMPING, side]), state)[0])


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_it_grows_e_fold_over_an_inverse_rate(side):
    assert moment(ANGLE, 0.0, side) == pytest.approx(side * MOMENT)
    assert moment(ANGLE + side / RATE, 0.0, side) == pytest.approx(side * MOMENT * np.e)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_where_it_is_stated_is_a_convention(side):
    other = np.array([0.1, MOMENT * np.exp(RATE * side * (0.1 - ANGLE)), RATE, DAMPING, side])
    state = np.array([[0.0, 0.7, 1.1, 1.0, 0.0, 0.0, 0.0]])
    assert float(torque_along(EFFECT, other, state)[0]) == pytest.approx(moment(0.7, 1.1, side))


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_it_gives_back_less_than_it_took(side):
    assert (moment(0.5, 1.0, side) - moment(0.5, -1.0, side)) > 0.0


#: A knee's ends (Anderson 1999, table G.2): angle [rad], moment [N m] there, rate [1/rad]; flexion is negative.
EXTENDED, FLEXED = (0.13, 6.09, 33.94), (-2.40, 11.03, 11.33)


def knee_of(wheel, having, damping_s=0.0):
    for side, (angle, moment, rate) in ((1.0, EXTENDED), (-1.0, FLEXED)):
        stated = {"angle_rad": angle, "moment_N_m": moment, "rate_1_rad": rate}
        wheel = having(wheel, "passive_tissue", **stated, damping_s=damping_s, side=side)
    return wheel


def test_two_ends_are_a_knees_published_passive_moment(wheel, having):
    knee = knee_of(wheel, having)
    q = np.linspace(-2.5, 0.2, 28)[:, None]
    seen = resisting_torque(knee, q, 0 * q, 0 * q, 0 * q, np.zeros(len(q)))
    published = -6.09 * np.exp(33.94 * (q - 0.13)) + 11.03 * np.exp(-11.33 * (q + 2.40))
    np.testing.assert_allclose(seen, -published, rtol=1e-12)
    assert np.abs(seen[(q > -1.8) & (q < 0.0)]).max() < 0.1  # it is felt near the ends alone


@pytest.mark.parametrize("damping_s", [0.0, 0.1])
def test_tissue_keeps_a_knee_in_its_range(wheel, having, damping_s):
    knee = knee_of(wheel, having, damping_s)
    none = np.zeros((20_000, 1))
    motion = simulate(knee, none, 2e-4, np.array([-1.0]), np.array([4.0]), torque=none)
    q, dq = motion.q[:, 0], motion.dq[:, 0]
    energy = 0.5 / 2 * dq**2 + 6.09 / 33.94 * np.exp(33.94 * (q - 0.13))
    energy += 11.03 / 11.33 * np.exp(-11.33 * (q + 2.4))
    assert -2.7 < q.min() < -2.2 and 0.1 < q.max() < 0.3
    if damping_s:
        assert np.all(np.diff(energy) < 1e-6) and energy[-1] < 0.8 * energy[0]
    else:
        np.testing.assert_allclose(energy, energy[0], rtol=1e-5)


def test_what_it_may_be(ranges):
    numbers = {"angle_rad": ANGLE, "moment_N_m": MOMENT, "rate_1_rad": RATE, "damping_s": DAMPING, "side": 1.0}
    for name, low, high in (
        ("angle_rad", -10.0, 10.0),
        ("moment_N_m", 0.0, 1e4),
        ("rate_1_rad", 1.0, 100.0),
        ("damping_s", 0.0, 10.0),
        ("side", -1.0, 1.0),
    ):
        ranges("passive_tissue", name, low, high, **{k: x for k, x in numbers.items() if k != name})
