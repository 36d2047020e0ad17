"""Whether a motion reveals a joint."""

import numpy as np
import pytest

from fitter.functional.functional_axis import functional_axis
from fitter.functional.functional_centre import functional_centre
from fitter.functional.sufficient_rotation import LEAST_TURN_RAD, joint_motion, least_turn_rad, moved_trials
from limbcal.errors import NotIdentifiable
from tests.fitter.functional.poses import segments, simulated
from tests.fitter.functional.simulated_limb import RATE_HZ, ball_angles, limb


@pytest.mark.parametrize("find", [functional_centre, functional_axis])
def test_a_joint_that_stood_still_is_refused_with_the_motion_that_would_do(find):
    rng = np.random.default_rng(7)
    still = np.radians(1.0) * np.sin(np.arange(500)[:, None] / RATE_HZ + np.arange(3))
    parent, child = segments([limb(still, rng, skin_m=0.001, skin_rad=0.003)])
    with pytest.raises(NotIdentifiable, match=r"knee_right: shank_right turned by .* expected at least 8°: bend"):
        find("knee_right", parent, child)


def test_wandering_markers_need_more_turn():
    _, *calm = simulated("ball", 1, 300)
    _, *wild = simulated("ball", 1, 300, skin_m=0.03)
    assert least_turn_rad(*calm) == LEAST_TURN_RAD
    assert least_turn_rad(*wild) > LEAST_TURN_RAD


def test_a_trial_at_rest_does_not_speak_for_itself():
    rng = np.random.default_rng(2)
    parent, child = segments([limb(angles, rng) for angles in (ball_angles(rng, 900), np.zeros((900, 3)))])
    assert len(moved_trials(joint_motion("hip_right", parent, child), 0)) == 1
