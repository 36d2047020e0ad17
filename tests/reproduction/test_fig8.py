"""Fig. 8."""

import numpy as np


def test_the_calibrated_arm_moves_as_the_real_one(fig8):
    errors = fig8.document["calibrations"]["ours: smoother, eq. (9)"]["angle_error_deg"]
    assert errors["evaluate"]["mean"] < 0.5
    assert errors["evaluate"]["max"] < 1.5


def test_wrong_gains_scale_every_parameter_and_leave_the_motion(fig8):
    ours, other = (
        fig8.document["calibrations"][name]
        for name in ("ours: smoother, eq. (9)", "ours, gains 11.5 / -11.5 assumed")
    )
    for name, p in ours["parameters"].items():
        np.testing.assert_allclose(other["parameters"][name]["value"], 11.5 / 9.5 * p["value"], rtol=1e-3)
    for role in ("learn", "evaluate"):
        np.testing.assert_allclose(
            other["angle_error_deg"][role]["mean"], ours["angle_error_deg"][role]["mean"], rtol=1e-2
        )
