"""Fig. 8 under law (7)."""

import numpy as np


def test_gains_of_law_7_are_found_up_to_their_common_factor(fig8):
    law = fig8.document["law_7"]
    gains = law["gains_found"]["parameters"]
    np.testing.assert_allclose(gains["kp2"]["value"], 11.5, rtol=0.03)  # the real ones are alike
    errors = law["angle_error_deg"]
    assert errors["law (7), kp1 taken for 11.5, kp2 found"]["evaluate"]["mean"] < 2.0
    assert errors["law (7), gains taken for 11.5 and 7.5"]["evaluate"]["mean"] > 10.0


def test_a_damping_law_is_taken_for_friction_until_the_friction_is_known(fig8):
    wrong = fig8.document["law_7"]["wrong_law"]
    np.testing.assert_allclose([wrong["friction_free"][name]["value"] for name in ("D1", "D2")], 9.5, rtol=0.02)
    assert not wrong["friction_held"]["law_misfit"]["fits"]
    assert "kv dq" in wrong["friction_held"]["law_misfit"]["sentence"]
