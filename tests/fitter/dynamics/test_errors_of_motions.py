"""How well a fit of the torque is known, by what its motions were made of."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.model import Control
from arm.regressor import standard_parameters
from fitter.dynamics.errors_of_motions import known_by_motions
from fitter.dynamics.fit import fit_dynamics
from fitter.dynamics.torque_search import fit_sums
from fitter.regression_sums.torque_sums import add_up
from fitter.regression_sums.trial_sums import trial_sums

ARM = replace(load_arm("dd-arm"), control=Control())
BASE = base_parameters(ARM)
TRUE = BASE.combination @ standard_parameters(ARM)


def drifting(trials, seed):
    """Return tracked motions whose accelerations are off by what each has of its own."""
    rng, points = np.random.default_rng(seed), np.zeros((1, len(ARM.sensors), 3))
    return [
        replace(
            trial,
            ddq=trial.ddq + rng.normal(0.0, 0.2, 2),
            tau=trial.tau + 0.01 * rng.normal(size=trial.tau.shape),
            points=np.repeat(points, len(trial.t), axis=0),
        )
        for trial in trials
    ]


def test_intervals_of_tracked_motions_hold_their_errors(bench_trials):
    held = []
    for seed in range(4):
        trials = drifting(bench_trials[:4], seed)
        fit = fit_dynamics(ARM, trials, objective="torque", method="least-squares", examine=False)
        assert fit.freedom == 3.0
        held.append(
            [
                abs(fit.parameters[name].value - x) < fit.parameters[name].half_width
                for name, x in zip(BASE.names, TRUE, strict=True)
            ]
        )
    assert np.mean(held) > 0.9


@pytest.mark.parametrize("physical", [False, True])
def test_one_tracked_motion_alone_claims_nothing(bench_trials, physical):
    trials = drifting(bench_trials[:1], 0)
    fit = fit_dynamics(ARM, trials, objective="torque", method="least-squares", physical=physical)
    assert all(fit.parameters[name].ci95 is None for name in BASE.names)
    assert not any(fit.parameters[name].identifiable for name in BASE.names)
    assert all(np.isnan(one.std) for one in fit.arm.base_parameters.values())
    assert "one tracked motion" in fit.notes[0].text


def test_sums_are_known_as_their_motions_are(bench_trials):
    trials = drifting(bench_trials[:3], 0)
    sums = add_up([trial_sums(ARM, BASE, trial) for trial in trials])
    fit = known_by_motions(fit_sums(ARM, BASE, sums, method="least-squares"), tracked=True)
    whole = fit_dynamics(ARM, trials, objective="torque", method="least-squares", examine=False)
    assert fit.covariance == pytest.approx(whole.covariance) and fit.freedom == whole.freedom == 2.0
