"""Equations that no slow equilibrium trajectory reaches."""

import numpy as np
import pytest

from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.controller.equilibrium_ratios import equilibrium_columns
from fitter.controller.free_equilibrium import TrialEquations, _splines, angle_noise
from tests.fitter.held_limb import KP, KV_LOOSE, limb, released


def test_splines_of_a_bandwidth_hold_what_is_slower():
    t = np.linspace(0.0, 10.0, 1000)
    Q = np.linalg.qr(_splines(t, 1.0))[0]
    left = {
        hz: np.std(x - Q @ (Q.T @ x)) / np.std(x) for hz in (0.25, 0.5, 2.0) for x in [np.sin(6.28 * hz * t + 1)]
    }
    assert left[0.25] < 1e-4 and left[0.5] < 2e-3 and left[2.0] > 0.9


def test_the_true_arm_leaves_the_noise_of_its_angles_alone(tmp_path):
    arm = limb(KV_LOOSE)
    base = structural_parameters(arm)
    columns = equilibrium_columns(arm, base)
    assert columns.names == ("m1*sx1", "m1*sy1", "I1", "D1-kv1", "kp1")
    truth = np.append((base.combination @ standard_parameters(arm))[list(columns.kept[:-1])], KP)
    truth[3] -= KV_LOOSE
    rng, squares = np.random.default_rng(0), []
    for trial in released(tmp_path):
        rows, noise = TrialEquations(arm, base, columns, trial, rng).beyond(1.0)
        squares.append((rows @ truth) ** 2 / noise.variance(truth))
    assert np.mean(np.concatenate(squares)) == pytest.approx(1.0, abs=0.2)


def test_the_noise_of_angles_is_found(tmp_path):
    assert angle_noise(released(tmp_path)[0]) == pytest.approx(1e-3, rel=0.2)
