"""Equations of one trial under a law."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.regressor import standard_parameters
from fitter.controller.law_columns import law_columns
from fitter.controller.law_equations import law_equations

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
COLUMNS = law_columns(ARM, BASE).narrowed("pd")
TRUE = COLUMNS.start(BASE.combination @ standard_parameters(ARM), ARM.control)


def test_the_target_of_a_noise_free_motion_is_found(bench_trials):
    trial = bench_trials[0]
    equations = law_equations(ARM, BASE, replace(trial, ref=None))
    found = equations.target(TRUE, np.array(ARM.control.kp))
    assert found[0] == pytest.approx(trial.ref[-1], abs=1e-3)


def test_an_unknown_constant_torque_changes_no_equation(bench_trials):
    equations = law_equations(ARM, BASE, replace(bench_trials[0], ref=None))
    shifted = equations.counted(equations.rows + 0.5 * np.std(equations.rows, axis=0))
    varies = np.abs(equations.counted(equations.rows)).max(axis=0) > 0.0
    assert shifted.shape == equations.rows.shape
    assert (shifted - equations.counted(equations.rows))[:, varies] == pytest.approx(0.0, abs=1e-9)


def test_at_rest_no_equation_counts(bench_trials):
    still = replace(bench_trials[0], dq=np.zeros_like(bench_trials[0].dq))
    equations = law_equations(ARM, BASE, still)
    assert not equations.moving.any()
    assert not equations.counted(equations.rows).any()
