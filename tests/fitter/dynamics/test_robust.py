"""Weighted and robust torque fits."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.model import Control
from arm.newton_euler import inverse_dynamics
from arm.regressor import regressor, standard_parameters
from fitter.dynamics.fit import fit_dynamics
from limbcal.errors import ConfigError

ARM = replace(load_arm("dd-arm"), control=Control())
BASE = base_parameters(ARM)
TRUE = BASE.combination @ standard_parameters(ARM)


def with_torque_noise(trials, sizes, spikes=0.0, seed=0):
    rng = np.random.default_rng(seed)
    for trial in trials:
        tau = trial.tau + np.array(sizes) * rng.normal(size=trial.q.shape)
        hit = rng.random(trial.q.shape) < spikes
        yield replace(trial, tau=np.where(hit, tau + rng.choice([-8.0, 5.0], trial.q.shape), tau))


def off(fit):
    values = np.array([fit.parameters[name].value for name in BASE.names])
    std = np.array([fit.parameters[name].std for name in BASE.names])
    return values - TRUE, std


def test_outliers_are_drawn_in(bench_trials):
    trials = list(with_torque_noise(bench_trials, (0.02, 0.02), spikes=0.03))
    plain, robust = (
        off(fit_dynamics(ARM, trials, objective=objective, method="least-squares"))
        for objective in ("torque", "robust")
    )
    assert np.linalg.norm(robust[0]) < 0.2 * np.linalg.norm(plain[0])
    assert np.all(np.abs(robust[0]) < 5.0 * robust[1])


def test_it_is_hubers_estimate(bench_trials):
    """Iteratively reweighted least squares, written out sample by sample, end at the same place."""
    trials = list(with_torque_noise(bench_trials[:1], (0.05, 0.02), spikes=0.05))
    fit = fit_dynamics(ARM, trials, objective="robust", method="least-squares")
    trial = trials[0]
    moving = np.abs(trial.dq) > 0.02
    Y = regressor(ARM, trial.q, trial.dq, trial.ddq)[..., BASE.independent]
    values = np.linalg.lstsq(Y[moving], trial.tau[moving], rcond=None)[0]
    for _ in range(200):
        r = trial.tau - Y @ values
        s = np.array([np.median(np.abs(r[moving[:, j], j])) / 0.6745 for j in range(2)])
        w = np.sqrt(np.minimum(1.0, 1.345 * s / np.maximum(np.abs(r), 1e-300))) / s
        values = np.linalg.lstsq((w[..., None] * Y)[moving], (w * trial.tau)[moving], rcond=None)[0]
    found, std = off(fit)
    assert np.all(np.abs(found + TRUE - values) < 0.1 * std)


def test_a_noisy_joint_weighs_less(bench_trials):
    errors = {"torque": [], "weighted": []}
    for seed in range(4):
        trials = list(with_torque_noise(bench_trials[:2], (2.0, 0.01), seed=seed))
        for objective, found in errors.items():
            fit = fit_dynamics(ARM, trials, objective=objective, method="least-squares")
            found.append(off(fit)[0][:4])
    assert np.linalg.norm(errors["weighted"]) < 0.5 * np.linalg.norm(errors["torque"])


def test_an_unknown_target_is_no_outlier(bench_trials):
    untold = [replace(trial, ref=None) for trial in bench_trials[:2]]
    with pytest.raises(ConfigError, match="expected columns ref1"):
        fit_dynamics(load_arm("dd-arm"), untold, objective="robust")


def test_a_joint_that_stands_still_has_no_say(bench_trials):
    trial = bench_trials[0]
    q, dq, ddq = (np.array(x) for x in (trial.q, trial.dq, trial.ddq))
    q[:, 0], dq[:, 0], ddq[:, 0] = 0.3, 0.0, 0.0
    still = replace(trial, q=q, dq=dq, ddq=ddq, tau=inverse_dynamics(ARM, q, dq, ddq))
    fit = fit_dynamics(
        ARM, list(with_torque_noise([still], (0.02, 0.02))), objective="robust", method="least-squares"
    )
    assert fit.parameters["I2"].value == pytest.approx(TRUE[BASE.names.index("I2")], rel=0.01)
    assert not fit.parameters["I1+m2*L1^2"].identifiable
