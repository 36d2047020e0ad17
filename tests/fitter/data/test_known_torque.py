"""A known torque leaves a trial as if it had never been there, filtered or not."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.known_torque import without_torque
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from limbcal.errors import DataError

DT_S = 0.002


def spring(q, dq, ddq, tau, t):
    """Return the torque of a spring, damping, inertia, a share of the torque, and something of the run's time."""
    return 3.0 * q + 0.5 * dq + 0.1 * ddq + 0.05 * tau + np.sin(t)[:, None]


def moved(**columns):
    t = 5.0 + np.arange(0.0, 8.0, DT_S)
    q = np.stack([0.8 * np.sin(2.0 * t), 0.5 * np.cos(3.1 * t)], axis=1)
    dq = np.stack([1.6 * np.cos(2.0 * t), -1.55 * np.sin(3.1 * t)], axis=1)
    ddq = np.stack([-3.2 * np.sin(2.0 * t), -4.805 * np.cos(3.1 * t)], axis=1)
    rest = np.cos(np.outer(t, [1.3, 0.7]))
    tau = (rest + 3.0 * q + 0.5 * dq + 0.1 * ddq + np.sin(t)[:, None]) / 0.95
    given = {"q": q, "dq": dq, "ddq": ddq, "tau": tau}
    (trial,) = to_trials([Measured("m", "m", 0, t, {k: given[k] for k in columns["of"]})], cutoff_hz=15.0)
    return trial, rest


@pytest.mark.parametrize("of", [("q", "dq", "ddq", "tau"), ("q", "dq", "tau"), ("q", "tau")])
def test_what_is_left_is_the_rest(of):
    trial, rest = moved(of=of)
    bare = without_torque(trial, spring)
    inner = slice(trial.trimmed, len(rest) - trial.trimmed)
    assert np.abs(bare.tau - rest[inner]).max() < 5e-3
    assert np.abs(bare.tau_measured - rest[inner]).max() < 5e-3
    if trial.trimmed:  # ends included, where the motion is what the filter makes of it
        assert np.abs(bare.whole["tau"][inner] - rest[inner]).max() < 5e-3
        outer = slice(trial.trimmed // 2, len(rest) - trial.trimmed // 2)
        assert np.abs(bare.whole["tau"][outer] - rest[outer]).max() < 0.05
        assert np.array_equal(bare.whole["q"], trial.whole["q"])


def test_without_a_torque_there_is_nothing_to_take_it_from():
    trial, _ = moved(of=("q", "tau"))
    with pytest.raises(DataError, match="no torque was measured"):
        without_torque(replace(trial, tau=None), spring)
