"""Simulated motion fitted to measured angles."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import Bench, motions
from arm.model import Arm, Control, Friction
from arm.regressor import standard_parameters
from arm.simulation import simulate
from arm.structural_parameters import structural_parameters
from fitter.data.motions import Measured
from fitter.data.trial import undriven
from fitter.data.trials import to_trials
from fitter.dynamics.fit import fit_dynamics

BRAKED = load_arm("dd-arm")
BRAKED = replace(BRAKED, joints=tuple(replace(j, friction=Friction(0.05, 0.08)) for j in BRAKED.joints))
BASE = structural_parameters(BRAKED)
TRUE = BASE.combination @ standard_parameters(BRAKED)


def noisy_trials(arm: Arm, noise: float, seed: int, *, rate_hz=250.0, ref=True, torque=False, trials=5):
    rng = np.random.default_rng(seed)
    measured = []
    for i, m in enumerate(motions(arm, replace(Bench(), rate_hz=rate_hz, learning=trials, evaluating=0), seed)):
        columns = {"q": m.q + noise * rng.normal(size=m.q.shape)}
        columns |= {"ref": m.ref} if ref else {}
        columns |= {"tau": m.tau} if torque else {}
        measured.append(Measured(f"bench#{i}", "here", 0, m.t, columns))
    return to_trials(measured)


def z_scores(fit):
    found = [fit.parameters[name] for name in BASE.names]
    return np.array([(p.value - true) / p.std for p, true in zip(found, TRUE, strict=True)])


def test_without_noise_it_finds_the_truth():
    fit = fit_dynamics(
        BRAKED, noisy_trials(BRAKED, 0.0, 1, rate_hz=100.0), objective="motion", method="least-squares"
    )
    assert fit.objective == "motion"
    values = [fit.parameters[name].value for name in BASE.names]
    assert np.allclose(values, TRUE, rtol=2e-4, atol=1e-5)


def test_intervals_hold_the_truth_and_it_is_nearer_than_the_torque_fit():
    scores, nearer = [], []
    for seed in range(3):
        trials = noisy_trials(BRAKED, 2e-3, seed, rate_hz=100.0)
        fits = [fit_dynamics(BRAKED, trials, objective=o, method="least-squares") for o in ("motion", "torque")]
        scores.append(z_scores(fits[0]))
        off = [np.array([f.parameters[n].value for n in BASE.names]) - TRUE for f in fits]
        nearer.append(np.linalg.norm(off[0][:4]) < np.linalg.norm(off[1][:4]))
    z = np.abs(np.array(scores))
    assert np.mean(z < 1.96) > 0.8 and np.max(z) < 5.0 and 0.6 < np.sqrt(np.mean(z**2)) < 1.6
    assert sum(nearer) >= 2


def test_ten_percent_of_noise_leaves_inertias_within_one_percent():
    trials = noisy_trials(BRAKED, 0.06, 3, rate_hz=4000.0)
    fit = fit_dynamics(BRAKED, trials, objective="motion", method="least-squares")
    for name in ("I1+m2*L1^2", "m2*sx2", "I2"):
        truth = TRUE[BASE.names.index(name)]
        assert abs(fit.parameters[name].value / truth - 1.0) < max(0.01, 3.0 * fit.parameters[name].std / truth)


def test_unknown_targets_are_found_along():
    trials = noisy_trials(BRAKED, 1e-4, 2, rate_hz=100.0, ref=False)
    fit = fit_dynamics(BRAKED, trials, objective="motion", method="least-squares")
    assert fit.objective == "motion"
    assert (
        np.nanmax(np.abs(z_scores(fit))) < 5.0
    )  # friction that always brakes one way is not distinguished from a target


def test_measured_torque_is_followed_in_windows():
    arm = replace(BRAKED, control=Control())
    trials = noisy_trials(BRAKED, 1e-4, 2, ref=False, torque=True, trials=2)
    fit = fit_dynamics(arm, trials, objective="motion", method="least-squares", window_s=1.0)
    assert fit.objective == "motion"
    for name in ("I1+m2*L1^2", "m2*sx2", "I2"):
        assert fit.parameters[name].value == pytest.approx(TRUE[BASE.names.index(name)], rel=0.01)


def test_a_free_swing_tells_all_but_the_scale():
    arm = load_arm("dd-arm-vertical")
    arm = replace(
        arm,
        control=Control("p", kp=(0.0, 0.0)),
        joints=tuple(replace(j, friction=Friction(0.02, 0.0)) for j in arm.joints),
    )
    swing = simulate(arm, np.zeros((3000, 2)), 2e-3, np.array([0.3, 0.4]))
    trial = undriven(to_trials([Measured("swing", "here", 0, swing.t, {"q": swing.q})])[0])
    base = structural_parameters(arm)
    true = dict(zip(base.names, base.combination @ standard_parameters(arm), strict=True))
    fit = fit_dynamics(
        replace(arm, control=Control()),
        [trial],
        objective="motion",
        method="least-squares",
        fixed={"I2": 2.0 * true["I2"]},
        window_s=2.0,
    )
    for name in ("I1+m2*L1^2", "m2*sx2", "D1", "D2"):
        assert fit.parameters[name].value == pytest.approx(2.0 * true[name], rel=5e-3)
