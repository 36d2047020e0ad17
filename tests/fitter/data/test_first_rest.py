"""The rest before a motion."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.data.first_rest import displacement, first_rest
from fitter.data.trial import Trial
from limbcal.errors import DataError

ARM = load_arm("dd-arm")


def test_the_rest_before_the_motion(bench_trials):
    rest = first_rest(bench_trials[0])
    assert abs(bench_trials[0].t[rest.stop] - 0.5) < 0.05
    rushed = replace(bench_trials[0], dq=np.ones_like(bench_trials[0].dq))
    assert first_rest(rushed) == slice(0, 1)
    still = replace(bench_trials[0], dq=np.zeros_like(bench_trials[0].dq))
    assert first_rest(still) == slice(0, len(still.q))


def test_displacement_does_not_know_where_the_base_stands(bench_trials):
    trial = bench_trials[1]
    moved, rest = displacement(ARM, trial)
    assert np.allclose(moved[: len(rest)].mean(axis=0), 0.0, atol=1e-12)
    elsewhere, _ = displacement(ARM, replace(trial, tip=trial.tip + [1.0, -2.0, 3.0]))
    assert np.allclose(moved, elsewhere, atol=1e-12)


def test_says_what_is_missing(bench_trials):
    with pytest.raises(DataError, match="bench#0: has no tip"):
        displacement(ARM, replace(bench_trials[0], tip=None))
    with pytest.raises(DataError, match="has 1 joints"):
        displacement(ARM, replace(bench_trials[0], q=bench_trials[0].q[:, :1]))


@pytest.mark.parametrize(
    ("speeds", "rows"),
    [
        ([0.02, -0.02, 0.02, 0.021, 0.0], 3),  # a degree a second is none
        ([0.0, 0.0, -0.021, 0.0, 0.0], 2),
        ([0.021, 0.0, 0.0, 0.0, 0.0], 1),
        ([0.0, 0.021, 0.0, 0.0, 0.0], 1),
        ([0.0, 0.0, 0.0, 0.0, 0.0], 5),
    ],
)
@pytest.mark.parametrize("joint", [0, 1])
def test_the_rest_ends_where_any_joint_moves(speeds, rows, joint):
    dq = np.zeros((5, 2))
    dq[:, joint] = speeds
    q, tip = np.arange(10.0).reshape(5, 2), np.arange(15.0).reshape(5, 3) ** 2
    trial = Trial("a", np.arange(5.0), 1.0, q, dq, dq, tip=tip)
    assert first_rest(trial) == slice(0, rows)
    moved, rest = displacement(ARM, trial)
    np.testing.assert_allclose(moved, tip - tip[: rest.shape[0]].mean(axis=0))
    assert np.array_equal(rest, q[:rows])
