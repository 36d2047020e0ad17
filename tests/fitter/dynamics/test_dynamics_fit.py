"""The document of a fit of dynamics."""

import numpy as np

from arm.arm_file import load_arm
from arm.structural_parameters import structural_parameters
from fitter.dynamics.dynamics_fit import document
from fitter.dynamics.torque_search import fit_sums
from fitter.regression_sums.torque_sums import torque_sums

ARM = load_arm("dd-arm")


def test_it_has_a_95_percent_interval_for_every_parameter():
    base = structural_parameters(ARM)
    rng = np.random.default_rng(0)
    q, dq, ddq, tau = rng.normal(size=(4, 2000, 2))
    fit = fit_sums(ARM, base, torque_sums(ARM, base, q, dq, ddq, tau), method="least-squares")
    found = document(fit, None)
    assert list(found["parameters"]) == [*base.names, "F1", "F2"] == list(found["ci95"])
    value, std = (found["parameters"]["I2"][key] for key in ("value", "std"))
    low, high = found["ci95"]["I2"]
    assert np.allclose([low, high], [value - 1.96 * std, value + 1.96 * std], atol=1e-2 * std)
    assert found["torque_rms_N_m"] == {"learn": None, "evaluate": None}
