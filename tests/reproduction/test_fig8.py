"""Fig. 8, law (7) included."""

import numpy as np
import pytest

from reproduction.experiment import Experiment, Settings
from reproduction.fig8 import run


@pytest.fixture(scope="module")
def found() -> Experiment:
    return run(Settings(quick=True))


def test_the_calibrated_arm_moves_as_the_real_one(found):
    errors = found.document["calibrations"]["ours: smoother, eq. (9)"]["angle_error_deg"]
    assert errors["evaluate"]["mean"] < 0.5
    assert errors["evaluate"]["max"] < 1.5


def test_wrong_gains_scale_every_parameter_and_leave_the_motion(found):
    ours, other = (
        found.document["calibrations"][name]
        for name in ("ours: smoother, eq. (9)", "ours, gains 11.5 / -11.5 assumed")
    )
    for name, p in ours["parameters"].items():
        np.testing.assert_allclose(other["parameters"][name]["value"], 11.5 / 9.5 * p["value"], rtol=1e-3)
    for role in ("learn", "evaluate"):
        np.testing.assert_allclose(
            other["angle_error_deg"][role]["mean"], ours["angle_error_deg"][role]["mean"], rtol=1e-2
        )


def test_gains_of_law_7_are_found_up_to_their_common_factor(found):
    law = found.document["law_7"]
    gains = law["gains_found"]["parameters"]
    np.testing.assert_allclose(gains["kp2"]["value"], 11.5, rtol=0.03)  # the real ones are alike
    errors = law["angle_error_deg"]
    assert errors["law (7), kp1 taken for 11.5, kp2 found"]["evaluate"]["mean"] < 2.0
    assert errors["law (7), gains taken for 11.5 and 7.5"]["evaluate"]["mean"] > 10.0


def test_a_damping_law_is_taken_for_friction_until_the_friction_is_known(found):
    wrong = found.document["law_7"]["wrong_law"]
    np.testing.assert_allclose([wrong["friction_free"][name]["value"] for name in ("D1", "D2")], 9.5, rtol=0.02)
    assert not wrong["friction_held"]["law_misfit"]["fits"]
    assert "kv dq" in wrong["friction_held"]["law_misfit"]["sentence"]
