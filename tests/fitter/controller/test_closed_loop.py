"""Gains and base parameters by the simulated motion."""

import numpy as np

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.chain import chain_of
from arm.model import Control
from arm.regressor import standard_parameters
from fitter.controller.closed_loop import ClosedLoop, polished
from fitter.controller.law_columns import law_columns
from fitter.controller.law_equations import law_equations
from fitter.controller.law_fit import fit_law

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
COLUMNS = law_columns(ARM, BASE, "pd")


def test_the_simulated_arm_has_the_base_parameters_and_the_gains():
    values = COLUMNS.start(BASE.combination @ standard_parameters(ARM), Control("pd", (3.0, 4.0), (-5.0, -6.0)))
    machine = ClosedLoop(ARM, BASE, COLUMNS).machine(values)
    assert np.array_equal(machine.law, [[3.0, 4.0], [-5.0, -6.0], [0.0, 0.0]])
    assert np.allclose(machine.chain.inertial, chain_of(ARM).inertial)


def test_a_fit_to_derivatives_that_came_with_the_motion_stays_as_it_is(bench_trials):
    trial = bench_trials[0]
    assert not trial.whole
    fit = fit_law(ARM, BASE, COLUMNS, [law_equations(ARM, BASE, trial)], {COLUMNS.names.index("kp1"): 9.5})
    assert polished(fit, ARM, BASE, [trial]) is fit
