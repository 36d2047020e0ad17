"""A residual's rows: two a period of the band's corner, known where all of their samples are."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.torque.pulse_column import pulse_means
from tests.fitter.diagnosis.torque.residuals import STEP_S, trial


def test_rows_have_two_samples_a_period_of_the_band():
    part = replace(trial(np.random.default_rng(3)), band_hz=6.25)
    part.known[:1] = False
    rows = part.rows(0)
    assert rows.step_s == pytest.approx(0.08)
    assert not rows.known[0]
    assert rows.known[1:].all()
    assert rows.signals.shape == (len(rows.t), 2)


def test_friction_of_a_joint_that_turns_back_is_uniform():
    part = trial(np.random.default_rng(4))
    part.friction[:] = 0.3
    part.turning[100:110] = 0.5
    rows = part.rows(0)
    np.testing.assert_allclose(rows.friction_error[100:110], 0.5 * 0.3 / np.sqrt(3.0))
    assert not rows.friction_error[:100].any() and not rows.friction_error[110:].any()


@pytest.mark.parametrize("resisted", [True, False])
@pytest.mark.parametrize("size", [3.0, -3.0])
def test_a_push_is_no_signal_whether_the_motor_resists_it_or_the_arm_gives_way(size, resisted):
    part = trial(np.random.default_rng(5))
    push = size * pulse_means(part.t, STEP_S, 4.0, 0.2, "rectangular")[:, None]
    pushed = replace(part, r=part.r + push, torque=part.torque - (push if resisted else 0.0))
    torque, rate = pushed.rows(0).signals.T
    clean = part.torque[:, 0]
    assert np.all(np.abs(torque) <= np.abs(clean) + 0.1 * abs(size))
    assert np.abs(rate).max() < 1.5 * np.abs(np.gradient(clean, STEP_S)).max()
    away = (part.t < 3.9) | (part.t > 4.3)
    np.testing.assert_allclose(torque[away], clean[away], atol=0.1 * abs(size))


def test_a_torque_reverses_as_far_as_the_filter_looks_and_at_the_neighbours_too():
    part = trial(np.random.default_rng(6))
    still = np.where(np.abs(part.torque) < 0.2, 0.0, part.torque)
    one, none = np.hstack([still, np.ones_like(still)]), np.ones((len(still), 2))
    for torque, expected in ((one, True), (none, False)):
        both = replace(
            part,
            torque=torque,
            **{name: np.hstack([getattr(part, name)] * 2) for name in ("r", "known", "friction", "turning")},
            torque_noise=np.full(2, 0.005),
            angle_noise=np.zeros(2),
        )
        near = [both.rows(joint).reversing > 0.0 for joint in range(2)]
        np.testing.assert_array_equal(*near)
        assert near[0].any() == expected
        assert not np.any(near[0] & (np.abs(part.torque[: len(near[0]), 0]) > 0.75))


def test_a_push_that_the_motor_resists_reverses_nothing():
    part = replace(trial(np.random.default_rng(7)), torque=np.full((250, 1), 0.3))
    push = 2.0 * pulse_means(part.t, STEP_S, 4.0, 0.2, "rectangular")[:, None]
    assert not replace(part, r=part.r + push, torque=part.torque - push).rows(0).reversing.any()
