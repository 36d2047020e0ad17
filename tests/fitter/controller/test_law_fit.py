"""Base parameters and gains of one form of the law."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.regressor import standard_parameters
from fitter.controller.law_columns import law_columns
from fitter.controller.law_equations import law_equations
from fitter.controller.law_fit import equations_gram, fit_law, torque_shares

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
COLUMNS = law_columns(ARM, BASE).narrowed("pd")
TRUE = COLUMNS.start(BASE.combination @ standard_parameters(ARM), ARM.control)


def test_noise_free_motion_and_one_known_gain_give_the_true_arm(bench_trials):
    equations = [law_equations(ARM, BASE, bench_trials[0])]
    fit = fit_law(ARM, BASE, COLUMNS, equations, {COLUMNS.names.index("kp1"): 9.5})
    assert fit.converged
    identified = [k for k, name in enumerate(COLUMNS.names) if fit.identifiable(name)]
    assert fit.values[identified] == pytest.approx(TRUE[identified], rel=1e-5, abs=1e-8)
    assert np.isnan(fit.std()[COLUMNS.names.index("kp1")])
    assert fit.torque_share.max() < 1e-9


def test_without_any_torque_of_the_arm_the_law_s_is_unexplained(bench_trials):
    gram = equations_gram([law_equations(ARM, BASE, bench_trials[0])])
    gains_alone = np.where(np.arange(len(TRUE)) < COLUMNS.n_base, 0.0, TRUE)
    n = len(TRUE)
    assert torque_shares(COLUMNS, gram[:, :n, :n], gains_alone) == pytest.approx([1.0, 1.0])
    assert torque_shares(COLUMNS, gram[:, :n, :n], TRUE) == pytest.approx([0.0, 0.0], abs=1e-9)
