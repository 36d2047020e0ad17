"""Trials cut into windows of simulation."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.model import Control
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.dynamics.shooting import Shooting
from fitter.dynamics.shooting_windows import shooting_windows
from limbcal.errors import DataError

ARM = load_arm("dd-arm")


@pytest.fixture(scope="module")
def fast_motion():
    return next(iter(motions(ARM, replace(Bench(), rate_hz=8000.0, learning=1, evaluating=0), 4)))


def trial_of(motion, **columns):
    return to_trials([Measured("m", "here", 0, motion.t, {"q": motion.q, **columns})])[0]


@pytest.mark.parametrize("step_s", [2e-3, 5e-3, 1.9e-3])
def test_long_steps_see_the_motion_that_short_ones_do(fast_motion, step_s):
    window = shooting_windows(ARM, [trial_of(fast_motion, ref=fast_motion.ref)], step_s)[0]
    base = structural_parameters(ARM)
    shooting = Shooting(ARM, base)
    machine = shooting.machine(base.combination @ standard_parameters(ARM))
    start = np.concatenate([window.measured[0], [0.0, 0.0]])
    assert np.max(np.abs(shooting.angles(machine, window, start) - window.measured)) < 3e-6


def test_white_noise_is_averaged_over_every_sample(fast_motion):
    rng = np.random.default_rng(0)
    noise = 1e-2 * rng.normal(size=fast_motion.q.shape)
    clean, noisy = (
        shooting_windows(
            ARM, to_trials([Measured("m", "h", 0, fast_motion.t, columns)], cutoff_hz=50.0)[:1], 2e-3
        )[0]
        for columns in (
            {"q": fast_motion.q, "ref": fast_motion.ref},
            {"q": fast_motion.q + noise, "ref": fast_motion.ref},
        )
    )
    spread = np.std(noisy.measured - clean.measured)
    assert spread == pytest.approx(1e-2 / np.sqrt(16), rel=0.1)


def test_windows_meet_and_cover_the_trial(fast_motion):
    arm = replace(ARM, control=Control())
    cut = shooting_windows(arm, [trial_of(fast_motion, tau=fast_motion.tau)], 1e-3, window_s=0.5)
    assert len(cut) == 14
    assert all(np.array_equal(a.measured[-1], b.measured[0]) for a, b in zip(cut, cut[1:], strict=False))
    assert sum(len(s.measured) - 1 for s in cut) == pytest.approx(6750, abs=1)


def test_without_torque_there_is_nothing_to_follow(fast_motion):
    with pytest.raises(DataError, match="has no torque"):
        shooting_windows(replace(ARM, control=Control()), [trial_of(fast_motion)], 1e-3)
