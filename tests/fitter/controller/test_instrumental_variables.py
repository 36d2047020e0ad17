"""Instrumental variables: columns of a simulated motion."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.newton_euler import mass_matrix
from arm.regressor import standard_parameters
from fitter.controller.instrumental_variables import InstrumentalVariables
from fitter.controller.law_columns import law_columns
from fitter.controller.law_equations import law_equations

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
COLUMNS = law_columns(ARM, BASE, "pda")
TRUE = COLUMNS.start(BASE.combination @ standard_parameters(ARM), ARM.control)
INSTRUMENTS = InstrumentalVariables(ARM, BASE, COLUMNS)


def test_with_the_true_arm_they_are_the_columns_of_the_noise_free_motion(bench_trials):
    equations = law_equations(ARM, BASE, bench_trials[0])
    simulated = INSTRUMENTS.rows(TRUE, equations)
    measured = equations.counted(equations.rows)
    off = np.linalg.norm(simulated - measured, axis=(0, 1)) / np.linalg.norm(measured, axis=(0, 1))
    assert off.max() < 0.1  # a simulation in means of 4 ms; the target jumps within one of them


@pytest.mark.parametrize(("share", "possible"), [(0.999, True), (1.001, False)])
def test_a_gain_of_the_acceleration_beyond_the_smallest_inertia_is_impossible(share, possible):
    q = np.array([[0.0, 1.0]])
    values = TRUE.copy()
    values[-2:] = share * np.linalg.eigvalsh(mass_matrix(ARM, q)[0]).min()
    assert INSTRUMENTS.possible(values, q) == possible
