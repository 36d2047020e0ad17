"""The common factor from measured torque."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from fitter.controller.instrumental_variables import InstrumentalVariables
from fitter.controller.law_columns import law_columns
from fitter.controller.law_equations import law_equations
from fitter.controller.law_fit import fit_law
from fitter.controller.torque_scale import scaled_to_torque

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
COLUMNS = law_columns(ARM, BASE).narrowed("pd")


@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_gains_and_errors_take_the_torque_s_scale(bench_trials, factor):
    kp1, kp2, inertia = (COLUMNS.names.index(name) for name in ("kp1", "kp2", "I2"))
    equations = [law_equations(ARM, BASE, bench_trials[0])]
    fit = fit_law(ARM, BASE, COLUMNS, equations, {kp1: factor * 9.5})
    scaled = scaled_to_torque(fit, InstrumentalVariables(ARM, BASE, COLUMNS), equations)
    assert scaled.values[[kp1, kp2]] == pytest.approx([9.5, 9.5], rel=1e-3)
    assert scaled.values[inertia] == pytest.approx(fit.values[inertia] / factor, rel=1e-3)
    assert np.isfinite(scaled.std()[kp1])
