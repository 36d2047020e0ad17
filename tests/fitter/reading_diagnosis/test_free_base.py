"""What a base that moves freely did, and what that costs."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import axis_frames, rotation_from_rpy
from fitter.reading_diagnosis.free_base import base_course, freedom
from fitter.reading_diagnosis.sensor_fit import fit, judge
from fitter.reading_diagnosis.sensor_frames import trials_of
from fitter.reading_diagnosis.sensor_search import first_motions
from fitter.reading_diagnosis.trial_equations import Trials
from tests.fitter.reading_diagnosis.conftest import motion

SHAKES_HZ, SIZE_M_S2 = 3.0, 0.4


def shaken(a, t):
    """Return readings on a base that shakes along y, across the swinging arm's zero."""
    arm = load_arm("dd-arm-vertical")
    q = motion("dd-arm-vertical", 31)[0]
    frames, base = axis_frames(arm, q), SIZE_M_S2 * np.sin(2.0 * np.pi * SHAKES_HZ * t)
    for s, sensor in enumerate(arm.sensors):
        R = frames[:, sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)
        a[:, 3 * s : 3 * s + 3] += base[:, None] * R[:, 2]
    return a


@pytest.fixture(scope="module")
def fits(measure):
    run = measure(touch=shaken)
    trials = Trials(run.arm, trials_of(run.arm, [*run.learn, *run.evaluate]), len(run.learn))
    nothing, motions = trials.nothing(), first_motions(run.arm, trials.trials)
    fixed = judge(trials, fit(trials, nothing, motions))
    return trials, fixed, judge(trials, fit(trials, replace(nothing, free_base=True), motions))


def test_the_bases_acceleration_is_found(fits):
    trials, _, free = fits
    for number, trial in enumerate(trials.trials):
        course = base_course(trials, free, number)
        true = SIZE_M_S2 * np.sin(2.0 * np.pi * SHAKES_HZ * trial.t)
        assert np.sqrt(np.mean((course[:, 2] - true) ** 2)) < 0.02


def test_a_base_at_rest_costs_nothing_and_a_free_one_less_than_it_explains(fits):
    trials, fixed, free = fits
    judging = range(trials.n_learn, len(trials.trials))
    assert [freedom(trials, fixed, k) for k in judging] == [0.0] * len(judging)
    costs = [freedom(trials, free, k) for k in judging]
    gains = [fixed.squares[k] - free.squares[k] for k in judging]
    assert all(
        gain > cost > 3.0 * len(free.motions[k]) - 6.0 for gain, cost, k in zip(gains, costs, judging, strict=True)
    )
