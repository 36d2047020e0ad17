"""What friction adds up to."""

from dataclasses import replace

import numpy as np
import pytest

from arm.chain import chain_of
from arm.model import Effect
from fitter.dynamics.braking import friction_at, seen_states
from tests.fitter.driven import TRUE, driven_trials

SEEN = np.zeros((3, 4, 2))
SEEN[2] = np.array([0.5, 1.0, 2.0, 4.0])[:, None]


def test_terms_of_any_name_add_up_and_what_is_no_friction_does_not():
    effects = (
        Effect("coulomb", {"coulomb_N_m": -0.05}, joints=(1,)),
        Effect("quadratic_drag", {"drag_N_m_s2": 0.01}, joints=(1,)),
        Effect("torque_offset", {"torque_N_m": 3.0}, joints=(1,)),
        Effect("joint_spring", {"stiffness_N_m_rad": 3.0, "rest_angle_rad": 1.0}, joints=(1,)),
    )
    arm = replace(TRUE, effects=effects)
    total, largest = friction_at(arm, chain_of(arm).friction, SEEN)
    v = SEEN[2, :, 0]
    assert total[:, 0] == pytest.approx(0.01 * v + 0.02 - 0.05 + 0.01 * v**2)
    assert total[:, 1] == pytest.approx(0.01 * v + 0.02)
    assert largest == pytest.approx([0.16, 0.04])


def test_speeds_go_from_the_slowest_to_the_fastest():
    trials = driven_trials(TRUE, 2, 2e-4)
    speed = seen_states(trials)[2]
    dq = np.abs(np.concatenate([trial.dq for trial in trials]))
    assert speed[-1] == pytest.approx(dq.max(axis=0)) and np.all(np.diff(speed, axis=0) >= 0.0)
    assert np.all(speed[0] > 0.0)
