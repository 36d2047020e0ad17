"""A torque fit moved by simulated motion."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.dynamics.motion_search import polished_by_motion
from fitter.dynamics.torque_search import assembled, fit_sums
from fitter.regression_sums.torque_sums import torque_sums

ARM = load_arm("dd-arm")
BASE = structural_parameters(ARM)


def test_from_values_five_percent_off_it_ends_at_those_of_the_noise_free_motion(bench_trials):
    trial = bench_trials[0]
    sums = torque_sums(ARM, BASE, trial.q, trial.dq, trial.ddq, trial.tau)
    values = dict(zip(BASE.names, BASE.combination @ standard_parameters(ARM), strict=True))
    friction = {name: values[name] for name in ("D1", "D2", "fc1", "fc2")}
    fit = fit_sums(ARM, BASE, sums, method="least-squares", fixed=friction)
    true = np.array([value for name, value in values.items() if name not in friction])
    found = polished_by_motion(assembled(fit, 1.05 * true), bench_trials[:4], np.inf)
    assert found.objective == "motion"
    learnt = np.array([found.parameters[BASE.names[k]].value for k in fit.problem.free])
    assert learnt == pytest.approx(true, rel=5e-3)  # steps of 2 ms; the data come from far shorter ones
