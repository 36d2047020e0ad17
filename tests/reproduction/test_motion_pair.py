"""Two sets of motions beside each other."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Control
from fitter.data.trial import Trial
from reproduction.bench_data import bench_trials, true_arm
from reproduction.motion_pair import (
    angle_errors,
    motion_by_motion,
    picture_of,
    under_the_same_control,
)


@pytest.fixture(scope="module")
def real() -> list[Trial]:
    return bench_trials(true_arm(), 2 * 27_000, seed=2, learning=2, evaluating=1)


def test_the_arm_itself_moves_as_it_does(real):
    itself = angle_errors(real, under_the_same_control(true_arm(), real, 2))
    assert itself.learn == itself.evaluate == (0.0, 0.0)
    again = angle_errors(real, motion_by_motion(true_arm(), real))
    assert max(*again.learn, *again.evaluate) < 1e-3


def test_an_arm_that_is_held_does_too():
    arm = replace(true_arm(), control=Control("p", (9.5, 9.5)))
    held = bench_trials(arm, 27_000, seed=2, learning=1, evaluating=1, held=True)
    assert angle_errors(held, under_the_same_control(arm, held, 2, held=True)).evaluate == (0.0, 0.0)


def test_errors_are_of_all_joints_and_kept_apart_by_role(real):
    shifted = [trial.q + np.deg2rad([1.0, 3.0]) * (2.0 if trial.role == "evaluate" else 1.0) for trial in real]
    errors = angle_errors(real, shifted)
    np.testing.assert_allclose(errors.learn, (2.0, 3.0))
    np.testing.assert_allclose(errors.evaluate, (4.0, 6.0))
    assert errors.cells() == ("2.000", "3.000", "4.000", "6.000")
    assert angle_errors(real[:1], shifted[:1]).cells()[2:] == (None, None)


def test_the_picture_has_a_row_a_joint_and_one_for_the_error(real):
    assert len(picture_of(real, [trial.q for trial in real], ("a", "b")).axes) == 3
