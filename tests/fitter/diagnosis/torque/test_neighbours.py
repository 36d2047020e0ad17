"""Vibrations that neighbouring joints share are distinguished from pushes; a neighbour's push is no vibration."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from fitter.diagnosis.torque.neighbours import beside_neighbours, neighbours
from fitter.diagnosis.torque.pulse import Pulse
from fitter.diagnosis.torque.pulses import find_pulses
from fitter.diagnosis.torque.residual_torque import ResidualTorque
from tests.fitter.diagnosis.torque.residuals import LASTS_S, STEP_S, coloured, filtered_pulse, trial


def of_joints(*residuals: np.ndarray) -> ResidualTorque:
    """Return a trial with these residuals of its joints."""
    one, n_joint = trial(np.random.default_rng(0)), len(residuals)
    r = np.stack(residuals, axis=1)
    return ResidualTorque(
        one.t,
        r,
        np.ones(r.shape, dtype=bool),
        np.repeat(one.torque, n_joint, axis=1),
        one.band_hz,
        np.full(n_joint, 0.005),
        np.zeros(n_joint),
        *np.zeros((2, *r.shape)),
        np.zeros(r.shape, dtype=bool),
    )


def ringing(rng: np.random.Generator, hz: float = 8.0, damping: float = 0.2) -> np.ndarray:
    """Return an oscillator that white noise drives, of size one."""
    n, w = round(LASTS_S / STEP_S), 2.0 * np.pi * hz * STEP_S
    pole = np.exp(-damping * w + 1j * w * np.sqrt(1.0 - damping**2))
    drawn = lfilter([1.0], [1.0, -2.0 * pole.real, abs(pole) ** 2], rng.normal(size=2 * n))[n:]
    return np.asarray(drawn / drawn.std())


def test_joints_are_neighbours_along_the_chain() -> None:
    assert [neighbours(k, 3) for k in range(3)] == [[1], [0, 2], [1]]
    assert neighbours(0, 1) == []


def test_a_neighbours_second_difference_is_a_signal_where_it_is_known() -> None:
    rng = np.random.default_rng(1)
    part = of_joints(*rng.normal(size=(3, 250)))
    part.known[100, 0] = False
    joints = [[part.rows(k)] for k in range(3)]
    (first,), (middle,), (last,) = (beside_neighbours(joints, k, []) for k in range(3))
    assert [one.signals.shape[1] for one in (first, middle, last)] == [3, 4, 3]
    np.testing.assert_array_equal(middle.signals[:, :2], joints[1][0].signals)
    np.testing.assert_array_equal(first.signals[:, 2], last.signals[:, 2])
    curved = np.zeros(250)
    curved[1:-1] = np.diff(joints[0][0].r, 2)
    curved[99:102] = 0.0
    np.testing.assert_allclose(middle.signals[:, 2], curved)


def test_a_push_at_a_neighbour_is_no_vibration() -> None:
    rng = np.random.default_rng(2)
    quiet = of_joints(coloured(rng), coloured(rng))
    pushed = replace(quiet, r=quiet.r.copy())
    pushed.r[:, 1] += filtered_pulse(4.0, 0.2, 0.7, "bell")
    pulse = Pulse(0, 1, 4.0, 0.2, 0.7, 0.01, 0.01, 0.01, 0.01, "bell", 50.0, 40.0)
    one, other = (
        beside_neighbours([[part.rows(k)] for k in range(2)], 0, known)[0].signals[:, 2]
        for part, known in ((quiet, []), (pushed, [pulse]))
    )
    assert np.abs(one - other).max() < 0.02 * 0.7


@pytest.mark.parametrize("seed", [3, 4])
def test_a_push_is_known_better_beside_a_joint_that_shakes_alike(seed: int) -> None:
    rng = np.random.default_rng(seed)
    trials = []
    for _ in range(3):
        shaken = 0.15 * ringing(rng)
        trials.append(of_joints(0.5 * coloured(rng) + shaken, 0.5 * coloured(rng) - 0.7 * shaken))
    trials[1].r[:, 0] += filtered_pulse(4.0, 0.2, 0.45, "bell")
    (found,) = find_pulses(trials)
    (alone,) = find_pulses([of_joints(part.r[:, 0]) for part in trials])
    assert (found.trial, found.joint) == (1, 0)
    for std, error in ((found.start_std, found.start_s - 4.0), (found.torque_std, found.torque_N_m - 0.45)):
        assert abs(error) < 3.0 * std
    assert found.start_std < alone.start_std
